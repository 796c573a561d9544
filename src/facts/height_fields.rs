//! Warnings about water from numbers that a user brings.

use glam::DVec2;

use super::blocked::places;
use super::source::Source;
use super::warnings::{warning, with_flux};
use super::window::{self, Rect};
use super::{BeamSet, SceneFacts};
use crate::physics::fresnel::fresnel_transmittance;
use crate::stats::Warning;
use crate::waves::Rim;

/// Places along each side of a part of a rim, for the flux of a point light.
const SIDE: u32 = 32;

/// Share of the mean square slope in a file that may belong to no surface without a warning.
const MAX_NO_GRADIENT: f64 = 0.01;

/// Relative change of the irradiance, from sample to sample, that the steps of the numbers in a file may make without a warning.
const MAX_STEP_LIGHT: f64 = 0.02;

/// All warnings about height fields.
pub(super) fn warnings(facts: &SceneFacts) -> Vec<Warning> {
    let mut all = Vec::new();
    for (wave, notes) in facts.water.surface.field_notes() {
        let at = format!("/water/waves/{wave}");
        if let Some(rim) = &notes.rim {
            all.extend(rim_warning(facts, rim, &at));
        }
        if notes.no_gradient > MAX_NO_GRADIENT {
            let message = format!(
                "{:.1} % of the mean square slope in the file belongs to no surface, so it is left out; slopes of a surface have no curl, and those of a periodic one no mean. A wrong sign, order of channels, `first_row` or `rows_along` is often the cause",
                100.0 * notes.no_gradient
            );
            all.push(warning("slopes_are_no_gradient", message, at.clone()));
        }
        // A second derivative h″ at the depth d changes the irradiance by the factor 1/(1 − (1 − 1/n) d h″).
        let lens = 1.0 - 1.0 / facts.water.ior;
        let change = notes.curvature_of_steps_per_m * lens * deepest_m(facts);
        if change > MAX_STEP_LIGHT {
            let message = format!(
                "the steps between the numbers that the file can hold change the irradiance by about {:.0} % from sample to sample; a narrower range, floats of more bits or fewer samples make smaller steps",
                100.0 * change
            );
            all.push(warning("height_field_coarse_numbers", message, at));
        }
    }
    all
}

/// Depth of the deepest receiver, m.
fn deepest_m(facts: &SceneFacts) -> f64 {
    let receivers = window::receivers(facts);
    receivers.iter().map(|lit| -lit.min.y).fold(0.0, f64::max)
}

/// Light that enters through the rim of a bounded field.
fn rim_warning(facts: &SceneFacts, rim: &Rim, at: &str) -> Option<Warning> {
    let [outer, inner] = [rim.outer_m, rim.inner_m].map(|[min, max]| Rect { min, max });
    let (mut through_rim_w, mut within_w, mut all_w) = ([0.0; 3], 0.0, 0.0);
    for set in &facts.lights.beam_sets {
        let entering = |rect: Rect| {
            let part = rect.within(set.window);
            part.map_or(0.0, |rect| unit_flux_in(facts, set, rect))
        };
        let unit: f64 = frame(outer, inner).into_iter().map(entering).sum();
        for (sum, power) in through_rim_w.iter_mut().zip(set.power) {
            *sum += power * unit;
        }
        let power: f64 = set.power.iter().sum();
        within_w += power * (unit + entering(inner));
        all_w += power * entering(set.window);
    }
    let rim_w: f64 = through_rim_w.iter().sum();
    if rim_w <= 0.0 {
        return None;
    }
    let message = format!(
        "the field is blended to flat within {:.3} m of its edges, which changes heights by up to {:.1e} m; of the light that enters the simulated part of the water, {:.1} % does so through this rim and {:.1} % beyond the field, where the water is flat",
        inner.min.x - outer.min.x,
        rim.changed_m,
        100.0 * rim_w / all_w,
        100.0 * (1.0 - within_w / all_w).max(0.0),
    );
    Some(with_flux(
        warning("height_field_rim", message, at),
        through_rim_w,
    ))
}

/// The four parts between two rectangles.
fn frame(outer: Rect, inner: Rect) -> [Rect; 4] {
    let rect = |min_x: f64, min_z: f64, max_x: f64, max_z: f64| Rect {
        min: DVec2::new(min_x, min_z),
        max: DVec2::new(max_x, max_z),
    };
    [
        rect(outer.min.x, outer.min.y, outer.max.x, inner.min.y),
        rect(outer.min.x, inner.max.y, outer.max.x, outer.max.y),
        rect(outer.min.x, inner.min.y, inner.min.x, inner.max.y),
        rect(inner.max.x, inner.min.y, outer.max.x, inner.max.y),
    ]
}

/// Flux of a light of unit power that enters the water at rest in a rectangle, m² or sr; none of a light under water.
fn unit_flux_in(facts: &SceneFacts, set: &BeamSet, rect: Rect) -> f64 {
    match set.source {
        Source::Sun { to_light } => {
            let area_m2 = rect.size().element_product();
            area_m2 * to_light.y * fresnel_transmittance(to_light.y, facts.water.ior)
        }
        Source::Point { .. } => {
            let entering = |place: super::blocked::Place| {
                let (to_light, _) = place.to(&set.source)?;
                Some(
                    place.unit_flux(&set.source)
                        * fresnel_transmittance(to_light.y, facts.water.ior),
                )
            };
            places(rect, SIDE).filter_map(entering).sum()
        }
        Source::Submerged { .. } => 0.0,
    }
}
