//! How sunlight on a horizontal floor under the sea fluctuates with depth and wind, beside what was measured at sea.
//!
//! `scene` makes the sea over a floor, `disc` blurs maps by the sun's disc, `fluctuation` and `flashes` make figures of maps and of time
//! series, `measure` renders and collects them in a `study`; `published` has the figures of others; `markdown`, `csv` and `write` write
//! files.

mod csv;
mod disc;
mod flashes;
mod fluctuation;
mod markdown;
mod measure;
mod published;
mod scene;
mod study;
mod write;

pub use csv::to_csv;
pub use disc::Disc;
pub use flashes::{Flashes, flashes};
pub use fluctuation::{Fluctuation, Grid, fluctuation};
pub use markdown::to_markdown;
pub use measure::{Render, SeaError, Settings, measure};
pub use scene::{Place, scene, texel_m};
pub use study::{Check, Checks, Estimate, FlashFigures, PlaceResult, SeaStudy, SlopeResult};
pub use write::{plots, write};
