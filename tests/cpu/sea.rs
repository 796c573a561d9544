//! Seas from wave spectra: the formulas, and the sea they make.

use std::f64::consts::{PI, TAU};

use crate::surfaces::{refined_surface, surface_of};

use caustica::physics::dispersion::{angular_frequency, with_surface_tension};
use caustica::physics::sea::{
    Elfouhaily, FrequencySpectrum, depth_factor, phillips, phillips_peak,
};
use caustica::physics::spreading::{Spread, elfouhaily_delta};
use caustica::scene::{ResolvedScene, Scene, SpectrumWaves, Wave};
use caustica::waves::{ROW_POINTS, RowPoints, Surface};
use glam::DVec2;
use serde_json::{Value, json};

/// A sea with these fields besides those that every sea needs; `scene` are fields of the scene.
fn scene_with(fields: Value, scene: Value) -> Scene {
    let mut waves = json!({ "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 8, "tile_m": 50, "samples": 64 });
    let mut whole = json!({ "water": { "waves": [] } });
    for (into, from) in [(&mut waves, fields), (&mut whole, scene)] {
        for (name, value) in from.as_object().unwrap() {
            into[name] = value.clone();
        }
    }
    whole["water"]["waves"] = json!([waves]);
    serde_json::from_value(whole).unwrap()
}

fn scene_of(fields: Value) -> Scene {
    scene_with(fields, json!({}))
}

fn waves_of(scene: &Scene) -> &SpectrumWaves {
    match &scene.water.waves[0] {
        Wave::Spectrum(waves) => waves,
        _ => panic!("no spectrum"),
    }
}

/// Heights at `count` × `count` points of the tile, row by row along x.
fn heights(scene: &Scene, count: usize) -> Vec<f64> {
    grid(&surface_of(scene), waves_of(scene).tile_m, count)
}

fn grid(surface: &Surface, tile_m: f64, count: usize) -> Vec<f64> {
    let step_m = tile_m / count as f64;
    let mut heights = Vec::with_capacity(count * count);
    let mut points = RowPoints::FLAT;
    let rows = surface.rows(DVec2::X * step_m);
    for row in 0..count {
        for first in (0..count).step_by(ROW_POINTS) {
            let points_here = ROW_POINTS.min(count - first);
            let start = DVec2::new(first as f64, row as f64) * step_m;
            rows.evaluate(start, &mut points);
            heights.extend_from_slice(&points.height_m[..points_here]);
        }
    }
    heights
}

fn significant_height(heights: &[f64]) -> f64 {
    4.0 * (heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64).sqrt()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(
        0.0,
        |most, d| if d.is_nan() { f64::NAN } else { most.max(d) },
    )
}

/// Integral over `from` … `to` in even steps of the logarithm.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (count, step) = (20_000, (to / from).ln() / 20_000.0);
    (0..count)
        .map(|i| {
            let x = from * ((f64::from(i) + 0.5) * step).exp();
            f(x) * x * step
        })
        .sum()
}

/// Period of the highest value of `f`, found on a fine grid.
fn peak_period(f: impl Fn(f64) -> f64) -> f64 {
    let omegas = (1..100_000).map(|i| f64::from(i) * 2e-4);
    TAU / omegas.max_by(|a, b| f(*a).total_cmp(&f(*b))).unwrap()
}

#[test]
fn spectra_have_the_published_heights_and_periods() {
    let pierson = FrequencySpectrum::pierson_moskowitz;
    let jonswap = |wind, fetch| FrequencySpectrum::jonswap(wind, fetch, 3.3);
    // Integrated by others from the same formulas; heights in two or three digits.
    for (name, spectrum, height_m, period_s) in [
        ("JONSWAP 5", jonswap(5.0, 20e3), 0.45, 2.81),
        ("JONSWAP 10", jonswap(10.0, 100e3), 2.01, 6.05),
        ("JONSWAP 17", jonswap(17.0, 300e3), 5.94, 10.41),
        ("PM 5", pierson(5.0), 0.53, 3.68),
        ("PM 10", pierson(10.0), 2.13, 7.36),
        ("PM 17", pierson(17.0), 6.17, 12.52),
    ] {
        let peak = spectrum.peak_rad_per_s();
        let found = 4.0 * integral(0.1 * peak, 1e3 * peak, |w| spectrum.at(w)).sqrt();
        assert!((found / height_m - 1.0).abs() < 0.012, "{name}: {found} m");
        let found = peak_period(|w| spectrum.at(w));
        assert!((found / period_s - 1.0).abs() < 0.02, "{name}: {found} s");
    }
}

#[test]
fn phillips_is_pierson_moskowitz_for_short_waves() {
    let (wind, k) = (7.0, 1000.0);
    let omega = angular_frequency(k, f64::INFINITY);
    let group_speed = omega / (2.0 * k);
    let pierson = FrequencySpectrum::pierson_moskowitz(wind).at(omega) * group_speed;
    assert!((phillips(k, wind) / pierson - 1.0).abs() < 1e-6);
    let in_frequency = |omega: f64| {
        let k = omega * omega / 9.806_65;
        phillips(k, wind) * 2.0 * k / omega
    };
    let period = peak_period(in_frequency);
    assert!((period * phillips_peak(wind) / TAU - 1.0).abs() < 1e-3);
}

#[test]
fn the_depth_factor_keeps_the_similarity() {
    let depth = 3.0;
    for k in [1e-3, 0.05, 0.3, 1.0, 5.0, 300.0] {
        let omega = |k: f64| angular_frequency(k, depth);
        let h = 1e-5 * k;
        let k_slope = 2.0 * h / (omega(k + h) - omega(k - h));
        // (k⁻³ ∂k/∂ω) in water of this depth over that in deep water, 2 g²/ω⁵.
        let similar = k_slope / k.powi(3) * omega(k).powi(5) / (2.0 * 9.806_65_f64.powi(2));
        let found = depth_factor(k * depth);
        assert!(
            (found / similar - 1.0).abs() < 1e-8,
            "{k}: {found} {similar}"
        );
    }
    assert_eq!(depth_factor(0.0), 0.0);
}

#[test]
fn surface_tension_makes_short_waves_faster() {
    // Without tension's effect: long waves. Group speed: the derivative.
    for depth in [0.02, 2.0, f64::INFINITY] {
        let (long, _) = with_surface_tension(0.1, depth);
        assert!((long / angular_frequency(0.1, depth) - 1.0).abs() < 1e-6);
        for k in [0.01, 1.0, 370.0, 1e5] {
            let omega = |k: f64| with_surface_tension(k, depth).0;
            let slope = (omega(k * 1.000_01) - omega(k * 0.999_99)) / (2e-5 * k);
            let found = with_surface_tension(k, depth).1;
            assert!((found / slope - 1.0).abs() < 1e-7, "{k} {depth}");
        }
    }
    // The slowest waves: 1.7 cm long, 23 cm/s (Lamb, §267).
    let speed = |k: f64| with_surface_tension(k, f64::INFINITY).0 / k;
    let slowest = (100..1000)
        .map(f64::from)
        .min_by(|a, b| speed(*a).total_cmp(&speed(*b)));
    let length_m = TAU / slowest.unwrap();
    assert!((length_m - 0.0171).abs() < 1e-4 && (speed(slowest.unwrap()) - 0.231).abs() < 1e-3);
    assert_eq!(with_surface_tension(1.0, 0.0), (0.0, 0.0));
}

#[test]
fn elfouhaily_has_the_slopes_of_cox_and_munk() {
    // Clean water: 0.003 + 5.12e-3 W. Below 3 m/s the model has more long waves than they saw (1.53 times the slopes at 2 m/s).
    for wind in [3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 14.0] {
        let spectrum = Elfouhaily::of(wind, 300e3);
        let found = integral(1e-4, 1e5, |k| k * k * spectrum.at(k));
        let seen = 0.003 + 5.12e-3 * wind;
        assert!(
            (found / seen - 1.0).abs() < 0.25,
            "{wind} m/s: {found} {seen}"
        );
    }
}

fn spreads() -> Vec<(String, Spread)> {
    let mut spreads = Vec::new();
    for swell in [0.0, 0.3, 1.0] {
        for ratio in [1e-3, 0.3, 0.56, 0.8, 0.95, 1.0, 1.05, 1.3, 1.6, 4.0, 100.0] {
            let delta = elfouhaily_delta(10.0 / ratio, 10.0, 0.3);
            for (name, spread) in [
                ("cos2", Spread::cos2(ratio, swell)),
                ("hasselmann", Spread::hasselmann(ratio, 1.0, swell)),
                ("donelan_banner", Spread::donelan_banner(ratio, swell)),
                ("elfouhaily", Spread::elfouhaily(delta, ratio, swell)),
            ] {
                spreads.push((format!("{name} {ratio} {swell}"), spread));
            }
        }
    }
    spreads
}

/// Simpson's rule.
fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let count = 20_000;
    let step = (to - from) / f64::from(count);
    let inside: f64 = (1..count)
        .map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * f(from + f64::from(i) * step))
        .sum();
    (f(from) + inside + f(to)) * step / 3.0
}

