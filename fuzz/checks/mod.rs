//! Checks that must hold for any bytes, shared by the fuzz targets and the tests that replay fuzzing's finds.

pub(crate) mod field;
pub(crate) mod obj;
pub(crate) mod scene;
