//! Views: radiance, refraction, Snell's window, layers, and orientation.

use caustica::frame::Frame;
use caustica::physics::fresnel::{fresnel_reflectance, fresnel_transmittance};
use caustica::physics::refraction::refract_direction;
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::scene::{LayerName, Light};
use glam::DVec3;
use serde_json::{Value, json};

use super::harness::{self, largest_relative};
use super::scene_files;

const IOR: f64 = 1.333;
const ALBEDO: [f64; 3] = [0.7, 0.5, 0.3];
const ABSORPTION: [f64; 3] = [0.35, 0.07, 0.03];
const DEPTH_M: f64 = 2.0;

/// A flat pool under a slanted sun; `camera` looks at it.
fn pool(camera: Value) -> Value {
    json!({
        "water": { "absorption_per_m": ABSORPTION },
        "floor": { "depth_m": DEPTH_M, "size_m": [60, 60], "albedo": ALBEDO },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 20, "irradiance_w_m2": [1000, 900, 800] }],
        "camera": camera,
        "quality": { "water_cells": 64, "map_texels": 64, "level_map_texels": 128 },
        "output": { "kind": "view", "width": 48, "height": 32, "format": "exr",
                    "layers": ["radiance", "depth", "normal", "position", "albedo", "irradiance"] }
    })
}

fn frame(scene: Value) -> Frame {
    harness::render(&scene_files::scene(scene))
}

fn floor_irradiance() -> [f64; 3] {
    let resolved = scene_files::scene(pool(down(3.0)));
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("no sun");
    };
    flat_water_irradiance(&resolved.scene.water, DEPTH_M, sun)
}

/// An orthographic camera at height `y` that looks straight down; the top of the picture is −z.
fn down(y: f64) -> Value {
    json!({ "kind": "orthographic", "position_m": [0, y, 0], "target_m": [0, y - 1.0, 0], "up": [0, 0, -1], "height_m": 1 })
}

/// Every pixel of a layer against one value.
fn assert_even(frame: &Frame, name: LayerName, expected: [f64; 3], tolerance: f64) {
    let seen = harness::layer(frame, name);
    let all: Vec<f64> = seen.iter().flat_map(|_| expected).collect();
    let error = largest_relative(seen.as_flattened(), &all);
    assert!(
        error <= tolerance,
        "{name:?}: {error:e}; {:?} {expected:?}",
        seen[0]
    );
}

#[test]
fn a_floor_seen_from_above_loses_what_fresnel_and_the_solid_angle_take() {
    let frame = frame(pool(down(3.0)));
    let e = floor_irradiance();
    assert_even(&frame, LayerName::Irradiance, e, 1e-4);
    assert_even(&frame, LayerName::Albedo, ALBEDO, 1e-6);
    let through = fresnel_transmittance(1.0, IOR) / (IOR * IOR);
    let expected = std::array::from_fn(|c| {
        ALBEDO[c] / std::f64::consts::PI * e[c] * through * (-ABSORPTION[c] * DEPTH_M).exp()
    });
    assert_even(&frame, LayerName::Radiance, expected, 1e-4);
    let depth = &frame.layers[&LayerName::Depth];
    assert_eq!(depth.channels, 1);
    assert!(
        depth.data.iter().all(|&d| (d - 3.0).abs() <= 1e-4),
        "{}",
        depth.data[0]
    );
    for n in harness::layer(&frame, LayerName::Normal) {
        assert_eq!(n, [0.0, 1.0, 0.0]);
    }
}

#[test]
fn a_floor_seen_from_under_water_does_not() {
    let frame = frame(pool(down(-0.5)));
    let e = floor_irradiance();
    let expected = std::array::from_fn(|c| {
        ALBEDO[c] / std::f64::consts::PI * e[c] * (-ABSORPTION[c] * (DEPTH_M - 0.5)).exp()
    });
    assert_even(&frame, LayerName::Radiance, expected, 1e-4);
    let depth = &frame.layers[&LayerName::Depth];
    assert!(depth.data.iter().all(|&d| (d - 1.5).abs() <= 1e-4));
}

/// A perspective camera in f64: the ray of a pixel, as the scene format describes it.
struct Pinhole {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    size: [u32; 2],
}

