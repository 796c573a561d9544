//! The scene: what a request may say (`types`, `quality`), how JSON becomes it (`json` reads text, `strict` reads values, `parse` puts
//! them together), what is refused (`ranges`, `validate`, `validate_output`), how single fields are replaced from outside
//! (`overrides`), how mesh ids become meshes (`resolve`), and the figures everything downstream is decided from (`facts`; `source`: where
//! light comes from; `window` and `lamp_window`: through which water), and what they say is left out (`warnings`; `unfollowed`, `stopped`:
//! how much light that is).
//!
//! To add a field: put it into `types` with unit, range and default in its doc comment, its range into `ranges`, check it in
//! `validate`, and run the tests, which tell where `openapi.yaml` has to follow.

pub mod error;
mod findings;
pub mod json;
mod names;
pub mod overrides;
pub mod parse;
mod pointer;
pub mod quality;
pub mod ranges;
pub mod resolve;
mod strict;
pub mod types;
pub mod validate;
mod validate_output;

pub use error::{Issue, IssueKind, SceneError};
pub use quality::{Method, Placement, Quality, Slicing};
pub use resolve::{ResolvedScene, resolve};
pub use types::*;
