//! Chooses dials for a requested error or time, by trial renders of the scene's light.

use tokio_util::sync::CancellationToken;

use super::{Prepared, RenderError, Renderer, bindable_bytes};
use crate::methods;
use crate::plan::{self, NothingCached, Wanted, WarmCache};
use crate::scene::ResolvedScene;
use crate::stats::{ChosenDials, Warning};
use crate::tuning::choose::{self, Prospect};
use crate::tuning::{chooses_dials, cost, ladder};

/// A scene whose dials were chosen.
pub(super) struct Tuned {
    /// The scene with them.
    pub(super) rung: Prepared,
    /// What they are, and why.
    pub(super) chosen: ChosenDials,
}

impl Renderer {
    /// The scene with dials chosen for the error or time that `quality` requests; `None` if it requests neither, or if no dial has an
    /// effect on the output.
    pub(super) fn tuned(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Option<Tuned>, RenderError> {
        let resolved = prepared.resolved();
        let quality = &resolved.scene.quality;
        if !chooses_dials(&resolved.scene) {
            return Ok(None);
        }
        let chosen = if let Some(target) = quality.target_error {
            self.for_error(resolved, target, cancel)?
        } else if let Some(budget_ms) = quality.time_budget_ms {
            self.for_time(resolved, budget_ms, cancel)?
        } else {
            return Ok(None);
        };
        // Prepared here and not with the request, because trial renders on this device choose the dials that facts and warnings depend on.
        let rung = Prepared::new(with_cells(resolved, chosen.water_cells))?;
        Ok(Some(Tuned { rung, chosen }))
    }

    fn for_error(
        &mut self,
        resolved: &ResolvedScene,
        target: f64,
        cancel: &CancellationToken,
    ) -> Result<ChosenDials, RenderError> {
        let is_view = resolved.scene.output.is_view();
        let prospect = Prospect {
            most_cells: self.most_cells(resolved)?,
            margin: choose::margin(self.calibration.error_margin, is_view),
            is_view,
        };
        let choice = choose::for_error(target, &prospect, |cells| {
            self.probe(resolved, cells, cancel)
        })?;
        let reason = if choice.meets {
            format!(
                "{} trial renders: the fewest cells that are predicted to stay under {target}",
                choice.probes
            )
        } else {
            format!(
                "{} trial renders: no number of cells is certain to stay under {target}; these are predicted to come nearest",
                choice.probes
            )
        };
        self.dials(
            resolved,
            choice.cells,
            choice.predicted_error,
            choice.meets,
            reason,
        )
    }

    fn for_time(
        &mut self,
        resolved: &ResolvedScene,
        budget_ms: f64,
        cancel: &CancellationToken,
    ) -> Result<ChosenDials, RenderError> {
        let most = self.most_cells(resolved)?;
        let (cells, meets) =
            choose::for_time(budget_ms, most, |cells| self.predicted_ms(resolved, cells))?;
        // A trial render with enough cells to predict the error from.
        let probe_cells = (cells / 2).max(ladder::FEWEST_CELLS);
        let probed = self.probe(resolved, probe_cells, cancel)?;
        let error = probed.unwrap_or(0.0);
        let is_view = resolved.scene.output.is_view();
        let margin = choose::margin(self.calibration.error_margin, is_view);
        let predicted = choose::extrapolated(error * margin, probe_cells, cells, is_view);
        let reason = if meets {
            format!("the most cells that are predicted to take at most {budget_ms} ms")
        } else {
            format!("even the fewest cells are predicted to take more than {budget_ms} ms")
        };
        self.dials(resolved, cells, predicted, meets, reason)
    }

    fn dials(
        &self,
        resolved: &ResolvedScene,
        cells: u32,
        predicted_error: f64,
        meets: bool,
        reason: String,
    ) -> Result<ChosenDials, RenderError> {
        let quality = ladder::rung(&resolved.scene.quality, &resolved.scene.output, cells);
        Ok(ChosenDials {
            water_cells: quality.water_cells,
            map_texels: quality.map_texels,
            level_map_texels: quality.level_map_texels,
            split_levels: quality.split_levels,
            predicted_error,
            predicted_ms: self.predicted_ms(resolved, cells)?,
            meets,
            reason,
        })
    }

    /// Hash of everything besides the scene and the adapter that the chosen dials depend on.
    pub fn dial_basis(&self) -> String {
        let calibration = &self.calibration;
        let budgets = [
            self.memory_budget_bytes,
            self.level_maps.stats().budget_bytes,
            bindable_bytes(&self.gpu),
        ];
        let basis = serde_json::json!({ "calibration": calibration, "budgets_bytes": budgets });
        blake3::hash(basis.to_string().as_bytes())
            .to_hex()
            .to_string()
    }

    /// The largest number of cells whose frame fits the memory of an empty GPU. Independent of the cache, so that the same request gets the
    /// same dials.
    fn most_cells(&self, resolved: &ResolvedScene) -> Result<u32, RenderError> {
        let (mut low, mut high) = (ladder::FEWEST_CELLS, ladder::MOST_CELLS + 1);
        let empty = NothingCached {
            arena_bytes: self.level_maps.stats().budget_bytes,
            field_arena_bytes: self.fields.stats().budget_bytes,
        };
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            let mut rung = with_cells(resolved, middle);
            rung.scene.quality.estimate_error = true;
            let facts = methods::facts(&rung)?;
            let level_maps: u64 = plan::level_maps(&facts).iter().map(|k| k.bytes()).sum();
            let fits = level_maps <= empty.arena_bytes;
            match self.check_budget(&plan::plan_scene(&facts, Wanted::Frame, &empty)?) {
                Ok(()) if fits => low = middle,
                Ok(()) => high = middle,
                Err(RenderError::OverBudget { .. }) => high = middle,
                Err(error) => return Err(error),
            }
        }
        Ok(low)
    }

