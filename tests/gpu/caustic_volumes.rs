//! Caustic volumes: against a plain program in float64, against the truth, and in closed form.

use caustica::accuracy::{convergence_order, metrics};
use caustica::gpu::{BindGroups, Binding, Kernel, readback};
use caustica::methods::caustic_volume::{DENSITY, LINEAR, METHOD, OFF, SHADOWS};
use caustica::reference::closed_form::{SineUnderZenith, flat_water_irradiance};
use caustica::scene::{LayerName, Light, MethodChoice, ResolvedScene};
use caustica::stages::points::Point;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::harness::{self, Map, nan_fails};
use super::plain_volumes::{self, Density, Lit};
use super::{scene_files, sine_pool, truths};

const DENSITIES: [Density; 2] = [Density::Constant, Density::Linear];

fn choice(density: Density) -> MethodChoice {
    let choice = MethodChoice::named(METHOD.name);
    match density {
        Density::Constant => choice,
        Density::Linear => choice.with(&DENSITY, LINEAR),
    }
}

/// A scene with caustic volumes.
fn with(mut scene: Value, density: Density, has_shadows: bool) -> ResolvedScene {
    let mut choice = choice(density);
    if !has_shadows {
        choice = choice.with(&SHADOWS, OFF);
    }
    scene["quality"]["method"] = json!(choice);
    scene_files::scene(scene)
}

fn points_of(resolved: &ResolvedScene) -> Vec<Point> {
    let points = harness::renderer().points(resolved, &CancellationToken::new());
    points.unwrap_or_else(|error| panic!("{error}"))
}

/// A pool with a box, and what the lights are.
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
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1.2, 0] },
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

/// Every kind of output and light: the pixels are those of the plain program, up to the rounding of f32. Where a point lies within that
/// rounding of a volume's side, or where a cut is as small as it, they differ.
#[test]
fn points_have_the_light_of_the_plain_program() {
    let two = json!([
        { "kind": "sun", "elevation_deg": 55, "azimuth_deg": 30, "irradiance_w_m2": [1000, 900, 800] },
        { "kind": "sun", "elevation_deg": 25, "azimuth_deg": 200, "irradiance_w_m2": [300, 400, 500] }
    ]);
    let lamp = json!([{ "kind": "point", "position_m": [0.4, 1.1, -0.3], "intensity_w_sr": [100, 90, 80] }]);
    let on_floor =
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 96, "height": 64 });
    let on_box = json!({ "kind": "irradiance_map", "receiver": 0 });
    let mut under_water = pool(sun(), view());
    under_water["camera"] = json!({ "position_m": [-1.2, -0.9, 1.4], "target_m": [0.1, -1.0, 0.2], "vertical_fov_deg": 75 });
    let mut steep = pool(sun(), view());
    steep["water"]["waves"][0]["amplitude_m"] = json!(0.09);
    let cases = [
        ("floor", pool(sun(), on_floor.clone())),
        ("box", pool(sun(), on_box)),
        ("view", pool(sun(), view())),
        ("under water", under_water),
        ("steep waves", steep),
        ("two suns", pool(two, view())),
        ("lamp, floor", pool(lamp.clone(), on_floor)),
        ("lamp, view", pool(lamp, view())),
    ];
    for (name, scene) in cases {
        for density in DENSITIES {
            let resolved = with(scene.clone(), density, false);
            let points = points_of(&resolved);
            let plain = plain_volumes::irradiance(&resolved, &points, density);
            let frame = harness::render(&resolved);
            let mut found = harness::layer(&frame, LayerName::Irradiance);
            // Dry places are lit by the lights in the air.
            for (found, point) in found.iter_mut().zip(&points) {
                if point.receiver < 0.0 {
                    *found = [0.0; 3];
                }
            }
            let (l1, many) = difference(&found, &plain);
            let lit = plain.iter().filter(|lit| lit.volumes > 0).count();
            let folded = plain.iter().filter(|lit| lit.volumes > 2).count();
            println!(
                "{name}, {density:?}: L1 {l1:.1e}, off {:.2} %, {lit} lit, {folded} in folds",
                100.0 * many
            );
            assert!(lit > 1000, "{name}: {lit}");
            assert!(l1 <= 1e-4, "{name}, {density:?}: {l1:e}");
            assert!(many <= 2e-3, "{name}, {density:?}: {many}");
        }
    }
}

