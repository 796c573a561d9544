//! Studies: error against time.
//!
//! `dial` says what may be swept, `sweep` renders, compares and times each setting, `study` holds the results. `figures` has all
//! metrics of one image, `order` how fast the error falls with a dial, `pareto` the settings that no other beats. For people: `plot`
//! (curves), `error_images` (contact sheets) and `report` (JSON, CSV, Markdown and the folder with everything); `words` writes
//! numbers.

mod colour_map;
pub mod dial;
pub mod error_images;
pub mod figures;
pub mod order;
pub mod pareto;
pub mod plot;
pub mod report;
mod resize;
mod sheet;
#[expect(clippy::module_inception, reason = "a study is what the room makes")]
pub mod study;
pub mod sweep;
pub mod words;

pub use error_images::error_images;
pub use figures::error_figures;
pub use order::fit_orders;
pub use pareto::mark_pareto_front;