impl Pinhole {
    fn new(eye: DVec3, target: DVec3, up: DVec3, fov_deg: f64, size: [u32; 2]) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        let half = (0.5 * fov_deg.to_radians()).tan();
        Self {
            eye,
            forward,
            right: right * half * f64::from(size[0]) / f64::from(size[1]),
            up: right.cross(forward) * half,
            size,
        }
    }

    fn json(&self, target: DVec3, up: DVec3, fov_deg: f64) -> Value {
        json!({ "position_m": self.eye.to_array(), "target_m": target.to_array(), "up": up.to_array(), "vertical_fov_deg": fov_deg })
    }

    fn direction(&self, at: usize) -> DVec3 {
        let (x, y) = (at as u32 % self.size[0], at as u32 / self.size[0]);
        let share = |i: u32, n: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
        (self.forward + self.right * share(x, self.size[0]) - self.up * share(y, self.size[1]))
            .normalize()
    }

    fn pixels(&self) -> usize {
        (self.size[0] * self.size[1]) as usize
    }
}

/// Distance to an axis-aligned box along a ray, if it is met.
fn box_distance(low: DVec3, high: DVec3, origin: DVec3, direction: DVec3) -> Option<f64> {
    let (a, b) = ((low - origin) / direction, (high - origin) / direction);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    (near <= far && far > 0.0).then_some(near)
}

#[test]
fn refraction_shifts_what_is_seen_as_snell_says() {
    let (eye, target, up) = (
        DVec3::new(0.3, 1.5, 2.0),
        DVec3::new(0.0, -0.8, 0.0),
        DVec3::Y,
    );
    let camera = Pinhole::new(eye, target, up, 45.0, [96, 64]);
    let mut scene = pool(camera.json(target, up, 45.0));
    scene["output"]["width"] = json!(96);
    scene["output"]["height"] = json!(64);
    scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.6, "albedo": [0.1, 0.2, 0.9] }]);
    let frame = frame(scene);
    let positions = harness::layer(&frame, LayerName::Position);
    let albedos = harness::layer(&frame, LayerName::Albedo);
    let depths = &frame.layers[&LayerName::Depth].data;
    let (low, high) = (DVec3::new(-0.3, -1.3, -0.3), DVec3::new(0.3, -0.7, 0.3));
    let (mut wrong, mut on_box, mut straight_wrong) = (0, 0, 0);
    for at in 0..camera.pixels() {
        let d = camera.direction(at);
        let to_water = eye.y / -d.y;
        let p = eye + d * to_water;
        let below = refract_direction(d, DVec3::Y, IOR).unwrap();
        let on_floor = p + below * ((p.y + DEPTH_M) / -below.y);
        let met = box_distance(low, high, p, below);
        let expected = met.map_or(on_floor, |t| p + below * t);
        on_box += usize::from(met.is_some());
        let seen = DVec3::from(positions[at]);
        if (seen - expected).length() > 1e-3 {
            wrong += 1;
        } else {
            let blue = albedos[at][2] > 0.8;
            assert_eq!(blue, met.is_some(), "pixel {at}");
        }
        let depth = to_water * d.dot(camera.forward);
        assert!((f64::from(depths[at]) - depth).abs() <= 1e-3, "pixel {at}");
        // Without refraction the box would be seen elsewhere.
        straight_wrong += usize::from(box_distance(low, high, p, d).is_some() != met.is_some());
    }
    println!(
        "{wrong} of {} pixels differ, {on_box} on the box",
        camera.pixels()
    );
    assert!(wrong <= 3, "{wrong} pixels see something else");
    assert!(
        on_box > 300 && straight_wrong > 50,
        "{on_box} {straight_wrong}"
    );
}

#[test]
fn an_object_under_water_is_lit_as_the_floor_is_at_its_depth() {
    let mut scene = pool(down(3.0));
    scene["camera"]["height_m"] = json!(0.4);
    scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, -1, 0] }]);
    let resolved = scene_files::scene(scene.clone());
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("no sun");
    };
    // The top lies half a metre deep.
    let e = flat_water_irradiance(&resolved.scene.water, 0.5, sun);
    let frame = frame(scene);
    assert_even(&frame, LayerName::Irradiance, e, 1e-3);
    assert_even(&frame, LayerName::Albedo, [0.8; 3], 1e-6);
    let positions = harness::layer(&frame, LayerName::Position);
    assert!(positions.iter().all(|p| (p[1] + 0.5).abs() <= 1e-4));
}

