//! Tests (gpu).
