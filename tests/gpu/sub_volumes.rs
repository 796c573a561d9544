//! Sub-volumes: against a plain program in float64, against caustic volumes, which interpolate nothing, and in closed form.

use caustica::accuracy::{convergence_order, metrics};
use caustica::config::RenderConfig;
use caustica::mesh::Mesh;
use caustica::methods::sub_volume::{
    FACE, FLAT_WATER, FLUX_RATIO, INTENSITY, METHOD, OFF, SAMPLE_PLANES, SHADE, SHADOWS,
};
use caustica::methods::{self, caustic_volume};
use caustica::reference::closed_form::{SineUnderZenith, flat_water_irradiance};
use caustica::render::Renderer;
use caustica::scene::{LayerName, Light, MethodChoice, ResolvedScene};
use caustica::stages::points::Point;
use serde_json::{Value, json};
use std::sync::Arc;
use tokio_util::sync::CancellationToken;

use super::harness::{self, Map, nan_fails};
use super::plain_sub_volumes::{self, Dials};
use super::plain_volumes::Lit;
use super::scene_files;

const OURS: Dials = Dials {
    planes: 20,
    has_faces: false,
    is_scaled: true,
};
const PAPER: Dials = Dials {
    has_faces: true,
    is_scaled: false,
    ..OURS
};
/// Every combination of shade and intensity.
const ALL: [Dials; 4] = [
    OURS,
    Dials {
        has_faces: true,
        ..OURS
    },
    Dials {
        is_scaled: false,
        ..OURS
    },
    PAPER,
];

/// A plate, as the text of an OBJ file.
const PLATE: &str = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n";

fn choice(dials: Dials, shadows: &str) -> MethodChoice {
    let mut choice = MethodChoice::named(METHOD.name)
        .with(&SAMPLE_PLANES, dials.planes)
        .with(&SHADOWS, shadows);
    if dials.has_faces {
        choice = choice.with(&SHADE, FACE);
    }
    if !dials.is_scaled {
        choice = choice.with(&INTENSITY, FLUX_RATIO);
    }
    choice
}

/// A scene with a choice of method, and with `meshes` beside those in files.
fn with(mut scene: Value, choice: &MethodChoice, meshes: &[Arc<Mesh>]) -> ResolvedScene {
    scene["quality"]["method"] = json!(choice);
    if meshes.is_empty() {
        return scene_files::scene(scene);
    }
    scene_files::with_meshes(scene, meshes)
}

fn points_of(resolved: &ResolvedScene) -> Vec<Point> {
    let points = harness::renderer().points(resolved, &CancellationToken::new());
    points.unwrap_or_else(|error| panic!("{error}"))
}

/// A pool with a box.
fn pool(lights: Value, output: Value) -> Value {
    json!({
        "water": {
            "waves": [
                { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "direction_deg": 20 },
                { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.5, "direction_deg": 110, "phase_deg": 50 }
            ],
            "absorption_per_m": [0.3, 0.1, 0.05]
        },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": lights,
        "objects": [{ "mesh": "box.obj", "translation_m": [0.1, -1.2, 0.2], "scale": 0.5,
                      "rotation": [0.2052, 0.3078, 0.1026, 0.9234] }],
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1.2, 0], "vertical_fov_deg": 18 },
        "quality": { "water_cells": 97, "level_map_texels": 64 },
        "output": output
    })
}

fn sun() -> Value {
    json!([{ "kind": "sun", "elevation_deg": 55, "azimuth_deg": 30, "irradiance_w_m2": [1000, 900, 800] }])
}

fn view() -> Value {
    json!({ "kind": "view", "width": 96, "height": 72, "layers": ["irradiance"], "format": "exr" })
}

/// How far a frame is from the plain program: relative L1 difference, and the share of values that are off by more than a thousandth.
fn difference(found: &[[f64; 3]], plain: &[Lit]) -> (f64, f64) {
    assert_eq!(found.len(), plain.len());
    let (mut off, mut sum, mut many) = (0.0, 0.0, 0);
    for (found, plain) in found.iter().zip(plain) {
        let mut is_off = false;
        for (found, due) in found.iter().zip(plain.irradiance) {
            off += (found - due).abs();
            sum += due;
            is_off |= (found - due).abs() > 1e-3 * due;
        }
        many += u32::from(is_off);
    }
    assert!(sum > 0.0);
    (off / sum, f64::from(many) / found.len() as f64)
}

