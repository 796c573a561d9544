//! Point lights without a GPU: validation, ray directions, and the float64 reference against the closed form.

use caustica::accuracy::metrics::relative_l1;
use caustica::config::Limits;
use caustica::facts::SceneFacts;
use caustica::facts::source::Source;
use caustica::physics::refraction::{entry_distance, refract_direction};
use caustica::physics::solid_angle::solid_angle;
use caustica::reference::closed_form::LampOverFlatWater;
use caustica::scene::Scene;
use caustica::waves::normal;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

use super::reference::count;
use super::scene_files;

/// A lamp over a pool of 2 m; the map is 2 m × 2 m.
pub(crate) fn pool(position_m: [f64; 3], water: Value, side: u32) -> Value {
    json!({
        "water": water,
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [{ "kind": "point", "position_m": position_m, "intensity_w_sr": [1, 2, 3] }],
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": side, "height": side }
    })
}

fn waves() -> Value {
    json!({ "waves": [
        { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.3, "direction_deg": 20 },
        { "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.5, "direction_deg": 100, "phase_deg": 60 }
    ] })
}

fn findings(value: &Value) -> Vec<(String, String)> {
    match Scene::from_value(value.clone()).and_then(|s| s.validate(&Limits::default())) {
        Ok(()) => Vec::new(),
        Err(error) => error
            .issues
            .into_iter()
            .map(|issue| (issue.pointer, issue.accepted))
            .collect(),
    }
}

#[test]
fn a_point_light_is_read_strictly_and_checked() {
    let good = pool([0.0, 1.0, 0.0], json!({}), 8);
    assert_eq!(findings(&good), []);
    let with = |pointer: &str, value: Value| {
        let mut scene = good.clone();
        *scene.pointer_mut(pointer).unwrap() = value;
        let found = findings(&scene);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].clone()
    };
    let (pointer, accepted) = with("/lights/0/position_m/1", json!(2e8));
    assert_eq!(pointer, "/lights/0/position_m/1");
    assert_eq!(accepted, "a number, -1e8 … 1e8 m");
    let (pointer, accepted) = with("/lights/0/intensity_w_sr/2", json!(-1));
    assert_eq!(pointer, "/lights/0/intensity_w_sr/2");
    assert_eq!(accepted, "a number, 0 … 1e9 W/sr");
    with("/lights/0/position_m", json!([0, 1]));
    let mut unknown = good.clone();
    unknown["lights"][0]["power_w"] = json!(3);
    assert_eq!(findings(&unknown)[0].0, "/lights/0/power_w");
    let mut missing = good.clone();
    missing["lights"][0]
        .as_object_mut()
        .unwrap()
        .remove("intensity_w_sr");
    let found = findings(&missing);
    assert_eq!(found[0].0, "/lights/0/intensity_w_sr");
    assert!(found[0].1.contains("W/sr"), "{found:?}");
}

fn facts(scene: Value) -> SceneFacts {
    caustica::methods::facts_with_warnings(&scene_files::scene(scene)).unwrap()
}

#[test]
fn the_waves_at_that_time_decide_whether_a_light_is_under_water() {
    // A crest of 3 cm stands over the light at 2 cm; half a period later there is a trough.
    let at = |time_s: f64, y: f64| {
        let water = json!({ "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1,
                                        "phase_deg": 90, "period_s": 2 }] });
        let mut scene = pool([0.0, y, 0.0], water, 8);
        scene["time_s"] = json!(time_s);
        facts(scene).lights.beam_sets[0].source
    };
    assert!(matches!(at(0.0, 0.02), Source::Submerged { .. }));
    assert!(matches!(at(1.0, 0.02), Source::Point { .. }));
    assert!(matches!(at(1.0, -0.02), Source::Point { .. }));
    assert!(matches!(at(1.0, -0.04), Source::Submerged { .. }));
    // On flat water to the millimetre.
    let flat = |y: f64| facts(pool([0.0, y, 0.0], json!({}), 8)).lights.beam_sets[0].source;
    assert!(matches!(flat(0.001), Source::Point { .. }));
    assert!(matches!(flat(0.0), Source::Submerged { .. }));
}

