//! Checks obstacles in basins: that they exist, that the basin allows them, and that the steps in time are affordable.

use super::findings::Findings;
use super::ranges::{self, number};
use super::types::Scene;
use super::waves::{RippleDispersion, Ripples, Wave};

pub(super) fn obstacles(findings: &mut Findings, scene: &Scene) {
    let mut sample_steps = 0.0;
    for (index, wave) in scene.water.waves.iter().enumerate() {
        let Wave::Ripples(waves) = wave else {
            continue;
        };
        if waves.obstacles.is_empty() {
            continue;
        }
        let at = |field: &str| format!("/water/waves/{index}/{field}");
        if is_allowed(findings, scene, waves, &at) && is_sized(waves) {
            let depth_m = scene.floor.as_ref().map(|floor| floor.depth_m);
            let own = waves.sample_steps(depth_m, scene.time_s);
            sample_steps += own;
            if sample_steps > ranges::MAX_SAMPLE_STEPS {
                over_budget(findings, scene.time_s, waves, sample_steps, own);
                return;
            }
        }
    }
}

/// Whether ranges that other checks report allow to count steps.
fn is_sized(waves: &Ripples) -> bool {
    waves
        .sides_m()
        .iter()
        .all(|side_m| ranges::TILE.contains(*side_m))
        && <ranges::BasinSamples as ranges::Integer>::accepts(waves.samples)
}

fn is_allowed(
    findings: &mut Findings,
    scene: &Scene,
    waves: &Ripples,
    at: &dyn Fn(&str) -> String,
) -> bool {
    let count = scene.objects.len();
    for (place, object) in waves.obstacles.iter().enumerate() {
        let pointer = at(&format!("obstacles/{place}"));
        if *object as usize >= count {
            let accepted = match count {
                0 => "no obstacles: the scene has no objects".to_owned(),
                1 => "0".to_owned(),
                _ => format!("0 … {}", count - 1),
            };
            findings.invalid(pointer, format!("there is no object {object}"), accepted);
        } else if waves.obstacles[..place].contains(object) {
            findings.invalid(pointer, "the object is named twice", "each object once");
        }
    }
    if waves.dispersion != RippleDispersion::Shallow {
        findings.invalid(
            at("dispersion"),
            "waves whose speed depends on their length are not computed around obstacles",
            "`shallow`, or no `obstacles`",
        );
        return false;
    }
    if scene.floor.is_none() {
        findings.invalid(
            at("obstacles"),
            "without a floor there is no shallow water, and no other is computed around obstacles",
            "a `floor`, whose `depth_m` sets the speed of the waves, or no `obstacles`",
        );
        return false;
    }
    true
}

fn over_budget(findings: &mut Findings, time_s: f64, waves: &Ripples, all: f64, own: f64) {
    let first_s = waves.first_drop_s().unwrap_or(time_s);
    let left = (ranges::MAX_SAMPLE_STEPS - (all - own)).max(0.0);
    let most_s = (time_s - first_s) * (left / own);
    findings.over_limit(
        "/time_s",
        format!(
            "from the first drop at {} s, basins with obstacles need {} samples × steps",
            number(first_s),
            number(all)
        ),
        format!(
            "at most {} samples × steps: a time of at most {} s after the first drop, or fewer `samples`, or less depth",
            number(ranges::MAX_SAMPLE_STEPS),
            number((most_s * 100.0).floor() / 100.0)
        ),
    );
}
