//! Point lights in views and in maps on meshes, against the reference: above the water, and under it.

use std::sync::Arc;

use caustica::accuracy::metrics::relative_l1;
use caustica::mesh::Mesh;
use caustica::reference::Truth;
use caustica::scene::LayerName;
use serde_json::{Value, json};

use super::harness::{self, Map};
use super::scene_files;
use super::truths::truth_to as truth_of;

/// Water cells, each twice the one before.
const CELLS: [u32; 4] = [8, 16, 32, 64];
/// Pixels of the truth along x and y.
const SIZE: [usize; 2] = [24, 18];
/// Pixels of the renderer for each of those along both: the truth is the mean over a pixel, a picture is what its middle shows.
const FINER: usize = 4;

/// A pool under waves with these lamps.
fn pool(lamps: &[[f64; 3]], cells: u32) -> Value {
    let lamp = |position_m: &[f64; 3]| json!({ "kind": "point", "position_m": position_m, "intensity_w_sr": [3, 2, 1] });
    json!({
        "water": {
            "waves": [
                { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9, "direction_deg": 20 },
                { "kind": "sine", "amplitude_m": 0.008, "wavelength_m": 0.6, "direction_deg": 100, "phase_deg": 60 }
            ],
            "absorption_per_m": [0.3, 0.06, 0.02]
        },
        "floor": { "depth_m": 1.5, "size_m": [8, 8] },
        "lights": lamps.iter().map(lamp).collect::<Vec<_>>(),
        "quality": { "water_cells": cells, "map_texels": 128, "level_map_texels": 64, "split_levels": 3 }
    })
}

/// Mean of each pixel of the truth over those of the renderer.
fn coarse(seen: &[[f64; 3]]) -> Vec<f64> {
    let width = SIZE[0] * FINER;
    let mean = |at: usize, c: usize| {
        let first = (at / SIZE[0]) * FINER * width + (at % SIZE[0]) * FINER;
        let all = (0..FINER * FINER).map(|i| seen[first + i / FINER * width + i % FINER][c]);
        all.sum::<f64>() / (FINER * FINER) as f64
    };
    (0..SIZE[0] * SIZE[1])
        .flat_map(|at| [0, 1, 2].map(|c| mean(at, c)))
        .collect()
}

/// Twice the cells, half of the error or less (a quarter where cells are all there is to it), until what is left is that of the truth.
fn assert_halves(name: &str, errors: [f64; 4], truth: &Truth) {
    for pair in errors.windows(2) {
        let bound = 0.5 * pair[0] + truth.relative_error;
        assert!(pair[1] <= bound, "{name}: {errors:?}");
    }
    // Else there is nothing to halve.
    assert!(errors[0] > 3.0 * truth.relative_error, "{name}: {errors:?}");
}

/// Nothing is left but the truth's own error, and a part as large.
fn assert_meets(name: &str, errors: [f64; 4], truth: &Truth) {
    let bound = 2.0 * truth.relative_error;
    assert!(errors[3] <= bound, "{name}: {errors:?}");
}

#[test]
fn a_view_of_the_floor_under_lamps_nears_the_reference_as_cells_do() {
    let view = |cells: u32, finer: usize| {
        let mut scene = pool(&[[0.3, 0.8, -0.2], [-0.3, -0.4, 0.2]], cells);
        scene["camera"] = json!({ "kind": "orthographic", "position_m": [0, 1, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "height_m": 0.3 });
        scene["output"] = json!({ "kind": "view", "width": SIZE[0] * finer, "height": SIZE[1] * finer, "layers": ["irradiance"], "format": "exr" });
        scene_files::scene(scene)
    };
    let truth = truth_of(&view(CELLS[0], 1), 1e-3);
    let errors = CELLS.map(|cells| {
        let frame = harness::render(&view(cells, FINER));
        let seen = coarse(&harness::layer(&frame, LayerName::Irradiance));
        relative_l1(&seen, truth.irradiance.as_flattened()).unwrap()
    });
    println!("view: {errors:?}; truth {:.1e}", truth.relative_error);
    assert_halves("view", errors, &truth);
    assert_meets("view", errors, &truth);
}

/// Turned about z by 20°.
const TURNED: [f64; 4] = [0.0, 0.0, 0.173_648_177_666_930_33, 0.984_807_753_012_208];
/// Lamps above the water and under it.
const LAMPS: [(&str, [f64; 3]); 2] = [("above", [0.3, 0.8, -0.2]), ("under", [0.4, -0.3, 0.2])];

/// Errors of the map with `texels` on `mesh` against a reference accurate to `error`, over the texels that `wanted` selects from
/// the reference; and the reference.
fn map_errors(
    mesh: &Arc<Mesh>,
    (texels, error): (u32, f64),
    lamp: [f64; 3],
    wanted: &dyn Fn(&Truth, usize) -> bool,
) -> ([f64; 4], Truth) {
    let scene = |cells: u32| {
        let mut scene = pool(&[lamp], cells);
        scene["quality"]["level_map_texels"] = json!(texels);
        scene["objects"] = json!([{ "mesh": mesh.id, "translation_m": [0, -1, 0], "rotation": TURNED, "scale": 0.4 }]);
        scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
        scene_files::with_meshes(scene, std::slice::from_ref(mesh))
    };
    let truth = truth_of(&scene(CELLS[0]), error);
    let pick = |values: &[[f64; 3]]| -> Vec<f64> {
        let texels = (0..values.len()).filter(|&at| wanted(&truth, at));
        texels.flat_map(|at| values[at]).collect()
    };
    let errors = CELLS.map(|cells| {
        let map = Map::from(&scene(cells));
        assert!(map.closure() <= 1e-5, "{:?}", map.stats.energy);
        relative_l1(&pick(&map.texels), &pick(&truth.irradiance)).unwrap()
    });
    (errors, truth)
}

/// Texels at the rim are only partly on the plate, and hold as much of its light.
fn within(truth: &Truth, at: usize) -> bool {
    let width = truth.width as usize;
    let around = [at.wrapping_sub(1), at, at + 1].map(|x| [x.wrapping_sub(width), x, x + width]);
    let mut around = around.into_iter().flatten();
    truth.compared[at]
        && around.all(|near| truth.compared.get(near).is_some_and(|&compared| compared))
}

#[test]
fn a_map_on_a_plate_under_a_lamp_meets_the_reference() {
    let corners = "v -0.5 0 -0.5\nv -0.5 0 0.5\nv 0.5 0 0.5\nv 0.5 0 -0.5\nf 1 2 3 4\n";
    let plate = scene_files::mesh_of(corners.as_bytes());
    for (name, lamp) in LAMPS {
        let (errors, truth) = map_errors(&plate, (32, 4e-3), lamp, &within);
        println!(
            "plate, {name}: {errors:?}; truth {:.1e}",
            truth.relative_error
        );
        assert_halves(name, errors, &truth);
        assert_meets(name, errors, &truth);
    }
}

/// A texel across an edge has one cosine for both faces, however many cells there are: what is left then is of the level map's texels.
#[test]
fn a_map_on_a_box_under_a_lamp_nears_the_reference_as_cells_do() {
    for (name, lamp) in LAMPS {
        let compared = |truth: &Truth, at: usize| truth.compared[at];
        let (errors, truth) =
            map_errors(&scene_files::mesh("box.obj"), (64, 8e-3), lamp, &compared);
        println!(
            "box, {name}: {errors:?}; truth {:.1e}",
            truth.relative_error
        );
        assert_halves(name, errors, &truth);
    }
}
