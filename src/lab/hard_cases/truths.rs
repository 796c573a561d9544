//! What pictures are compared with: closed forms, the reference, and other pictures.

use std::collections::BTreeMap;

use glam::DVec3;
use serde_json::{Value, json};

use super::bench::Bench;
use super::case::Failure;
use crate::accuracy::metrics;
use crate::physics::refraction::normal_from_slope;
use crate::reference::closed_form::flat_water_irradiance;
use crate::reference::{ReferenceSettings, TruthSettings, irradiance_map, truth};
use crate::scene::{LayerName, Light, ResolvedScene};

/// Reference maps that were computed already, by the hashes of their scenes, so that repeated cases do not compute them again.
#[derive(Debug, Default)]
pub struct Truths(BTreeMap<String, Vec<[f64; 3]>>);

/// Side of the maps, texels.
pub(super) const SIDE: u32 = 32;

/// A floor 2 m deep under a sun of 60°, its map over the middle 2 m × 2 m; no waves.
pub(super) fn pool() -> Value {
    json!({
        "water": { "waves": [] },
        "floor": { "depth_m": 2, "size_m": [40, 40] },
        "lights": [sun(60.0, 30.0)],
        "quality": { "water_cells": 128 },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": SIDE, "height": SIDE }
    })
}

/// A sun of 1 W/m².
pub(super) fn sun(elevation_deg: f64, azimuth_deg: f64) -> Value {
    json!({ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": azimuth_deg, "irradiance_w_m2": [1, 1, 1] })
}

/// Two crossing sines of slope 0.1 … 0.2.
pub(super) fn waves() -> Value {
    json!([
        { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.3, "direction_deg": 20, "phase_deg": 23 },
        { "kind": "sine", "amplitude_m": 0.012, "wavelength_m": 0.8, "direction_deg": 100, "phase_deg": 97 }
    ])
}

/// Height of [`waves`] at local (x, z), m, and their unit normal there.
pub(super) fn waves_at(x_m: f64, z_m: f64) -> (f64, DVec3) {
    let (mut height_m, mut slope_x, mut slope_z) = (0.0, 0.0, 0.0);
    for wave in waves().as_array().into_iter().flatten() {
        let of = |field: &str| wave[field].as_f64().unwrap_or_default();
        let (sin, cos) = of("direction_deg").to_radians().sin_cos();
        let turns = (x_m * cos + z_m * sin) / of("wavelength_m") + of("phase_deg") / 360.0;
        let (rise, run) = (std::f64::consts::TAU * turns).sin_cos();
        height_m += of("amplitude_m") * rise;
        let slope = of("amplitude_m") * std::f64::consts::TAU / of("wavelength_m") * run;
        slope_x += slope * cos;
        slope_z += slope * sin;
    }
    (height_m, normal_from_slope(slope_x, slope_z))
}

/// [`pool`] with other values at some JSON pointers; missing fields are added.
pub(super) fn with(mut scene: Value, changes: &[(&str, Value)]) -> Value {
    for (pointer, value) in changes {
        let mut place = &mut scene;
        for key in pointer.split('/').skip(1) {
            place = match key.parse::<usize>() {
                Ok(index) if place.is_array() => &mut place[index],
                _ => &mut place[key],
            };
        }
        *place = value.clone();
    }
    scene
}

/// Irradiance of all suns together under flat water at the given depth, W/m².
pub(super) fn flat_irradiance(resolved: &ResolvedScene, depth_m: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for light in &resolved.scene.lights {
        if let Light::Sun(sun) = light {
            let one = flat_water_irradiance(&resolved.scene.water, depth_m, sun);
            for (sum, value) in sum.iter_mut().zip(one) {
                *sum += value;
            }
        }
    }
    sum
}

/// Largest relative error of a map under flat water against the closed form, all suns together. Where no light is
/// expected, any light is an error of 1.
pub(super) fn flat_error(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let resolved = bench.scene(scene)?;
    let depth_m = resolved.scene.floor.as_ref().map_or(0.0, |f| f.depth_m);
    let truth = flat_irradiance(&resolved, depth_m);
    let frame = bench.render_resolved(&resolved)?;
    let texels = super::bench::texels(&frame, LayerName::Irradiance);
    Ok(texels
        .iter()
        .flat_map(|texel| texel.iter().zip(truth))
        .map(|(&found, truth)| {
            if truth > 0.0 {
                (found / truth - 1.0).abs()
            } else {
                f64::from(u8::from(found != 0.0))
            }
        })
        .fold(0.0, worst))
}

/// Relative L1 error of a floor map against the reference.
pub(super) fn reference_error(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let resolved = bench.scene(scene)?;
    let hash = resolved.hash();
    if !bench.truths.0.contains_key(&hash) {
        let settings = ReferenceSettings {
            target_error: Some(2e-3),
            max_rays: 40_000_000,
            initial_rays: 1 << 20,
        };
        let truth = irradiance_map(&resolved, &settings, &|_| {})
            .map_err(|error| Failure::Check(format!("no reference: {error}")))?;
        bench.truths.0.insert(hash.clone(), truth.irradiance);
    }
    let frame = bench.render_resolved(&resolved)?;
    let found = super::bench::texels(&frame, LayerName::Irradiance);
    let truth = &bench.truths.0[&hash];
    metrics::relative_l1(found.as_flattened(), truth.as_flattened())
        .map_err(|error| Failure::Check(error.to_string()))
}

/// Relative L1 error of the irradiance in a view against the reference, over the pixels that the reference traces; 1 where any of
/// them shows nothing.
pub(super) fn seen_error(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let resolved = bench.scene(scene)?;
    let settings = TruthSettings {
        target_error: Some(2e-3),
        max_rays: 40_000_000,
        most_points: 200,
        disk: None,
    };
    let truth = truth(&resolved, &settings, &|_| {}, &|| false)
        .map_err(|error| Failure::Check(format!("no reference: {error}")))?;
    let frame = bench.render_resolved(&resolved)?;
    if truth.compared.contains(&false) {
        return Ok(1.0);
    }
    let seen = super::bench::texels(&frame, LayerName::Irradiance);
    let found: Vec<[f64; 3]> = (0..truth.width * truth.height)
        .map(|at| {
            let x = truth.first_pixel[0] + at % truth.width * truth.pixel_step;
            let y = truth.first_pixel[1] + at / truth.width * truth.pixel_step;
            seen[(y * frame.width + x) as usize]
        })
        .collect();
    relative_l1(&found, &truth.irradiance)
}

/// Largest difference of two maps as a share of the mean of the second.
pub(super) fn largest_to_mean(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let (a, b) = (a.as_flattened(), b.as_flattened());
    if a.len() != b.len() || b.is_empty() {
        return f64::INFINITY;
    }
    let mean = b.iter().sum::<f64>() / b.len() as f64;
    a.iter()
        .zip(b)
        .map(|(a, b)| ((a - b) / mean).abs())
        .fold(0.0, worst)
}

/// Largest |a − b| / |b| of two maps; where b is 0, any a is a difference of 1.
pub(super) fn largest_relative(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let (a, b) = (a.as_flattened(), b.as_flattened());
    if a.len() != b.len() || b.is_empty() {
        return f64::INFINITY;
    }
    a.iter()
        .zip(b)
        .map(|(&a, &b)| {
            if b == 0.0 {
                f64::from(u8::from(a != 0.0))
            } else {
                ((a - b) / b).abs()
            }
        })
        .fold(0.0, worst)
}

/// Σ|a − b| / Σ|b|.
pub(super) fn relative_l1(a: &[[f64; 3]], b: &[[f64; 3]]) -> Result<f64, Failure> {
    metrics::relative_l1(a.as_flattened(), b.as_flattened())
        .map_err(|error| Failure::Check(error.to_string()))
}

/// `f64::max`, but NaN becomes infinity instead of getting lost.
pub(super) fn worst(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}