#[test]
fn spreadings_integrate_to_one() {
    for (name, spread) in spreads() {
        let density = |angle: f64| spread.density(angle.cos());
        // Against the wind densities may go as a broken power p of the distance: in steps of its logarithm, the rest by the power.
        let distance = |d: f64| density(PI - d);
        let near = 1e-5_f64;
        let power = (distance(near) / distance(0.5 * near)).log2();
        let rest = if power.is_finite() {
            near * distance(near) / (power + 1.0)
        } else {
            0.0
        };
        let against = simpson(near.ln(), (PI / 2.0).ln(), |l| distance(l.exp()) * l.exp());
        let total = 2.0 * (simpson(0.0, PI / 2.0, density) + against + rest);
        assert!((total - 1.0).abs() < 1e-10, "{name}: {total}");
    }
}

#[test]
fn swell_narrows_all_spreadings() {
    for of in [
        |swell| Spread::cos2(0.8, swell),
        |swell| Spread::hasselmann(0.8, 1.0, swell),
        |swell| Spread::donelan_banner(0.8, swell),
        |swell| Spread::elfouhaily(0.6, 0.8, swell),
    ] {
        let ahead = [0.0, 0.5, 1.0].map(|swell| of(swell).density(1.0));
        assert!(ahead[0] < ahead[1] && ahead[1] < ahead[2], "{ahead:?}");
    }
}

