//! Tests (http).
