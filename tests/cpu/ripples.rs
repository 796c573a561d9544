//! Ripples in basins: against the sum of their modes, their own symmetries, and hard cases; and the oscillator of a mode.

use std::f64::consts::{PI, TAU};

use crate::surfaces::{refined_surface, surface_of};

use caustica::physics::constants::GRAVITY_M_PER_S2;
use caustica::physics::dispersion::{angular_frequency, angular_frequency_with_surface_tension};
use caustica::physics::oscillator::{Elapsed, Oscillator};
use caustica::physics::turns::fraction_of_product;
use caustica::scene::{RippleDispersion, RippleDrop, Ripples, Scene, Walls, Wave};
use caustica::waves::{ROW_POINTS, RowPoints, Surface, slope_lost};
use glam::DVec2;
use serde_json::json;

fn drop(position_m: [f64; 2], radius_m: f64, height_m: f64, at_s: f64) -> RippleDrop {
    RippleDrop {
        position_m,
        radius_m,
        height_m,
        at_s,
    }
}

/// A basin with the corner (−0.5, 0.25).
fn basin(sides_m: [f64; 2], samples: u32, drops: &[RippleDrop]) -> Ripples {
    let kind = json!({ "kind": "ripples", "min_m": [-0.5, 0.25], "max_m": [0, 1], "drops": [] });
    let mut ripples: Ripples = serde_json::from_value(kind).unwrap();
    ripples.max_m = [0, 1].map(|i| ripples.min_m[i] + sides_m[i]);
    ripples.samples = samples;
    ripples.drops = drops.to_vec();
    ripples
}

fn scene(ripples: &Ripples, depth_m: Option<f64>, time_s: f64) -> Scene {
    let mut scene: Scene = match depth_m {
        Some(depth_m) => {
            serde_json::from_value(json!({ "floor": { "depth_m": depth_m, "size_m": [8, 8] } }))
        }
        None => serde_json::from_value(json!({})),
    }
    .unwrap();
    scene.water.waves = vec![Wave::Ripples(ripples.clone())];
    scene.time_s = time_s;
    scene
}

fn surface(ripples: &Ripples, depth_m: Option<f64>, time_s: f64) -> Surface {
    surface_of(&scene(ripples, depth_m, time_s))
}

fn sides_m(ripples: &Ripples) -> [f64; 2] {
    [0, 1].map(|i| ripples.max_m[i] - ripples.min_m[i])
}

/// Places of the samples along an axis.
fn places(ripples: &Ripples, axis: usize, count: usize) -> Vec<f64> {
    let half = match ripples.walls {
        Walls::Reflecting => 0.5,
        Walls::Periodic | Walls::Absorbing => 0.0,
    };
    let step_m = sides_m(ripples)[axis] / count as f64;
    (0..count)
        .map(|i| ripples.min_m[axis] + (i as f64 + half) * step_m)
        .collect()
}

