//! Maps of the water against the float64 surface.

use caustica::config::RenderConfig;
use caustica::frame::Frame;
use caustica::image::{Metadata, decode_exr, decode_png, encode};
use caustica::methods;
use caustica::scene::{LayerName, Output, ResolvedScene};
use caustica::waves::Surface;
use glam::DVec2;
use serde_json::{Value, json};

use super::harness;
use super::scene_files;

/// Each kind of water, and all of them together. Ripples have an origin of their own; all others are the same everywhere.
fn waters() -> Vec<(&'static str, Value)> {
    let sines = json!([
        { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.7, "direction_deg": -50 },
        { "kind": "sine", "amplitude_m": 0.05, "wavelength_m": 3.1, "direction_deg": 77, "phase_deg": 40 }
    ]);
    let gerstner = json!([{ "kind": "gerstner", "amplitude_m": 0.03, "wavelength_m": 1.1, "direction_deg": 20, "steepness": 0.6 }]);
    let sea = json!([{
        "kind": "spectrum", "model": "elfouhaily", "wind_speed_m_s": 4, "fetch_m": 5000, "wind_direction_deg": 40,
        "tile_m": 8, "samples": 128, "seed": 3
    }]);
    let ripples = json!([{
        "kind": "ripples", "min_m": [-1.6, -1.2], "max_m": [1.6, 1.2], "samples": 160,
        "drops": [
            { "position_m": [-0.5, -0.2], "radius_m": 0.09, "height_m": 0.04 },
            { "position_m": [0.6, 0.4], "radius_m": 0.1, "height_m": -0.04, "at_s": 0.3 }
        ]
    }]);
    let all = [&ripples, &sines, &gerstner, &sea].map(|waves| waves.as_array().unwrap().clone());
    vec![
        ("flat", json!([])),
        ("sines", sines),
        ("gerstner", gerstner),
        ("sea", sea),
        ("ripples", ripples),
        ("all", json!(all.concat())),
    ]
}

fn scene(waves: &Value, output: Value) -> Value {
    let mut scene =
        json!({ "water": { "waves": waves, "level_m": 3 }, "time_s": 0.8, "output": output });
    scene["output"]["kind"] = json!("water_map");
    scene
}

/// The centres of the texels, and the surface there.
fn truth(resolved: &ResolvedScene) -> Vec<[f64; 3]> {
    let Output::WaterMap(map) = &resolved.scene.output else {
        panic!("no map of the water");
    };
    let [min, max] = map
        .corners_m(resolved.scene.floor.as_ref())
        .unwrap()
        .map(DVec2::from);
    let [width, height] = map.size();
    let step = (max - min) / DVec2::new(f64::from(width), f64::from(height));
    let surface = Surface::of(resolved).unwrap();
    (0..height)
        .flat_map(|j| (0..width).map(move |i| DVec2::new(f64::from(i), f64::from(j))))
        .map(|at| {
            let p = min + (at + 0.5) * step;
            let point = surface.at(p.x, p.y);
            [point.height_m, point.slope.x, point.slope.y]
        })
        .collect()
}

fn values(frame: &Frame) -> Vec<[f64; 3]> {
    harness::layer(frame, LayerName::Water)
}

/// What single precision may lose: a few roundings of the values, and of the places, whose steps grow with the map's half side.
fn tolerance(resolved: &ResolvedScene, half_m: f64) -> [f64; 2] {
    let surface = Surface::of(resolved).unwrap();
    const ROUNDINGS: f64 = 8.0 * f32::EPSILON as f64;
    let reach_m = half_m + 1.0;
    [
        ROUNDINGS * (surface.max_height_m() + reach_m * surface.max_slope()),
        ROUNDINGS * (surface.max_slope() + reach_m * surface.max_second_derivative_per_m()),
    ]
}

fn assert_is_surface(name: &str, resolved: &ResolvedScene, half_m: f64) -> Frame {
    let frame = harness::render(resolved);
    let expected = truth(resolved);
    let found = values(&frame);
    assert_eq!(found.len(), expected.len());
    let [height_m, slope] = tolerance(resolved, half_m);
    let mut worst = [0.0_f64; 3];
    for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
        for c in 0..3 {
            let off = (found[c] - expected[c]).abs();
            let allowed = if c == 0 { height_m } else { slope };
            assert!(
                off <= allowed,
                "{name}, texel {index}, value {c}: {found:?} {expected:?}, {off:e} > {allowed:e}"
            );
            worst[c] = harness::nan_fails(worst[c], off);
        }
    }
    println!("{name}: {worst:?} of {height_m:e}, {slope:e}");
    frame
}

#[test]
fn each_water_is_that_of_float64() {
    let windows = [
        ("around the origin", json!([-1, -0.8]), json!([1, 0.8]), 1.0),
        ("beside it", json!([2.3, -7.7]), json!([9.1, -4.5]), 3.4),
        (
            "far away",
            json!([5_000_001.25, -2_999_998.5]),
            json!([5_000_003.75, -2_999_997.0]),
            1.25,
        ),
    ];
    for (name, waves) in waters() {
        for (place, min, max, half_m) in &windows {
            let output = json!({ "min_m": min, "max_m": max, "width": 61, "height": 38 });
            let resolved = scene_files::scene(scene(&waves, output));
            let frame = assert_is_surface(&format!("{name} {place}"), &resolved, *half_m);
            assert_eq!((frame.width, frame.height), (61, 38));
            let slopes = values(&frame).into_iter().map(|v| v[1].hypot(v[2]));
            let steepest = slopes.fold(0.0, f64::max);
            assert_eq!(steepest > 0.005, name != "flat", "{name}: {steepest}");
        }
    }
}

