//! From a wanted error or time to dials.
//!
//! - `ladder`: the dials as one family, each rung in balance;
//! - `choose`: which rung a wanted error needs, from looks at its light;
//! - `cost`: what a plan will take, pass by pass;
//!
//! Both rest on the figures of a [calibration](crate::calibration).
//!
//! Nothing here touches a GPU: looking at a scene and measuring are handed in.

pub mod choose;
pub mod cost;
pub mod ladder;

use crate::scene::Quality;

/// Whether dials are chosen for what `quality` asks.
pub fn chooses_dials(quality: &Quality) -> bool {
    quality.target_error.is_some() || quality.time_budget_ms.is_some()
}