/// Root mean square of the significant heights of 32 seas, m.
fn height_of_32(fields: &Value) -> f64 {
    let mut squares = 0.0;
    for seed in 0..32 {
        let mut fields = fields.clone();
        fields["seed"] = json!(seed);
        let scene = scene_of(fields);
        let count = waves_of(&scene).samples as usize;
        squares += significant_height(&heights(&scene, count)).powi(2);
    }
    (squares / 32.0).sqrt()
}

#[test]
fn seas_have_the_published_heights() {
    // Tiles of 20 waves of the peak's length, 512 samples: the band is 1/6 … 20 of this length, which leaves out about 1 % of the height.
    for (fields, height_m) in [
        (
            json!({ "wind_speed_m_s": 5, "fetch_m": 20e3, "tile_m": 250 }),
            0.45,
        ),
        (
            json!({ "wind_speed_m_s": 10, "fetch_m": 100e3, "tile_m": 1200 }),
            2.01,
        ),
        (
            json!({ "model": "pierson_moskowitz", "wind_speed_m_s": 10, "tile_m": 1800 }),
            2.13,
        ),
    ] {
        let mut fields = fields;
        fields["samples"] = json!(512);
        fields["spreading"] = json!("hasselmann");
        let found = height_of_32(&fields);
        assert!((found / height_m - 1.0).abs() < 0.02, "{fields}: {found} m");
    }
}

#[test]
fn the_height_depends_on_neither_tile_nor_samples() {
    // One band on tiles of 5 … 20 waves of the peak's length.
    let peak = FrequencySpectrum::jonswap(6.0, 5e3, 3.3);
    let omega = |length_m: f64| angular_frequency(TAU / length_m, f64::INFINITY);
    for (tile_m, samples) in [(100.0, 256), (50.0, 128), (25.0, 64)] {
        let found = height_of_32(&json!({
            "wind_speed_m_s": 6, "fetch_m": 5e3, "tile_m": tile_m, "samples": samples, "min_wavelength_m": 1.6,
        }));
        let whole = 4.0 * integral(omega(25.0), omega(1.6), |w| peak.at(w)).sqrt();
        // Scatter of 32 seas: few waves on the smallest tile.
        let tolerance = if tile_m < 30.0 { 0.08 } else { 0.03 };
        assert!(
            (found / whole - 1.0).abs() < tolerance,
            "{tile_m}: {found} {whole}"
        );
    }
}

