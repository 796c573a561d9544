//! Curves of a study as SVG and PNG, both from one drawing routine.
//!
//! `error_time`, `convergence` and `lines` say what is drawn. They draw on a `canvas` (any backend), on a `frame` of axes (`axis`) with
//! a `legend`; `labels` keeps texts apart, `marker` and `palette` tell sweeps apart, `font` holds the one font, `output` makes
//! the files, `error` says why there is none.

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
