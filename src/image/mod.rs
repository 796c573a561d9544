//! Image files: how the linear layers of a frame become PNG or EXR, and back.
//!
//! `encode` picks the format; `layers` says what each layer is called in a file and checks it; `tone` holds the display
//! curves; `png` and `exr` write; `exr_header` makes an EXR header reproducible; `metadata` picks from the statistics what
//! a file may carry; `decode` reads both formats for comparisons.
//!
//! The same frame gives the same bytes: no file holds a time of day, a duration or the state of a cache.

pub mod decode;
pub mod encode;
pub mod exr;
mod exr_header;
pub mod layers;
pub mod metadata;
pub mod png;
pub mod tone;

pub use decode::{DecodeError, DecodedExr, DecodedPng, decode_exr, decode_png};
pub use encode::{EncodeError, Encoded, encode};
pub use metadata::Metadata;