#[test]
fn the_significant_height_is_exact() {
    for (direction, time_s, swell) in [(0.0, 0.0, 0.0), (33.0, 7.25, 0.5), (90.0, 1e6, 1.0)] {
        let scene = scene_with(
            json!({ "wind_direction_deg": direction, "significant_height_m": 0.7, "swell": swell }),
            json!({ "time_s": time_s }),
        );
        let found = significant_height(&heights(&scene, 64));
        assert!((found - 0.7).abs() < 1e-9, "{direction}: {found}");
    }
    // With waves in all directions it is that of the mean over time.
    let squares = (0..64).map(|i| {
        let scene = scene_with(
            json!({ "spreading": "elfouhaily", "significant_height_m": 0.7, "samples": 128, "tile_m": 100 }),
            json!({ "time_s": f64::from(i) * 7.3 }),
        );
        significant_height(&heights(&scene, 128)).powi(2)
    });
    let mean = (squares.sum::<f64>() / 64.0).sqrt();
    assert!((mean / 0.7 - 1.0).abs() < 0.01, "{mean}");
}

#[test]
fn a_sea_is_the_same_with_other_samples() {
    for spreading in ["cos2", "donelan_banner"] {
        let sea = |samples: u32| {
            scene_with(
                json!({ "samples": samples, "min_wavelength_m": 1.7, "spreading": spreading, "seed": 9 }),
                json!({ "time_s": 12.5 }),
            )
        };
        // At the samples splines go through the heights.
        let fine = heights(&sea(256), 256);
        let coarse = heights(&sea(128), 128);
        let common: Vec<f64> = (0..128 * 128)
            .map(|i| fine[i / 128 * 2 * 256 + i % 128 * 2])
            .collect();
        assert!(largest_difference(&coarse, &common) < 1e-12);
        assert!(significant_height(&coarse) > 0.1);
    }
}

#[test]
fn seeds_give_different_seas() {
    let sea = |seed: u32| {
        heights(
            &scene_of(json!({ "seed": seed, "significant_height_m": 1 })),
            64,
        )
    };
    let (a, b) = (sea(0), sea(1));
    let together: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / 4096.0;
    assert!((together * 16.0).abs() < 0.5, "correlation {together}");
    assert_eq!(a, sea(0));
}

#[test]
fn refinement_interpolates_the_same_waves() {
    let scene = scene_with(json!({ "spreading": "hasselmann" }), json!({ "time_s": 3 }));
    let coarse = grid(&refined_surface(&scene, 1), 50.0, 64);
    for refinement in [2, 3, 4] {
        let fine = grid(&refined_surface(&scene, refinement), 50.0, 64);
        assert!(largest_difference(&coarse, &fine) < 1e-12, "{refinement}");
    }
}

/// Every frame of a loop is the same to the bit after many turns, though f64 rounds its time differently then.
#[test]
fn all_frames_of_a_loop_repeat_after_a_thousand_turns() {
    for loop_s in [12.7, 60.0, 1.0 / 24.0, 3.1] {
        let fields = json!({ "loop_s": loop_s, "min_wavelength_m": 5, "max_wavelength_m": 12 });
        let mut resolved = ResolvedScene::bare(scene_of(fields));
        let mut at = |time_s: f64| {
            resolved.scene.time_s = time_s;
            Surface::of(&resolved).unwrap()
        };
        let frames = (loop_s * 24.0) as i32;
        for frame in 0..=frames {
            let time_s = f64::from(frame) / 24.0;
            let first = at(time_s);
            for turns in [1.0, 10.0, 1000.0] {
                let later = at(time_s + turns * loop_s);
                assert!(
                    first == later,
                    "frame {frame} of {loop_s} s, {turns} turns later"
                );
            }
        }
    }
}