/// The irradiance of a frame at points under water; dry places are lit by the lights in the air.
fn at_points(renderer: &mut Renderer, resolved: &ResolvedScene, points: &[Point]) -> Vec<[f64; 3]> {
    let frame = harness::render_with(renderer, resolved);
    let mut found = harness::layer(&frame, LayerName::Irradiance);
    for (found, point) in found.iter_mut().zip(points) {
        if point.receiver < 0.0 {
            *found = [0.0; 3];
        }
    }
    found
}

/// Every kind of output and light, and every combination of the dials: the pixels are those of the plain program, up to the rounding of f32.
/// Where a point lies within that rounding of a volume's side, or where a triangle is as small as it, they differ.
#[test]
fn points_have_the_light_of_the_plain_program() {
    let lamp = json!([{ "kind": "point", "position_m": [0.4, 1.1, -0.3], "intensity_w_sr": [100, 90, 80] }]);
    let on_floor =
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 96, "height": 64 });
    let on_box = json!({ "kind": "irradiance_map", "receiver": 0 });
    let mut under_water = pool(sun(), view());
    under_water["camera"] = json!({ "position_m": [-1.2, -0.9, 1.4], "target_m": [0.1, -1.15, 0.2], "vertical_fov_deg": 40 });
    let mut parallel = pool(sun(), view());
    parallel["camera"] = json!({ "kind": "orthographic", "height_m": 1.2, "position_m": [0, 2, 2], "target_m": [0, -1.2, 0] });
    let mut steep = pool(sun(), view());
    steep["water"]["waves"][0]["amplitude_m"] = json!(0.09);
    let cases = [
        ("floor", pool(sun(), on_floor)),
        ("box", pool(sun(), on_box)),
        ("view", pool(sun(), view())),
        ("parallel view", parallel),
        ("under water", under_water),
        ("steep waves", steep),
        ("lamp, view", pool(lamp, view())),
    ];
    for (name, scene) in cases {
        for dials in ALL {
            let resolved = with(scene.clone(), &choice(dials, OFF), &[]);
            let points = points_of(&resolved);
            let plain = plain_sub_volumes::irradiance(&resolved, &points, dials);
            let found = at_points(&mut harness::renderer(), &resolved, &points);
            let (l1, many) = difference(&found, &plain);
            let lit = plain.iter().filter(|lit| lit.volumes > 0).count();
            let on_objects = points.iter().filter(|point| point.receiver > 0.0).count();
            println!(
                "{name}, {dials:?}: L1 {l1:.1e}, off {:.2} %, {lit} lit, {on_objects} on objects",
                100.0 * many
            );
            assert!(lit > 1000, "{name}: {lit}");
            assert!(name == "floor" || on_objects > 500, "{name}: {on_objects}");
            // The flux ratio next to a focus is as large as its triangle is small, and so is its rounding error.
            let most = if dials.is_scaled { 2e-4 } else { 1e-3 };
            assert!(l1 <= most, "{name}, {dials:?}: {l1:e}");
            assert!(many <= 4e-3, "{name}, {dials:?}: {many}");
        }
    }
}

/// A ramp from 0.5 m to 1.9 m of depth, 1.6 m wide, which lies between many planes.
fn ramp() -> Arc<Mesh> {
    scene_files::mesh_of(
        b"v -0.8 -0.5 -0.8\nv 0.8 -1.9 -0.8\nv 0.8 -1.9 0.8\nv -0.8 -0.5 0.8\nf 1 4 3 2\n",
    )
}

/// A horizontal plate of two by two waves, at the level of the water.
fn plate() -> Arc<Mesh> {
    scene_files::mesh_of(PLATE.as_bytes())
}

/// The ramp or the plate under a sine, which has a closed form.
fn ramp_under(mesh: &Mesh, amplitude_m: f64) -> Value {
    json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": amplitude_m, "wavelength_m": 1.0, "direction_deg": 0, "phase_deg": 90 }],
            "absorption_per_m": [0.1, 0.2, 0.4], "ior": 1.333
        },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": mesh.id }],
        "quality": { "water_cells": 256, "level_map_texels": 128 },
        "output": { "kind": "irradiance_map", "receiver": 0 }
    })
}

