//! The scene: what a request may say (`types`, `quality`, `dials`: a method and what only this method can be told), how JSON becomes it (`json` reads text, `strict` reads values, `parse` puts
//! them together), what is refused (`ranges`, `validate`, `validate_output`), how single fields are replaced from outside
//! (`overrides`), and how mesh ids become meshes (`resolve`). Which methods there are is known above, in `methods`: faces and tests
//! therefore resolve scenes there.
//!
//! To add a field: put it into `types` with unit, range and default in its doc comment, its range into `ranges`, check it in
//! `validate`, and run the tests, which tell where `openapi.yaml` has to follow.

pub mod dials;
pub mod error;
mod findings;
pub mod json;
pub mod names;
pub mod overrides;
pub mod parse;
pub mod pointer;
pub mod quality;
pub mod ranges;
pub mod resolve;
mod strict;
pub mod types;
pub mod validate;
mod validate_output;

pub use dials::{Dial, DialKind, DialValue, DialWord, MethodChoice};
pub use error::{Issue, IssueKind, SceneError};
pub use quality::Quality;
pub use resolve::{ResolvedScene, resolve};
pub use types::*;
