//! Any bytes as an OBJ, and after every two zero bytes as an MTL.
#![no_main]

#[path = "../checks/obj.rs"]
mod obj;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| obj::check(bytes));