/// The height by direct summation over all modes that `counts` samples carry, with textbook formulas. For times that are not large.
fn summed(ripples: &Ripples, depth_m: Option<f64>, time_s: f64, counts: [usize; 2]) -> Vec<f64> {
    let sides = sides_m(ripples);
    let reflecting = ripples.walls == Walls::Reflecting;
    let (turn, share) = if reflecting { (PI, 2) } else { (TAU, 4) };
    let gamma = ripples.damping_per_s;
    let (xs, zs) = (places(ripples, 0, counts[0]), places(ripples, 1, counts[1]));
    let mut heights = vec![0.0; counts[0] * counts[1]];
    for drop in ripples.drops.iter().filter(|drop| drop.at_s <= time_s) {
        let tau = time_s - drop.at_s;
        for m in 0..=counts[0] / share {
            for n in 0..=counts[1] / share {
                if m + n == 0 {
                    continue;
                }
                let k = [m as f64 * turn / sides[0], n as f64 * turn / sides[1]];
                let length = (k[0] * k[0] + k[1] * k[1]).sqrt();
                let omega = match (ripples.dispersion, depth_m) {
                    (RippleDispersion::Shallow, Some(d)) => length * (9.80665 * d).sqrt(),
                    (_, d) => {
                        let tanh = d.map_or(1.0, |d| (length * d).tanh());
                        ((9.80665 * length + 7.28e-5 * length.powi(3)) * tanh).sqrt()
                    }
                };
                let swing = if omega > gamma {
                    let w = (omega * omega - gamma * gamma).sqrt();
                    (-gamma * tau).exp() * ((w * tau).cos() + gamma / w * (w * tau).sin())
                } else {
                    let w = (gamma * gamma - omega * omega).sqrt();
                    (-gamma * tau).exp() * ((w * tau).cosh() + gamma / w * (w * tau).sinh())
                };
                let mut amplitude = drop.height_m * swing;
                for i in [0, 1] {
                    amplitude *= if [m, n][i] == 0 { 1.0 } else { 2.0 };
                    amplitude *= TAU.sqrt() * drop.radius_m / sides[i];
                    amplitude *= (-0.5 * (k[i] * drop.radius_m).powi(2)).exp();
                }
                let shape = |axis: usize, at: f64| {
                    let centre = drop.position_m[axis] - ripples.min_m[axis];
                    let at = at - ripples.min_m[axis];
                    if reflecting {
                        (k[axis] * centre).cos() * (k[axis] * at).cos()
                    } else {
                        (k[axis] * (at - centre)).cos()
                    }
                };
                for (row, z) in zs.iter().enumerate() {
                    for (column, x) in xs.iter().enumerate() {
                        heights[row * counts[0] + column] +=
                            amplitude * shape(0, *x) * shape(1, *z);
                    }
                }
            }
        }
    }
    heights
}

/// Heights at the samples of a basin.
fn sampled(ripples: &Ripples, surface: &Surface, counts: [usize; 2]) -> Vec<f64> {
    let (xs, zs) = (places(ripples, 0, counts[0]), places(ripples, 1, counts[1]));
    zs.iter()
        .flat_map(|z| xs.iter().map(|x| surface.at(*x, *z).height_m))
        .collect()
}

#[track_caller]
fn all_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let worst = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
    assert!(worst <= tolerance, "{worst} is above {tolerance}");
    assert!(expected.iter().any(|value| value.abs() > 1e3 * tolerance));
}

/// Drops of several kinds in a basin of 1.5 × 0.9 m.
fn some_drops() -> [RippleDrop; 4] {
    [
        drop([0.1, 0.6], 0.05, 0.01, 0.0),
        drop([-0.5, 0.25], 0.2, -0.004, -1.25),
        drop([0.93, 1.1], 0.08, 0.007, 1.0),
        drop([0.7, 0.3], 0.01, 0.02, 0.0),
    ]
}

#[test]
fn the_surface_is_the_sum_of_its_modes() {
    for walls in [Walls::Reflecting, Walls::Periodic] {
        for dispersion in [RippleDispersion::FiniteDepth, RippleDispersion::Shallow] {
            for (depth_m, damping_per_s) in [(None, 0.0), (Some(0.2), 0.3), (Some(0.05), 9.0)] {
                let mut ripples = basin([1.5, 0.9], 40, &some_drops());
                ripples.walls = walls;
                ripples.dispersion = dispersion;
                ripples.damping_per_s = damping_per_s;
                for time_s in [0.0, 0.4, 3.7] {
                    let surface = surface(&ripples, depth_m, time_s);
                    let found = sampled(&ripples, &surface, [40, 24]);
                    let expected = summed(&ripples, depth_m, time_s, [40, 24]);
                    all_near(&found, &expected, 1e-9 * 0.01);
                }
            }
        }
    }
}