#[test]
fn the_comparison_rejects_wrong_light() {
    let resolved = with(
        pool(
            sun(),
            json!({ "kind": "irradiance_map", "receiver": "floor", "width": 96, "height": 64 }),
        ),
        Density::Constant,
        false,
    );
    let points = points_of(&resolved);
    let plain = plain_volumes::irradiance(&resolved, &points, Density::Constant);
    let other = plain_volumes::irradiance(&resolved, &points, Density::Linear);
    let of = |lit: &[Lit]| -> Vec<[f64; 3]> { lit.iter().map(|lit| lit.irradiance).collect() };
    assert_eq!(difference(&of(&plain), &plain), (0.0, 0.0));
    let mut brighter = of(&plain);
    brighter.iter_mut().flatten().for_each(|v| *v *= 1.003);
    for wrong in [brighter, of(&other)] {
        let (l1, many) = difference(&wrong, &plain);
        assert!(l1 > 2e-3 && many > 0.5, "{l1:e} {many}");
    }
}

/// The error against the truth is that of the method, not of its implementation. It does not go to 0: the truth is the mean over a texel, and
/// the method looks at one point in it.
#[test]
fn the_error_is_that_of_the_plain_program() {
    let truth = sine_pool::truth();
    for density in DENSITIES {
        for cells in [64, 128, 256] {
            let text = cells.to_string();
            let mut resolved =
                scene_files::load("sine_pool", &[("/quality/water_cells", text.as_str())]);
            resolved.scene.quality.method = choice(density);
            let error = |values: &[f64]| {
                metrics::relative_l1(values, truth.irradiance.as_flattened()).unwrap()
            };
            let own = error(Map::from(&resolved).values());
            let points = points_of(&resolved);
            let plain = plain_volumes::irradiance(&resolved, &points, density);
            let plain: Vec<f64> = plain.iter().flat_map(|lit| lit.irradiance).collect();
            let plain = error(&plain);
            println!("{density:?}, {cells} cells: {own:.4e}, plain program {plain:.4e}");
            assert!(own <= 1.2 * plain && own >= plain / 1.2, "{own} {plain}");
        }
    }
}

