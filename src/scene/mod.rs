//! The scene: the JSON that a request consists of.
//!
//! - `types`, `waves`, `height_field`, `quality`, `dials`: the fields (`dials`: the choice of a method, and the dials that only this method has);
//! - `json` reads text, `strict` reads values, `parse` puts the two together;
//! - `basin`: samples and steps of basins;
//! - `ranges`, `validate`, `validate_obstacles`, `validate_output`: which values are refused;
//! - `overrides`: single fields replaced from outside, as by command-line flags;
//! - `projection`: a camera as matrices;
//! - `resolve`: mesh ids become meshes; `field_frames`: those of files of heights become frames.
//!
//! The list of methods is known to `methods` only, which therefore has a `resolve` of its own: the CLI, the HTTP service and the
//! tests call that one.
//!
//! To add a field: put it into `types` with unit, range and default in its doc comment, put its range into `ranges`, check it in
//! `validate`, and run the tests: they report where `openapi.yaml` has to change.

mod basin;
pub mod dials;
pub mod error;
mod field_frames;
mod findings;
pub mod height_field;
pub mod json;
pub mod names;
pub mod overrides;
pub mod parse;
pub mod pointer;
pub mod projection;
pub mod quality;
pub mod ranges;
pub mod resolve;
mod strict;
pub mod types;
pub mod validate;
mod validate_obstacles;
mod validate_output;
pub mod water_map;
pub mod waves;

pub use dials::{Dial, DialKind, DialValue, DialWord, MethodChoice};
pub use error::{Issue, IssueKind, SceneError};
pub use field_frames::FieldFrames;
pub use height_field::{
    AfterLast, FieldEdges, FieldHolds, FirstRow, HeightField, RowAxis, SampleDistance,
};
pub use quality::Quality;
pub use resolve::{Assets, ResolvedScene, resolve};
pub use types::*;
pub use water_map::WaterMapOutput;
pub use waves::*;