#[test]
fn light_that_is_not_followed_is_reported() {
    let codes = |scene: Value| -> Vec<String> {
        let warnings = facts(scene).warnings;
        assert!(
            warnings
                .iter()
                .all(|w| w.pointer.as_deref() == Some("/lights/0"))
        );
        warnings.into_iter().map(|w| w.code).collect()
    };
    assert_eq!(codes(pool([0.0, 1.0, 0.0], json!({}), 8)), [""; 0]);
    let under = pool([0.0, -1.0, 0.0], json!({}), 8);
    assert_eq!(codes(under.clone()), ["light_from_below_not_followed"]);
    let flux = facts(under).warnings[0].flux_w.unwrap();
    assert_eq!(flux, [1.0, 2.0, 3.0].map(|i| i * std::f64::consts::TAU));
    assert_eq!(
        codes(pool([0.0, -2.0, 0.0], json!({}), 8)),
        ["light_under_floor"]
    );
    assert_eq!(
        codes(pool([0.0, 1e-9, 0.0], json!({}), 8)),
        ["light_close_to_water"]
    );
    let mut around = pool([0.0, -1.0, 0.0], json!({}), 8);
    around["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, -1, 0] }]);
    assert_eq!(
        codes(around),
        ["light_from_below_not_followed", "light_within_object"]
    );
}

#[test]
fn exposure_is_a_number_wherever_the_light_is() {
    for y in [1e6, 1.0, 1e-9, 0.0, -1.0, -2.0, -1e6] {
        let facts = facts(pool([0.0, y, 0.0], json!({}), 8));
        assert!(
            facts.lights.white_radiance.is_finite() && facts.lights.white_radiance > 0.0,
            "{y}"
        );
    }
    // 3 m above the floor's middle: 2 W/sr on the mean, over 9 m².
    let facts = facts(pool([0.0, 1.0, 0.0], json!({}), 8));
    let expected = 2.0 / 9.0 / std::f64::consts::PI;
    assert!((facts.lights.white_radiance / expected - 1.0).abs() < 1e-12);
}

#[test]
fn level_maps_are_drawn_along_the_refracted_ray_to_the_objects_middle() {
    for (lamp, object) in [
        ([0.7, 1.1, -0.4], [0.0, -1.0, 0.2]),
        ([3.0, 0.05, 0.0], [-0.5, -1.5, 0.0]),
        ([0.0, 2.0, 0.0], [0.0, -1.0, 0.0]),
        ([0.3, -0.4, 0.1], [-0.2, -1.2, 0.4]),
    ] {
        let mut scene = pool(lamp, json!({}), 8);
        scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": object, "scale": 0.3 }]);
        let facts = facts(scene);
        let axis = facts.lights.lit[0].boxes[0].as_ref().unwrap().axis;
        let middle = (facts.receivers.objects[0].min + facts.receivers.objects[0].max) * 0.5;
        let lamp_m = DVec3::from(lamp);
        if lamp[1] < 0.0 {
            let straight = (middle - lamp_m).normalize();
            assert!((axis - straight).length() < 2e-6, "{axis} and {straight}");
            continue;
        }
        // Back along the axis to the water, and from there to the light: Snell's law holds, and all in one plane.
        let entry = middle + axis * (middle.y / -axis.y);
        let incident = (entry - lamp_m).normalize();
        let refracted = refract_direction(incident, DVec3::Y, facts.water.ior).unwrap();
        assert!(
            (axis - refracted).length() < 2e-5,
            "{lamp:?}: {axis} and {refracted}"
        );
    }
}

#[test]
fn the_entry_point_takes_the_least_time() {
    // Fermat: the optical path over all entry points is least where Snell's law holds.
    for (h, d, r, n) in [
        (1.0, 2.0, 3.0, 1.333),
        (0.01, 1.0, 5.0, 1.333),
        (5.0, 0.1, 1.0, 1.0),
    ] {
        let path = |x: f64| f64::hypot(h, x) + n * f64::hypot(d, r - x);
        let x = entry_distance(h, d, r, n);
        for step in [-1e-3, 1e-3] {
            assert!(path(x) <= path(x + step * r), "{h} {d} {r} {n}: {x}");
        }
    }
    assert_eq!(entry_distance(1.0, 1.0, 0.0, 1.333), 0.0);
    assert_eq!(entry_distance(1.0, 0.0, 2.0, 1.333), 2.0);
}

#[test]
fn solid_angles_of_known_triangles() {
    use std::f64::consts::{FRAC_PI_2, PI};
    let octant = solid_angle(DVec3::X, DVec3::Y - DVec3::X, DVec3::Z - DVec3::X);
    assert!((octant - FRAC_PI_2).abs() < 1e-15);
    // A plane's quarter seen from just above its corner region: a huge square is half of all directions.
    let corner = DVec3::new(-1e6, -1.0, -1e6);
    let side = 2e6;
    let half = solid_angle(
        corner,
        DVec3::new(side, 0.0, 0.0),
        DVec3::new(side, 0.0, side),
    ) + solid_angle(
        corner,
        DVec3::new(side, 0.0, side),
        DVec3::new(0.0, 0.0, side),
    );
    assert!((half - 2.0 * PI).abs() < 1e-5, "{half}");
    // Small: area over the distance squared; turned over: the negative; at a corner: nothing.
    let (a, b, c) = (
        DVec3::new(0.0, -2.0, 0.0),
        DVec3::X * 1e-4,
        DVec3::new(0.0, 0.0, 1e-4),
    );
    assert_eq!(solid_angle(a, b, c), -solid_angle(a, c, b));
    assert!((solid_angle(a, b, c) / (0.5e-8 / 4.0) - 1.0).abs() < 1e-7);
    assert_eq!(solid_angle(DVec3::ZERO, b, c), 0.0);
}

/// No light that lands on a receiver enters beside the window.
#[test]
fn windows_lose_no_light() {
    let mut checked = 0;
    for lamp in [
        [0.0, 0.05, 0.0],
        [0.4, 0.5, -0.3],
        [3.0, 0.3, 1.0],
        [-0.9, 2.0, 0.9],
        [30.0, 1.0, 0.0],
    ] {
        for water in [json!({}), waves(), json!({ "ior": 1.0 })] {
            let mut scene = pool(lamp, water, 8);
            scene["objects"] =
                json!([{ "mesh": "box.obj", "translation_m": [0.5, -0.3, 0], "scale": 0.2 }]);
            let facts = facts(scene);
            let light = &facts.lights.beam_sets[0];
            let Source::Point { position_m } = light.source else {
                continue; // a crest stands over it
            };
            let map = facts.receivers.floor_map.unwrap().rect;
            // Every place of a region far wider than the window, and a fine one around the light.
            let n = 400;
            for (middle, half) in [
                (DVec2::ZERO, 6.0),
                (DVec2::new(position_m.x, position_m.z), 0.6),
            ] {
                for j in 0..n {
                    for i in 0..n {
                        let at = |k: u32| half * (2.0 * (f64::from(k) + 0.37) / f64::from(n) - 1.0);
                        let place = middle + DVec2::new(at(i), at(j));
                        let water = facts.water.surface.at(place.x, place.y);
                        let from = DVec3::new(place.x, water.height_m, place.y);
                        let to_light = (position_m - from).normalize();
                        let normal = normal(water);
                        if normal.dot(to_light) <= 0.0 {
                            continue;
                        }
                        let Some(ray) = refract_direction(-to_light, normal, facts.water.ior)
                        else {
                            continue;
                        };
                        if ray.y > -1e-2 {
                            continue;
                        }
                        let hit = from + ray * ((from.y + 2.0) / -ray.y);
                        let lands = hit.x > map.min.x
                            && hit.x < map.max.x
                            && hit.z > map.min.y
                            && hit.z < map.max.y;
                        if lands {
                            checked += 1;
                            let inside = place.cmpge(light.window.min).all()
                                && place.cmple(light.window.max).all();
                            assert!(inside, "{lamp:?}: {place} is not in {:?}", light.window);
                        }
                    }
                }
            }
            // And the grid covers it, corner to corner.
            let grid = &light.grid;
            let corner = |s: DVec2| grid.foot_m + s * (1.0 + grid.bend_per_m2 * s * s);
            assert!((corner(grid.places.min) - light.window.min).length() < 1e-9);
            assert!((corner(grid.places.max) - light.window.max).length() < 1e-9);
        }
    }
    assert!(checked > 10_000, "{checked}");
}

/// The window of a lamp close to the water is small: its light spreads from near its foot.
#[test]
fn windows_are_no_wider_than_light_needs() {
    let facts = facts(pool([0.0, 0.05, 0.0], json!({}), 8));
    let size = facts.lights.beam_sets[0].window.size();
    // From r = ρ + 2 m · tan θ_t: what lands 1.42 m aside (the map's corner) has entered 0.06 m aside.
    assert!(size.max_element() < 0.2, "{size}");
}

/// Flat water of this index and extinction, alike in all channels.
fn flat_water(ior: f64, absorption: f64) -> Value {
    json!({ "ior": ior, "absorption_per_m": [absorption, absorption, absorption] })
}

/// Rays of the maps that are compared with closed forms.
const RAYS: u64 = 40_000_000;

/// Mean over each texel of the closed form, from 4 × 4 points.
pub(crate) fn closed_form_map(lamp: &LampOverFlatWater, foot: [f64; 2], side: usize) -> Vec<f64> {
    (0..side * side)
        .map(|texel| {
            let mut sum = 0.0;
            for j in 0..4 {
                for i in 0..4 {
                    let at = |k: usize, sub: usize| {
                        2.0 * (k as f64 + (sub as f64 + 0.5) / 4.0) / side as f64 - 1.0
                    };
                    let x = at(texel % side, i) - foot[0];
                    let z = at(texel / side, j) - foot[1];
                    sum += lamp.irradiance_at(x.hypot(z)) / 16.0;
                }
            }
            sum
        })
        .collect()
}

#[test]
fn the_reference_agrees_with_the_closed_form() {
    for (y, ior, absorption, bound) in [
        (1.0, 1.333, 0.0, 1e-3),
        (0.3, 1.333, 0.2, 2e-3),
        (4.0, 1.5, 0.1, 1e-3),
        (-0.5, 1.333, 0.3, 1e-3),
    ] {
        let resolved = scene_files::scene(pool([0.2, y, -0.1], flat_water(ior, absorption), 32));
        let map = count(&resolved, RAYS);
        let lamp = LampOverFlatWater {
            height_m: y,
            depth_m: 2.0,
            ior,
            extinction_per_m: absorption,
        };
        let expected = closed_form_map(&lamp, [0.2, -0.1], 32);
        for c in 0..3 {
            let found: Vec<f64> = map
                .irradiance
                .iter()
                .map(|t| t[c] / [1.0, 2.0, 3.0][c])
                .collect();
            let error = relative_l1(&found, &expected).unwrap();
            let worst = found
                .iter()
                .zip(&expected)
                .map(|(a, b)| (a / b - 1.0).abs())
                .fold(0.0, f64::max);
            println!(
                "{y} m, channel {c}: L1 {error:.1e}, worst texel {worst:.1e}, estimate {:.1e}",
                map.relative_error
            );
            assert!(error < bound, "{y} m: {error:e}");
            assert!(
                error < 1.5 * map.relative_error.max(5e-4),
                "{y} m: {error:e}"
            );
        }
        crate::reference::assert_energy_closes(&map);
    }
}

/// The solid angle under which flat water sees the light is what the reference says falls on it.
#[test]
fn the_reference_emits_the_solid_angle_of_its_window() {
    let resolved = scene_files::scene(pool([0.2, 1.0, -0.1], flat_water(1.333, 0.0), 32));
    let map = count(&resolved, RAYS);
    let window = map.windows[0];
    let corner = DVec3::new(window.min_m.x - 0.2, -1.0, window.min_m.y + 0.1);
    let x = DVec3::X * (window.max_m.x - window.min_m.x);
    let z = DVec3::Z * (window.max_m.y - window.min_m.y);
    let whole = (solid_angle(corner, x, x + z) + solid_angle(corner, x + z, z)).abs();
    let error = (map.energy.emitted_w[0] / whole - 1.0).abs();
    assert!(error < 1e-4, "{error:e}");
}