#[test]
fn a_loop_repeats_to_the_bit() {
    let sea = |time_s: f64, loop_s: f64| {
        let fields = json!({ "loop_s": loop_s, "spreading": "elfouhaily" });
        heights(&scene_with(fields, json!({ "time_s": time_s })), 64)
    };
    for loop_s in [4.0, 3.1, 12.7] {
        for time_s in [0.0, 0.3, 1.1, 2.9, -0.7] {
            let first = sea(time_s, loop_s);
            assert!(first == sea(time_s + loop_s, loop_s), "{time_s} {loop_s}");
            assert!(first != sea(time_s + 0.5 * loop_s, loop_s));
        }
    }
    // 24 frames a second of a loop of 10 s, the second time round.
    for frame in [1, 77, 239] {
        let at = |frame: i32| sea(f64::from(frame) / 24.0, 10.0);
        assert!(at(frame) == at(frame + 240), "{frame}");
    }
}

#[test]
fn the_tile_repeats() {
    let scene = scene_of(json!({}));
    let surface = surface_of(&scene);
    for (x, z) in [(0.1, 0.2), (17.0, 48.3), (-3.3, 21.9)] {
        let here = surface.at(x, z);
        for (i, j) in [(1.0, 0.0), (0.0, -1.0), (-7.0, 12.0)] {
            let there = surface.at(x + 50.0 * i, z + 50.0 * j);
            assert!((here.height_m - there.height_m).abs() < 1e-12);
            assert!((here.slope - there.slope).length() < 1e-11);
        }
    }
}

/// Amplitude of e^(i (2π/L) (i x + j z)) in the heights of a tile: (real, imaginary).
fn coefficient(heights: &[f64], count: usize, i: f64, j: f64) -> DVec2 {
    let sum: DVec2 = heights
        .iter()
        .enumerate()
        .map(|(index, h)| {
            let (x, z) = ((index % count) as f64, (index / count) as f64);
            *h * DVec2::from_angle(-TAU * (i * x + j * z) / count as f64)
        })
        .sum();
    sum / heights.len() as f64
}

#[test]
fn waves_travel_with_the_wind_at_their_speed() {
    // The wind along (1, 2): these waves have no opposites.
    let direction_deg = 2.0_f64.atan2(1.0).to_degrees();
    let sea = |time_s: f64, floor: bool| {
        let mut scene = json!({ "time_s": time_s });
        if floor {
            scene["floor"] = json!({ "depth_m": 0.2, "size_m": [1, 1] });
        }
        let fields = json!({ "tile_m": 4, "wind_direction_deg": direction_deg });
        heights(&scene_with(fields, scene), 64)
    };
    for (floor, depth_m) in [(false, f64::INFINITY), (true, 0.2)] {
        let first = sea(0.0, floor);
        for time_s in [0.37, 11.0, -2.5] {
            let later = sea(time_s, floor);
            for (i, j) in [(1.0_f64, 2.0_f64), (3.0, 3.0), (0.0, 7.0), (-1.0, 4.0)] {
                let (omega, _) = with_surface_tension(TAU / 4.0 * i.hypot(j), depth_m);
                let before = coefficient(&first, 64, i, j);
                let expected = DVec2::from_angle(-omega * time_s).rotate(before);
                let found = coefficient(&later, 64, i, j);
                // Frequencies are whole multiples of 2⁻³⁰ Hz.
                let off = (found - expected).length() / before.length();
                assert!(off < 1e-7, "({i}, {j}) at {time_s} s: {off}");
            }
        }
    }
}

#[test]
fn phases_are_exact_at_late_times() {
    // Frequencies are n 2⁻³⁰ Hz: at t = 10⁹ s + 0.25 s, and 2³⁰ s later, phases are those of whole numbers.
    let sea = |time_s: f64| {
        heights(
            &scene_with(json!({ "tile_m": 4 }), json!({ "time_s": time_s })),
            64,
        )
    };
    let (i, j) = (2.0_f64, 1.0_f64);
    let (omega, _) = with_surface_tension(TAU / 4.0 * i.hypot(j), f64::INFINITY);
    let units = (omega / TAU * (1_u64 << 30) as f64).round() as i128;
    let before = coefficient(&sea(0.0), 64, i, j);
    // In quarters of a second.
    for quarters in [4_000_000_001_i128, -4_000_000_000_000, 3_999_999_999_999, 1] {
        let turns = (units * quarters).rem_euclid(1 << 32) as f64 / (1_u64 << 32) as f64;
        let found = coefficient(&sea(quarters as f64 / 4.0), 64, i, j);
        let expected = DVec2::from_angle(-TAU * turns).rotate(before);
        let off = (found - expected).length() / before.length();
        assert!(off < 1e-12, "{quarters}: {off}");
    }
    assert!(sea(0.75) == sea(0.75 + (1_u64 << 30) as f64));
}

