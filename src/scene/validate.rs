//! Ranges and references.