#[test]
fn a_drop_is_a_gaussian_folded_at_walls_or_wrapped() {
    for walls in [Walls::Reflecting, Walls::Periodic] {
        let (position_m, radius_m) = ([-0.45, 0.95], 0.15);
        let mut ripples = basin([1.5, 0.9], 90, &[drop(position_m, radius_m, 1.0, 5.0)]);
        ripples.walls = walls;
        let sides = sides_m(&ripples);
        let factor = |axis: usize, at_m: f64| -> f64 {
            let mirrored = 2.0 * ripples.min_m[axis] - position_m[axis];
            let images: &[f64] = match walls {
                Walls::Reflecting => &[position_m[axis], mirrored],
                Walls::Periodic | Walls::Absorbing => &[position_m[axis]],
            };
            let repeat_m = images.len() as f64 * sides[axis];
            let gaussian = |middle_m: f64| (-0.5 * ((at_m - middle_m) / radius_m).powi(2)).exp();
            (-4..=4)
                .flat_map(|i| {
                    images
                        .iter()
                        .map(move |image| image + f64::from(i) * repeat_m)
                })
                .map(gaussian)
                .sum()
        };
        let mean = TAU * radius_m * radius_m / (sides[0] * sides[1]);
        let expected: Vec<f64> = places(&ripples, 1, 54)
            .iter()
            .flat_map(|z| places(&ripples, 0, 90).into_iter().map(|x| (x, *z)))
            .map(|(x, z)| factor(0, x) * factor(1, z) - mean)
            .collect();
        let fallen = surface(&ripples, Some(1.0), 5.0);
        all_near(&sampled(&ripples, &fallen, [90, 54]), &expected, 1e-12);
        assert_eq!(surface(&ripples, Some(1.0), 4.999).max_slope(), 0.0);
    }
}

#[test]
fn one_mode_swings_by_its_closed_form() {
    // Wide drops leave the longest mode alone: the next has e^(−1.5 · (π 1.2)²) of its height.
    let mut ripples = basin([1.0, 0.4], 32, &[drop([-0.5, 0.4], 1.2, 100.0, 0.0)]);
    for damping_per_s in [0.0, 0.5, 5.545, 50.0] {
        ripples.damping_per_s = damping_per_s;
        let omega = angular_frequency_with_surface_tension(PI, f64::INFINITY);
        let oscillator = Oscillator::of(omega, damping_per_s);
        let start = surface(&ripples, None, 0.0);
        for time_s in [0.1, 1.0, 2.0, 7.3] {
            let later = surface(&ripples, None, time_s);
            let a = oscillator.swing(Elapsed::between(0.0, time_s)).amplitude;
            for x in places(&ripples, 0, 32) {
                let (first, then) = (start.at(x, 0.5).height_m, later.at(x, 0.5).height_m);
                assert!((then - a * first).abs() < 1e-8 * start.max_height_m());
            }
        }
    }
}

/// Amplitude of the mode (m, n) between reflecting walls, from the samples of the surface.
fn projected(ripples: &Ripples, surface: &Surface, counts: [usize; 2], mode: [usize; 2]) -> f64 {
    let heights = sampled(ripples, surface, counts);
    let cosine = |axis: usize, i: usize| {
        (PI * mode[axis] as f64 * (i as f64 + 0.5) / counts[axis] as f64).cos()
    };
    let products = heights
        .iter()
        .enumerate()
        .map(|(i, height)| height * cosine(0, i % counts[0]) * cosine(1, i / counts[0]));
    let twos = mode.iter().filter(|number| **number > 0).count();
    products.sum::<f64>() * f64::from(1 << twos) / heights.len() as f64
}

#[test]
fn the_energy_of_a_mode_stays_without_damping() {
    let ripples = basin([1.0, 1.0], 16, &[drop([-0.2, 0.4], 0.1, 0.01, 0.0)]);
    for mode in [[1, 0], [2, 1], [3, 4]] {
        let k = PI * DVec2::new(mode[0] as f64, mode[1] as f64).length();
        let omega = angular_frequency_with_surface_tension(k, 0.5);
        let at = |time_s| {
            projected(
                &ripples,
                &surface(&ripples, Some(0.5), time_s),
                [16; 2],
                mode,
            )
        };
        // From two amplitudes a quarter of a period apart: a² + (a′/ω)².
        let energy = |time_s| at(time_s).hypot(at(time_s + 0.25 * TAU / omega)).powi(2);
        let start = energy(0.0);
        assert!(start > 1e-14);
        for time_s in [0.3, 17.0, 333.3, 4321.0, 1e4] {
            assert!((energy(time_s) / start - 1.0).abs() < 1e-10);
        }
    }
}

