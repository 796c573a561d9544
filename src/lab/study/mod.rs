//! Studies: error against time.
//!
//! `dial` lists what can be swept, `comparison` the settings of each method, `settings` the series of both, `points` what is compared;
//! `sweep` renders, compares and times each setting, `study` holds the results. `figures` computes all metrics of one image, `order` the
//! order of convergence, `pareto` the Pareto front, `equal_time` which method is nearest in a time. For people: `plot` (curves), `error_images`
//! (contact sheets) and `report` (JSON, CSV, Markdown and the folder with all files); `words` formats numbers.

mod colour_map;
pub mod comparison;
pub mod dial;
pub mod equal_time;
pub mod error_images;
mod error_tiles;
pub mod figures;
pub mod order;
pub mod pareto;
pub mod plot;
pub mod points;
pub mod report;
mod resize;
mod settings;
mod sheet;
#[expect(clippy::module_inception, reason = "a study is what the room makes")]
pub mod study;
pub mod sweep;
pub mod words;

pub use error_images::error_images;
pub use figures::error_figures;
pub use order::fit_orders;
pub use pareto::mark_pareto_front;
