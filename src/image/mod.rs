//! Image files: writes the linear layers of a frame as PNG or EXR, and reads them back.
//!
//! `encode` selects the format; `layers` names the layers in a file and checks them; `tone` has the tone curves, `normal_map` the codes of normals; `png` and
//! `exr` write; `exr_header` makes an EXR header reproducible; `metadata` selects the statistics that a file contains; `decode` reads
//! both formats for comparisons.
//!
//! The same frame gives the same bytes: no file contains a time of day, a duration or the state of a cache.

pub mod decode;
pub mod encode;
pub mod exr;
mod exr_header;
pub mod layers;
pub mod metadata;
mod normal_map;
pub mod png;
pub mod tone;

pub use decode::{DecodeError, DecodedExr, DecodedPng, decode_exr, decode_png};
pub use encode::{EncodeError, Encoded, encode};
pub use metadata::Metadata;