#[test]
fn a_drop_in_the_middle_of_a_square_stays_symmetric() {
    for walls in [Walls::Reflecting, Walls::Periodic] {
        let mut ripples = basin([1.0, 1.0], 64, &[drop([0.0, 0.75], 0.06, 1.0, 0.0)]);
        ripples.walls = walls;
        for time_s in [0.0, 0.21, 1.7, 43.0] {
            let surface = surface(&ripples, Some(0.3), time_s);
            let at = |x: f64, z: f64| surface.at(x, 0.75 + z).height_m;
            for i in 0..200 {
                let p = (f64::from(i) * DVec2::new(0.618_034, 0.754_878)).fract() - 0.5;
                let first = at(p.x, p.y);
                for (x, z) in [(p.y, p.x), (-p.x, p.y), (p.x, -p.y), (-p.y, p.x)] {
                    assert!((at(x, z) - first).abs() < 1e-12, "{time_s}");
                }
            }
        }
    }
}

#[test]
fn the_surface_is_mirrored_at_walls() {
    let ripples = basin([1.5, 0.9], 64, &some_drops());
    let surface = surface(&ripples, None, 2.2);
    let most = surface.max_slope();
    for i in 0..50 {
        let along = f64::from(i) / 50.0;
        let (x, z) = (-0.5 + 1.5 * along, 0.25 + 0.9 * along);
        for wall_x in [-0.5, 1.0] {
            assert!(surface.at(wall_x, z).slope.x.abs() < 1e-12 * most);
            let (here, there) = (surface.at(wall_x + 0.1, z), surface.at(wall_x - 0.1, z));
            assert!((here.height_m - there.height_m).abs() < 1e-14);
        }
        for wall_z in [0.25, 1.15] {
            assert!(surface.at(x, wall_z).slope.y.abs() < 1e-12 * most);
            let (here, there) = (surface.at(x, wall_z + 0.1), surface.at(x, wall_z - 0.1));
            assert!((here.height_m - there.height_m).abs() < 1e-14);
        }
    }
}

#[test]
fn a_periodic_basin_repeats_and_has_no_walls() {
    let mut ripples = basin([1.5, 0.9], 64, &some_drops());
    ripples.walls = Walls::Periodic;
    let here = surface(&ripples, None, 2.2);
    // All drops moved by the same distance, which takes some through the sides: the whole surface moves. Whole samples, so that the
    // spline is the same.
    let moved_by = DVec2::new(1.5 * 20.0 / 64.0, 0.9 * 11.0 / 38.0);
    for drop in &mut ripples.drops {
        drop.position_m[0] = -0.5 + (drop.position_m[0] + 0.5 + moved_by.x).rem_euclid(1.5);
        drop.position_m[1] = 0.25 + (drop.position_m[1] - 0.25 + moved_by.y).rem_euclid(0.9);
    }
    let moved = surface(&ripples, None, 2.2);
    for i in 0..200 {
        let p = f64::from(i) * DVec2::new(0.618_034, 0.754_878);
        let height_m = here.at(p.x, p.y).height_m;
        for (x, z) in [(1.5, 0.0), (0.0, 0.9), (-4.5, 1.8)] {
            assert!((here.at(p.x + x, p.y + z).height_m - height_m).abs() < 1e-13);
        }
        assert!((moved.at(p.x + moved_by.x, p.y + moved_by.y).height_m - height_m).abs() < 1e-13);
    }
}

