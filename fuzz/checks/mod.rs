//! What must hold for any bytes at all: shared by the fuzz targets and by the tests that replay what fuzzing has found.

pub(crate) mod obj;
pub(crate) mod scene;
