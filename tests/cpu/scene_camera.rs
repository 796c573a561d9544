//! Cameras: fields of view and intrinsics, and their matrices.

use caustica::scene::projection::{Lens, rows};
use caustica::scene::{Camera, IssueKind};
use glam::{DVec3, DVec4};
use serde_json::{Value, json};

use super::scene_parse::refusal;
use super::scene_validate::{findings, full, only, with};
use super::truth::pool;
use super::truths::truth_to;

fn camera(value: Value) -> Camera {
    serde_json::from_value(value).unwrap()
}

fn calibrated(intrinsics: Value) -> Value {
    let mut scene = full();
    scene["camera"]
        .as_object_mut()
        .unwrap()
        .remove("vertical_fov_deg");
    scene["camera"]["intrinsics"] = intrinsics;
    scene
}

#[test]
fn intrinsics_are_another_way_to_say_a_lens() {
    let pose = json!({ "position_m": [1, 2, 3], "target_m": [1.5, 0, -1] });
    let with_fov = camera(with_field(&pose, "vertical_fov_deg", json!(40)));
    let focal = 300.0 / 20f64.to_radians().tan();
    let with_k = camera(with_field(
        &pose,
        "intrinsics",
        json!({ "fx": focal, "fy": focal, "cx": 400, "cy": 300 }),
    ));
    let (a, b) = (
        with_fov.projection([800, 600]),
        with_k.projection([800, 600]),
    );
    assert_eq!((a.eye_m, a.axes), (b.eye_m, b.axes));
    let (Lens::Perspective { fx, fy, cx, cy }, Some(k)) = (a.lens, b.k_px()) else {
        panic!("two pinholes");
    };
    assert!((fx - k[0][0]).abs() < 1e-9 && (fy - k[1][1]).abs() < 1e-9);
    assert_eq!([cx, cy], [k[0][2], k[1][2]]);
    let [x, y] = b.field_of_view_deg().unwrap();
    assert!((y - 40.0).abs() < 1e-9, "{y}");
    assert!(
        (x - 2.0 * (400.0 / focal).atan().to_degrees()).abs() < 1e-9,
        "{x}"
    );
    // Without either it has the default, and keeps it when it is written.
    let plain = camera(pose);
    assert!(
        serde_json::to_string(&plain)
            .unwrap()
            .contains("\"vertical_fov_deg\":45.0")
    );
    assert!(!serde_json::to_string(&with_k).unwrap().contains("fov"));
}

fn with_field(object: &Value, name: &str, value: Value) -> Value {
    let mut object = object.clone();
    object[name] = value;
    object
}