/// The wrong sign or factor in a shader is seen in the comparison with the plain program.
#[test]
fn the_comparison_rejects_planted_errors() {
    let file = "methods/sub_volume/point_in_sub_volume.wgsl";
    let plants = [
        ("vec2f(number, number + 1.0)", "vec2f(number, number + 1.1)"),
        (
            "0.5 * (cross2(upper_b, lower_c)",
            "0.45 * (cross2(upper_b, lower_c)",
        ),
        (
            "vec2f(1.0 - place.share, place.share)",
            "vec2f(place.share, 1.0 - place.share)",
        ),
        ("abs(shares.zx)", "abs(shares.xz)"),
        ("-(to_eye.xz + volume", "-(to_eye.xz - volume"),
        ("to_eye.y > 0.0", "to_eye.y < 0.0"),
        ("entering * densities", "densities"),
    ];
    let mesh = ramp();
    let mut scene = ramp_under(&mesh, 0.05);
    scene["lights"] = sun();
    scene["quality"]["water_cells"] = json!(64);
    let dials = Dials {
        planes: 6,
        has_faces: true,
        ..OURS
    };
    let resolved = with(scene, &choice(dials, OFF), &[mesh]);
    let points = points_of(&resolved);
    let plain = plain_sub_volumes::irradiance(&resolved, &points, dials);
    let found = at_points(&mut harness::renderer(), &resolved, &points);
    let (l1, many) = difference(&found, &plain);
    assert!(l1 < 2e-4 && many < 4e-3, "{l1:e} {many}");
    for (from, to) in plants {
        let sources = methods::embedded().with_replacement(file, from, to);
        let sources = sources.unwrap_or_else(|| panic!("{file} no longer says `{from}`"));
        let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources).unwrap();
        let found = at_points(&mut renderer, &resolved, &points);
        let (l1, many) = difference(&found, &plain);
        println!("{to}: L1 {l1:.1e}, off {:.1} %", 100.0 * many);
        assert!(l1 > 1e-3 && many > 0.1, "{to}: {l1:e} {many}");
    }
}

/// The error of the interpolation, against caustic volumes of the same rays, falls with the planes where the light does not fold: as the
/// square of their distance at the point, as their distance on the front face.
#[test]
fn the_error_falls_with_the_planes() {
    let mesh = ramp();
    let meshes = [Arc::clone(&mesh)];
    let scene = ramp_under(&mesh, 0.02);
    let exact = Map::from(&with(
        scene.clone(),
        &MethodChoice::named(caustic_volume::METHOD.name),
        &meshes,
    ));
    for dials in ALL {
        // With few planes the way to the front face ends at a side of the volume instead.
        let counts = if dials.has_faces {
            [16, 32, 64, 128, 256]
        } else {
            [4, 8, 16, 32, 64]
        };
        let errors = counts.map(|planes| {
            let choice = choice(Dials { planes, ..dials }, "on");
            let map = Map::from(&with(scene.clone(), &choice, &meshes));
            let error = metrics::relative_l1(map.values(), exact.values()).unwrap();
            (f64::from(planes), error)
        });
        let order = convergence_order(&errors);
        println!("{dials:?}: {errors:?}, order {order:.2}");
        let due = if dials.has_faces { 1.0 } else { 2.0 };
        assert!((order - due).abs() <= 0.15, "{dials:?}: {order}");
    }
}

