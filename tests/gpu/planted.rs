//! Wrong signs planted in shaders: the comparison with the float64 reference must detect each. (Those planted in the reference
//! itself are for `make mutants`, which changes the Rust sources.)

use std::sync::OnceLock;

use caustica::accuracy::metrics::relative_l1;
use caustica::config::RenderConfig;
use caustica::methods;
use caustica::reference::{ReferenceSettings, irradiance_map};
use caustica::render::Renderer;
use serde_json::json;

use super::harness::Map;
use super::scene_files;

/// A box under waves and absorption, small: everything that carries light has a part in it.
fn scene() -> caustica::scene::ResolvedScene {
    scene_files::scene(json!({
        "water": {
            "waves": [
                { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.2, "direction_deg": 25 },
                { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.7, "direction_deg": 110, "phase_deg": 70 }
            ],
            "absorption_per_m": [0.3, 0.1, 0.05]
        },
        "floor": { "depth_m": 1.5, "size_m": [6, 6] },
        "lights": [{ "kind": "sun", "elevation_deg": 55, "azimuth_deg": 40, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0.1, -0.8, 0], "scale": 0.4 }],
        "quality": { "water_cells": 128, "level_map_texels": 128, "split_levels": 3 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-0.8, -0.8], "max_m": [0.8, 0.8], "width": 96, "height": 96 }
    }))
}

/// Relative L1 error of the scene with these shaders.
fn error(sources: caustica::gpu::shader::ShaderSources) -> f64 {
    static TRUTH: OnceLock<Vec<[f64; 3]>> = OnceLock::new();
    let scene = scene();
    let truth = TRUTH.get_or_init(|| {
        let settings = ReferenceSettings {
            target_error: Some(4e-3),
            ..ReferenceSettings::default()
        };
        irradiance_map(&scene, &settings, &|_| {})
            .unwrap()
            .irradiance
    });
    let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources).unwrap();
    let map = Map::with(&mut renderer, &scene);
    relative_l1(map.values(), truth.as_flattened()).unwrap()
}

#[test]
fn the_shaders_as_they_are_pass() {
    let error = error(methods::embedded());
    println!("as it is: {error:.2e}");
    assert!(error < 1.2e-2, "{error}");
}

#[test]
fn a_wrong_sign_in_any_of_them_is_caught() {
    let plants = [
        (
            "lib/refraction.wgsl",
            "vec3f(-slope_x, 1.0, -slope_z)",
            "vec3f(slope_x, 1.0, -slope_z)",
        ),
        (
            "lib/refraction.wgsl",
            "(cos_i - sqrt(square))",
            "(cos_i + sqrt(square))",
        ),
        (
            "lib/attenuation.wgsl",
            "exp(-c_per_m * length_m)",
            "exp(c_per_m * length_m)",
        ),
        (
            "lib/attenuation.wgsl",
            "exp(-c_per_m * length_m)",
            "exp(-0.5 * c_per_m * length_m)",
        ),
        ("shared/water_surface.wgsl", "+ w.w)", "- w.w)"),
    ];
    for (file, from, to) in plants {
        let planted = methods::embedded().with_replacement(file, from, to);
        let planted = planted.unwrap_or_else(|| panic!("{file} no longer says `{from}`"));
        let error = error(planted);
        println!("{file}: {error:.2e}");
        assert!(error > 3e-2, "{file} with `{to}`: {error}");
    }
}
