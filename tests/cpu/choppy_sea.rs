//! Choppy seas: surface points that move to the sides as well as up and down.

use std::f64::consts::TAU;

use caustica::render::Prepared;
use caustica::scene::{ResolvedScene, Scene, SceneError};
use caustica::waves::Surface;
use glam::DVec2;
use serde_json::{Value, json};

/// A sea with these fields besides those that every sea needs.
fn scene(fields: Value) -> Scene {
    let mut waves = json!({ "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 8, "tile_m": 50, "samples": 128 });
    for (name, value) in fields.as_object().unwrap() {
        waves[name] = value.clone();
    }
    serde_json::from_value(json!({ "water": { "waves": [waves] }, "time_s": 2.5 })).unwrap()
}

fn refined(scene: Scene, refinement: u32) -> Result<Surface, SceneError> {
    Surface::refined(&ResolvedScene::bare(scene), refinement)
}

fn surface(fields: Value) -> Surface {
    refined(scene(fields), 1).unwrap()
}

/// Heights at `count` × `count` points of the tile of 50 m.
fn heights(surface: &Surface, count: usize) -> Vec<f64> {
    let step_m = 50.0 / count as f64;
    let places = (0..count * count).map(|i| (i % count, i / count));
    places
        .map(|(x, z)| surface.at(x as f64 * step_m, z as f64 * step_m).height_m)
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Skewness of the downward curvature at 128 × 128 points: above 0 if crests are sharper than troughs.
fn sharpness(surface: &Surface) -> f64 {
    let step_m = 50.0 / 128.0;
    let places = (0..128 * 128).map(|i| (f64::from(i % 128) * step_m, f64::from(i / 128) * step_m));
    let curvatures: Vec<f64> = places
        .map(|(x_m, z_m)| surface.curved_at(x_m, z_m).1)
        .map(|curvature| -(curvature.xx_per_m + curvature.zz_per_m))
        .collect();
    let moment = |power: i32| mean(&curvatures.iter().map(|c| c.powi(power)).collect::<Vec<_>>());
    moment(3) / moment(2).powf(1.5)
}

/// One wave: of all waves of 1/11 of the tile only that along the wind has a height, for swell spreads little.
fn one_wave(choppiness: f64) -> Value {
    json!({
        "wind_speed_m_s": 1, "swell": 1, "min_wavelength_m": 4.54, "max_wavelength_m": 4.55, "samples": 1024,
        "significant_height_m": 0.8, "choppiness": choppiness
    })
}

#[test]
fn one_wave_is_a_trochoid() {
    let amplitude_m = 0.8 / 8.0_f64.sqrt();
    let k_per_m = TAU * 11.0 / 50.0;
    let start = surface(one_wave(0.0)).at(0.0, 0.0);
    let phase = (-start.slope.x / k_per_m).atan2(start.height_m);
    let found_m = start.height_m.hypot(start.slope.x / k_per_m);
    assert!(
        (found_m / amplitude_m - 1.0).abs() < 1e-6,
        "{found_m} {amplitude_m}"
    );
    for choppiness in [0.3, 1.0, 2.0] {
        let gerstner: Scene = serde_json::from_value(json!({ "water": { "waves": [{
            "kind": "gerstner", "amplitude_m": amplitude_m, "wavelength_m": 50.0 / 11.0, "phase_deg": phase.to_degrees(),
            "steepness": choppiness * k_per_m * amplitude_m
        }] } }))
        .unwrap();
        let trochoid = refined(gerstner, 1).unwrap();
        let sea = surface(one_wave(choppiness));
        for point in 0..400 {
            // At the samples; between them too, but for crests of a steepness of 0.78, of which 93 samples per wave miss more.
            let between = if choppiness > 1.0 { 0.0 } else { 0.01 };
            let x_m = f64::from(point) * (50.0 / 1024.0 + between);
            let z_m = f64::from(point) * (50.0 / 1024.0 + 2.0 * between);
            let (found, expected) = (sea.at(x_m, z_m), trochoid.at(x_m, z_m));
            let off_m = (found.height_m - expected.height_m).abs();
            assert!(off_m < 1e-6, "{choppiness} at {x_m} m: {off_m}");
        }
    }
}

/// Coefficients of e^(i (2π/L) (i x + j z)) of long waves, by a plain sum over the heights: i, j, real and imaginary part.
fn waves(surface: &Surface) -> Vec<(f64, f64, DVec2)> {
    let count = 32;
    let heights = heights(surface, count);
    let mut waves = Vec::new();
    for i in -12..=12_i32 {
        for j in -12..=12_i32 {
            let sum: DVec2 = heights
                .iter()
                .enumerate()
                .map(|(index, h)| {
                    let turns = f64::from(i) * (index % count) as f64
                        + f64::from(j) * (index / count) as f64;
                    *h * DVec2::from_angle(-TAU * turns / count as f64)
                })
                .sum();
            waves.push((f64::from(i), f64::from(j), sum / heights.len() as f64));
        }
    }
    waves
}

/// Points are where the waves, added up one by one, displace them.
#[test]
fn points_are_displaced_along_their_waves() {
    let fields = |choppiness: f64| {
        json!({
            "min_wavelength_m": 4.5, "spreading": "elfouhaily", "samples": 1024, "choppiness": choppiness, "seed": 5
        })
    };
    let waves = waves(&surface(fields(0.0)));
    let sea = surface(fields(0.9));
    let offsets: Vec<f64> = (0..60)
        .map(|index| {
            let rest_m = DVec2::new(f64::from(index) * 7.31, f64::from(index) * 3.77);
            let (mut place_m, mut height_m) = (rest_m, 0.0);
            for (i, j, coefficient) in &waves {
                let k = DVec2::new(*i, *j);
                let wave = coefficient.rotate(DVec2::from_angle(TAU * k.dot(rest_m) / 50.0));
                height_m += wave.x;
                // The real part of i times the wave.
                place_m -= 0.9 * k.normalize_or_zero() * wave.y;
            }
            sea.at(place_m.x, place_m.y).height_m - height_m
        })
        .collect();
    // The mean height was 0 over q and is 0 over x.
    for offset in &offsets {
        assert!(
            (offset - offsets[0]).abs() < 1e-6,
            "{offset} {}",
            offsets[0]
        );
    }
    assert!((0.001..0.2).contains(&offsets[0]), "{}", offsets[0]);
}

/// Crests are sharper and troughs flatter. The heights themselves are no more skewed: those of normally distributed waves stay
/// symmetric about their mean to second order, while a single wave's do not.
#[test]
fn crests_sharpen_and_the_mean_stays() {
    let seas = [0.0, 0.3, 0.6, 0.9]
        .map(|choppiness| surface(json!({ "choppiness": choppiness, "seed": 3 })));
    let heights = seas.each_ref().map(|sea| heights(sea, 128));
    for sea in &heights {
        assert!(mean(sea).abs() < 1e-15, "{}", mean(sea));
    }
    let sharpness = seas.each_ref().map(sharpness);
    assert!(sharpness[0].abs() < 0.1, "{sharpness:?}");
    assert!(
        sharpness.windows(2).all(|pair| pair[1] > pair[0] + 0.03),
        "{sharpness:?}"
    );
    // What is raised at the sides of crests is missing below: the mean over x is 0, that over points at rest is above it.
    let ends = heights.each_ref().map(|sea| {
        sea.iter().fold((0.0, 0.0), |(low, high): (f64, f64), h| {
            (low.min(*h), high.max(*h))
        })
    });
    assert!(ends[3].1 > ends[0].1 && ends[3].0 > ends[0].0, "{ends:?}");
}

/// Refined grids hold the same surface: it differs by what the splines of 8 samples per wave miss.
#[test]
fn refinement_keeps_the_surface() {
    let sea = |refinement: u32| {
        let fields = json!({ "min_wavelength_m": 3.125, "choppiness": 0.8 });
        heights(&refined(scene(fields), refinement).unwrap(), 128)
    };
    let (coarse, fine) = (sea(1), sea(4));
    let off_m = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs());
    let off_m = off_m.fold(0.0, f64::max);
    let highest_m = fine.iter().fold(0.0, |a: f64, h| a.max(*h));
    assert!(off_m < 2e-3 * highest_m, "{off_m} {highest_m}");
    assert!(off_m > 0.0);
}

#[test]
fn a_sea_that_folds_is_refused_with_its_limit() {
    let amplitude_m = 0.8 / 8.0_f64.sqrt();
    let steepness = TAU * 11.0 / 50.0 * amplitude_m;
    // Waves twice as high as those above.
    let fields = |choppiness: f64| {
        let mut fields = one_wave(choppiness);
        fields["significant_height_m"] = json!(1.6);
        fields
    };
    let limit = 0.95 / (2.0 * steepness);
    let error = refined(scene(fields(limit * 1.001)), 1).unwrap_err();
    let [issue] = &error.issues[..] else {
        panic!("{error}")
    };
    assert_eq!(issue.pointer, "/water/waves/0/choppiness");
    assert!(issue.detail.contains("at 2.5 s"), "{issue}");
    let named: f64 = issue.accepted["at most ".len()..]
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!(
        (0.998 * limit - 1e-3..=limit).contains(&named),
        "{named} {limit}"
    );
    let surface = surface(fields(named));
    assert!(surface.max_slope().is_finite());
    // The finer grid of a reference has a limit that is at least as large.
    refined(scene(fields(named)), 4).unwrap();

    // It is an error of the scene, before anything is rendered.
    let whole = ResolvedScene::bare(scene(fields(1.9)));
    let error = Prepared::new(whole.clone()).unwrap_err();
    assert_eq!(error.issues[0].pointer, "/water/waves/0/choppiness");
    // And of another moment of an animation.
    let mut calm = whole;
    calm.scene = scene(fields(named));
    let prepared = Prepared::new(calm).unwrap();
    assert!(prepared.at(2.5).is_ok());
}

/// Every sea is either refused, with a limit that is accepted, or a function with finite bounds.
#[test]
fn limits_are_accepted() {
    let (mut refused, mut taken) = (0, 0);
    for seed in 0..12 {
        for (model, wind, height_m, shortest_m) in [
            ("jonswap", 8.0, None, 1.5625),
            ("elfouhaily", 3.0, None, 1.5625),
            ("phillips", 20.0, None, 1.5625),
            ("phillips", 10.0, Some(100.0), 20.0),
        ] {
            let fields = |choppiness: f64| {
                let mut fields = json!({ "model": model, "wind_speed_m_s": wind, "seed": seed, "min_wavelength_m": shortest_m, "choppiness": choppiness });
                if let Some(height_m) = height_m {
                    fields["significant_height_m"] = json!(height_m);
                }
                fields
            };
            let surface = match refined(scene(fields(2.0)), 1) {
                Ok(surface) => surface,
                Err(error) => {
                    refused += 1;
                    let accepted = &error.issues[0].accepted["at most ".len()..];
                    let limit: f64 = accepted.split(' ').next().unwrap().parse().unwrap();
                    refined(scene(fields(limit)), 1).unwrap()
                }
            };
            taken += 1;
            let bounds = [
                surface.max_height_m(),
                surface.max_slope(),
                surface.max_third_derivative_per_m2(),
            ];
            assert!(
                bounds.iter().all(|bound| bound.is_finite()),
                "{model} {seed}"
            );
            assert!(mean(&heights(&surface, 128)).abs() < 1e-12 * surface.max_height_m());
        }
    }
    assert!(refused >= 12 && taken == 48, "{refused} of {taken}");
}
