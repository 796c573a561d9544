//! Tests (cpu).
