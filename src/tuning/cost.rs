//! What a plan will take: each pass costs something to start and something per unit of its work.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::facts::SceneFacts;
use crate::passes::estimate::{self, Compared};
use crate::passes::maps::MapLayout;
use crate::passes::slot;
use crate::plan::Plan;

/// Cost of a pass on one machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassRate {
    /// Each run, whatever it does, ms.
    pub start_ms: f64,
    /// Each unit of [`work`], ns.
    pub unit_ns: f64,
}

/// Units of work of one run of a pass: rays through waves, texels, pixels — whatever its time grows with. 0 for a pass that is not
/// known.
pub fn work(pass: &str, facts: &SceneFacts) -> f64 {
    let cells = f64::from(facts.quality.water_cells).powi(2);
    let waves = facts.surface.gpu_element_count() as f64;
    let wet = facts.wet_objects().count() as f64;
    let maps = MapLayout::of(facts);
    let texels = maps.flux_texels() as f64;
    let sums = 0.6 + 0.4 * f64::from(facts.channels());
    let level_texels = (facts.objects.iter())
        .map(|o| f64::from(o.map_texels).powi(2))
        .fold(0.0, f64::max);
    let pixels = facts.camera.map_or(0.0, |camera| {
        f64::from(camera.width)
            * f64::from(
                camera
                    .height
                    .min(slot::band_rows(camera.width, camera.height)),
            )
    });
    match pass {
        // Front and back, and once more for each further layer.
        "level_map" | "level_map_pyramid" => {
            level_texels * 0.5 * f64::from(1 + facts.quality.layers)
        }
        "surface" => cells * (1.0 + waves),
        "beams" => cells,
        // A ray looks at the objects over its way, which the hierarchy over them finds: between some and all of a row of them.
        "hits" => cells * (1.0 + wet.sqrt()),
        // Beams cover the maps about twice over, however many there are; each has its share of setting up, and each channel its sums.
        "deposit" => (5.0 * cells + texels) * sums,
        // Parts along the shadows' edges, each with rays through the waves and down the meshes' hierarchies.
        "split" => {
            f64::from(facts.quality.water_cells)
                * f64::from(1_u32 << facts.quality.split_levels)
                * edges(facts)
                * (1.0 + waves + (facts.geometry_bytes as f64 / 64.0).max(1.0).log2())
        }
        // Where rays are looked after, each goes through the waves some dozens of times.
        "unfollowed" => {
            let ways = facts.unfollowed_ways();
            let steps = if ways.again || ways.bared { 32.0 } else { 0.0 };
            cells * (2.0 + steps * (1.0 + waves))
        }
        "landed" => texels * f64::from(facts.channels()),
        "irradiance" => texels,
        // All the light's passes with fewer cells on the coarse maps, then its part of the places that are looked at.
        "coarse_irradiance" => {
            let coarse_texels = MapLayout::with_floor(facts, estimate::coarse_floor_map(facts))
                .flux_texels() as f64;
            f64::from(estimate::coarse_cells(facts)).powi(2)
                * (5.0 * sums + 2.0 + waves + wet.sqrt())
                + coarse_texels * sums
                + places_of_a_light(facts)
        }
        "estimate" => compared_places(facts, |_| true),
        "camera_hits" => pixels * (1.0 + waves),
        "camera_irradiance" | "shade" => pixels,
        _ => 0.0,
    }
}

/// Places at which a frame's estimate of its own error compares these maps.
fn compared_places(facts: &SceneFacts, these: impl Fn(&Compared) -> bool) -> f64 {
    let compared = estimate::compared(facts);
    let these = compared.iter().filter(|map| these(map));
    these.map(|map| f64::from(map.comparison.places)).sum()
}

/// Those of one light, as a mean: the floor's, to which every light adds, and those of its own maps.
fn places_of_a_light(facts: &SceneFacts) -> f64 {
    let lights = facts.lights.len().max(1) as f64;
    compared_places(facts, |map| map.light.is_none())
        + compared_places(facts, |map| map.light.is_some()) / lights
}

/// Length of the shadows' edges, in sides of the lights' windows.
fn edges(facts: &SceneFacts) -> f64 {
    let around_m: f64 = facts
        .wet_objects()
        .map(|index| {
            let size = facts.objects[index].max - facts.objects[index].min;
            2.0 * (size.x + size.z)
        })
        .sum();
    let side_m = facts
        .lights
        .iter()
        .map(|light| light.span_m(facts.quality.water_cells))
        .fold(0.0, f64::max);
    if side_m > 0.0 { around_m / side_m } else { 0.0 }
}

/// What a plan will take with warm pipelines, ms. Passes without a rate count nothing.
pub fn predicted_ms(
    plan: &Plan,
    facts: &SceneFacts,
    frame_ms: f64,
    rates: &BTreeMap<String, PassRate>,
) -> f64 {
    let samples = f64::from(facts.quality.pixel_samples).powi(2);
    let passes: f64 = plan
        .passes
        .iter()
        .filter_map(|pass| {
            let rate = rates.get(&pass.name)?;
            let looks = if pass.name.starts_with("camera") || pass.name == "shade" {
                samples
            } else {
                1.0
            };
            let once = rate.start_ms + rate.unit_ns * 1e-6 * work(&pass.name, facts);
            Some(f64::from(pass.runs) * looks * once)
        })
        .sum();
    frame_ms + passes
}

/// The rate that comes nearest to some measured (work, ms of one run) in relative terms; both parts 0 or more.
pub fn fit_rate(measured: &[(f64, f64)]) -> PassRate {
    // Least squares of (start + unit·work)/ms − 1: every measurement counts alike, small or large.
    let (mut a, mut b, mut c, mut d, mut e) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(work, ms) in measured.iter().filter(|(_, ms)| *ms > 0.0) {
        let (x, y) = (1.0 / ms, work / ms);
        a += x * x;
        b += x * y;
        c += y * y;
        d += x;
        e += y;
    }
    let determinant = a * c - b * b;
    let (start, unit) = if determinant > 1e-12 * a * c {
        ((d * c - e * b) / determinant, (a * e - b * d) / determinant)
    } else if c > 0.0 {
        (0.0, e / c)
    } else {
        (0.0, 0.0)
    };
    let (start, unit) = if start < 0.0 && c > 0.0 {
        (0.0, e / c)
    } else if unit < 0.0 && a > 0.0 {
        (d / a, 0.0)
    } else {
        (start, unit)
    };
    PassRate {
        start_ms: start,
        unit_ns: unit * 1e6,
    }
}