#[test]
fn the_mean_height_is_zero() {
    for walls in [Walls::Reflecting, Walls::Periodic] {
        let mut ripples = basin([1.5, 0.9], 40, &some_drops());
        ripples.walls = walls;
        for time_s in [-1.0, 0.0, 0.5, 1.0, 1e5] {
            let surface = surface(&ripples, None, time_s);
            let heights = sampled(&ripples, &surface, [40, 24]);
            assert!((heights.iter().sum::<f64>() / heights.len() as f64).abs() < 1e-16);
            assert!(heights.iter().any(|height| height.abs() > 1e-4));
        }
    }
}

#[test]
fn the_surface_depends_on_the_time_alone() {
    let mut ripples = basin([1.5, 0.9], 40, &some_drops());
    let first = surface(&ripples, None, 6.5);
    let _ = surface(&ripples, None, 1.5);
    assert_eq!(first, surface(&ripples, None, 6.5));
    // Later, after drops that fall later.
    for drop in &mut ripples.drops {
        drop.at_s += 4.0;
    }
    assert_eq!(first, surface(&ripples, None, 10.5));
    // Rows and points are the same surface.
    let mut points = RowPoints::FLAT;
    let step_m = DVec2::new(0.011, 0.007);
    first
        .rows(step_m)
        .evaluate(DVec2::new(-0.7, 0.1), &mut points);
    for i in 0..ROW_POINTS {
        let p = DVec2::new(-0.7, 0.1) + step_m * i as f64;
        assert!((points.height_m[i] - first.at(p.x, p.y).height_m).abs() < 1e-15);
    }
}

#[test]
fn a_refined_basin_has_the_same_modes() {
    for walls in [Walls::Reflecting, Walls::Periodic] {
        let mut ripples = basin([1.5, 0.9], 40, &some_drops());
        ripples.walls = walls;
        let scene = scene(&ripples, None, 1.3);
        let (coarse, thrice) = (surface_of(&scene), refined_surface(&scene, 3));
        // Every third sample of the finer grid is one of the coarse one.
        let found = sampled(&ripples, &thrice, [40, 24]);
        all_near(&found, &sampled(&ripples, &coarse, [40, 24]), 1e-13);
        assert_eq!(coarse.shortest_wave_m(), thrice.shortest_wave_m());
    }
    // Between samples the spline of well resolved drops is as good.
    let ripples = basin([1.5, 0.9], 256, &[drop([0.1, 0.6], 0.12, 1.0, 0.0)]);
    let scene = scene(&ripples, None, 1.3);
    let (coarse, twice) = (surface_of(&scene), refined_surface(&scene, 2));
    for i in 0..400 {
        let p = f64::from(i) * DVec2::new(0.618_034, 0.754_878);
        let difference_m = coarse.at(p.x, p.y).height_m - twice.at(p.x, p.y).height_m;
        assert!(difference_m.abs() < 1e-6);
    }
}

#[test]
fn shallow_waves_run_at_the_root_of_gravity_and_depth() {
    let radius_m = 0.03;
    let mut ripples = basin([4.0, 4.0], 512, &[drop([1.5, 2.25], radius_m, 1.0, 0.0)]);
    ripples.dispersion = RippleDispersion::Shallow;
    let speed_m_per_s = (GRAVITY_M_PER_S2 * 0.1).sqrt();
    let times_s = [0.5, 1.0, 1.5];
    let crests_m = times_s.map(|time_s| {
        let surface = surface(&ripples, Some(0.1), time_s);
        let height_m = |r: f64| surface.at(1.5 + r, 2.25).height_m;
        let front_m = speed_m_per_s * time_s;
        // Nothing runs ahead but the mound's own tail, and the level from which its water was taken.
        let rest_m = -TAU * radius_m * radius_m / 16.0;
        assert!((height_m(front_m + 6.0 * radius_m) - rest_m).abs() < 1e-6);
        let outside_m = (0..4000).map(|i| front_m - 0.1 + f64::from(i) * 5e-5);
        outside_m
            .max_by(|a, b| height_m(*a).total_cmp(&height_m(*b)))
            .unwrap()
    });
    for (time_s, crest_m) in times_s.iter().zip(crests_m) {
        assert!((crest_m - speed_m_per_s * time_s).abs() < radius_m);
    }
    for pair in crests_m.windows(2) {
        assert!(((pair[1] - pair[0]) / 0.5 - speed_m_per_s).abs() < 2e-3 * speed_m_per_s);
    }
}

