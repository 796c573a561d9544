//! Experiments that repeat what others have published, a folder each: `level_map` the thesis's comparison of techniques, `sea` the
//! fluctuations of sunlight under the sea.

pub mod level_map;
pub mod sea;
