//! The reference for point lights: almost on the water, in views, and in maps on objects; against closed forms, against
//! directions from the light, and against itself.

use std::f64::consts::TAU;

use caustica::accuracy::metrics::relative_l1;
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::physics::refraction::{entry_distance, refract_direction};
use caustica::reference::closed_form::LampOverFlatWater;
use caustica::reference::{TruthKind, TruthSettings, truth};
use caustica::scene::ResolvedScene;
use caustica::waves::{Surface, normal};
use glam::{DVec2, DVec3, Vec3};
use serde_json::{Value, json};

use super::lamps;
use super::reference::count;
use super::scene_files::{self, mesh_of, with_meshes};
use super::truth::box_obj;
use super::truths::truth_to as find;

/// Extinction of the red channel of [`pool`], 1/m.
const EXTINCTION_PER_M: f64 = 0.3;
const IOR: f64 = 1.333;

fn lamp(position_m: [f64; 3]) -> Value {
    json!({ "kind": "point", "position_m": position_m, "intensity_w_sr": [30, 20, 10] })
}

/// A pool with a box of half sizes `half`; `change` edits the JSON.
fn pool(half: Vec3, lights: Value, change: impl FnOnce(&mut Value)) -> ResolvedScene {
    let mesh = mesh_of(box_obj(half).as_bytes());
    let mut value = json!({
        "water": { "waves": [], "absorption_per_m": [EXTINCTION_PER_M, 0.06, 0.0] },
        "floor": { "depth_m": 1.5, "size_m": [20, 20] },
        "lights": lights,
        "objects": [{ "mesh": mesh.id, "translation_m": [0.15, -1, 0] }],
        "quality": { "level_map_texels": 32 },
        "camera": { "kind": "orthographic", "position_m": [0, -1.2, 0], "target_m": [0, -1.5, 0], "up": [0, 0, -1], "height_m": 0.8 },
        "output": { "kind": "view", "width": 16, "height": 16 }
    });
    change(&mut value);
    with_meshes(value, &[mesh])
}

fn waves() -> Value {
    json!([
        { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9, "direction_deg": 10 },
        { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.6, "direction_deg": 110, "phase_deg": 70 }
    ])
}

/// Height of [`waves`] at a place, m.
fn wave_height_m(x_m: f64, z_m: f64) -> f64 {
    let scene = pool(Vec3::ONE, json!([]), |v| v["water"]["waves"] = waves());
    Surface::of(&scene).unwrap().at(x_m, z_m).height_m
}

fn error(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    relative_l1(a.as_flattened(), b.as_flattened()).unwrap()
}

/// An even lattice steps over all the light of a lamp that almost touches the water, both halves are black, and black equals black.
#[test]
fn a_lamp_a_millimetre_above_flat_water_gives_the_closed_form() {
    for y in [1e-3, 1e-6] {
        let resolved = scene_files::scene(lamps::pool([0.1, y, 0.05], json!({}), 16));
        let map = count(&resolved, 4_000_000);
        let lamp = LampOverFlatWater {
            height_m: y,
            depth_m: 2.0,
            ior: IOR,
            extinction_per_m: 0.0,
        };
        let expected = lamps::closed_form_map(&lamp, [0.1, 0.05], 16);
        let found: Vec<f64> = map.irradiance.iter().map(|t| t[0]).collect();
        let error = relative_l1(&found, &expected).unwrap();
        println!("{y} m: L1 {error:.1e}, estimate {:.1e}", map.relative_error);
        assert!(error < 1e-2, "{y} m: {error:e}");
        assert!(error < 1.5 * map.relative_error, "{y} m: {error:e}");
        crate::reference::assert_energy_closes(&map);
    }
}

/// The same under water: a millimetre above the floor half of all light lands within a few millimetres.
#[test]
fn a_lamp_a_millimetre_above_the_floor_lights_half_of_all_directions() {
    let resolved = scene_files::scene(lamps::pool([0.1, -1.999, 0.05], json!({}), 16));
    let landed = count(&resolved, 100_000).landed_w[0][0];
    // What passes over the rim of the map, which is 0.9 m away or more, is less than 2π · 1 mm / 0.9 m of it.
    assert!((landed / TAU - 1.0).abs() < 1.5e-3, "{landed}");
}

