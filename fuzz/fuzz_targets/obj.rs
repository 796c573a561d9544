//! Any bytes as an OBJ; the bytes after a zero byte are the MTL.
#![no_main]

#[path = "../checks/obj.rs"]
mod obj;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| obj::check(bytes));