#[test]
fn spreadings_turn_with_the_wind() {
    // Mean squared slopes along x and z over 8 seas; the wind along x, then along z.
    let slopes = |spreading: &str, direction: f64| {
        let mut sums = DVec2::ZERO;
        for seed in 0..8 {
            let scene = scene_of(
                json!({ "spreading": spreading, "wind_direction_deg": direction, "seed": seed }),
            );
            let surface = surface_of(&scene);
            for point in 0..1024 {
                let (x, z) = (
                    f64::from(point % 32) * 1.5625,
                    f64::from(point / 32) * 1.5625,
                );
                let slope = surface.at(x, z).slope;
                sums += slope * slope;
            }
        }
        sums
    };
    for (spreading, least) in [("cos2", 2.0), ("donelan_banner", 1.2), ("elfouhaily", 1.2)] {
        let (along_x, along_z) = (slopes(spreading, 0.0), slopes(spreading, 90.0));
        let ratios = [along_x.x / along_x.y, along_z.y / along_z.x];
        assert!(
            ratios.iter().all(|ratio| *ratio > least),
            "{spreading}: {ratios:?}"
        );
    }
}

#[test]
fn the_band_and_the_name_are_reported() {
    let surface = surface_of(&scene_of(json!({ "min_wavelength_m": 5 })));
    assert_eq!(surface.shortest_wave_m(), 5.0);
    assert_eq!(surface.description(), "water with a JONSWAP sea");
    assert!((surface_of(&scene_of(json!({}))).shortest_wave_m() - 3.125).abs() < 1e-12);
    for flat in [
        json!({ "wind_speed_m_s": 0 }),
        json!({ "wind_speed_m_s": 0, "significant_height_m": 2 }),
        json!({ "significant_height_m": 0 }),
        // The band between two waves of the tile.
        json!({ "min_wavelength_m": 36, "max_wavelength_m": 49 }),
        // Waves of 5 … 10 km under a breeze.
        json!({ "wind_speed_m_s": 0.5, "tile_m": 1e4, "min_wavelength_m": 5e3, "model": "pierson_moskowitz", "significant_height_m": 2 }),
    ] {
        let surface = surface_of(&scene_of(flat.clone()));
        assert_eq!(surface.shortest_wave_m(), f64::INFINITY, "{flat}");
        assert_eq!(surface.max_height_m(), 0.0);
        assert_eq!(surface.at(3.0, 4.0).height_m, 0.0);
    }
}

#[test]
fn extreme_seas_are_finite() {
    let models = [
        "phillips",
        "pierson_moskowitz",
        "jonswap",
        "tma",
        "elfouhaily",
    ];
    let spreadings = ["cos2", "hasselmann", "donelan_banner", "elfouhaily"];
    for (case, model) in models.into_iter().enumerate() {
        for (wind, tile_m, time_s, fetch_m) in [
            (0.0, 10.0, 0.0, 1e5),
            (1e-200, 10.0, 0.0, 1e5),
            (60.0, 0.01, 1e9, 1.0),
            (60.0, 1e4, -1e12, 1e7),
            (0.1, 0.01, 1e12, 1e7),
            (0.1, 1e4, 1e-9, 1.0),
        ] {
            for depth_m in [0.0, 1e-3, 11_000.0] {
                for (extra, spreading) in spreadings.into_iter().enumerate() {
                    let fields = json!({
                        "model": model, "wind_speed_m_s": wind, "tile_m": tile_m, "fetch_m": fetch_m, "spreading": spreading,
                        "swell": if extra % 2 == 0 { 1.0 } else { 0.0 }, "gamma": if case % 2 == 0 { 10.0 } else { 1.0 },
                    });
                    let floor = json!({ "time_s": time_s, "floor": { "depth_m": depth_m, "size_m": [1, 1] } });
                    let scene = scene_with(fields.clone(), floor);
                    let surface = surface_of(&scene);
                    let bounds = [
                        surface.max_height_m(),
                        surface.max_slope(),
                        surface.max_third_derivative_per_m2(),
                    ];
                    assert!(
                        bounds.iter().all(|b| b.is_finite()),
                        "{fields} {depth_m}: {bounds:?}"
                    );
                    let heights = heights(&scene, 64);
                    assert!(heights.iter().all(|h| h.is_finite()), "{fields} {depth_m}");
                }
            }
        }
    }
}