const SKY: [f64; 3] = [10.0, 20.0, 40.0];

/// A camera 2 m under water that looks straight up with a wide view.
fn looking_up() -> (Pinhole, Value) {
    let (eye, target, up) = (DVec3::new(0.0, -2.0, 0.0), DVec3::ZERO, DVec3::NEG_Z);
    let camera = Pinhole::new(eye, target, up, 110.0, [64, 64]);
    let json = camera.json(target, up, 110.0);
    (camera, json)
}

#[test]
fn snells_window_holds_the_whole_sky_and_nothing_is_seen_beside_it() {
    let (camera, json) = looking_up();
    let mut scene = pool(json);
    scene["floor"] = Value::Null;
    scene.as_object_mut().unwrap().remove("floor");
    scene["lights"] = json!([{ "kind": "sky", "radiance_w_m2_sr": SKY }]);
    scene["output"]["width"] = json!(64);
    scene["output"]["height"] = json!(64);
    scene["output"]["layers"] = json!(["radiance"]);
    let frame = frame(scene);
    let seen = harness::layer(&frame, LayerName::Radiance);
    let (mut inside, mut outside) = (0, 0);
    for (at, seen) in seen.iter().enumerate() {
        let d = camera.direction(at);
        let sin = (1.0 - d.y * d.y).sqrt();
        let path_m = 2.0 / d.y;
        if (sin * IOR - 1.0).abs() < 0.01 {
            continue; // on the edge f32 may fall to either side
        }
        let through = 1.0 - fresnel_reflectance(d.y, 1.0 / IOR);
        for c in 0..3 {
            let expected = if sin * IOR < 1.0 {
                SKY[c] * IOR * IOR * through * (-ABSORPTION[c] * path_m).exp()
            } else {
                0.0
            };
            assert!(
                (seen[c] - expected).abs() <= 1e-3 * SKY[c],
                "pixel {at}: {seen:?}, {expected}"
            );
        }
        if sin * IOR < 1.0 {
            inside += 1;
        } else {
            outside += 1;
        }
    }
    assert!(inside > 500 && outside > 500, "{inside} {outside}");
}

#[test]
fn beside_snells_window_the_surface_mirrors_the_floor() {
    let (camera, json) = looking_up();
    let mut scene = pool(json);
    scene["floor"]["depth_m"] = json!(3);
    scene["output"]["width"] = json!(64);
    scene["output"]["height"] = json!(64);
    let resolved = scene_files::scene(scene.clone());
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("no sun");
    };
    let e = flat_water_irradiance(&resolved.scene.water, 3.0, sun);
    let frame = frame(scene);
    let radiance = harness::layer(&frame, LayerName::Radiance);
    let positions = harness::layer(&frame, LayerName::Position);
    let mut mirrored = 0;
    for at in 0..camera.pixels() {
        let d = camera.direction(at);
        let sin = (1.0 - d.y * d.y).sqrt();
        if sin * IOR < 1.01 {
            continue;
        }
        // Up 2 m, down 3 m.
        let path_m = 5.0 / d.y;
        let expected = DVec3::new(d.x * path_m, -3.0, d.z * path_m);
        let error = (DVec3::from(positions[at]) - expected).length();
        assert!(error <= 1e-3, "pixel {at}: {:?}, {expected}", positions[at]);
        for c in 0..3 {
            let l = ALBEDO[c] / std::f64::consts::PI * e[c] * (-ABSORPTION[c] * path_m).exp();
            assert!(
                (radiance[at][c] / l - 1.0).abs() <= 2e-3,
                "pixel {at}: {:?}",
                radiance[at]
            );
        }
        mirrored += 1;
    }
    assert!(mirrored > 500, "{mirrored}");
}

#[test]
fn deep_water_mirrors_the_sky_as_fresnel_says() {
    let (eye, target, up) = (DVec3::new(0.0, 2.0, 3.0), DVec3::ZERO, DVec3::Y);
    let camera = Pinhole::new(eye, target, up, 50.0, [48, 32]);
    let mut scene = pool(camera.json(target, up, 50.0));
    scene.as_object_mut().unwrap().remove("floor");
    scene["lights"] = json!([{ "kind": "sky", "radiance_w_m2_sr": SKY }]);
    let frame = frame(scene);
    for (at, seen) in harness::layer(&frame, LayerName::Radiance)
        .iter()
        .enumerate()
    {
        let reflectance = fresnel_reflectance(-camera.direction(at).y, IOR);
        for c in 0..3 {
            assert!(
                (seen[c] - SKY[c] * reflectance).abs() <= 1e-4 * SKY[c],
                "pixel {at}: {seen:?}"
            );
        }
    }
    for p in harness::layer(&frame, LayerName::Position) {
        assert_eq!(p, [0.0; 3], "no surface is seen");
    }
}