    /// Predicted time of a warm frame with this number of cells, ms.
    fn predicted_ms(&self, resolved: &ResolvedScene, cells: u32) -> Result<f64, RenderError> {
        let facts = methods::facts(&with_cells(resolved, cells))?;
        let plan = plan::plan_scene(&facts, Wanted::Frame, &WarmCache)?;
        Ok(cost::predicted_ms(
            &plan,
            &facts,
            self.calibration.frame_ms,
            &self.calibration.passes,
        ))
    }

    /// A trial render: the error estimate of the maps with this number of cells. No picture is made.
    fn probe(
        &mut self,
        resolved: &ResolvedScene,
        cells: u32,
        cancel: &CancellationToken,
    ) -> Result<Option<f64>, RenderError> {
        let mut rung = with_cells(resolved, cells);
        rung.scene.quality.estimate_error = true;
        let facts = methods::facts(&rung)?;
        let plan = self.plan_in_budget(
            &methods::of(&facts.quality).pipeline(),
            &facts,
            Wanted::Estimate,
        )?;
        let run = self.run(&rung, &facts, &plan, cancel)?;
        Ok(run.accuracy.and_then(|accuracy| accuracy.estimated_error))
    }
}

fn with_cells(resolved: &ResolvedScene, cells: u32) -> ResolvedScene {
    let mut rung = resolved.clone();
    rung.scene.quality = ladder::rung(&resolved.scene.quality, &resolved.scene.output, cells);
    rung
}

/// A warning if predictions rest on the calibration of another machine.
pub(super) fn foreign(calibrated: &str, adapter: &str) -> Option<Warning> {
    (calibrated != adapter).then(|| {
        Warning::new(
            "calibrated_elsewhere",
            format!(
                "times are predicted from a calibration of {calibrated}, this is {adapter}: `caustica calibrate` makes one for it"
            ),
        )
    })
}

/// A warning if the requested error or time cannot be met.
pub(super) fn unmet(resolved: &ResolvedScene, chosen: &ChosenDials) -> Option<Warning> {
    if chosen.meets {
        return None;
    }
    let (code, field) = if resolved.scene.quality.target_error.is_some() {
        ("target_error_not_met", "target_error")
    } else {
        ("time_budget_not_met", "time_budget_ms")
    };
    let mut warning = Warning::new(
        code,
        format!(
            "{}: {} water cells, a relative L1 error of {:.2e}, {:.0} ms",
            chosen.reason, chosen.water_cells, chosen.predicted_error, chosen.predicted_ms
        ),
    );
    warning.pointer = Some(format!("/quality/{field}"));
    Some(warning)
}
