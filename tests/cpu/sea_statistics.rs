//! Peak periods of seas, estimated from the heights of 32 seeds as an oceanographer would from records.

use std::f64::consts::TAU;

use caustica::physics::dispersion;
use caustica::physics::sea::FrequencySpectrum;
use caustica::scene::Scene;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use serde_json::{Value, json};

use crate::surfaces::surface_of;

const SEEDS: u32 = 32;

fn scene(fields: &Value, seed: u32) -> Scene {
    let mut waves = json!({ "kind": "spectrum", "seed": seed });
    for (name, value) in fields.as_object().unwrap() {
        waves[name] = value.clone();
    }
    serde_json::from_value(json!({ "water": { "waves": [waves] } })).unwrap()
}

/// Mean squared height, m², of the waves whose wave number is nearest to m · 2π/L, by m, in the mean of all seeds, and the number of these
/// waves.
fn rings(fields: &Value) -> Vec<(f64, f64)> {
    let count = fields["samples"].as_u64().unwrap() as usize;
    let tile_m = fields["tile_m"].as_f64().unwrap();
    let fft = FftPlanner::new().plan_fft_forward(count);
    let mut rings = vec![(0.0, 0.0); count / 2];
    for seed in 0..SEEDS {
        let surface = surface_of(&scene(fields, seed));
        let step_m = tile_m / count as f64;
        let mut lines: Vec<Complex64> = (0..count * count)
            .map(|at| {
                let (x, z) = ((at % count) as f64 * step_m, (at / count) as f64 * step_m);
                Complex64::new(surface.at(x, z).height_m, 0.0)
            })
            .collect();
        for _ in 0..2 {
            fft.process(&mut lines);
            let rows = lines.clone();
            for (at, value) in lines.iter_mut().enumerate() {
                *value = rows[at % count * count + at / count];
            }
        }
        let signed = |i: usize| (i as f64) - if i > count / 2 { count as f64 } else { 0.0 };
        for (at, value) in lines.iter().enumerate() {
            let ring = signed(at % count).hypot(signed(at / count)).round() as usize;
            if (1..count / 2).contains(&ring) {
                rings[ring].0 += value.norm_sqr() / (count as f64).powi(4) / f64::from(SEEDS);
                rings[ring].1 += 1.0;
            }
        }
    }
    rings
}

/// The factor on the peak frequency of `expected` with which it fits the rings best, and its scale with them: most likely under
/// exponentially distributed squares (Whittle 1953). Rings below `first_ring`, where there are almost no waves, are left out.
fn best_factor(fields: &Value, expected: &FrequencySpectrum, first_ring: usize) -> f64 {
    let rings = rings(fields);
    let step_per_m = TAU / fields["tile_m"].as_f64().unwrap();
    // A spectrum keeps its shape if its frequencies are stretched; its height is fitted.
    let variance = |ring: usize, factor: f64| {
        let parts = 32;
        (0..parts)
            .map(|part| {
                let ring = ring as f64 - 0.5 + (f64::from(part) + 0.5) / f64::from(parts);
                let (omega, speed) =
                    dispersion::with_surface_tension(ring * step_per_m, f64::INFINITY);
                expected.at(omega / factor) * speed * step_per_m / f64::from(parts)
            })
            .sum::<f64>()
    };
    let unlikeliness = |factor: f64| {
        // The spline through the samples carries waves of four samples and more.
        let used: Vec<(f64, f64, f64)> = (first_ring..rings.len() / 2)
            .map(|ring| (rings[ring].0, rings[ring].1, variance(ring, factor)))
            .collect();
        let all: f64 = used.iter().map(|(_, count, _)| count).sum();
        let scale = used
            .iter()
            .map(|(squares, count, model)| count * squares / model)
            .sum::<f64>()
            / all;
        let logs: f64 = used
            .iter()
            .map(|(_, count, model)| count * (scale * model).ln())
            .sum();
        logs + all
    };
    let factors = (0..=400).map(|i| 0.8 + f64::from(i) * 1e-3);
    factors
        .min_by(|a, b| unlikeliness(*a).total_cmp(&unlikeliness(*b)))
        .unwrap()
}

/// Peak periods, s, integrated from the published formulas by others.
#[test]
fn seas_have_the_published_peak_periods() {
    for (model, wind, fetch_m, period_s) in [
        ("jonswap", 5.0, 20_000.0, 2.81),
        ("jonswap", 10.0, 100_000.0, 6.05),
        ("jonswap", 17.0, 300_000.0, 10.41),
        ("pierson_moskowitz", 5.0, 20_000.0, 3.68),
        ("pierson_moskowitz", 10.0, 100_000.0, 7.36),
    ] {
        let expected = match model {
            "jonswap" => FrequencySpectrum::jonswap(wind, fetch_m, 3.3),
            _ => FrequencySpectrum::pierson_moskowitz(wind),
        };
        // Tiles of 12 and 16 peak waves, of 128 and 256 samples: both resolve the band.
        let peak_m = 9.81 * period_s * period_s / TAU;
        for (waves, samples) in [(12.0, 128), (16.0, 256)] {
            let fields = json!({
                "model": model, "wind_speed_m_s": wind, "fetch_m": fetch_m,
                "tile_m": waves * peak_m, "samples": samples
            });
            let factor = best_factor(&fields, &expected, waves as usize / 2);
            let found_s = TAU / (factor * expected.peak_rad_per_s());
            println!(
                "{model} {wind} m/s, {samples} samples: {found_s:.3} s, published {period_s} s"
            );
            assert!(
                (found_s / period_s - 1.0).abs() < 0.02,
                "{model} {wind}: {found_s}"
            );
        }
    }
}