#[test]
fn the_sky_lights_the_floor_through_the_water() {
    // A bright floor under a white sky and no sun: π L t(diffuse) e^(−c · factor · d).
    let mut scene = pool(down(3.0));
    scene["water"] = json!({});
    scene["lights"] = json!([{ "kind": "sky", "radiance_w_m2_sr": SKY }]);
    let frame = frame(scene);
    let through = caustica::physics::fresnel::diffuse_transmittance(IOR);
    let expected = SKY.map(|l| std::f64::consts::PI * l * through);
    assert_even(&frame, LayerName::Irradiance, expected, 1e-4);
}

#[test]
fn dry_surfaces_are_lit_by_the_sun_itself() {
    let mut scene = pool(
        json!({ "kind": "orthographic", "position_m": [0, 5, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "height_m": 0.5 }),
    );
    scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, 2, 0], "albedo": ALBEDO }]);
    scene["lights"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "kind": "sky", "radiance_w_m2_sr": SKY }));
    let frame = frame(scene);
    let sine = 60_f64.to_radians().sin();
    let e: [f64; 3] =
        std::array::from_fn(|c| [1000.0, 900.0, 800.0][c] * sine + std::f64::consts::PI * SKY[c]);
    assert_even(&frame, LayerName::Irradiance, e, 1e-4);
    let radiance = std::array::from_fn(|c| ALBEDO[c] / std::f64::consts::PI * e[c]);
    assert_even(&frame, LayerName::Radiance, radiance, 1e-4);
    let depth = &frame.layers[&LayerName::Depth];
    assert!(
        depth.data.iter().all(|&d| (d - 2.5).abs() <= 1e-4),
        "{}",
        depth.data[0]
    );
}

/// Mean (column, row) of the pixels that see an object.
fn middle_of_object(translation: [f64; 3], camera: Value) -> [f64; 2] {
    let scene = json!({
        "objects": [{ "mesh": "box.obj", "translation_m": translation, "scale": 0.5 }],
        "camera": camera,
        "output": { "kind": "view", "width": 64, "height": 48, "layers": ["albedo"], "format": "exr" }
    });
    let frame = frame(scene);
    let seen = harness::layer(&frame, LayerName::Albedo);
    let places: Vec<[f64; 2]> = (0..64 * 48)
        .filter(|&at| seen[at][0] > 0.0)
        .map(|at| [(at % 64) as f64 + 0.5, (at / 64) as f64 + 0.5])
        .collect();
    assert!(places.len() > 10, "the object is not seen");
    std::array::from_fn(|axis| places.iter().map(|p| p[axis]).sum::<f64>() / places.len() as f64)
}

#[test]
fn the_picture_is_not_mirrored() {
    let perspective =
        json!({ "position_m": [0, 5, 0], "target_m": [0, 5, -1], "vertical_fov_deg": 45 });
    let orthographic = json!({ "kind": "orthographic", "position_m": [0, 5, 0], "target_m": [0, 5, -1], "height_m": 4 });
    for camera in [perspective, orthographic] {
        let at = |x: f64, y: f64| middle_of_object([x, 5.0 + y, -5.0], camera.clone());
        let [x, y] = at(0.0, 0.0);
        assert!(
            (x - 32.0).abs() <= 0.5 && (y - 24.0).abs() <= 0.5,
            "{x} {y}"
        );
        let [x, y] = at(1.0, 0.0);
        assert!(x > 36.0 && (y - 24.0).abs() <= 0.5, "+x is right: {x} {y}");
        let [x, y] = at(0.0, 1.0);
        assert!(y < 20.0 && (x - 32.0).abs() <= 0.5, "+y is up: {x} {y}");
    }
}

