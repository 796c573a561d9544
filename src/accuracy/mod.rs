//! How far an image is from the truth, and what it cost to get that near.
//!
//! `dial` says what may be swept, `sweep` renders, compares and times each setting, `study` holds what was found; `estimate` is what
//! a frame says of its own error. The figures of a study: `metrics` (numbers against numbers), `flip` and `luv` (pictures
//! against pictures, made by `display`), `figures` (all of them for one image), `order` (how fast the error falls with a dial),
//! `pareto` (which settings nothing beats). For people: `plot` (curves), `error_images` (contact sheets) and `report` (JSON,
//! CSV, Markdown and the folder with everything); `words` writes numbers.

mod colour_map;
pub mod dial;
pub mod display;
pub mod error_images;
pub mod estimate;
pub mod figures;
pub mod flip;
pub mod luv;
pub mod metrics;
pub mod order;
pub mod pareto;
pub mod plot;
pub mod report;
mod resize;
mod sheet;
pub mod study;
pub mod sweep;
pub mod words;

pub use error_images::error_images;
pub use figures::error_figures;
pub use metrics::{MetricError, convergence_order};
pub use order::fit_orders;
pub use pareto::mark_pareto_front;
