//! Many instances of a few meshes under water: a scene for tests and for `make bench`.

use serde_json::{Value, json};

/// Cells along each side of the grid that objects stand on.
const CELLS: usize = 15;
/// From one cell to the next, m.
const CELL_M: f64 = 0.4;
/// Meshes and, of each, the rotation of all its instances: instances share their level maps.
const KINDS: [(&str, [f64; 4], f64); 5] = [
    ("box.obj", [0.0, 0.0, 0.0, 1.0], 0.22),
    ("teapot.obj", [0.0, 0.382_683_432, 0.0, 0.923_879_533], 0.3),
    ("torus_knot.obj", [0.0, 0.0, 0.0, 1.0], 0.3),
    ("floor_tiles.obj", [0.0, 0.0, 0.0, 1.0], 0.25),
    ("box.obj", [0.0, 0.258_819_045, 0.0, 0.965_925_826], 0.2),
];

/// A pool of 6 m by 6 m of objects, `count` of them, 1 … 225, scattered over all of it, seen by a camera; `mesh` is a file name.
pub(crate) fn scene(count: usize) -> Value {
    let objects: Vec<Value> = (0..count)
        .map(|i| {
            let (mesh, rotation, scale) = KINDS[i % KINDS.len()];
            // 89 and 225 have no common divisor: every cell comes once, neighbours late.
            let cell = i * 89 % (CELLS * CELLS);
            let place = |k: usize| (k as f64 - (CELLS - 1) as f64 / 2.0) * CELL_M;
            let depth_m = 0.6 + 0.7 * ((i * 37 % 64) as f64 / 64.0);
            json!({ "mesh": mesh, "rotation": rotation, "scale": scale,
                    "translation_m": [place(cell % CELLS), -depth_m, place(cell / CELLS)] })
        })
        .collect();
    json!({
        "water": { "waves": [
            { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.1, "direction_deg": 30 },
            { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.7, "direction_deg": 120, "phase_deg": 60 }
        ] },
        "floor": { "depth_m": 1.6, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 150, "irradiance_w_m2": [1000, 1000, 1000] }],
        "objects": objects,
        "camera": { "position_m": [0, 2.5, 5], "target_m": [0, -1, 0.5], "vertical_fov_deg": 45 },
        "quality": { "water_cells": 384, "map_texels": 512, "level_map_texels": 64, "split_levels": 1 },
        "output": { "kind": "view", "width": 320, "height": 240, "format": "exr", "layers": ["radiance", "irradiance"] }
    })
}

/// In `shared/geometry.wgsl`, what makes rays look at every instance's own bounds instead of walking down the hierarchy over them.
pub(crate) const WITHOUT_HIERARCHY: [&str; 2] = [
    "if !box_met(bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz), origin, inverse, t_max) { return InstanceStep",
    "if (low.w & LEAF) != 0u && !box_met(bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz), origin, inverse, t_max) { return InstanceStep",
];
