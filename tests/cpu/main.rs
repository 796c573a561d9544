//! Tests (cpu).
mod image_exr;
mod image_metadata;
mod image_png;
mod image_support;
mod project;
mod tone;