/// The map of a lamp over waves from directions that leave the light evenly, each followed to every place where it goes down through
/// the water: waves do not shade each other.
fn from_directions(scene: &ResolvedScene, lamp_m: DVec3, directions: u32, side: usize) -> Vec<f64> {
    let surface = Surface::of(scene).unwrap();
    let crest_m = surface.max_height_m();
    let gap_m = |p: DVec3| p.y - surface.at(p.x, p.z).height_m;
    let mut texels = vec![0.0; side * side];
    for j in 0..directions {
        for i in 0..directions {
            // Cosines with straight down from 1 to a little below 0: the flanks of waves face the light from above it too.
            let cosine = 1.0 - 1.4 * (f64::from(j) + 0.5) / f64::from(directions);
            let sine = (1.0 - cosine * cosine).sqrt();
            let azimuth = TAU / f64::from(directions)
                * (f64::from(i) + (f64::from(j) * 0.618_033_988_749_895).fract());
            let way = DVec3::new(sine * azimuth.cos(), -cosine, sine * azimuth.sin());
            let end_m = ((lamp_m.y + crest_m.copysign(cosine)) / cosine)
                .abs()
                .min(8.0);
            let steps = (end_m / 0.02).ceil() as u32;
            let at = |step: u32| end_m * f64::from(step) / f64::from(steps);
            for step in 0..steps {
                let (mut low, mut high) = (at(step), at(step + 1));
                if gap_m(lamp_m + way * low) < 0.0 || gap_m(lamp_m + way * high) >= 0.0 {
                    continue;
                }
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    if gap_m(lamp_m + way * middle) >= 0.0 {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                let from_m = lamp_m + way * low;
                let n = normal(surface.at(from_m.x, from_m.z));
                let Some(ray) = refract_direction(way, n, IOR).filter(|ray| ray.y < 0.0) else {
                    continue;
                };
                let to_m = from_m + ray * ((from_m.y + 2.0) / -ray.y);
                let texel = (DVec2::new(to_m.x, to_m.z) + 1.0) * (0.5 * side as f64);
                if texel.min_element() >= 0.0 && texel.max_element() < side as f64 {
                    let at = texel.y as usize * side + texel.x as usize;
                    texels[at] += fresnel_transmittance(-way.dot(n), IOR);
                }
            }
        }
    }
    let per_direction = 1.4 * TAU / f64::from(directions).powi(2);
    let texel_m2 = (2.0 / side as f64).powi(2);
    texels
        .iter()
        .map(|t| t * per_direction / texel_m2)
        .collect()
}

#[test]
fn a_lamp_a_millimetre_above_a_wave_is_what_directions_from_it_say() {
    let water = json!({ "waves": waves() });
    let y_m = wave_height_m(0.1, 0.05) + 1e-3;
    let resolved = scene_files::scene(lamps::pool([0.1, y_m, 0.05], water, 16));
    let map = count(&resolved, 4_000_000);
    let expected = from_directions(&resolved, DVec3::new(0.1, y_m, 0.05), 1000, 16);
    let found: Vec<f64> = map.irradiance.iter().map(|t| t[0]).collect();
    let error = relative_l1(&found, &expected).unwrap();
    println!("L1 {error:.1e}, estimate {:.1e}", map.relative_error);
    assert!(error < 1.5e-2, "{error:e}");
}

/// Irradiance of the red channel at a point with unit normal in flat water, W/m².
fn closed_form(lamp_m: DVec3, p_m: DVec3, normal: DVec3) -> f64 {
    let aside_m = DVec2::new(p_m.x - lamp_m.x, p_m.z - lamp_m.z);
    let (r, depth_m) = (aside_m.length(), -p_m.y);
    let ray = if lamp_m.y > 0.0 {
        let under_m = r - entry_distance(lamp_m.y, depth_m, r, IOR);
        let along = aside_m.normalize_or_zero() * under_m;
        DVec3::new(along.x, -depth_m, along.y).normalize()
    } else {
        (p_m - lamp_m).normalize()
    };
    let level = LampOverFlatWater {
        height_m: lamp_m.y,
        depth_m,
        ior: IOR,
        extinction_per_m: EXTINCTION_PER_M,
    };
    // The level plane shows the rays −t_y, the tilted one −t·n.
    30.0 * level.irradiance_at(r) * (ray.dot(normal) / ray.y)
}

#[test]
fn a_floor_in_flat_water_seen_from_above_is_the_closed_form() {
    for y in [1.0, 1e-3, -0.5] {
        let lamp_m = [0.1, y, 0.05];
        // The box is far aside.
        let scene = pool(Vec3::splat(0.1), json!([lamp(lamp_m)]), |v| {
            v["objects"][0]["translation_m"] = json!([5, -1, 0]);
        });
        let view = find(&scene, 3e-3);
        assert_eq!(view.kind, TruthKind::View);
        let side = 16;
        let expected: Vec<f64> = (0..side * side)
            .map(|at| {
                let place =
                    |k: usize, sub: usize| (k as f64 + (sub as f64 + 0.5) / 4.0) * 0.05 - 0.4;
                let points = (0..16).map(|p| {
                    let p_m = DVec3::new(place(at % side, p % 4), -1.5, place(at / side, p / 4));
                    closed_form(DVec3::from(lamp_m), p_m, DVec3::Y)
                });
                points.sum::<f64>() / 16.0
            })
            .collect();
        let found: Vec<f64> = view.irradiance.iter().map(|e| e[0]).collect();
        let error = relative_l1(&found, &expected).unwrap();
        println!(
            "{y} m: L1 {error:.1e}, estimate {:.1e}",
            view.relative_error
        );
        assert!(view.relative_error <= 3e-3);
        assert!(
            error < 1.5 * view.relative_error.max(1e-3),
            "{y} m: {error:e}"
        );
        assert!(view.shadow.unwrap().iter().all(|&share| share == 0.0));
    }
}

#[test]
fn a_tilted_plate_follows_the_cosine() {
    for (y, tilt_deg) in [(0.8, 25.0f64), (2.0, -40.0), (1e-3, 25.0), (-0.3, 25.0)] {
        let lamp_m = DVec3::new(0.5, y, 0.2);
        let (half_sin, half_cos) = (tilt_deg.to_radians() / 2.0).sin_cos();
        let (sin, cos) = tilt_deg.to_radians().sin_cos();
        let normal = DVec3::new(-sin, cos, 0.0);
        let middle_m = DVec3::new(0.0, -1.0, 0.0) + normal * 0.0005;
        let eye_m = middle_m + normal * 0.3;
        let side_m = 0.02;
        let plate = |v: &mut Value| {
            v["objects"][0]["translation_m"] = json!([0, -1, 0]);
            v["objects"][0]["rotation"] = json!([0, 0, half_sin, half_cos]);
        };
        let half = Vec3::new(0.3, 0.0005, 0.3);
        let expected = closed_form(lamp_m, middle_m, normal);
        let view = pool(half, json!([lamp(lamp_m.to_array())]), |v| {
            plate(v);
            v["camera"] = json!({ "kind": "orthographic", "position_m": eye_m.to_array(), "target_m": middle_m.to_array(), "up": [0, 0, 1], "height_m": side_m });
            v["output"] = json!({ "kind": "view", "width": 1, "height": 1 });
        });
        // All rays at once: two halves of one value may be alike by chance.
        let many = TruthSettings {
            target_error: None,
            max_rays: 1_000_000,
            ..TruthSettings::default()
        };
        let seen = truth(&view, &many, &|_| (), &|| false).unwrap().irradiance[0][0];
        println!("{y} m, {tilt_deg}°: seen {:.1e}", seen / expected - 1.0);
        assert!(
            (seen / expected - 1.0).abs() < 2e-3,
            "{y}: {seen}, {expected}"
        );

        // Of the map the four texels around the middle; the axis shifts the thin plate's top by half a millimetre at most.
        let map = pool(half, json!([lamp(lamp_m.to_array())]), |v| {
            plate(v);
            v["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
        });
        let map = find(&map, 1e-3);
        assert_eq!(
            (map.kind, map.width, map.height),
            (TruthKind::ObjectMap, 32, 32)
        );
        let four = [15 * 32 + 15, 15 * 32 + 16, 16 * 32 + 15, 16 * 32 + 16];
        let mapped = four.iter().map(|&at| map.irradiance[at][0]).sum::<f64>() / 4.0;
        println!("{y} m, {tilt_deg}°: mapped {:.1e}", mapped / expected - 1.0);
        assert!(
            (mapped / expected - 1.0).abs() < 1e-2,
            "{y}: {mapped}, {expected}"
        );
    }
}

/// Two independent engines: the search from each square, and plain rays counted on the floor.
#[test]
fn points_on_the_floor_agree_with_the_map_of_the_floor() {
    let near_m = wave_height_m(0.1, 0.05) + 1e-3;
    for y in [0.7, near_m, -0.4] {
        let with = |change: &dyn Fn(&mut Value)| {
            pool(Vec3::splat(0.1), json!([lamp([0.1, y, 0.05])]), |v| {
                v["water"]["waves"] = waves();
                change(v);
            })
        };
        let view = with(&|_| ());
        let map = with(&|v| {
            v["output"] = json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [-0.4, -0.4], "max_m": [0.4, 0.4], "width": 16, "height": 16 });
        });
        let (points, texels) = (find(&view, 4e-3), find(&map, 4e-3));
        let error = error(&points.irradiance, &texels.irradiance);
        println!(
            "{y:.4} m: L1 {error:.1e}, estimates {:.1e} and {:.1e}",
            points.relative_error, texels.relative_error
        );
        assert!(
            error < 1.5 * (points.relative_error + texels.relative_error),
            "{y}: {error:e}"
        );
        let (a, b) = (points.shadow.unwrap(), texels.shadow.unwrap());
        assert!(b.iter().any(|&share| share > 0.9), "the box casts a shadow");
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 0.06, "{y}: {a} {b}");
        }
    }
}

