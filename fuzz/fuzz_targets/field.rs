//! Any bytes as a file of numbers: NPY, EXR or PNG.
#![no_main]

#[path = "../checks/field.rs"]
mod field;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| field::check(bytes));