#[test]
fn matrices_follow_their_conventions() {
    let lens = json!({ "fx": 500, "fy": 400, "cx": 100, "cy": 250 });
    let of = |up: [f64; 3]| {
        let value = json!({ "position_m": [5567891.5, 2, 3], "target_m": [5567891.5, 2, -7], "up": up, "intrinsics": lens });
        camera(value).projection([640, 480])
    };
    // It looks along −z with y up: OpenGL's camera axes are the world's.
    let upright = of([0.0, 1.0, 0.0]);
    let point = DVec3::new(5_567_892.0, 2.25, 1.0);
    let seen = |projection: &caustica::scene::projection::Projection| {
        let p = point.extend(1.0);
        (
            (projection.world_to_camera_opencv() * p).truncate(),
            (projection.world_to_camera_opengl() * p).truncate(),
            projection.world_to_ndc() * p,
        )
    };
    let (cv, gl, ndc) = seen(&upright);
    assert_eq!(cv, DVec3::new(0.5, -0.25, 2.0));
    assert_eq!(gl, DVec3::new(0.5, 0.25, -2.0));
    // u = fx X / Z + cx, v = fy Y / Z + cy.
    let (u, v) = (500.0 * 0.25 + 100.0, 400.0 * -0.125 + 250.0);
    let expected = DVec4::new(u / 640.0, v / 480.0, 1.0 - 0.005, 1.0);
    assert!((ndc / ndc.w).abs_diff_eq(expected, 1e-12), "{ndc}");
    let k = upright.k_px().unwrap();
    let [x, y, z] = [0, 1, 2].map(|i| DVec3::from(k[i]).dot(cv));
    assert_eq!([x / z, y / z], [u, v]);
    assert_eq!(
        rows(upright.world_to_camera_opencv())[1],
        [0.0, -1.0, 0.0, 2.0]
    );
    // A quarter turn to the right: what was up is left.
    let (cv, ..) = seen(&of([1.0, 0.0, 0.0]));
    assert_eq!(cv, DVec3::new(-0.25, -0.5, 2.0));

    let parallel = camera(json!({
        "kind": "orthographic", "position_m": [0, 5, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "height_m": 4
    }))
    .projection([80, 40]);
    assert_eq!(parallel.lens, Lens::Orthographic { pixels_per_m: 10.0 });
    assert_eq!(
        (parallel.k_px(), parallel.field_of_view_deg()),
        (None, None)
    );
    let p = parallel.world_to_ndc() * DVec4::new(2.0, 1.0, -1.0, 1.0);
    assert_eq!(p, DVec4::new(0.75, 0.25, 4.0, 1.0));
}

#[test]
fn lenses_are_checked() {
    let good = json!({ "fx": 400, "fy": 300, "cx": -2000, "cy": 5000 });
    assert_eq!(findings(&calibrated(good.clone())), []);
    for (name, value) in [("fx", 0.0), ("fy", -1.0), ("cx", 1.1e6), ("cy", -1.1e6)] {
        let pointer = format!("/camera/intrinsics/{name}");
        let scene = with(calibrated(good.clone()), &pointer, json!(value));
        let issue = only(&scene, &pointer);
        assert!(issue.detail.contains("out of range"), "{issue}");
    }
    // Half of 960 pixels at 89.4° and 89.6°.
    for (degrees, is_good) in [(89.4_f64, true), (89.6, false)] {
        let focal = 480.0 / degrees.to_radians().tan();
        let scene = calibrated(json!({ "fx": focal, "fy": 300, "cx": 480, "cy": 270 }));
        if is_good {
            assert_eq!(findings(&scene), []);
        } else {
            let issue = only(&scene, "/camera/intrinsics/cx");
            assert!(issue.detail.contains("89.6"), "{issue}");
        }
    }
    let needles = calibrated(json!({ "fx": 1e7, "fy": 400, "cx": 480, "cy": 270 }));
    let issue = only(&needles, "/camera/intrinsics/fy");
    assert!(issue.detail.contains("4e-5 times as wide"), "{issue}");
    let mut both = calibrated(good);
    both["camera"]["vertical_fov_deg"] = json!(45);
    let issue = only(&both, "/camera/vertical_fov_deg");
    assert_eq!(issue.kind, IssueKind::Invalid);
    let text = r#"{"camera": {"position_m": [0,1,0], "target_m": [0,0,0], "intrinsics": {"fx": 1, "fy": 1, "cx": 1}}}"#;
    let issue = refusal(text);
    assert!(issue.detail.contains("`cy`"), "{issue}");
    let text =
        r#"{"camera": {"position_m": [0,1,0], "target_m": [0,0,0], "principal_point_px": [1, 2]}}"#;
    assert!(
        refusal(text).accepted.contains("intrinsics"),
        "{}",
        refusal(text)
    );
}

/// The reference of a part of a picture, taken by a camera with the principal point outside, is that part of the reference.
#[test]
fn the_reference_knows_intrinsics() {
    let focal = 12.0 / 10f64.to_radians().tan();
    let scene = |lens: Value, width: u32, height: u32| {
        pool(glam::Vec3::new(0.3, 0.2, 0.1), |v| {
            let camera = v["camera"].as_object_mut().unwrap();
            camera.remove("vertical_fov_deg");
            camera.insert("intrinsics".to_owned(), lens);
            v["output"] = json!({ "kind": "view", "width": width, "height": height });
        })
    };
    let whole = pool(glam::Vec3::new(0.3, 0.2, 0.1), |_| {});
    let whole = truth_to(&whole, 1e-3);
    let part = scene(
        json!({ "fx": focal, "fy": focal, "cx": 16 - 20, "cy": 12 - 3 }),
        12,
        16,
    );
    let part = truth_to(&part, 1e-3);
    let mut lit = 0;
    for y in 0..16 {
        for x in 0..12 {
            let expected = whole.irradiance[(y + 3) * 32 + x + 20];
            let found = part.irradiance[y * 12 + x];
            for c in 0..3 {
                assert!(
                    (found[c] - expected[c]).abs() <= 5e-3 * expected[c],
                    "({x}, {y}): {found:?} {expected:?}"
                );
            }
            lit += usize::from(expected[0] > 0.0);
        }
    }
    assert!(lit > 150, "{lit}");
}
