//! The laboratory: studies of error against time, published experiments, hard cases, generated shapes and planted errors. It uses
//! the engine as any other program would; the engine never imports it.

pub mod calibrate;
pub mod experiment;
pub mod hard_cases;
pub mod shapes;
pub mod study;