/// What a spline misses: of waves of four samples 2.9 % of the mean square slope along an axis, of eight 0.1 %.
#[test]
fn what_the_samples_miss_is_told() {
    let lost = |shortest_m: f64| {
        let scene: Scene = serde_json::from_value(serde_json::json!({
            "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 2 }, {
                "kind": "spectrum", "model": "phillips", "wind_speed_m_s": 3, "tile_m": 16, "samples": 64,
                "min_wavelength_m": shortest_m, "max_wavelength_m": shortest_m * 1.1
            }] }
        }))
        .unwrap();
        surface_of(&scene).slope_lost().collect::<Vec<_>>()
    };
    let [(wave, four)] = lost(1.0)[..] else {
        panic!("one grid")
    };
    assert_eq!(wave, 1);
    assert!((0.01..0.03).contains(&four), "{four}");
    let eight = lost(2.0)[0].1;
    assert!(eight < 0.002, "{eight}");
}

/// Seas as they were when they were first computed, wave by wave: a seed never gets another sea.
#[test]
fn a_seed_keeps_its_sea() {
    let places = [(0.0, 0.0), (12.3, 45.6), (-7.0, 20.1)];
    for (fields, time_s, points) in [
        (
            json!({ "seed": 7 }),
            0.0,
            [
                (
                    0.07826794415020595,
                    -0.10003714163091974,
                    0.005185793382114206,
                ),
                (
                    -0.3123973936043561,
                    -0.04906104867516272,
                    0.1232768457201835,
                ),
                (
                    -0.06492775142515543,
                    0.07053992524836847,
                    -0.008016168084401991,
                ),
            ],
        ),
        (
            json!({ "seed": 4_000_000_000_u32, "spreading": "hasselmann", "wind_direction_deg": 70 }),
            1234.5,
            [
                (
                    -0.24548098359370896,
                    -0.03368194845100653,
                    -0.13666881821024332,
                ),
                (
                    0.026876195397168793,
                    0.10150618336625036,
                    -0.09962459673038816,
                ),
                (
                    -0.3618487028297276,
                    0.12049026694744022,
                    0.09794596554637551,
                ),
            ],
        ),
        (
            json!({ "model": "elfouhaily", "loop_s": 10, "significant_height_m": 0.5, "samples": 128 }),
            // Three eighths of the loop, exactly.
            -3.75,
            [
                (
                    0.0009028089844948174,
                    0.04269406356159345,
                    -0.032567066228126454,
                ),
                (
                    -0.10435397397819467,
                    -0.04616986787249652,
                    -0.006413339465734289,
                ),
                (
                    -0.11836005605393246,
                    -0.025770157943679813,
                    -0.006121558987858702,
                ),
            ],
        ),
    ] {
        let surface = surface_of(&scene_with(fields, json!({ "time_s": time_s })));
        let found = places.map(|(x, z)| surface.at(x, z));
        for (point, (height_m, slope_x, slope_z)) in found.iter().zip(points) {
            let off = (point.slope - DVec2::new(slope_x, slope_z)).length();
            assert!(
                (point.height_m - height_m).abs() < 1e-12 && off < 1e-11,
                "{time_s}: {found:?}"
            );
        }
    }
}

/// What does not depend on time is kept: a sea that was computed at another moment first is the same to the bit.
#[test]
fn a_kept_sea_is_the_same() {
    let mut resolved = ResolvedScene::bare(scene_of(json!({ "spreading": "elfouhaily" })));
    let first = Surface::of(&resolved).unwrap();
    resolved.scene.time_s = 3.7;
    let alone = surface_of(&resolved.scene);
    assert!(Surface::of(&resolved).unwrap() == alone);
    assert!(first != alone);
    // Grids of two moments, and less than 64² pairs of waves.
    let grids = 2 * 64 * 64 * 8;
    assert!((grids + 1..grids + 64 * 64 * 48).contains(&resolved.kept.bytes()));
}