#[test]
fn hard_cases_are_finite_and_right() {
    let flat = |ripples: &Ripples, time_s: f64| {
        let surface = surface(ripples, Some(0.1), time_s);
        assert_eq!(surface.max_slope(), 0.0);
        assert_eq!(surface.shortest_wave_m(), f64::INFINITY);
        assert_eq!(
            slope_lost(&Ripples {
                drops: Vec::new(),
                ..ripples.clone()
            }),
            0.0
        );
    };
    let one = drop([0.0, 0.5], 0.05, 0.01, 0.0);
    flat(&basin([1.0, 1.0], 32, &[]), 3.0);
    flat(&basin([1.0, 1.0], 32, &[one]), -1e12);
    flat(
        &basin(
            [1.0, 1.0],
            32,
            &[RippleDrop {
                height_m: 0.0,
                ..one
            }],
        ),
        3.0,
    );
    flat(
        &basin(
            [1.0, 1.0],
            32,
            &[RippleDrop {
                radius_m: 1e4,
                ..one
            }],
        ),
        3.0,
    );

    for side_m in [[0.01, 0.01], [1e4, 1e4], [1e4, 0.01], [1.0, 0.7]] {
        for walls in [Walls::Reflecting, Walls::Periodic] {
            for (damping_per_s, depth_m) in [
                (0.0, None),
                (0.0, Some(0.0)),
                (1e-9, Some(1e-300)),
                (1000.0, Some(0.0)),
                (1000.0, None),
                (3.0, Some(11e3)),
            ] {
                let corner = [-0.5, 0.25];
                let far = [corner[0] + side_m[0], corner[1] + side_m[1]];
                let drops = [
                    drop(corner, 1e-4, 100.0, 0.0),
                    drop(far, 0.3 * side_m[0].max(side_m[1]), -1.0, -1e12),
                    drop([corner[0], far[1]], 1e4, 1.0, 1e9),
                ];
                let mut ripples = basin(side_m, 17, &drops);
                ripples.walls = walls;
                ripples.damping_per_s = damping_per_s;
                assert!((0.0..=1.0).contains(&slope_lost(&ripples)));
                for dispersion in [RippleDispersion::Shallow, RippleDispersion::FiniteDepth] {
                    ripples.dispersion = dispersion;
                    for time_s in [-1e12, 0.0, 0.1, 1e9, 1e12] {
                        let surface = surface(&ripples, depth_m, time_s);
                        let point = surface.at(0.1, 0.3);
                        assert!(point.height_m.is_finite() && point.slope.is_finite());
                        assert!(surface.max_slope().is_finite());
                        assert!(point.height_m.abs() <= surface.max_height_m());
                        assert!(surface.shortest_wave_m() > 0.0);
                    }
                }
            }
        }
    }
}

#[test]
fn without_depth_the_mound_stands_still() {
    for damping_per_s in [0.0, 1000.0] {
        let mut ripples = basin([1.0, 0.7], 32, &[drop([0.0, 0.5], 0.1, 0.01, 0.0)]);
        ripples.damping_per_s = damping_per_s;
        let start = surface(&ripples, Some(0.0), 0.0);
        assert!(start.max_slope() > 0.05);
        assert_eq!(surface(&ripples, Some(0.0), 1e12), start);
    }
}