#[test]
fn one_texel_is_the_middle_of_the_rectangle() {
    let (_, waves) = waters().remove(1);
    let output = json!({ "min_m": [0.3, 0.1], "max_m": [0.7, 0.2], "width": 1, "height": 1 });
    let resolved = scene_files::scene(scene(&waves, output));
    let frame = assert_is_surface("1 × 1", &resolved, 0.2);
    let middle = Surface::of(&resolved).unwrap().at(0.5, 0.15);
    assert!((values(&frame)[0][0] - middle.height_m).abs() < 1e-7);
}

/// More rows than a band holds, and dispatches cut into pieces.
#[test]
fn bands_and_pieces_leave_no_trace() {
    let (_, waves) = waters().remove(1);
    let output = json!({ "min_m": [-4, -3], "max_m": [4, 3], "width": 2048, "height": 1100 });
    let resolved = scene_files::scene(scene(&waves, output));
    let frame = assert_is_surface("2048 × 1100", &resolved, 4.0);
    assert_eq!(frame.stats.passes[0].runs, 2);
    let mut renderer = harness::new_renderer(&RenderConfig::default());
    renderer.cut_into(Some(1000));
    let cut = harness::render_with(&mut renderer, &resolved);
    assert!(renderer.pieces().0 > 10, "{:?}", renderer.pieces());
    assert!(cut.layers == frame.layers);
}

#[test]
fn methods_lights_and_receivers_change_nothing() {
    let (_, waves) = waters().remove(5);
    let output = json!({ "min_m": [-1, -1], "max_m": [1, 1], "width": 32, "height": 32 });
    let mut plain = scene(&waves, output.clone());
    // Its depth decides how fast waves run.
    plain["floor"] = json!({ "depth_m": 2, "size_m": [8, 8] });
    let bare = plain.clone();
    let plain = harness::render(&scene_files::scene(plain));
    // A renderer that has made nothing else: its memory is that of these frames.
    let mut renderer = harness::new_renderer(&RenderConfig::default());
    for method in methods::variants() {
        let mut scene = bare.clone();
        scene["lights"] = json!([
            { "kind": "sun", "elevation_deg": 50, "irradiance_w_m2": [1, 1, 1] },
            { "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] }
        ]);
        scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, 2, 0] }]);
        scene["quality"] = json!({ "method": method, "estimate_error": true });
        if method.kind.as_deref() == Some("level_map") {
            scene["quality"]["target_error"] = json!(0.01);
        }
        let before = renderer.level_map_cache();
        let frame = harness::render_with(&mut renderer, &scene_files::scene(scene));
        assert!(frame.layers == plain.layers, "{method:?}");
        let stats = &frame.stats;
        let passes: Vec<&str> = stats.passes.iter().map(|pass| &*pass.name).collect();
        assert_eq!(passes, ["water_map"]);
        assert!(stats.energy.is_empty() && stats.planes.is_empty());
        assert_eq!(stats.accuracy, None);
        assert_eq!(renderer.level_map_cache().misses, before.misses);
        assert!(stats.memory.peak_bytes > 0);
        assert!(stats.memory.peak_bytes <= stats.memory.planned_peak_bytes);
    }
}

/// EXR has the very numbers; a normal map those of the surface within its codes.
#[test]
fn files_hold_the_surface() {
    for name in ["sea_jonswap", "rain_pool"] {
        let load = |format: &str| {
            scene_files::load(
                name,
                &[
                    ("/output/kind", "water_map"),
                    ("/output/width", "64"),
                    ("/output/height", "48"),
                    ("/output/format", format),
                ],
            )
        };
        let resolved = load("exr");
        let frame = harness::render(&resolved);
        let metadata = Metadata::of(&frame.stats);
        let exr = encode(&frame, &resolved.scene.output.encoding(), &metadata).unwrap();
        let read = decode_exr(&exr.bytes).unwrap();
        for (c, channel) in ["height", "slope.x", "slope.z"].into_iter().enumerate() {
            let own = frame.layers[&LayerName::Water].data.iter();
            let own: Vec<f32> = own.skip(c).step_by(3).copied().collect();
            assert_eq!(read.channels[channel], own, "{name} {channel}");
        }
        assert!(read.texts["caustica:scene"].contains("water_map"));
        let resolved = load("png");
        let frame = harness::render(&resolved);
        let png = encode(&frame, &resolved.scene.output.encoding(), &metadata).unwrap();
        let read = decode_png(&png.bytes).unwrap();
        assert_eq!(read.bits, 16);
        for (codes, [_, slope_x, slope_z]) in read.rgb.chunks_exact(3).zip(truth(&resolved)) {
            let [red, green, blue] =
                std::array::from_fn(|c| 2.0 * f64::from(codes[c]) / 65535.0 - 1.0);
            let found = DVec2::new(-red, green) / blue;
            let off = (found - DVec2::new(slope_x, slope_z)).abs().max_element();
            assert!(off < 5e-5, "{name}: {found} {slope_x} {slope_z}");
        }
    }
}
