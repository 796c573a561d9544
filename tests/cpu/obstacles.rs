//! Ripples around obstacles, in steps of time: against exact solutions, their own symmetries, and hard cases.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use caustica::config::Limits;
use caustica::kept::Kept;
use caustica::mesh::{Mesh, obj};
use caustica::physics::constants::GRAVITY_M_PER_S2;
use caustica::physics::oscillator::{Elapsed, Oscillator};
use caustica::scene::{ResolvedScene, Scene, Wave};
use caustica::waves::{Surface, slope_lost};
use serde_json::{Value, json};

/// Depth of the water, m: waves run at 0.99 m/s.
const DEPTH_M: f64 = 0.1;

/// A mesh that cuts no water of these tests.
const AWAY: [f64; 3] = [0.0, -50.0, 0.0];

fn speed_m_per_s() -> f64 {
    (GRAVITY_M_PER_S2 * DEPTH_M).sqrt()
}

/// A box around the origin with these sides.
fn block(sides_m: [f64; 3]) -> Arc<Mesh> {
    let [x, y, z] = sides_m.map(|side_m| 0.5 * side_m);
    let mut text = String::new();
    for corner in 0..8 {
        let sign = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        text += &format!("v {} {} {}\n", sign(0) * x, sign(1) * y, sign(2) * z);
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    Arc::new(obj::read(text.as_bytes(), &[], &Limits::default()).unwrap())
}

/// An upright sheet without thickness from one (x, z) to the next.
fn sheet(corners_m: &[[f64; 2]]) -> Arc<Mesh> {
    let mut text = String::new();
    for [x, z] in corners_m {
        text += &format!("v {x} -1 {z}\nv {x} 1 {z}\n");
    }
    for i in 0..corners_m.len() - 1 {
        let first = 2 * i + 1;
        text += &format!("f {} {} {}\n", first, first + 1, first + 2);
        text += &format!("f {} {} {}\n", first + 1, first + 2, first + 3);
    }
    Arc::new(obj::read(text.as_bytes(), &[], &Limits::default()).unwrap())
}

/// A basin with the fields `waves` in shallow water; its obstacles are `meshes`, each moved by its translation.
struct Basin {
    resolved: ResolvedScene,
}

impl Basin {
    fn new(waves: Value, meshes: &[(Arc<Mesh>, [f64; 3])]) -> Self {
        let mut fields = json!({ "kind": "ripples", "min_m": [-0.5, -0.5], "max_m": [0.5, 0.5], "dispersion": "shallow",
            "obstacles": (0..meshes.len()).collect::<Vec<_>>() });
        let waves = waves.as_object().unwrap().clone();
        fields.as_object_mut().unwrap().extend(waves);
        let objects: Vec<Value> = meshes
            .iter()
            .map(|(mesh, translation_m)| json!({ "mesh": mesh.id, "translation_m": translation_m }))
            .collect();
        let scene: Scene = serde_json::from_value(json!({
            "water": { "waves": [fields] }, "floor": { "depth_m": DEPTH_M, "size_m": [8, 8] }, "objects": objects
        }))
        .unwrap();
        let mut resolved = ResolvedScene::bare(scene);
        resolved.meshes = meshes.iter().map(|(mesh, _)| Arc::clone(mesh)).collect();
        Self { resolved }
    }

    /// Without an obstacle in the water, but computed in steps.
    fn stepped(waves: Value) -> Self {
        Self::new(waves, &[(block([0.1; 3]), AWAY)])
    }

    /// The same without obstacles.
    fn exact(&self) -> Self {
        let mut exact = self.afresh();
        exact.waves_mut().obstacles.clear();
        exact
    }

    /// The same with nothing kept.
    fn afresh(&self) -> Self {
        let mut resolved = self.resolved.clone();
        resolved.kept = Kept::default();
        Self { resolved }
    }

    fn waves_mut(&mut self) -> &mut caustica::scene::Ripples {
        match &mut self.resolved.scene.water.waves[0] {
            Wave::Ripples(waves) => waves,
            other => panic!("{other:?}"),
        }
    }

    fn at(&self, time_s: f64) -> Surface {
        let mut resolved = self.resolved.clone();
        resolved.scene.time_s = time_s;
        Surface::of(&resolved).unwrap()
    }
}

/// Heights at 101 × 101 even places from `min_m` to `max_m`.
fn sampled(surface: &Surface, min_m: [f64; 2], max_m: [f64; 2]) -> Vec<f64> {
    let place =
        |axis: usize, i: usize| min_m[axis] + (max_m[axis] - min_m[axis]) * i as f64 / 100.0;
    (0..101 * 101)
        .map(|i| surface.at(place(0, i % 101), place(1, i / 101)).height_m)
        .collect()
}

/// Root of the mean square of the differences in the basin of a metre.
fn difference(a: &Surface, b: &Surface) -> f64 {
    let (a, b) = (
        sampled(a, [-0.5; 2], [0.5; 2]),
        sampled(b, [-0.5; 2], [0.5; 2]),
    );
    rms(&a.iter().zip(&b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Two drops, the second between two steps.
fn two_drops() -> Value {
    json!([
        { "position_m": [-0.1, 0.2], "radius_m": 0.07, "height_m": 1.0 },
        { "position_m": [0.3, -0.15], "radius_m": 0.08, "height_m": -0.7, "at_s": 0.0311 }
    ])
}

/// Between walls and in open water the solutions are known; the error of the steps falls with the square of the samples.
#[test]
fn steps_converge_to_the_exact_solutions_at_second_order() {
    for walls in ["reflecting", "periodic", "absorbing"] {
        for damping_per_s in [0.0, 0.7] {
            // 0.037 s is soon after the second drop; at 0.3 s waves have reached the nearest wall.
            for time_s in [0.037, 0.3, 0.711] {
                let errors = [64, 128, 256].map(|samples| {
                    let basin = Basin::stepped(json!({ "samples": samples, "walls": walls,
                        "damping_per_s": damping_per_s, "drops": two_drops() }));
                    difference(&basin.at(time_s), &basin.exact().at(time_s))
                });
                let what = format!("{walls} {damping_per_s} {time_s} {errors:?}");
                // What absorbing walls return, below 10⁻³ of the amplitude, does not fall with the samples.
                let returned = if walls == "absorbing" { 1e-4 } else { 0.0 };
                assert!(errors[0] < 5e-3, "{what}");
                assert!(errors[1] < errors[0] / 3.6 + returned, "{what}");
                assert!(errors[2] < errors[1] / 3.6 + returned, "{what}");
            }
        }
    }
}

/// Damping limits neither the step nor the accuracy, also where it exceeds the reciprocal of a step.
#[test]
fn strongly_damped_water_creeps_back_as_it_should() {
    for damping_per_s in [50.0, 300.0, 1000.0] {
        for walls in ["reflecting", "periodic", "absorbing"] {
            let basin = Basin::stepped(json!({ "samples": 128, "walls": walls,
                "damping_per_s": damping_per_s, "drops": two_drops() }));
            for time_s in [0.0, 0.037, 0.3, 3.0] {
                let (found, exact) = (basin.at(time_s), basin.exact().at(time_s));
                let whole = rms(&sampled(&exact, [-0.5; 2], [0.5; 2]));
                let error = difference(&found, &exact);
                // What absorbing walls return is a ten-thousandth of the energy.
                let most = if walls == "absorbing" { 1e-2 } else { 2e-3 };
                assert!(
                    error < most * whole,
                    "{damping_per_s} {walls} {time_s} {error} {whole}"
                );
            }
        }
    }
}

/// Waves leave through absorbing walls at all angles, from drops in the middle, in a corner, of a channel eight times as long as it is
/// wide, and wider than the layer; with the fewest samples too. What is there beyond the solution of open water has come back.
#[test]
fn absorbing_walls_return_less_than_a_hundredth_of_the_energy() {
    for (max_m, position_m, radius_m, samples, most) in [
        ([0.5, 0.5], [0.0, 0.0], 0.05, 256, 1e-5),
        ([0.5, 0.5], [0.4, 0.4], 0.03, 256, 1e-4),
        ([0.5, -0.375], [-0.3, -0.4], 0.03, 256, 1e-4),
        ([0.5, 0.5], [0.0, 0.0], 0.15, 256, 1e-3),
        ([0.5, 0.5], [0.0, 0.3], 0.15, 256, 1e-2),
        ([0.5, 0.5], [0.0, 0.0], 0.15, 16, 1e-2),
    ] {
        let basin = Basin::stepped(
            json!({ "samples": samples, "max_m": max_m, "walls": "absorbing",
            "drops": [{ "position_m": position_m, "radius_m": radius_m, "height_m": 1.0 }] }),
        );
        let exact = basin.exact();
        let start = rms(&sampled(&exact.at(0.0), [-0.5; 2], max_m));
        for time_s in [0.4, 0.7, 1.0, 1.5, 3.0] {
            let found = sampled(&basin.at(time_s), [-0.5; 2], max_m);
            let open = sampled(&exact.at(time_s), [-0.5; 2], max_m);
            let back: Vec<f64> = found.iter().zip(&open).map(|(a, b)| a - b).collect();
            let share = (rms(&back) / start).powi(2);
            assert!(
                share < most,
                "{max_m:?} {position_m:?} {samples} {time_s}: {share}"
            );
        }
        // Nothing grows in the layer: at last there is no more than the tail that waves on a plane leave behind, H R²/(c t)².
        let tail = (radius_m / (speed_m_per_s() * 8.0)).powi(2);
        let late = rms(&sampled(&basin.at(8.0), [-0.5; 2], max_m));
        assert!(late < 1.3 * tail, "{late} {tail}");
    }
}

/// The longest mode alone, of a mound far wider than the basin is deep: cos(πx) swings by its closed form, and its energy stays: the two
/// amplitudes a quarter of a period apart keep their sum of squares, for 20 000 steps.
#[test]
fn one_mode_swings_by_its_closed_form_and_keeps_its_energy() {
    let omega = PI * speed_m_per_s();
    // Means over z leave out modes that change along it.
    let amplitude = |basin: &Basin, time_s: f64| {
        let surface = basin.at(time_s);
        let places = (0..64).flat_map(|i| (0..16).map(move |k| (i, k)));
        let sum: f64 = places
            .map(|(i, k)| ((f64::from(i) + 0.5) / 64.0, (f64::from(k) + 0.5) / 64.0))
            .map(|(x, z)| surface.at(x - 0.5, z - 0.5).height_m * (PI * x).cos())
            .sum();
        sum / 512.0
    };
    let errors = [32, 64].map(|samples| {
        let basin = Basin::stepped(
            json!({ "samples": samples, "max_m": [0.5, -0.25], "drops": [
            { "position_m": [-0.5, -0.4], "radius_m": 0.25, "height_m": 1.0 }] }),
        );
        let start = amplitude(&basin, 0.0);
        let oscillator = Oscillator::of(omega, 0.0);
        let errors = [0.31, 0.9, 2.2, 3.7].map(|time_s| {
            let swing = oscillator.swing(Elapsed::between(0.0, time_s)).amplitude;
            (amplitude(&basin, time_s) - swing * start).abs() / start
        });
        let energy = |time_s: f64| {
            let later_s = time_s + 0.5 * PI / omega;
            amplitude(&basin, time_s).powi(2) + amplitude(&basin, later_s).powi(2)
        };
        if samples == 32 {
            for time_s in [10.0, 123.4, 600.0] {
                let change = energy(time_s) / energy(0.0) - 1.0;
                assert!(change.abs() < 2e-2, "{time_s} {change}");
            }
        }
        errors.into_iter().fold(0.0, f64::max)
    });
    assert!(
        errors[0] < 1e-2 && errors[1] < errors[0] / 3.6,
        "{errors:?}"
    );
}

#[test]
fn a_drop_in_the_middle_of_a_square_stays_symmetric() {
    let post = block([0.083, 1.0, 0.083]);
    let posts: Vec<_> = [[-0.2, -0.2], [0.2, -0.2], [-0.2, 0.2], [0.2, 0.2]]
        .map(|[x, z]| (Arc::clone(&post), [x, 0.0, z]))
        .into();
    for walls in ["reflecting", "absorbing"] {
        let basin = Basin::new(
            json!({ "samples": 100, "walls": walls, "drops": [
                { "position_m": [0, 0], "radius_m": 0.05, "height_m": 1.0, "at_s": 0.001 }] }),
            &posts,
        );
        for time_s in [0.001, 0.1, 0.45, 2.0] {
            let surface = basin.at(time_s);
            let at = |x: f64, z: f64| surface.at(x, z).height_m;
            for i in 0..200 {
                let (x, z) = (
                    (f64::from(i) * 0.618_034) % 0.5,
                    (f64::from(i) * 0.754_878) % 0.5,
                );
                let first = at(x, z);
                for (x, z) in [(z, x), (-x, z), (x, -z), (-z, x)] {
                    assert!((at(x, z) - first).abs() < 1e-12, "{walls} {time_s}");
                }
            }
        }
    }
}

/// A block that fills half of the basin is a wall: what is left of the water is a reflecting basin of half the size.
#[test]
fn waves_are_reflected_by_a_block_as_by_a_wall() {
    let drops = json!([{ "position_m": [-0.25, 0.1], "radius_m": 0.03, "height_m": 1.0 }]);
    let blocked = Basin::new(
        json!({ "samples": 128, "drops": drops }),
        &[(block([1.0, 1.0, 2.0]), [0.5, 0.0, 0.0])],
    );
    // One more obstacle that does nothing; the longer side, along z, has as many samples.
    let half = Basin::stepped(json!({ "samples": 128, "max_m": [0.0, 0.5], "drops": drops }));
    for time_s in [0.0, 0.2, 0.7, 3.0] {
        let (found, expected) = (blocked.at(time_s), half.at(time_s));
        for i in 0..64 {
            for k in 0..128 {
                let (x, z) = (
                    -0.5 + (f64::from(i) + 0.5) / 128.0,
                    -0.5 + (f64::from(k) + 0.5) / 128.0,
                );
                let difference_m = found.at(x, z).height_m - expected.at(x, z).height_m;
                assert!(
                    difference_m.abs() < 1e-12,
                    "{time_s} {x} {z} {difference_m}"
                );
            }
        }
        // Across the rim the surface goes on almost without a slope.
        let slopes = (0..50).map(|k| found.at(0.0, -0.49 + f64::from(k) * 0.02).slope.x.abs());
        let steepest = slopes.fold(0.0, f64::max);
        assert!(
            steepest < 0.05 * found.max_slope(),
            "{time_s} {steepest} {}",
            found.max_slope()
        );
    }
}

/// A periodic basin has no sides: a post over its corner is the same as one in its middle, half a basin further.
#[test]
fn an_obstacle_over_the_side_of_a_periodic_basin_goes_on_at_the_other() {
    let with_post_at = |post_m: f64, drop_m: [f64; 2]| {
        Basin::new(
            json!({ "samples": 64, "walls": "periodic", "drops": [
                { "position_m": drop_m, "radius_m": 0.06, "height_m": 1.0 }] }),
            &[(block([0.16, 1.0, 0.12]), [post_m, 0.0, post_m])],
        )
    };
    let (corner, middle) = (
        with_post_at(0.5, [0.1, 0.2]),
        with_post_at(0.0, [-0.4, -0.3]),
    );
    for time_s in [0.0, 0.3, 1.1] {
        let (corner, middle) = (corner.at(time_s), middle.at(time_s));
        assert!(middle.max_slope() > 0.01);
        for i in 0..400 {
            let (x, z) = (f64::from(i) * 0.618_034, f64::from(i) * 0.754_878);
            let apart = corner.at(x, z).height_m - middle.at(x - 0.5, z - 0.5).height_m;
            assert!(apart.abs() < 1e-12, "{time_s} {x} {z} {apart}");
        }
    }
}

/// A mesh that crosses the lines of samples more often than is held at once, all within one cell: it is a wall like a single sheet.
#[test]
fn a_wall_of_many_fins_is_a_wall() {
    let basin = |fins: u32| {
        let mut text = String::new();
        for fin in 0..fins {
            let x = -0.2 + 5e-4 * f64::from(fin) / 20_001.0;
            text += &format!("v {x} -1 -0.45\nv {x} 1 -0.45\nv {x} -1 0.45\nv {x} 1 0.45\n");
            let first = 4 * fin + 1;
            text += &format!("f {} {} {}\n", first, first + 1, first + 2);
            text += &format!("f {} {} {}\n", first + 1, first + 2, first + 3);
        }
        let mesh = obj::read(text.as_bytes(), &[], &Limits::default()).unwrap();
        Basin::new(
            json!({ "samples": 256, "drops": [
                { "position_m": [0.0, 0.1], "radius_m": 0.05, "height_m": 1.0 }] }),
            &[(Arc::new(mesh), [0.0; 3])],
        )
    };
    let (one, many) = (basin(1).at(0.3), basin(20_001).at(0.3));
    assert!(one == many);
    let without = Basin::stepped(json!({ "samples": 256, "drops": [
        { "position_m": [0.0, 0.1], "radius_m": 0.05, "height_m": 1.0 }] }));
    assert!(
        difference(&one, &without.at(0.3)) > 1e-3,
        "it is in the way"
    );
}

/// Heights behind a wide wall, as a share of those without it; the wall may have no thickness, stand askew, or be a closed block.
#[test]
fn it_is_quiet_behind_a_wide_wall() {
    let fields = json!({ "samples": 128, "walls": "absorbing", "drops": [
        { "position_m": [-0.25, 0.0], "radius_m": 0.04, "height_m": 1.0 }] });
    let behind = |basin: &Basin| {
        [0.5, 0.6, 0.7].map(|time_s| rms(&sampled(&basin.at(time_s), [0.2, -0.1], [0.4, 0.1])))
    };
    let open = behind(&Basin::stepped(fields.clone()));
    for (name, wall) in [
        ("block", block([0.06, 1.0, 0.9])),
        ("thin block", block([1e-4, 1.0, 0.9])),
        ("sheet", sheet(&[[0.0, -0.45], [0.0, 0.45]])),
        ("askew", sheet(&[[-0.08, -0.45], [0.08, 0.45]])),
    ] {
        let shaded = behind(&Basin::new(fields.clone(), &[(wall, [0.0, 0.0, 0.0])]));
        for (open, shaded) in open.iter().zip(shaded) {
            // 1 % of the energy, which comes around the ends.
            assert!(shaded < 0.1 * open, "{name}: {shaded} of {open}");
            assert!(shaded > 0.0, "{name}");
        }
    }
}

/// Water inside a ring does not know what is outside of it.
#[test]
fn a_closed_ring_holds_its_water() {
    let ring = [
        [-0.2, -0.2],
        [0.21, -0.22],
        [0.3, 0.1],
        [-0.1, 0.25],
        [-0.2, -0.2],
    ];
    let basin = Basin::new(
        json!({ "samples": 96, "drops": [
            { "position_m": [-0.4, -0.4], "radius_m": 0.03, "height_m": 1.0 }] }),
        // A sheet whose cut closes: its inside counts as an obstacle, and stays as flat as its rim.
        &[(sheet(&ring), [0.0, 0.0, 0.0])],
    );
    let surface = basin.at(2.0);
    assert!(surface.idle_obstacles().next().is_none());
    assert!(surface.at(-0.4, 0.4).height_m.abs() > 1e-4);
    let outside = rms(&sampled(&surface, [-0.5; 2], [-0.25; 2]));
    let inside = rms(&sampled(&surface, [-0.05, -0.05], [0.1, 0.1]));
    assert!(inside < outside, "{inside} {outside}");
}

/// Whatever was asked for before, a moment has the same surface to the bit.
#[test]
fn a_moment_is_the_same_however_it_is_reached() {
    let basin = Basin::new(
        json!({ "samples": 48, "walls": "absorbing", "damping_per_s": 0.2, "drops": [
            { "position_m": [-0.3, 0.1], "radius_m": 0.05, "height_m": 1.0, "at_s": -0.4 },
            { "position_m": [0.3, -0.2], "radius_m": 0.05, "height_m": 0.5, "at_s": 0.777 },
            { "position_m": [0.1, 0.3], "radius_m": 0.06, "height_m": -0.5, "at_s": 2.5 }] }),
        &[(block([0.2, 1.0, 0.13]), [0.0, 0.0, 0.05])],
    );
    let times_s: Vec<f64> = (-15..90).map(|frame| f64::from(frame) / 30.0).collect();
    let alone: Vec<Surface> = times_s.iter().map(|t| basin.afresh().at(*t)).collect();
    let (forwards, backwards, without) = (basin.afresh(), basin.afresh(), {
        let mut without = basin.afresh();
        without.resolved.kept = Kept::within(0);
        without
    });
    for (time_s, alone) in times_s.iter().zip(&alone) {
        assert!(forwards.at(*time_s) == *alone, "forwards {time_s}");
    }
    for (time_s, alone) in times_s.iter().zip(&alone).rev() {
        assert!(backwards.at(*time_s) == *alone, "backwards {time_s}");
        if (time_s * 30.0).round() % 20.0 == 0.0 {
            assert!(without.at(*time_s) == *alone, "nothing kept {time_s}");
        }
    }
    assert_eq!(alone[0].max_slope(), 0.0);
    assert!(alone[4].max_slope() > 0.1);
    // The surface goes on without jumps, also where drops fall: their mounds are the only ones.
    let step = |a: &Surface, b: &Surface| difference(a, b);
    let (before, at, after) = (
        basin.at(0.777 - 1e-9),
        basin.at(0.777),
        basin.at(0.777 + 1e-9),
    );
    assert!(step(&at, &after) < 1e-6 && step(&before, &at) > 1e-2);
}

/// The moments at which a step ends, and those just beside it, agree.
#[test]
fn the_surface_is_continuous_in_time() {
    let basin = Basin::stepped(json!({ "samples": 32, "drops": two_drops() }));
    let step_s = 0.9 / (speed_m_per_s() * 32.0 * 2_f64.sqrt());
    for number in [1.0, 2.0, 3.0, 40.0, 41.0] {
        let at = |shift_s: f64| basin.at(number * step_s + shift_s);
        assert!(difference(&at(-1e-7), &at(1e-7)) < 1e-5, "{number}");
    }
}

#[test]
fn the_mean_height_stays_zero() {
    for walls in ["reflecting", "periodic"] {
        let basin = Basin::new(
            json!({ "samples": 40, "walls": walls, "drops": two_drops() }),
            &[(block([0.31, 1.0, 0.22]), [0.1, 0.0, 0.1])],
        );
        for time_s in [0.0, 0.5, 7.0] {
            let surface = basin.at(time_s);
            let first = if walls == "periodic" { 0.0 } else { 0.5 };
            let place = |i: usize| -0.5 + (i as f64 + first) / 40.0;
            let (mut sum, mut count) = (0.0, 0);
            for (x, z) in (0..1600).map(|i| (place(i % 40), place(i / 40))) {
                if (x - 0.1).abs() > 0.155 || (z - 0.1).abs() > 0.11 {
                    sum += surface.at(x, z).height_m;
                    count += 1;
                }
            }
            assert!(
                (sum / f64::from(count)).abs() < 1e-14,
                "{walls} {time_s} {sum}"
            );
        }
    }
}

#[test]
fn hard_cases_are_finite_and_bounded() {
    let all = block([40.0, 40.0, 40.0]);
    for (fields, mesh, depth_m) in [
        (json!({ "drops": [] }), block([0.1; 3]), 0.1),
        // No water is left.
        (json!({ "drops": two_drops() }), Arc::clone(&all), 0.1),
        (
            json!({ "drops": two_drops(), "walls": "absorbing" }),
            all,
            0.1,
        ),
        // Nothing moves.
        (json!({ "drops": two_drops() }), block([0.1; 3]), 0.0),
        (json!({ "drops": two_drops() }), block([0.1; 3]), 1e-300),
        (
            json!({ "drops": two_drops(), "damping_per_s": 1000 }),
            block([0.1; 3]),
            1e-5,
        ),
        (
            json!({ "drops": two_drops(), "damping_per_s": 1000, "walls": "absorbing" }),
            block([0.1; 3]),
            0.1,
        ),
        (
            json!({ "drops": two_drops(), "damping_per_s": 1e-12, "walls": "absorbing" }),
            block([0.1; 3]),
            0.1,
        ),
        // A drop on a wall, on a corner, and within the obstacle; a narrow one.
        (
            json!({ "walls": "absorbing", "drops": [
                { "position_m": [-0.5, 0], "radius_m": 0.1, "height_m": 1 },
                { "position_m": [0.5, 0.5], "radius_m": 1e-4, "height_m": 100 },
                { "position_m": [0, 0], "radius_m": 0.02, "height_m": 1 }] }),
            block([0.2; 3]),
            0.1,
        ),
        (
            json!({ "max_m": [9999, -0.49], "drops": two_drops(), "walls": "periodic" }),
            block([0.1; 3]),
            10.0,
        ),
    ] {
        let mut basin = Basin::new(fields, &[(mesh, [0.0; 3])]);
        basin.waves_mut().samples = 17;
        basin.resolved.scene.floor.as_mut().unwrap().depth_m = depth_m;
        for time_s in [-1e12, -0.1, 0.0, 0.02, 0.5, 4.0] {
            let surface = basin.at(time_s);
            for (x, z) in [(0.0, 0.0), (0.2, 0.1), (-0.5, -0.5), (0.51, 0.3)] {
                let point = surface.at(x, z);
                assert!(point.height_m.is_finite() && point.slope.is_finite());
                assert!(point.height_m.abs() <= surface.max_height_m());
            }
            assert!(surface.max_slope().is_finite() && surface.shortest_wave_m() > 0.0);
            assert!(time_s >= 0.0 || surface.max_slope() == 0.0);
        }
        if depth_m < 1e-200 {
            let [early, late] = [0.04, 1e12].map(|time_s| basin.at(time_s));
            assert!(early.max_slope() > 1.0 && early == late);
        }
    }
}

/// An absorbing basin ends in flat water.
#[test]
fn outside_of_absorbing_walls_the_surface_fades() {
    let drops = json!([{ "position_m": [0, 0.3], "radius_m": 0.05, "height_m": 1.0 }]);
    let stepped = Basin::stepped(json!({ "samples": 64, "walls": "absorbing", "drops": drops }));
    for surface in [stepped.at(0.3), stepped.exact().at(0.3)] {
        // 8 samples of water beyond the wall.
        let heights = |from_m: f64, to_m: f64| sampled(&surface, [-0.5, from_m], [0.5, to_m]);
        assert!(rms(&heights(0.4, 0.5)) > 0.05);
        assert!(rms(&heights(0.6, 0.625)) < 0.1 * rms(&heights(0.5, 0.525)));
        assert!(rms(&heights(0.66, 0.8)) < 1e-3 * rms(&heights(0.4, 0.5)));
        assert_eq!(surface.at(0.0, 2.0).height_m, 0.0);
        assert_eq!(surface.at(1.0, 0.3).height_m, 0.0, "it does not repeat");
    }
}

#[test]
fn narrow_drops_are_widened_and_that_is_reported() {
    let share = |radius_m: f64| {
        let mut basin = Basin::stepped(json!({ "samples": 100, "drops": [
            { "position_m": [0, 0], "radius_m": radius_m, "height_m": 1.0 }] }));
        slope_lost(basin.waves_mut())
    };
    // Two samples are 0.02 m.
    assert_eq!(share(0.02), 0.0);
    assert!((share(0.01) - (1.0 - 1.0 / 16.0)).abs() < 1e-12);
    // The water is the same: 2π R² H.
    let volume = |radius_m: f64| {
        let basin = Basin::stepped(json!({ "samples": 100, "walls": "absorbing", "drops": [
            { "position_m": [0.001, 0.002], "radius_m": radius_m, "height_m": 1.0 }] }));
        let surface = basin.at(0.0);
        let place = |i: u32| -0.5 + (f64::from(i) + 0.5) / 100.0;
        let heights = (0..10_000).map(|i| surface.at(place(i % 100), place(i / 100)).height_m);
        heights.sum::<f64>() * 1e-4
    };
    for radius_m in [0.003, 0.01, 0.03] {
        let expected = TAU * radius_m * radius_m;
        assert!((volume(radius_m) / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn obstacles_that_miss_the_water_are_told() {
    let drops = json!({ "samples": 32, "drops": two_drops() });
    let small = block([0.1, 0.2, 0.1]);
    let at = |y_m: f64, x_m: f64| {
        let basin = Basin::new(drops.clone(), &[(Arc::clone(&small), [x_m, y_m, 0.0])]);
        basin.at(0.1).idle_obstacles().collect::<Vec<_>>()
    };
    assert_eq!(at(0.0, 0.0), []);
    assert_eq!(at(0.09, 0.0), []);
    for (y_m, x_m) in [(0.11, 0.0), (-0.11, 0.0), (0.0, 0.7)] {
        assert_eq!(at(y_m, x_m), [(0, 0)], "{y_m} {x_m}");
    }
    let words = Basin::new(drops, &[(small, [0.0; 3])])
        .at(0.1)
        .description();
    assert_eq!(words, "water with a basin with 2 drops and 1 obstacle");
}

/// A turned and scaled object cuts the water where it is.
#[test]
fn the_footprint_follows_the_object() {
    // A block of 0.4 × 0.1 m, turned by 90° about y and moved: 0.1 m along x, 0.4 m along z.
    let mut basin = Basin::new(
        json!({ "samples": 100, "drops": [{ "position_m": [-0.3, 0.0], "radius_m": 0.04, "height_m": 1.0 }] }),
        &[(block([0.2, 1.0, 0.05]), [0.2, 0.0, 0.1])],
    );
    let object = &mut basin.resolved.scene.objects[0];
    object.scale = caustica::scene::Scale::Uniform(2.0);
    object.rotation = [0.0, 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()];
    let turned = basin.at(1.3);
    let straight = Basin::new(
        json!({ "samples": 100, "drops": [{ "position_m": [-0.3, 0.0], "radius_m": 0.04, "height_m": 1.0 }] }),
        &[(block([0.1, 2.0, 0.4]), [0.2, 0.0, 0.1])],
    );
    assert!(difference(&turned, &straight.at(1.3)) < 1e-12);
    let other = Basin::new(
        json!({ "samples": 100, "drops": [{ "position_m": [-0.3, 0.0], "radius_m": 0.04, "height_m": 1.0 }] }),
        &[(block([0.4, 2.0, 0.1]), [0.2, 0.0, 0.1])],
    );
    assert!(difference(&turned, &other.at(1.3)) > 1e-3);
}

/// The reference has twice the samples, and half the step.
#[test]
fn a_refined_basin_is_nearer_to_the_exact_solution() {
    let basin = Basin::stepped(json!({ "samples": 64, "drops": two_drops() }));
    let mut resolved = basin.resolved.clone();
    resolved.scene.time_s = 0.711;
    let exact = basin.exact().at(0.711);
    let [once, twice, four] = [1, 2, 4].map(|times| Surface::refined(&resolved, times).unwrap());
    assert!(difference(&twice, &exact) < difference(&once, &exact) / 3.6);
    assert!(twice == four);
}
