//! Properties of every scene within the documented ranges, tested with reproducible random scenes. `CAUSTICA_PROPERTY_CASES` is
//! their number; `CAUSTICA_PROPERTY_SEED` selects a single one. A failure prints the scene.

use std::panic::{AssertUnwindSafe, catch_unwind};

use caustica::assets::MeshStore;
use caustica::config::Limits;
use caustica::frame::Frame;
use caustica::mesh::Mesh;
use caustica::render::Renderer;
use caustica::scene::{ResolvedScene, Scene};
use caustica::stats::Warning;
use serde_json::{Value, json};

use super::harness::{renderer, try_render};

/// Most that an energy account may be open by, where planes do not place the light.
const CLOSURE: f64 = 1e-5;
/// One in this number of scenes is rendered again.
const AGAIN: u64 = 8;
/// Least share of the scenes that must be rendered, not refused: else the generator asks for nonsense.
const RENDERED: f64 = 0.8;
/// Scenes that once failed: unresolved pieces of beams as wide as the floor's map, which one invocation cannot deposit alone;
/// beams of a low sun too small for the account of their workgroup; and footprints 2000 and 70 times longer than wide, whose
/// texels took more than there was.
const ONCE_FAILED: [u64; 4] = [219, 422, 600, 760];

/// SplitMix64 (Steele, Lea, Flood 2014): every seed gives another stream.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 … 1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// As often in each power of ten.
    fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        (self.within(low.ln(), high.ln())).exp()
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    /// One of these, all alike.
    fn of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize].clone()
    }
}

const BOX: &str = include_str!("../../scenes/meshes/box.obj");
/// A closed tetrahedron with a needle for a face, and a face without area.
const SPIKE: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1e-4 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 2\n";

/// A scene; lengths go with `size_m`, so that small and large worlds come as often.
fn scene(random: &mut Random) -> Value {
    let size_m = random.magnitude(1e-2, 1e3);
    let depth_m = size_m * random.of(&[0.0, 1e-4, 0.1, 1.0, 1.0, 1.0, 10.0]);
    let waves: Vec<Value> = (0..random.below(4))
        .map(|_| {
            let wavelength_m = size_m * random.magnitude(0.1, 10.0);
            // Slopes 2π a/λ up to 20, mostly gentle.
            let slope = random.magnitude(1e-4, 20.0).min(random.magnitude(1e-3, 20.0));
            json!({ "kind": "sine", "amplitude_m": (slope * wavelength_m / std::f64::consts::TAU).min(100.0), "wavelength_m": wavelength_m,
                    "direction_deg": random.within(-360.0, 360.0), "phase_deg": random.within(-720.0, 720.0) })
        })
        .collect();
    let rgb = |random: &mut Random, low: f64, high: f64| {
        let one = random.magnitude(low, high);
        let tint = |random: &mut Random| {
            if random.one_in(6) {
                0.0
            } else {
                one * random.within(0.2, 1.0)
            }
        };
        json!([tint(random), tint(random), tint(random)])
    };
    let optical = random.of(&[0.0, 0.0, 0.1, 1.0, 30.0]) / (depth_m + size_m);
    let coefficients = |random: &mut Random, most: f64| -> Value {
        json!([
            most * random.unit(),
            most * random.unit(),
            most * random.unit()
        ])
    };
    let coefficient = coefficients(random, optical);
    let scattering = if random.one_in(3) {
        coefficients(random, optical)
    } else {
        json!([0, 0, 0])
    };
    let lights: Vec<Value> = (0..=random.below(3))
        .map(|_| {
            if random.one_in(3) {
                let position: Vec<f64> = [size_m, depth_m.max(size_m), size_m]
                    .map(|reach| reach * random.within(-1.0, 1.0) * random.of(&[0.0, 1e-3, 1.0, 1.0]))
                    .to_vec();
                json!({ "kind": "point", "position_m": position, "intensity_w_sr": rgb(random, 1e-6, 1e6) })
            } else {
                let elevation = match random.below(3) {
                    0 => random.within(-5.0, 90.0),
                    1 => random.magnitude(1e-3, 10.0),
                    _ => 90.0,
                };
                json!({ "kind": "sun", "elevation_deg": elevation, "azimuth_deg": random.within(-360.0, 360.0),
                        "irradiance_w_m2": rgb(random, 1e-6, 1e6) })
            }
        })
        .collect();
    let objects: Vec<Value> = (0..random.below(3))
        .map(|_| {
            let turn: [f64; 4] = std::array::from_fn(|_| random.within(-1.0, 1.0) + 1e-3);
            let length = turn.iter().map(|q| q * q).sum::<f64>().sqrt();
            json!({ "mesh": random.of(&["box", "spike"]), "scale": size_m * random.magnitude(1e-2, 1.0),
                    "rotation": turn.map(|q| q / length),
                    "translation_m": [size_m * random.within(-0.7, 0.7), -depth_m * random.within(-0.2, 1.2), size_m * random.within(-0.7, 0.7)],
                    "albedo": [random.unit(), random.unit(), random.unit()] })
        })
        .collect();
    let mut quality = json!({
        "water_cells": 2 + random.below(95), "map_texels": 16 + random.below(100), "level_map_texels": random.of(&[16, 32, 64]),
        "split_levels": random.below(4), "layers": 1 + random.below(2), "estimate_error": random.one_in(4)
    });
    let kind = match random.below(6) {
        0 => Some("planes"),
        1 => Some("volumetric"),
        _ => None,
    };
    if let Some(kind) = kind {
        quality["method"] = json!({ "kind": kind, "planes": 2 + random.below(14) });
        quality["layers"] = json!(1);
    }
    let side = size_m * random.magnitude(0.05, 2.0);
    let output = match random.below(3) {
        0 => {
            json!({ "kind": "view", "width": 1 + random.below(48), "height": 1 + random.below(32), "format": "exr",
                     "layers": ["radiance", "irradiance", "depth"] })
        }
        _ => {
            json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [-side, -side], "max_m": [side, side],
                     "width": 1 + random.below(40), "height": 1 + random.below(40) })
        }
    };
    let mut scene = json!({
        "water": { "waves": waves, "ior": random.of(&[1.0, 1.0001, 1.333, 1.333, 1.333, 2.4]),
                   "absorption_per_m": coefficient, "scattering_per_m": scattering },
        "floor": { "depth_m": depth_m, "size_m": [3.0 * size_m, 3.0 * size_m] },
        "lights": lights, "objects": objects, "quality": quality, "output": output,
        "time_s": random.of(&[0.0, 1.0, -1e6, 1e9])
    });
    if scene["output"]["kind"] == "view" {
        let eye: Vec<f64> = [1.0, 2.0, 1.0]
            .map(|reach| size_m * reach * random.within(-1.0, 1.0))
            .to_vec();
        scene["camera"] = json!({ "position_m": eye, "target_m": [0.0, -0.5 * depth_m - 0.01 * size_m, 0.02 * size_m],
                                  "vertical_fov_deg": random.of(&[1.0, 45.0, 120.0]) });
    }
    scene
}

