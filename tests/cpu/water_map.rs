//! Maps of the water: what a scene may say, what is planned for it, and what its files hold.

use std::f64::consts::FRAC_1_SQRT_2;

use caustica::frame::{Frame, FrameKind};
use caustica::image::{Metadata, decode_exr, decode_png, encode};
use caustica::lab::study::comparison;
use caustica::lab::study::sweep::{self, StudyError, SweepSettings};
use caustica::methods;
use caustica::plan::{self, NothingCached, Plan, Wanted};
use caustica::reference::{ReferenceError, TruthSettings, truth};
use caustica::render::{Prepared, RenderError};
use caustica::scene::{ExrPixel, Issue, LayerName, Output, ResolvedScene, Scene, ToneCurve};
use serde_json::{Value, json};

use super::image_support::{exr, frame, layer, png};
use super::scene_files;
use super::scene_validate::{findings, only};

/// A scene with everything in it that a map of the water does not need.
fn pool(output: Value) -> Value {
    let mut scene = json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.1 }],
            "absorption_per_m": [0.3, 0.1, 0.05], "scattering_per_m": [0.1, 0.1, 0.1]
        },
        "floor": { "depth_m": 2, "size_m": [8, 6], "center_m": [100, -20] },
        "lights": [
            { "kind": "sun", "elevation_deg": 50, "irradiance_w_m2": [1, 1, 1] },
            { "kind": "point", "position_m": [100, 1, -20], "intensity_w_sr": [1, 1, 1] },
            { "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] }
        ],
        "objects": [{ "mesh": "box.obj", "translation_m": [100, -1, -20] }],
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] },
        "output": output
    });
    scene["output"]["kind"] = json!("water_map");
    scene
}

fn planned(resolved: &ResolvedScene) -> Plan {
    let facts = methods::facts_with_warnings(resolved).unwrap();
    let empty = NothingCached {
        arena_bytes: 64 << 20,
        field_arena_bytes: 64 << 20,
    };
    let plan = plan::plan_scene(&facts, Wanted::Frame, &empty).unwrap();
    plan.report
}

/// Scene without meshes and floor.
fn bare(output: Value) -> Value {
    let mut scene = json!({ "output": output });
    scene["output"]["kind"] = json!("water_map");
    scene
}

#[test]
fn the_plan_has_one_pass_whatever_else_is_in_the_scene() {
    for method in methods::variants() {
        let mut scene = pool(json!({ "width": 40, "height": 30 }));
        scene["quality"]["method"] = serde_json::to_value(&method).unwrap();
        scene["quality"]["estimate_error"] = json!(true);
        let plan = planned(&scene_files::scene(scene));
        let passes: Vec<_> = plan.passes.iter().map(|p| (&*p.name, p.runs)).collect();
        assert_eq!(passes, [("water_map", 1)], "{method:?}");
        let slots: Vec<_> = plan.slots.iter().map(|s| (&*s.name, s.bytes)).collect();
        // A head and a sine; 16 bytes a texel on the GPU and for the host.
        let map = 16 * 40 * 30;
        assert_eq!(
            slots[..3],
            [("waves", 32), ("water_map", map), ("readback", map)]
        );
        assert_eq!(slots.len(), 4);
        for absent in &plan.absent {
            assert!(
                absent.reason.contains("map of the water")
                    || absent.reason.starts_with("quality.")
                    || absent.reason.starts_with("method ")
                    || absent.reason.starts_with("no object")
                    || absent.reason.starts_with("nothing in this frame"),
                "{absent:?}"
            );
            assert!(!absent.reason.contains("irradiance map"), "{absent:?}");
        }
        assert!(plan.absent.iter().any(|absent| absent.name == "light"));
        assert_eq!(plan.warnings, []);
    }
    // Other outputs have no such pass.
    for name in ["pool", "sine_pool"] {
        let plan = planned(&scene_files::load(name, &[]));
        let absent = plan.absent.iter().find(|pass| pass.name == "water_map");
        assert_eq!(absent.unwrap().reason, "output.kind is not water_map");
    }
}

/// The same map from one band to the next: a map of more rows than a band holds runs the pass once a band.
#[test]
fn large_maps_are_made_in_bands() {
    let scene = pool(json!({ "width": 8192, "height": 600 }));
    let plan = planned(&scene_files::scene(scene));
    assert_eq!(plan.passes[0].runs, 3);
    assert_eq!(plan.slots[1].bytes, 32 << 20);
}

#[test]
fn no_dial_is_chosen_for_it() {
    for quality in [
        json!({ "target_error": 0.01 }),
        json!({ "time_budget_ms": 5 }),
    ] {
        let mut scene = pool(json!({}));
        scene["quality"] = quality;
        let prepared = Prepared::new(scene_files::scene(scene.clone())).unwrap();
        assert!(!prepared.asks_for_dials());
        scene["output"] = json!({ "kind": "irradiance_map", "receiver": "floor" });
        let prepared = Prepared::new(scene_files::scene(scene)).unwrap();
        assert!(prepared.asks_for_dials());
    }
}