#[test]
fn the_map_on_a_plate_has_the_light_that_landed_on_it() {
    // Whole texels: 28 and 20 of them; too thin for its sides to take light.
    let half = Vec3::new(0.4, 0.002, 0.4 * 20.0 / 28.0);
    for y in [0.7, -0.4] {
        let with = |output: Value| {
            pool(half, json!([lamp([0.0, y, 0.0])]), |v| {
                v["water"]["waves"] = waves();
                v["objects"][0]["translation_m"] = json!([0, -1, 0]);
                v["output"] = output;
            })
        };
        let map = find(
            &with(json!({ "kind": "irradiance_map", "receiver": 0 })),
            4e-3,
        );
        let counted = count(
            &with(
                json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 32, "height": 32 }),
            ),
            4_000_000,
        );
        // Under a lamp right above the texels of the map lie level.
        let side_m = 2.0 * 0.4 / 28.0;
        for c in 0..3 {
            let total = map.irradiance.iter().map(|e| e[c]).sum::<f64>() * side_m * side_m;
            let landed = counted.landed_w[1][c];
            println!("{y} m: {:.1e}", total / landed - 1.0);
            assert!((total / landed - 1.0).abs() < 3e-3, "{y}: {total} {landed}");
        }
    }
}

#[test]
fn suns_and_lamps_add_up() {
    let lights = [
        json!({ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [10, 20, 30] }),
        lamp([0.3, 0.8, -0.2]),
        lamp([-0.2, -0.5, 0.1]),
        lamp([0.2, -1.6, 0.1]), // under the floor: nothing
    ];
    let with = |lights: &[Value]| {
        find(
            &pool(Vec3::splat(0.1), json!(lights), |v| {
                v["water"]["waves"] = waves();
            }),
            4e-3,
        )
    };
    let all = with(&lights);
    let mut sum = vec![[0.0; 3]; all.irradiance.len()];
    for light in &lights {
        for (sum, e) in sum
            .iter_mut()
            .zip(with(std::slice::from_ref(light)).irradiance)
        {
            for c in 0..3 {
                sum[c] += e[c];
            }
        }
    }
    let error = error(&sum, &all.irradiance);
    println!("sum of single lights: {error:.1e}");
    assert!(error < 8e-3, "{error:e}");
    let buried = with(&lights[3..]);
    assert!(buried.irradiance.iter().flatten().all(|&e| e == 0.0));
}