/// The error at points against the closed form falls with the cells, as their size: on the floor, and with many planes on a plate.
#[test]
fn the_error_falls_with_the_cells() {
    let plate = plate();
    let closed = |depth_m: f64| SineUnderZenith {
        amplitude_m: 0.02,
        wavelength_m: 1.0,
        phase_rad: std::f64::consts::FRAC_PI_2,
        ior: 1.333,
        depth_m,
        extinction_per_m: 0.1,
    };
    for depth_m in [2.0, 1.37] {
        let errors = [32, 64, 128, 256].map(|cells| {
            let mut scene = ramp_under(&plate, 0.02);
            scene["quality"]["water_cells"] = json!(cells);
            scene["objects"][0]["translation_m"] = json!([0, -depth_m, 0]);
            if depth_m == 2.0 {
                scene["objects"] = json!([]);
                scene["output"] = json!({ "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 32 });
            }
            let dials = Dials {
                planes: 256,
                ..OURS
            };
            let resolved = with(scene, &choice(dials, "on"), &[Arc::clone(&plate)]);
            let points = points_of(&resolved);
            let map = Map::from(&resolved);
            let texels = map.texels.iter().zip(&points);
            let lit = texels.filter(|(_, point)| point.receiver >= 0.0);
            let (found, due): (Vec<f64>, Vec<f64>) = lit
                .map(|(texel, point)| {
                    let x_m = f64::from(point.position_m[0]);
                    (texel[0], closed(depth_m).irradiance_at(x_m))
                })
                .unzip();
            assert!(found.len() > 1000, "{}", found.len());
            (
                f64::from(cells),
                metrics::relative_l1(&found, &due).unwrap(),
            )
        });
        let order = convergence_order(&errors);
        println!("{depth_m} m: {errors:?}, order {order:.2}");
        assert!(order >= 0.9, "{depth_m}: {order}");
    }
}

#[test]
fn the_floor_does_not_depend_on_the_planes() {
    let on_floor =
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 48, "height": 48 });
    let maps = [(2, OURS), (256, OURS), (7, PAPER)].map(|(planes, dials)| {
        let choice = choice(Dials { planes, ..dials }, "on");
        Map::from(&with(pool(sun(), on_floor.clone()), &choice, &[]))
    });
    assert_eq!(maps[0].texels, maps[1].texels);
    // The flux ratio and the scaled one are rounded differently.
    let off = metrics::relative_l1(maps[2].values(), maps[0].values()).unwrap();
    assert!(off <= 1e-6, "{off:e}");
}