/// The same with what not every scene has: a sky, a map of a mesh, cameras without perspective, several rays a pixel, smaller maps of
/// far objects.
fn varied(mut scene: Value, random: &mut Random) -> Value {
    if random.one_in(3) {
        let radiance = random.magnitude(1e-6, 1e6);
        let sky =
            json!({ "kind": "sky", "radiance_w_m2_sr": [radiance, radiance * random.unit(), 0.0] });
        scene["lights"].as_array_mut().unwrap().push(sky);
    }
    let is_view = scene["output"]["kind"] == "view";
    if is_view {
        scene["quality"]["pixel_samples"] = json!(1 + random.below(3));
        scene["quality"]["level_of_detail"] = random.of(&[json!(0), json!(0), json!(1)]);
        if random.one_in(4) {
            let camera = scene["camera"].as_object_mut().unwrap();
            camera.remove("vertical_fov_deg");
            camera.insert("kind".to_owned(), json!("orthographic"));
            camera.insert("height_m".to_owned(), json!(random.magnitude(1e-3, 1e3)));
        }
    } else {
        let objects = scene["objects"].as_array().unwrap().len() as u64;
        if objects > 0 && random.one_in(2) {
            let lights = scene["lights"].as_array().unwrap().iter();
            let light = lights.take_while(|light| light["kind"] != "sky").count() as u64;
            scene["output"] = json!({ "kind": "irradiance_map", "receiver": random.below(objects), "light": random.below(light) });
        } else {
            scene["output"]["include_sky"] = json!(random.one_in(2));
        }
    }
    scene
}

/// The scene as the service takes it in; `None` where it is refused with findings.
fn resolved(mut value: Value, store: &MeshStore) -> Option<ResolvedScene> {
    let mut meshes: Vec<std::sync::Arc<Mesh>> = Vec::new();
    for object in value["objects"].as_array_mut().unwrap() {
        let text = if object["mesh"] == "box" { BOX } else { SPIKE };
        let mesh = store.insert_obj(text.as_bytes(), &[]).unwrap().mesh;
        object["mesh"] = json!(mesh.id);
        meshes.push(mesh);
    }
    let find = |id: &str| meshes.iter().find(|mesh| mesh.id == id).cloned();
    let resolved = Scene::from_value(value)
        .and_then(|scene| caustica::methods::resolve(scene, &Limits::default(), find));
    match resolved {
        Ok(resolved) => Some(resolved),
        Err(error) => {
            assert!(!error.issues.is_empty());
            assert!(
                error.issues.iter().all(|issue| !issue.accepted.is_empty()),
                "{error}"
            );
            None
        }
    }
}