#[test]
fn lights_are_not_counted_for_it() {
    let lamp = json!({ "kind": "point", "position_m": [0, 1, 0], "intensity_w_sr": [1, 1, 1] });
    let mut scene = pool(json!({}));
    scene["lights"] = json!(vec![lamp; 64]);
    scene["lights"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "kind": "sun", "elevation_deg": 0.0000001, "irradiance_w_m2": [1, 1, 1] }));
    let limits = caustica::config::Limits {
        max_lights: 100,
        ..caustica::config::Limits::default()
    };
    let mut with = |output: Value| {
        scene["objects"] = json!([]);
        scene["output"] = output;
        let parsed = Scene::from_value(scene.clone()).unwrap();
        let resolved = methods::resolve(parsed, &limits, |_: &str| None).unwrap();
        methods::facts(&resolved).map(|facts| facts.lights.in_air.len())
    };
    assert_eq!(with(json!({ "kind": "water_map" })).unwrap(), 0);
    assert!(with(json!({ "kind": "irradiance_map", "receiver": "floor" })).is_err());
}

#[test]
fn the_warnings_of_the_water_stay() {
    let codes = |waves: Value, output: Value| {
        let mut scene = pool(output);
        scene["water"]["waves"] = waves;
        let warnings = planned(&scene_files::scene(scene)).warnings;
        warnings.into_iter().map(|w| w.code).collect::<Vec<_>>()
    };
    let ripples = json!([{ "kind": "ripples", "min_m": [96, -23], "max_m": [104, -17], "samples": 64,
                           "drops": [{ "position_m": [100, -20], "radius_m": 0.1, "height_m": 0.01 }] }]);
    let fine = json!({ "width": 2048, "height": 2048 });
    assert_eq!(codes(ripples, fine.clone()), ["waves_smoothed"]);
    let flat = json!([{ "kind": "spectrum", "model": "phillips", "wind_speed_m_s": 0, "tile_m": 8, "samples": 64 }]);
    assert_eq!(codes(flat, fine), ["sea_without_waves"]);
    let sine = json!([{ "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.5 }]);
    // Texels of 0.25 m and just above.
    let of_width = |width: u32| codes(sine.clone(), json!({ "width": width, "height": 24 }));
    assert_eq!(of_width(32), Vec::<String>::new());
    assert_eq!(of_width(31), ["water_map_coarse"]);
}

#[test]
fn fields_are_checked() {
    assert_eq!(findings(&pool_without_mesh(json!({}))), []);
    for (output, pointer) in [
        (json!({ "width": 0 }), "/output/width"),
        (json!({ "height": 8193 }), "/output/height"),
        (json!({ "png_bits": 12 }), "/output/png_bits"),
        (json!({ "min_m": [2e8, 0] }), "/output/min_m/0"),
        (json!({ "min_m": [104, -20] }), "/output/min_m/0"),
        (
            json!({ "min_m": [0, 0], "max_m": [1, 0] }),
            "/output/max_m/1",
        ),
        (
            json!({ "min_m": [0, 0], "max_m": [2e6, 1] }),
            "/output/max_m/0",
        ),
        (json!({ "exposure_ev": 1 }), "/output/exposure_ev"),
        (json!({ "receiver": "floor" }), "/output/receiver"),
    ] {
        let found = refused(&pool_without_mesh(output));
        assert_eq!(found.len(), 1, "{pointer}: {found:#?}");
        assert_eq!(found[0].pointer, pointer);
        assert!(!found[0].accepted.is_empty());
    }
    // It may lie anywhere, and needs a floor only for corners that are not given.
    let there = json!({ "min_m": [-3e6, 7], "max_m": [-2.9e6, 8] });
    assert_eq!(findings(&pool_without_mesh(there.clone())), []);
    assert_eq!(findings(&bare(there)), []);
    let found = findings(&bare(json!({})));
    let pointers: Vec<&str> = found.iter().map(|issue| &*issue.pointer).collect();
    assert_eq!(pointers, ["/output/min_m", "/output/max_m"]);
    assert!(found[0].accepted.contains("a scene with a `floor`"));
    only(&bare(json!({ "min_m": [0, 0] })), "/output/max_m");
}

/// What is found wrong with a scene, when it is read or when it is checked.
fn refused(scene: &Value) -> Vec<Issue> {
    match Scene::from_value(scene.clone()) {
        Ok(_) => findings(scene),
        Err(error) => error.issues,
    }
}

fn pool_without_mesh(output: Value) -> Value {
    let mut scene = pool(output);
    scene["objects"] = json!([]);
    scene
}

#[test]
fn defaults_are_those_of_a_map_of_the_floor() {
    let scene = Scene::from_value(pool_without_mesh(json!({}))).unwrap();
    let Output::WaterMap(map) = &scene.output else {
        panic!("{:?}", scene.output);
    };
    assert_eq!(map.size(), [512, 512]);
    let corners = map.corners_m(scene.floor.as_ref());
    assert_eq!(corners, Some([[96.0, -23.0], [104.0, -17.0]]));
    assert_eq!(scene.output.encoding().png_bits, 16);
    let written = serde_json::to_value(&scene).unwrap();
    assert_eq!(Scene::from_value(written).unwrap(), scene);
}

#[test]
fn it_has_no_truth_and_no_study() {
    let resolved = scene_files::scene(pool(json!({})));
    let found = truth(&resolved, &TruthSettings::default(), &|_| {}, &|| false);
    assert_eq!(found.unwrap_err(), ReferenceError::WaterMap);
    let settings = SweepSettings {
        dials: Vec::new(),
        grid: false,
        rungs: comparison::DEFAULT_RUNGS,
        runs: 1,
    };
    let limits = caustica::config::Limits::default();
    let refused = sweep::check::<RenderError>(&resolved, &settings, &limits);
    let Err(StudyError::Scene(error)) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(error.issues[0].pointer, "/output/kind");
    assert_eq!(error.issues[0].accepted, "`view` or `irradiance_map`");
}

/// Three by two texels: height, ∂h/∂x, ∂h/∂z.
const TEXELS: [[f32; 3]; 6] = [
    [0.1, 0.0, 0.0],
    [0.2, 1.0, 0.0],
    [-0.3, 0.0, 1.0],
    [0.0, -0.01, 0.3],
    [0.5, -2.5, -0.4],
    [0.0, 0.02, -0.001],
];

fn map() -> Frame {
    let values = layer(3, 2, 3, |x, y, c| TEXELS[(3 * y + x) as usize][c]);
    Frame {
        kind: FrameKind::WaterMap,
        scene: Some("{}".to_owned()),
        ..frame(3, 2, LayerName::Water, values)
    }
}

#[test]
fn exr_has_height_and_slopes_as_data() {
    let frame = map();
    let metadata = Metadata::of(&frame.stats);
    let encoded = encode(&frame, &exr(ExrPixel::Float), &metadata).unwrap();
    assert_eq!(encoded.warnings, []);
    let read = decode_exr(&encoded.bytes).unwrap();
    assert_eq!((read.width, read.height), (3, 2));
    let channels: Vec<&str> = read.channels.keys().map(String::as_str).collect();
    assert_eq!(channels, ["height", "slope.x", "slope.z"]);
    for (index, channel) in channels.into_iter().enumerate() {
        assert!(!read.is_half[channel]);
        let expected: Vec<f32> = TEXELS.iter().map(|texel| texel[index]).collect();
        assert_eq!(read.channels[channel], expected, "{channel}");
    }
    assert_eq!(read.texts["colorInteropID"], "data");
    assert_eq!(read.texts["caustica:scene"], "{}");
    assert_eq!(read.texts["caustica:scene_hash"], "blake3:0123");
}

#[test]
fn png_is_a_normal_map_that_decodes_to_the_slopes() {
    let frame = map();
    for (bits, most) in [(8, 255.0), (16, 65535.0)] {
        let encoding = png(bits, ToneCurve::PbrNeutral);
        let encoded = encode(&frame, &encoding, &Metadata::of(&frame.stats)).unwrap();
        assert_eq!(encoded.warnings, []);
        assert!(!encoded.bytes.windows(4).any(|chunk| chunk == b"sRGB"));
        let read = decode_png(&encoded.bytes).unwrap();
        assert_eq!((read.width, read.height, read.bits), (3, 2, bits));
        for (codes, [_, slope_x, slope_z]) in read.rgb.chunks_exact(3).zip(TEXELS) {
            let [red, green, blue] =
                std::array::from_fn(|c| 2.0 * f64::from(codes[c]) / most - 1.0);
            // A component is off by at most half a code, which is 1 / most.
            for (found, slope) in [(-red / blue, slope_x), (green / blue, slope_z)] {
                let slope = f64::from(slope);
                let step = (1.0 + slope.abs()) / most / (blue - 1.0 / most);
                assert!(
                    (found - slope).abs() <= step,
                    "{bits} bits: {found} for {slope}"
                );
            }
        }
    }
}

/// Water that rises to the right leans its normal to the left, and water that rises down the picture (+z) leans it up.
#[test]
fn the_channels_are_right_up_and_out() {
    let frame = map();
    let encoding = png(16, ToneCurve::Clip);
    let encoded = encode(&frame, &encoding, &Metadata::of(&frame.stats)).unwrap();
    let read = decode_png(&encoded.bytes).unwrap();
    let code = |component: f64| (65535.0 * 0.5 * (component + 1.0) + 0.5).floor() as u16;
    let texel = |index: usize| &read.rgb[3 * index..][..3];
    assert_eq!(texel(0), [code(0.0), code(0.0), 65535]);
    let half = FRAC_1_SQRT_2;
    assert_eq!(texel(1), [code(-half), code(0.0), code(half)]);
    assert_eq!(texel(2), [code(0.0), code(half), code(half)]);
}