/// Flat water: mean and every texel are right, on the floor and on a plate between planes.
#[test]
fn flat_water_is_even() {
    let mesh = plate();
    let meshes = [Arc::clone(&mesh)];
    for elevation_deg in [60.0, 20.0] {
        for (dials, depth_m) in ALL.into_iter().flat_map(|d| [(d, 2.0), (d, 0.93)]) {
            let mut scene = json!({
                "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
                "floor": { "depth_m": 2, "size_m": [8, 8] },
                "lights": [{ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": 30, "irradiance_w_m2": [1000, 800, 600] }],
                "quality": { "water_cells": 256, "level_map_texels": 64 },
                "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 128, "height": 128 }
            });
            let is_plate = depth_m < 2.0;
            if is_plate {
                scene["objects"] = json!([{ "mesh": mesh.id, "translation_m": [0, -depth_m, 0] }]);
                scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
            }
            let resolved = with(scene, &choice(dials, "on"), &meshes);
            let Light::Sun(sun) = &resolved.scene.lights[0] else {
                panic!("a sun");
            };
            let due = flat_water_irradiance(&resolved.scene.water, depth_m, sun);
            let map = Map::from(&resolved);
            // A level map is larger than its mesh.
            let lit: Vec<&[f64; 3]> = map.texels.iter().filter(|t| t[0] > 0.0).collect();
            let off = |values: &[f64; 3]| harness::largest_relative(values, &due);
            let worst = lit.iter().map(|texel| off(texel)).fold(0.0, nan_fails);
            let mean: [f64; 3] =
                std::array::from_fn(|c| lit.iter().map(|t| t[c]).sum::<f64>() / lit.len() as f64);
            let mean = off(&mean);
            println!(
                "{elevation_deg}°, {depth_m} m, {dials:?}: {} texels, mean off by {mean:.1e}, worst by {worst:.1e}",
                lit.len()
            );
            assert!(lit.len() > 1000, "{}", lit.len());
            // The front face lies nearer to the water, by up to a sub-volume, which absorbs 4 % of the red light at a low sun.
            let most = if is_plate && dials.has_faces {
                5e-2
            } else {
                1e-3
            };
            assert!(mean <= most && worst <= most, "{mean:e} {worst:e}");
        }
    }
}

/// Over the depths of a sub-volume, plates get the light that falls on them in the mean, also where light folds; with the flux ratio they get
/// more.
#[test]
fn scaled_intensities_keep_the_flux_where_light_folds() {
    const DEPTHS: u32 = 32;
    const WIDTH: u32 = 2048;
    let plate = plate();
    let planes = 5;
    // What the shader takes as the range of depths: from the crests to the floor, with a thousandth of room.
    let (crest_m, floor_m) = (0.15, 2.0);
    let room_m = (floor_m + crest_m) * 1e-3 + 1e-6;
    let gap_m = (floor_m + crest_m + 2.0 * room_m) / f64::from(planes);
    // The first focus is 0.6 m deep, in the third sub-volume.
    for number in [1, 2] {
        let mut sums = [0.0; 3];
        for k in 0..DEPTHS {
            let down = (f64::from(k) + 0.5) / f64::from(DEPTHS);
            let depth_m = -crest_m - room_m + (f64::from(number) + down) * gap_m;
            let mut scene = ramp_under(&plate, crest_m);
            scene["water"]["absorption_per_m"] = json!([0, 0, 0]);
            scene["objects"][0]["translation_m"] = json!([0, -depth_m, 0]);
            // A line across two waves, from just above the plate: light has bright edges that take many points.
            scene["output"] = json!({ "kind": "view", "width": WIDTH, "height": 2, "layers": ["irradiance"], "format": "exr" });
            scene["camera"] = json!({ "kind": "orthographic", "position_m": [0, 0.02 - depth_m, 0], "target_m": [0, -depth_m, 0],
                                      "up": [0, 0, -1], "height_m": 2.0 * 2.0 / f64::from(WIDTH) });
            let of = |choice: &MethodChoice| {
                let resolved = with(scene.clone(), choice, &[Arc::clone(&plate)]);
                let lit = harness::layer(&harness::render(&resolved), LayerName::Irradiance);
                lit.iter().map(|lit| lit[0]).sum::<f64>()
            };
            sums[0] += of(&MethodChoice::named(caustic_volume::METHOD.name));
            let ratio = Dials {
                is_scaled: false,
                ..OURS
            };
            for (sum, dials) in sums[1..].iter_mut().zip([OURS, ratio]) {
                *sum += of(&choice(Dials { planes, ..dials }, "on"));
            }
        }
        let [scaled, ratio] = [sums[1], sums[2]].map(|sum| sum / sums[0] - 1.0);
        println!("sub-volume {number}: scaled {scaled:+.2e}, flux ratio {ratio:+.2e}");
        assert!(scaled.abs() < 1e-2, "{number}: {scaled}");
        assert!(ratio > 2e-2, "{number}: {ratio}");
    }
}

/// Triangles without area on a plane or between planes, in every combination of the dials: all finite.
#[test]
fn foci_are_finite() {
    for name in ["a_point_focus_on_the_floor", "a_line_focus_on_the_floor"] {
        let case = caustica::lab::hard_cases::find(name).unwrap();
        let mut scene = caustica::lab::hard_cases::scene(case).unwrap();
        // A plate just above the focus; the floor lies deeper, so that the plate is between planes.
        let focus_m = scene["floor"]["depth_m"].as_f64().unwrap();
        scene["floor"]["depth_m"] = json!(1.7 * focus_m);
        scene["objects"] =
            json!([{ "mesh": PLATE, "translation_m": [0, -0.99 * focus_m, 0], "scale": 0.3 }]);
        scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
        for dials in ALL {
            for planes in [2, 20, 256] {
                scene["quality"]["method"] = json!(choice(Dials { planes, ..dials }, OFF));
                let resolved = caustica::lab::hard_cases::resolved(scene.clone()).unwrap();
                let map = Map::from(&resolved);
                let most = map.values().iter().copied().fold(0.0, nan_fails);
                println!("{name}, {dials:?}, {planes} planes: at most {most:.1e} W/m²");
                assert!(most > 0.0 && most.is_finite(), "{name}, {dials:?}");
            }
        }
    }
}

/// A box over the floor, seen on the floor.
fn box_over_floor(waves: Value) -> Value {
    json!({
        "water": { "waves": waves },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 50, "azimuth_deg": 30, "irradiance_w_m2": [1000, 800, 600] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4, "rotation": [0, 0.2588, 0, 0.9659] }],
        "quality": { "water_cells": 128, "level_map_texels": 256 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 200, "height": 200 }
    })
}

