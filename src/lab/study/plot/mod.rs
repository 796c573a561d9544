//! Curves of a study as SVG and PNG, both from one drawing routine.
//!
//! `error_time`, `convergence` and `lines` are the plots. They draw on a `canvas` (any backend), on a `frame` of axes (`axis`) with
//! a `legend`; `labels` places texts without overlap, `marker` and `palette` distinguish sweeps, `font` holds the font, `output` makes
//! the files, `error` has the errors.

mod axis;
pub(super) mod canvas;
mod convergence;
pub(super) mod error;
mod error_time;
pub(super) mod font;
mod frame;
mod labels;
mod legend;
mod lines;
mod marker;
pub(super) mod output;
pub(super) mod palette;
mod series;

pub use convergence::convergence;
pub use error::PlotError;
pub use error_time::error_against_time;
pub use lines::{LineChart, lines};
pub use output::Plot;