/// Where the light does not fold, the light at a point comes nearer to the closed form with the cells: as the cell's size with a constant
/// density, as its square with a linear one.
#[test]
fn the_error_at_points_falls_with_the_cells() {
    let closed = SineUnderZenith {
        amplitude_m: 0.02,
        wavelength_m: 1.0,
        phase_rad: std::f64::consts::FRAC_PI_2,
        ior: 1.333,
        depth_m: 2.0,
        extinction_per_m: 0.1,
    };
    for (density, least) in [(Density::Constant, 0.9), (Density::Linear, 1.8)] {
        let errors = [32, 64, 128, 256].map(|cells| {
            let scene = json!({
                "water": {
                    "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.0, "direction_deg": 0, "phase_deg": 90 }],
                    "absorption_per_m": [0.1, 0.1, 0.1], "ior": 1.333
                },
                "floor": { "depth_m": 2, "size_m": [4, 4] },
                "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 1] }],
                "quality": { "water_cells": cells },
                "output": { "kind": "irradiance_map", "receiver": "floor",
                            "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 32 }
            });
            let resolved = with(scene, density, true);
            let points = points_of(&resolved);
            let due: Vec<f64> = points
                .iter()
                .map(|point| closed.irradiance_at(f64::from(point.position_m[0])))
                .collect();
            let map = Map::from(&resolved);
            let found: Vec<f64> = map.texels.iter().map(|texel| texel[0]).collect();
            (f64::from(cells), metrics::relative_l1(&found, &due).unwrap())
        });
        let order = convergence_order(&errors);
        println!("{density:?}: {errors:?}, order {order:.2}");
        assert!(order >= least, "{density:?}: {order}");
    }
}

/// Flat water: the mean is right, and no texel is brighter or darker than others.
#[test]
fn flat_water_is_even() {
    for elevation_deg in [60.0, 20.0] {
        for density in DENSITIES {
            let scene = json!({
                "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
                "floor": { "depth_m": 2, "size_m": [8, 8] },
                "lights": [{ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": 30, "irradiance_w_m2": [1000, 800, 600] }],
                "quality": { "water_cells": 256 },
                "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 256, "height": 256 }
            });
            let resolved = with(scene, density, true);
            let Light::Sun(sun) = &resolved.scene.lights[0] else {
                panic!("a sun");
            };
            let due = flat_water_irradiance(&resolved.scene.water, 2.0, sun);
            let map = Map::from(&resolved);
            let worst = map
                .texels
                .iter()
                .map(|texel| harness::largest_relative(texel, &due));
            let worst = worst.fold(0.0, nan_fails);
            let mean = (0..3).map(|c| (map.mean(c) / due[c] - 1.0).abs());
            let mean = mean.fold(0.0, nan_fails);
            println!(
                "{elevation_deg}°, {density:?}: mean off by {mean:.1e}, worst texel by {worst:.1e}"
            );
            assert!(mean <= 1e-5, "{mean:e}");
            assert!(worst <= 1e-3, "{worst:e}");
        }
    }
}

/// Corners and sides of a grid of triangles in whole numbers, and points exactly on them: each point lies in exactly one triangle, however
/// the grid is turned over or sheared.
#[test]
fn points_on_sides_and_corners_are_counted_once() {
    const CELLS: u32 = 6;
    const ENTRY: &str = "
        @group(0) @binding(40) var<storage, read> corners: array<vec2f>;
        @group(0) @binding(41) var<storage, read> triangles: array<vec4u>;
        @group(0) @binding(42) var<storage, read> places: array<vec2f>;
        @group(0) @binding(43) var<storage, read_write> counts: array<u32>;
        @compute @workgroup_size(64) fn count_main(@builtin(global_invocation_id) id: vec3u) {
            if id.x >= arrayLength(&places) { return; }
            let p = places[id.x];
            var count = 0u;
            for (var k = 0u; k < arrayLength(&triangles); k++) {
                let v = triangles[k].xyz;
                if is_in(cut_between(v, corners[v.x] - p, corners[v.y] - p, corners[v.z] - p)) { count += 1u; }
            }
            counts[id.x] = count;
        }";
    let renderer = harness::renderer();
    let gpu = renderer.gpu();
    let path = "methods/caustic_volume/point_in_volume.wgsl";
    let text = renderer.sources().assemble(path).unwrap() + ENTRY;
    let kernel = Kernel::from_text(gpu, path, text, "count_main", &[]).unwrap();
    let side = CELLS + 1;
    let triangles: Vec<[u32; 4]> = (0..CELLS * CELLS)
        .flat_map(|cell| {
            let (i, j) = (cell % CELLS, cell / CELLS);
            let at = |di: u32, dj: u32| (j + dj) * side + i + di;
            if (i + j) % 2 == 0 {
                [
                    [at(0, 0), at(1, 0), at(1, 1), 0],
                    [at(0, 0), at(1, 1), at(0, 1), 0],
                ]
            } else {
                [
                    [at(0, 0), at(1, 0), at(0, 1), 0],
                    [at(1, 0), at(1, 1), at(0, 1), 0],
                ]
            }
        })
        .collect();
    for [[ax, ay], [bx, by]] in [
        [[4, 0], [0, 4]],
        [[-4, 0], [0, 4]],
        [[0, 4], [4, 0]],
        [[4, 8], [-12, 4]],
        [[12, 4], [4, -8]],
    ] {
        let of = |u: i32, v: i32| [(ax * u + bx * v) as f32, (ay * u + by * v) as f32];
        let corners: Vec<[f32; 2]> = (0..side * side)
            .map(|k| of((k % side) as i32, (k / side) as i32))
            .collect();
        // All quarters of a cell inside the rim: corners, middles of sides, middles of cells and others.
        let quarters = 4..4 * CELLS as i32 - 3;
        let places: Vec<[f32; 2]> = quarters
            .clone()
            .flat_map(|v| quarters.clone().map(move |u| (u, v)))
            .map(|(u, v)| {
                let [x, y] = of(u, v);
                [x / 4.0, y / 4.0]
            })
            .collect();
        let buffer = |bytes: &[u8], usage| {
            let made = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("lattice"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::STORAGE | usage,
                mapped_at_creation: false,
            });
            if usage == wgpu::BufferUsages::COPY_DST {
                gpu.queue.write_buffer(&made, 0, bytes);
            }
            made
        };
        let inputs = [
            bytemuck::cast_slice(&corners),
            bytemuck::cast_slice(&triangles),
            bytemuck::cast_slice(&places),
        ]
        .map(|bytes| buffer(bytes, wgpu::BufferUsages::COPY_DST));
        let counts = buffer(&vec![0; 4 * places.len()], wgpu::BufferUsages::COPY_SRC);
        let bound = kernel.bind(gpu, &mut BindGroups::default(), |name| {
            let buffer = match name {
                "corners" => &inputs[0],
                "triangles" => &inputs[1],
                "places" => &inputs[2],
                _ => &counts,
            };
            Some(Binding::Buffer {
                buffer,
                bytes: buffer.size(),
            })
        });
        let bound = bound.unwrap();
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(kernel.pipeline());
            pass.set_bind_group(0, &bound.group, &bound.offsets);
            pass.dispatch_workgroups((places.len() as u32).div_ceil(64), 1, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        let read: Vec<u32> = readback::read(gpu, &counts, 4 * places.len() as u64).unwrap();
        gpu.check().unwrap();
        assert_eq!(places.len(), 17 * 17);
        for (place, count) in places.iter().zip(&read) {
            assert_eq!(*count, 1, "{place:?} of {corners:?}");
        }
    }
}

/// A plate of `side`² pieces, 1.6 m wide, and a view of it through waves.
fn plate(side: u32) -> ResolvedScene {
    let step = 1.6 / f64::from(side);
    let piece = format!("v 0 0 0\nv {step} 0 0\nv {step} 0 {step}\nv 0 0 {step}\nf 1 4 3 2\n");
    let mesh = scene_files::mesh_of(piece.as_bytes());
    let objects: Vec<Value> = (0..side * side)
        .map(|k| {
            let at = |i: u32| -0.8 + step * f64::from(i);
            json!({ "mesh": mesh.id, "translation_m": [at(k % side), -1.5, at(k / side)], "albedo": [0.5, 0.5, 0.5] })
        })
        .collect();
    let mut scene = pool(sun(), view());
    scene["objects"] = json!(objects);
    scene["camera"] =
        json!({ "position_m": [0, 2.5, 1.5], "target_m": [0, -1.5, 0], "vertical_fov_deg": 30 });
    scene["quality"]["method"] = json!(choice(Density::Linear));
    scene_files::with_meshes(scene, &[mesh])
}

#[test]
fn a_receiver_in_64_pieces_has_no_seams() {
    let [whole, pieces] = [1, 8].map(|side| {
        let resolved = plate(side);
        let points = points_of(&resolved);
        let frame = harness::render(&resolved);
        (points, harness::layer(&frame, LayerName::Irradiance))
    });
    let on_plate = |point: &Point| point.receiver >= 1.0;
    let (mut seen, mut unlike) = (0, 0);
    for (k, (a, b)) in whole.1.iter().zip(&pieces.1).enumerate() {
        assert_eq!(on_plate(&whole.0[k]), on_plate(&pieces.0[k]), "pixel {k}");
        if !on_plate(&whole.0[k]) {
            continue;
        }
        seen += 1;
        let off = harness::largest_relative(a, b);
        unlike += u32::from(off > 1e-3);
        assert!(off <= 1e-2, "pixel {k}: {a:?} {b:?}");
    }
    println!("{seen} pixels of the plate, {unlike} off by more than a thousandth");
    assert!(seen > 2000, "{seen}");
    assert!(unlike <= seen / 500, "{unlike} of {seen}");
}

/// Waves that focus above the floor: several sheets of light lie over each other, and their light adds up to that of the truth.
#[test]
fn folds_add_up() {
    const BLOCKS: usize = 8;
    const SIDE: usize = 256;
    let scene = |side: usize| {
        let mut scene = pool(
            sun(),
            json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": side, "height": side }),
        );
        scene["objects"] = json!([]);
        scene["floor"] = json!({ "depth_m": 5, "size_m": [8, 8] });
        scene["water"]["waves"][0]["amplitude_m"] = json!(0.05);
        scene["quality"]["water_cells"] = json!(256);
        scene
    };
    // Means over blocks of points: the brightest lines lie between points.
    let truth = truths::floor_map(
        &scene_files::scene(scene(BLOCKS)),
        &harness::truth_settings(2e-3),
    );
    for density in DENSITIES {
        let resolved = with(scene(SIDE), density, true);
        let points = points_of(&resolved);
        let plain = plain_volumes::irradiance(&resolved, &points, density);
        let folded = plain.iter().filter(|lit| lit.volumes > 2).count();
        assert!(folded > plain.len() / 2, "{folded} of {}", plain.len());
        let map = Map::from(&resolved);
        let mut blocks = vec![[0.0; 3]; BLOCKS * BLOCKS];
        let per_side = SIDE / BLOCKS;
        for (k, texel) in map.texels.iter().enumerate() {
            let block = &mut blocks[k / SIDE / per_side * BLOCKS + k % SIDE / per_side];
            for (sum, value) in block.iter_mut().zip(texel) {
                *sum += value / (per_side * per_side) as f64;
            }
        }
        let due = truth.irradiance.as_flattened();
        let error = metrics::relative_l1(blocks.as_flattened(), due).unwrap();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let off = (mean(map.values()) / mean(due) - 1.0).abs();
        println!(
            "{density:?}: {folded} texels in folds, blocks off by {error:.1e}, mean by {off:.1e}"
        );
        assert!(error <= 3e-2, "{density:?}: {error:e}");
        assert!(off <= 5e-3, "{density:?}: {off:e}");
    }
}

/// The box's shadow on the floor is there, or the frame says that it is not.
#[test]
fn shadows_are_cast_or_reported() {
    let scene = || {
        json!({
            "floor": { "depth_m": 2, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1000, 800, 600] }],
            "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4 }],
            "quality": { "water_cells": 64 },
            "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-0.5, -0.5], "max_m": [0.5, 0.5], "width": 64, "height": 64 }
        })
    };
    let dark_m2 = |map: &Map| {
        let dark = map.texels.iter().filter(|texel| texel[0] == 0.0).count();
        dark as f64 / 4096.0
    };
    let lit = Map::from(&with(scene(), Density::Constant, false));
    assert_eq!(dark_m2(&lit), 0.0);
    let warning = lit
        .stats
        .warnings
        .iter()
        .find(|w| w.code == "objects_cast_no_shadows");
    let flux_w = warning.unwrap().flux_w.unwrap();
    // The top of the box, 0.4 m wide, under 1000 W/m² of which 2 % are reflected.
    assert!((flux_w[0] / (0.16 * 980.0) - 1.0).abs() < 0.1, "{flux_w:?}");
    let shaded = Map::from(&with(scene(), Density::Constant, true));
    assert!(
        (dark_m2(&shaded) / 0.16 - 1.0).abs() < 0.05,
        "{}",
        dark_m2(&shaded)
    );
    assert!(
        !shaded
            .stats
            .warnings
            .iter()
            .any(|w| w.code == "objects_cast_no_shadows")
    );
}

/// Cuts without area, vertical receivers and receivers along the light: all finite.
#[test]
fn cuts_without_area_and_receivers_along_the_light_are_finite() {
    for density in DENSITIES {
        for name in [
            "a_point_focus_on_the_floor",
            "a_line_focus_on_the_floor",
            "floor_at_depth_0",
        ] {
            let case = caustica::lab::hard_cases::find(name).unwrap();
            let mut scene = caustica::lab::hard_cases::scene(case).unwrap();
            scene["quality"]["method"] = json!(choice(density));
            let resolved = caustica::lab::hard_cases::resolved(scene).unwrap();
            let map = Map::from(&resolved);
            let most = map.values().iter().copied().fold(0.0, nan_fails);
            println!("{name}, {density:?}: at most {most:.1e} W/m²");
            assert!(most > 0.0 && most.is_finite(), "{name}, {density:?}");
        }
        // A box under the zenith: its sides are along the light, and get none or next to none.
        let mut scene = pool(
            json!([{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1000, 900, 800] }]),
            view(),
        );
        scene["water"]["waves"] = json!([]);
        scene["objects"][0]["rotation"] = json!([0, 0, 0, 1]);
        scene["camera"] = json!({ "position_m": [0, -1, 3], "target_m": [0, -1.2, 0] });
        let resolved = with(scene, density, true);
        let points = points_of(&resolved);
        let frame = harness::render(&resolved);
        let lit = harness::layer(&frame, LayerName::Irradiance);
        let mut sides = 0;
        for (point, lit) in points.iter().zip(&lit) {
            if point.receiver > 0.0 && point.normal[1].abs() < 1e-3 {
                sides += 1;
                assert!(lit[0] < 1.0, "{point:?} {lit:?}");
            }
        }
        assert!(sides > 200, "{sides}");
    }
}

#[test]
fn a_light_under_water_is_refused_with_the_reason() {
    let lamp =
        json!([{ "kind": "point", "position_m": [0.4, -0.5, -0.3], "intensity_w_sr": [1, 1, 1] }]);
    let resolved = with(pool(lamp, view()), Density::Constant, true);
    let error = harness::try_render(&mut harness::renderer(), &resolved).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("light 0 is under it"), "{text}");
}