/// Under flat water the shadow maps give the shadows of rays, up to a texel of a shadow map at their edges; under waves they stay where they
/// are, and those of rays do not.
#[test]
fn shadows_under_flat_water_are_those_of_rays_and_under_waves_are_not() {
    let waves =
        json!([{ "kind": "sine", "amplitude_m": 0.04, "wavelength_m": 0.8, "direction_deg": 40 }]);
    let dark = |waves: &Value, shadows: &str| -> Vec<bool> {
        let choice = choice(OURS, shadows);
        let map = Map::from(&with(box_over_floor(waves.clone()), &choice, &[]));
        // A frame whose shadows are elsewhere says so, with the light that the box blocks.
        let mut warnings = map.stats.warnings.iter();
        let warning = warnings.find(|w| w.code == "shadows_ignore_waves");
        let is_due = shadows == FLAT_WATER && *waves != json!([]);
        assert_eq!(warning.is_some(), is_due, "{shadows}");
        if let Some(warning) = warning {
            let flux_w = warning.flux_w.unwrap();
            assert!(flux_w[0] > 100.0 && flux_w[0] < 400.0, "{flux_w:?}");
        }
        map.texels.iter().map(|texel| texel[0] == 0.0).collect()
    };
    let unlike = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|(a, b)| a != b).count();
    let none = json!([]);
    let [flat_rays, flat_maps] = ["on", FLAT_WATER].map(|shadows| dark(&none, shadows));
    let [wave_rays, wave_maps] = ["on", FLAT_WATER].map(|shadows| dark(&waves, shadows));
    let all = flat_rays.iter().filter(|dark| **dark).count();
    let (at_edge, moved) = (
        unlike(&flat_rays, &flat_maps),
        unlike(&wave_rays, &wave_maps),
    );
    println!("{all} dark texels, {at_edge} unlike under flat water, {moved} under waves");
    // The shadow's edge is about 240 texels long, and a texel of a shadow map is a fifth of one of the floor's.
    assert!(all > 2000, "{all}");
    assert!(at_edge < 100, "{at_edge}");
    assert!(moved > 500, "{moved}");
    // The waves do not move the shadow of flat water, but where they leave the floor dark.
    assert!(unlike(&flat_maps, &wave_maps) < at_edge + 50);
    // On the box itself: its sides away from the sun are dark, its top has no spots.
    let mut scene = box_over_floor(none);
    scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
    let [rays, maps] = ["on", FLAT_WATER]
        .map(|shadows| Map::from(&with(scene.clone(), &choice(OURS, shadows), &[])));
    let off = metrics::relative_l1(maps.values(), rays.values()).unwrap();
    println!("on the box: {off:.1e}");
    assert!(off < 1e-2, "{off:e}");
}

#[test]
fn planted_errors_in_shadow_maps_are_seen() {
    let file = "methods/sub_volume/flat_water_shadows.wgsl";
    let resolved = with(box_over_floor(json!([])), &choice(OURS, FLAT_WATER), &[]);
    let rays = Map::from(&with(box_over_floor(json!([])), &choice(OURS, "on"), &[]));
    for (from, to) in [
        ("< q.z { return true; }", "> q.z { return true; }"),
        (
            "select(0u, 1u, is_hidden(point))",
            "select(1u, 0u, is_hidden(point))",
        ),
        ("vec2i(floor(q.xy))", "vec2i(floor(q.yx))"),
    ] {
        let sources = methods::embedded().with_replacement(file, from, to);
        let sources = sources.unwrap_or_else(|| panic!("{file} no longer says `{from}`"));
        let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources).unwrap();
        let map = Map::with(&mut renderer, &resolved);
        let unlike = map.texels.iter().zip(&rays.texels);
        let unlike = unlike
            .filter(|(a, b)| (a[0] == 0.0) != (b[0] == 0.0))
            .count();
        println!("{to}: {unlike}");
        assert!(unlike > 300, "{to}: {unlike}");
    }
}

#[test]
fn lights_that_do_not_fit_are_refused_with_the_reason() {
    let lamp = |y: f64| json!([{ "kind": "point", "position_m": [0.4, y, -0.3], "intensity_w_sr": [1, 1, 1] }]);
    for (lights, shadows, reason) in [
        (lamp(-0.5), "on", "light 0 is under it"),
        (lamp(1.0), FLAT_WATER, "light 0 is a point light"),
    ] {
        let resolved = with(pool(lights, view()), &choice(OURS, shadows), &[]);
        let error = harness::try_render(&mut harness::renderer(), &resolved).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(reason), "{text}");
    }
}