#[test]
fn a_dry_table_is_lit_by_the_lamp_in_the_air_only() {
    let lights = json!([lamp([0.0, 3.0, 0.0]), lamp([0.0, -0.5, 0.0])]);
    let table = |lid: bool| {
        pool(Vec3::splat(0.5), lights.clone(), |v| {
            v["objects"][0]["translation_m"] = json!([0, 0.5, 0]);
            if lid {
                let mut lid = v["objects"][0].clone();
                lid["translation_m"] = json!([0.6, 2, 0]);
                v["objects"].as_array_mut().unwrap().push(lid);
            }
            v["camera"] = json!({ "kind": "orthographic", "position_m": [0, 1.4, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "height_m": 0.5 });
            v["output"] = json!({ "kind": "view", "width": 9, "height": 9 });
        })
    };
    let open = find(&table(false), 1e-3);
    for (at, e) in open.irradiance.iter().enumerate() {
        let place = |k: usize| (k as f64 - 4.0) * 0.5 / 9.0;
        let slant_m = 2.0f64.hypot(place(at % 9).hypot(place(at / 9)));
        let expected = 30.0 * 2.0 / slant_m.powi(3);
        assert!(
            (e[0] / expected - 1.0).abs() < 1e-6,
            "{at}: {e:?}, {expected}"
        );
    }
    // A box between them, from 0.1 m aside on and half way up or higher, shades what lies 0.2 m aside.
    let shaded = find(&table(true), 1e-3);
    assert!(shaded.irradiance[4 * 9].iter().all(|&e| e > 0.0));
    assert!(shaded.irradiance[4 * 9 + 8].iter().all(|&e| e == 0.0));
    assert!(shaded.shadow.unwrap()[4 * 9 + 8] == 1.0);
}

/// A plate over a light under water is lit from below; what of it stands out of the water is not.
#[test]
fn a_light_under_a_plate_shines_up_at_it() {
    let plate = |y: f64| {
        let scene = pool(
            Vec3::new(0.3, 0.01, 0.3),
            json!([lamp([0.0, -1.2, 0.0])]),
            |v| {
                v["objects"][0]["translation_m"] = json!([0, y, 0]);
                v["water"]["waves"] = json!([{ "kind": "sine", "amplitude_m": 1e-4, "wavelength_m": 1, "period_s": 4, "phase_deg": 180 }]);
                v["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
            },
        );
        find(&scene, 2e-3)
    };
    let map = plate(-0.5);
    let (mut found, mut expected) = (Vec::new(), Vec::new());
    for (at, e) in map.irradiance.iter().enumerate() {
        let place_m = |k: usize| (k as f64 - 15.5) * 0.6 / 28.0;
        let aside_m = place_m(at % 32).hypot(place_m(at / 32));
        // Whole texels only.
        if aside_m < 0.28 {
            let r = aside_m.hypot(0.69);
            found.push(e[0]);
            expected.push(30.0 * 0.69 / r.powi(3) * f64::exp(-EXTINCTION_PER_M * r));
        }
    }
    let error = relative_l1(&found, &expected).unwrap();
    println!(
        "from below: L1 {error:.1e}, estimate {:.1e}",
        map.relative_error
    );
    assert!(found.len() > 400);
    assert!(error < 1.5 * map.relative_error, "{error:e}");
    // Its lower face lies under crests and over troughs of a tenth of a millimetre: only the former are wet.
    let wave = plate(0.01);
    let lit = wave.irradiance.iter().filter(|e| e[0] > 0.0).count();
    let inside = wave.compared.iter().filter(|&&inside| inside).count();
    assert!(
        lit * 10 > inside * 2 && lit * 10 < inside * 8,
        "{lit} of {inside}"
    );
}
