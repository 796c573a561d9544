//! Chooses dials for a target error or a time budget.
//!
//! - `ladder`: combinations of dials, one per number of water cells, in which no dial wastes what the others achieve;
//! - `choose`: which rung meets a target error, from trial renders (probes) of the light;
//! - `cost`: the predicted time of a plan, pass by pass;
//! - `method`: which method to use for an error, and why not the others.
//!
//! Predictions are based on a [calibration](crate::calibration).
//!
//! Nothing here uses a GPU: callers pass in closures that render probes and predict times.

pub mod choose;
pub mod cost;
pub mod ladder;
pub mod method;

use crate::scene::Scene;

/// Whether `quality` requests that dials are chosen. No dial has an effect on a map of the water, so none is chosen for it.
pub fn chooses_dials(scene: &Scene) -> bool {
    let quality = &scene.quality;
    let asks = quality.target_error.is_some() || quality.time_budget_ms.is_some();
    asks && !scene.output.is_water_map()
}
