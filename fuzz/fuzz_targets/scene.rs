//! Any bytes as a scene. Every second mutation changes JSON values, so that inputs get past the parser.
#![no_main]

#[path = "../checks/scene.rs"]
mod scene;

mod json_mutator;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|bytes: &[u8]| scene::check(bytes));

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    if seed % 2 == 0
        && let Some(changed) = json_mutator::change(&data[..size], seed)
        && changed.len() <= max_size.min(data.len())
    {
        data[..changed.len()].copy_from_slice(&changed);
        return changed.len();
    }
    fuzzer_mutate(data, size, max_size)
});