#[test]
fn the_shortest_wave_is_that_of_the_smallest_drop() {
    let small = drop([0.0, 0.5], 0.05, 0.01, 0.0);
    let shortest_m = |samples: u32, drops: &[RippleDrop]| {
        surface(&basin([1.0, 1.0], samples, drops), None, 0.0).shortest_wave_m()
    };
    // Slopes k e^(−k²r²/2) fall to a thousandth of the largest at k r = 4.2.
    let resolved_m = shortest_m(128, &[small]);
    assert!(
        (resolved_m / (TAU * 0.05 / 4.2) - 1.0).abs() < 0.05,
        "{resolved_m}"
    );
    let wide = RippleDrop {
        radius_m: 0.2,
        ..small
    };
    assert!(shortest_m(128, &[wide]) > 3.0 * resolved_m);
    assert!(shortest_m(128, &[wide, small]) < 1.1 * resolved_m);
    // At most four samples a wave along each side.
    let truncated_m = shortest_m(
        16,
        &[RippleDrop {
            radius_m: 0.001,
            ..small
        }],
    );
    assert!(truncated_m >= 4.0 / 16.0 / 2_f64.sqrt() && truncated_m < 4.0 / 16.0);
}

#[test]
fn the_lost_slope_is_that_of_the_modes_left_out() {
    for walls in [Walls::Reflecting, Walls::Periodic] {
        for position_m in [[0.0, 0.5], [-0.5, 0.25], [1.0, 0.3]] {
            let lost = |samples: u32, radius_m: f64| {
                let mut ripples =
                    basin([1.5, 0.9], samples, &[drop(position_m, radius_m, 1.0, 0.0)]);
                ripples.walls = walls;
                slope_lost(&ripples)
            };
            // All modes by images, and all modes of a grid that carries them.
            assert!(lost(1024, 0.0149) < 1e-12 && lost(1024, 0.0151) < 1e-12);
            // Just below and above the radius where the sums change.
            for samples in [16, 64, 100] {
                let (below, above) = (lost(samples, 0.014_999_9), lost(samples, 0.015_000_1));
                assert!((below - above).abs() < 1e-4 && below > 0.01);
            }
            assert!(lost(64, 0.3) < 1e-12);
            assert!(lost(16, 1e-4) > 0.999_9);
        }
    }
    // A drop in open water: of 2 r⁴ k² e^(−k²r²) d²k, what is beyond the square of side 2 · 2π/(4 steps).
    let ripples = basin([1.0, 1.0], 256, &[drop([0.0, 0.75], 1.0 / 256.0, 1.0, 0.0)]);
    let (steps, limit) = (20_000, 0.25 * TAU);
    let within = |power: i32| -> f64 {
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps) * limit;
        let sum: f64 = (0..steps)
            .map(|i| at(i).powi(power) * (-at(i).powi(2)).exp())
            .sum();
        sum * limit / f64::from(steps)
    };
    let all = [0.5 * PI.sqrt(), 0.25 * PI.sqrt()];
    let expected = 1.0 - within(2) * within(0) / (all[0] * all[1]);
    assert!(
        (slope_lost(&ripples) - expected).abs() < 0.01,
        "{} {expected}",
        slope_lost(&ripples)
    );
}

#[test]
fn basins_are_described() {
    let one = drop([0.0, 0.5], 0.05, 0.01, 0.0);
    let words =
        |drops: &[RippleDrop]| surface(&basin([1.0, 1.0], 32, drops), None, 0.1).description();
    assert_eq!(words(&[one]), "water with a basin with 1 drop");
    assert_eq!(words(&[one; 3]), "water with a basin with 3 drops");
}

#[test]
fn products_keep_the_digits_of_their_fraction() {
    // (2⁴⁰ + 1)(2²⁰ + 2⁻³⁰) = 2⁶⁰ + 2²⁰ + 2¹⁰ + 2⁻³⁰: whole turns and 2⁻³⁰.
    let (a, b) = (2_f64.powi(40) + 1.0, 2_f64.powi(20) + 2_f64.powi(-30));
    let fraction = fraction_of_product(a, b);
    assert_eq!(fraction - fraction.round(), 2_f64.powi(-30));
    assert_eq!(fraction_of_product(0.75, 3.0), 0.25);
    assert_eq!(fraction_of_product(-0.75, 3.0), -0.25);
    // 10⁹ times the f64 next to 0.1, which is 0.1 + 5.551115123125783·10⁻¹⁸.
    let exact = 5.551_115_123_125_783e-9;
    assert!((fraction_of_product(0.1, 1e9) - exact).abs() < 1e-22);
}