fn bits(frame: &Frame) -> Vec<Vec<u32>> {
    let layers = frame.layers.values();
    layers
        .map(|layer| layer.data.iter().map(|v| v.to_bits()).collect())
        .collect()
}

/// All lights twice as strong.
fn doubled(mut scene: Value) -> Value {
    for light in scene["lights"].as_array_mut().unwrap() {
        for field in ["irradiance_w_m2", "intensity_w_sr", "radiance_w_m2_sr"] {
            for value in light
                .get_mut(field)
                .and_then(Value::as_array_mut)
                .into_iter()
                .flatten()
            {
                *value = json!(2.0 * value.as_f64().unwrap());
            }
        }
    }
    scene
}

/// Checks one scene; by how much its worst account is open, or `None` where it was refused.
fn check(renderer: &mut Renderer, store: &MeshStore, value: &Value, again: bool) -> Option<f64> {
    let scene = resolved(value.clone(), store)?;
    let frame = match try_render(renderer, &scene) {
        Ok(frame) => frame,
        Err(caustica::render::RenderError::Scene(error)) => {
            assert!(!error.issues.is_empty());
            return None;
        }
        Err(error) => panic!("{error}"),
    };
    renderer.gpu().check().unwrap();
    for (name, layer) in &frame.layers {
        assert!(layer.data.iter().all(|v| v.is_finite()), "{name:?}");
    }
    let by_planes = value["quality"].get("method").is_some();
    let mut worst = 0.0;
    for account in frame.stats.energy.iter().filter(|_| !by_planes) {
        worst = f64::max(worst, account.closure);
        assert!(
            account.closure <= CLOSURE,
            "open by {:e}: {account:?}",
            account.closure
        );
    }
    for warning in &frame.stats.warnings {
        let tells = warning
            .flux_w
            .is_some_and(|flux| flux.iter().all(|v| v.is_finite()));
        let need_not = Warning::WITHOUT_FLUX.contains(&warning.code.as_str());
        assert!(tells || need_not, "{warning:?}");
    }
    if again {
        let second = try_render(renderer, &scene).unwrap();
        assert!(
            bits(&frame) == bits(&second),
            "another picture the second time"
        );
    }
    let twice = try_render(renderer, &resolved(doubled(value.clone()), store).unwrap()).unwrap();
    for name in [
        caustica::scene::LayerName::Irradiance,
        caustica::scene::LayerName::Radiance,
    ] {
        let (Some(one), Some(two)) = (frame.layers.get(&name), twice.layers.get(&name)) else {
            continue;
        };
        for (at, (a, b)) in one.data.iter().zip(&two.data).enumerate() {
            // The fourth channel is no light.
            let is_light = at % one.channels < 3;
            // Below the smallest normal number f32 has fewer digits, and a GPU may have none: of what is added up, a ray's light or a
            // light's, such parts get lost, and of the doubled fewer.
            let is_exact = (2.0 * a - b).abs() <= 4.0 * f32::MIN_POSITIVE;
            assert!(!is_light || is_exact, "{name:?} {at}: {a:e}, doubled {b:e}");
        }
    }
    Some(worst)
}

#[test]
fn random_scenes_are_finite_closed_linear_and_the_same_again() {
    let number = |name: &str| -> Option<u64> {
        let text = std::env::var(name).ok()?;
        Some(
            text.parse()
                .unwrap_or_else(|_| panic!("{name} is a number")),
        )
    };
    let cases = number("CAUSTICA_PROPERTY_CASES").unwrap_or(100);
    let seeds: Vec<u64> = match number("CAUSTICA_PROPERTY_SEED") {
        Some(seed) => vec![seed],
        None => (0..cases).chain(ONCE_FAILED).collect(),
    };
    let scenes = seeds.len();
    let store = MeshStore::new(&Limits::default());
    let mut renderer = renderer();
    let mut rendered = 0_usize;
    let mut worst = (0.0, 0);
    let mut failed = Vec::new();
    for seed in seeds {
        let plain = scene(&mut Random(seed));
        let value = if ONCE_FAILED.contains(&seed) {
            plain
        } else {
            varied(plain, &mut Random(!seed))
        };
        let checked = catch_unwind(AssertUnwindSafe(|| {
            check(&mut renderer, &store, &value, seed % AGAIN == 0)
        }));
        match checked {
            Ok(None) => {}
            Ok(Some(closure)) => {
                rendered += 1;
                if closure > worst.0 {
                    worst = (closure, seed);
                }
            }
            Err(_) => {
                println!("scene {seed}: {value}");
                failed.push(seed);
            }
        }
    }
    println!(
        "{rendered} of {scenes} scenes rendered, the others refused; accounts are open by {:.1e} at most (scene {})",
        worst.0, worst.1
    );
    assert!(failed.is_empty(), "scenes {failed:?} of {scenes}");
    assert!(
        scenes == 1 || rendered as f64 >= RENDERED * scenes as f64,
        "{rendered} of {scenes}"
    );
}