#[test]
fn an_orthographic_camera_sees_metres() {
    let camera = json!({ "kind": "orthographic", "position_m": [0, 5, 0], "target_m": [0, 5, -1], "height_m": 4 });
    let [x, y] = middle_of_object([1.0, 5.5, -5.0], camera.clone());
    // 48 rows are 4 m.
    assert!(
        (x - 32.0 - 12.0).abs() <= 0.5 && (y - 24.0 + 6.0).abs() <= 0.5,
        "{x} {y}"
    );
    let far = middle_of_object([1.0, 5.5, -500.0], camera);
    assert_eq!([x, y], far, "distance does not matter");
}

#[test]
fn a_view_far_from_the_origin_is_the_same() {
    let here = pool(json!({ "position_m": [0.3, 1.5, 2], "target_m": [0, -0.8, 0] }));
    let mut there = here.clone();
    there["camera"] = json!({ "position_m": [1e5 + 0.3, 1.5 + 64.0, 2.0 - 1e5], "target_m": [1e5, 64.0 - 0.8, -1e5] });
    there["floor"]["center_m"] = json!([1e5, -1e5]);
    there["water"]["level_m"] = json!(64);
    let (here, there) = (frame(here), frame(there));
    let a = harness::layer(&here, LayerName::Radiance);
    let b = harness::layer(&there, LayerName::Radiance);
    let error = largest_relative(a.as_flattened(), b.as_flattened());
    assert!(error <= 1e-4, "{error:e}");
}

#[test]
fn a_box_in_the_air_is_seen_from_under_water() {
    let mut scene = pool(json!({
        "position_m": [0, -1.5, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "vertical_fov_deg": 60
    }));
    scene["objects"] =
        json!([{ "mesh": "box.obj", "translation_m": [0, 2, 0], "albedo": [0.6, 0.6, 0.6] }]);
    let frame = frame(scene);
    let positions = harness::layer(&frame, LayerName::Position);
    // The middle of the picture looks straight up at the underside of the unit cube.
    let middle = positions[16 * 48 + 24];
    assert!((middle[1] - 1.5).abs() < 1e-3, "{middle:?}");
    let albedo = harness::layer(&frame, LayerName::Albedo);
    assert!((albedo[16 * 48 + 24][0] - 0.6).abs() < 1e-6);
}

/// A long sea of waves that are seldom all at their crests, and a camera a little above them.
fn along_the_sea(down_m: f64) -> Value {
    let wave = |wavelength_m: f64, direction_deg: f64| json!({ "kind": "sine", "amplitude_m": 0.05, "wavelength_m": wavelength_m, "direction_deg": direction_deg });
    let mut scene = pool(
        json!({ "position_m": [0, 0.3, 0], "target_m": [10, 0.3 - down_m, 0],
                                 "vertical_fov_deg": 2 }),
    );
    scene["water"]["waves"] = json!([wave(1.0, 10.0), wave(1.37, -40.0), wave(0.83, 75.0)]);
    scene["lights"] = json!([scene["lights"][0], { "kind": "sky", "radiance_w_m2_sr": SKY }]);
    scene["output"]["layers"] = json!(["radiance"]);
    scene
}

#[test]
fn pixels_whose_path_along_the_waves_is_not_followed_to_its_end_are_warned_of() {
    let count = |scene: Value| -> Option<u64> {
        let frame = frame(scene);
        let mut warnings = frame.stats.warnings.iter();
        let found = warnings.find(|w| w.code == "pixels_along_water")?;
        let (count, rest) = found.message.split_once(" pixels (").unwrap();
        let count: u64 = count.parse().unwrap();
        let share: f64 = rest.split_once(" %)").unwrap().0.parse().unwrap();
        let pixels = f64::from(frame.width * frame.height);
        assert!((share - 100.0 * count as f64 / pixels).abs() < 1e-3);
        Some(count)
    };
    let one = count(along_the_sea(0.02)).expect("pixels at the horizon");
    assert!(one < 48 * 32 / 4, "{one} pixels");
    // Sixteen rays per pixel: no pixel counts twice, and neighbours of those from before may join.
    let mut many = along_the_sea(0.02);
    many["quality"]["pixel_samples"] = json!(4);
    let of_many = count(many).expect("pixels at the horizon");
    assert!(
        of_many >= one / 2 && of_many < 4 * one + 100,
        "{of_many}, {one}"
    );
    assert_eq!(count(along_the_sea(3.0)), None);
}