#[test]
fn oscillators_solve_their_equation() {
    let swing = |omega: f64, gamma: f64, time_s: f64| {
        Oscillator::of(omega, gamma).swing(Elapsed::between(0.0, time_s))
    };
    for (omega, gamma) in [
        (3.0, 0.0),
        (3.0, 0.4),
        (3.0, 2.999),
        (3.0, 3.0),
        (3.0, 3.001),
        (3.0, 80.0),
        (0.0, 2.0),
    ] {
        let start = swing(omega, gamma, 0.0);
        assert_eq!((start.amplitude, start.rate_per_s), (1.0, 0.0));
        for time_s in [0.01, 0.3, 1.0, 4.0] {
            let h = 1e-4;
            let [before, here, after] = [-h, 0.0, h].map(|d| swing(omega, gamma, time_s + d));
            let rate = (after.amplitude - before.amplitude) / (2.0 * h);
            assert!((rate - here.rate_per_s).abs() < 1e-5);
            let force = (after.rate_per_s - before.rate_per_s) / (2.0 * h);
            let expected = -2.0 * gamma * here.rate_per_s - omega * omega * here.amplitude;
            assert!(
                (force - expected).abs() < 1e-4,
                "{omega} {gamma} {force} {expected}"
            );
        }
    }
    // Energy ½(ω²a² + a′²) without damping, to 10⁻¹⁰ and better.
    for time_s in [1.0, 1e4, 1e9] {
        let at = swing(2.7, 0.0, time_s);
        let energy = (2.7 * at.amplitude).powi(2) + at.rate_per_s.powi(2);
        assert!((energy / (2.7 * 2.7) - 1.0).abs() < 1e-14);
    }
    // No step at critical damping, where a = e^(−γτ)(1 + γτ), from either side.
    for time_s in [0.0, 1e-9, 0.5, 7.0, 40.0] {
        let critical = (-2.0_f64 * time_s).exp() * (1.0 + 2.0 * time_s);
        for gamma in [
            2.0,
            2.0 * (1.0 - 1e-16),
            2.0 * (1.0 + 3e-16),
            2.0 - 1e-13,
            2.0 + 1e-13,
        ] {
            let found = swing(2.0, gamma, time_s).amplitude;
            assert!(
                (found - critical).abs() < 1e-9 * critical,
                "{found} {critical}"
            );
        }
    }
    // Much damping: a creeps back with the rate ω²/(2γ).
    let creeping = swing(0.01, 1000.0, 1e6).amplitude;
    assert!((creeping - (-0.05_f64).exp()).abs() < 1e-9);
    assert_eq!(swing(0.0, 1000.0, 1e12).amplitude, 1.0);
    assert_eq!(swing(5.0, 1000.0, 1e12).amplitude, 0.0);
    // τ is the difference of the times, although no f64 holds it.
    let elapsed = Elapsed::between(0.1, 1e12);
    let late = Oscillator::of(TAU, 0.0).swing(elapsed).amplitude;
    assert!((late - (TAU * 0.9).cos()).abs() < 1e-12, "{late}");
}

#[test]
fn surface_tension_matters_for_short_waves_alone() {
    for depth_m in [0.5, f64::INFINITY] {
        let without = angular_frequency(1.0, depth_m);
        let with = angular_frequency_with_surface_tension(1.0, depth_m);
        assert!(with > without && with < 1.000_01 * without);
    }
    // Waves are slowest, 23 cm/s, at 1.7 cm (Lamb, §267).
    let speed = |wavelength_m: f64| {
        let k = TAU / wavelength_m;
        angular_frequency_with_surface_tension(k, f64::INFINITY) / k
    };
    assert!((speed(0.0171) - 0.231).abs() < 1e-3);
    assert!(speed(0.0171) < speed(0.0161) && speed(0.0171) < speed(0.0181));
    assert_eq!(angular_frequency_with_surface_tension(3.0, 0.0), 0.0);
    assert_eq!(angular_frequency_with_surface_tension(0.0, 1.0), 0.0);
}
