//! Height fields that are refused: broken files, and more than the limits allow.

use caustica::assets::{FieldStore, MeshStore};
use caustica::config::Limits;
use caustica::methods;
use caustica::scene::{IssueKind, Scene};
use serde_json::{Value, json};

use super::field_support::{self as files, npy};
use super::height_fields::{issues, refused, with};

/// Too many frames are refused as soon as they are too many, whatever the files have further on.
#[test]
fn too_many_frames_are_refused() {
    let file = npy(&[3000, 4, 4], &vec![0.0; 3000 * 16]);
    let field = json!({ "sample_m": 1, "frames_per_s": 30 });
    for count in [2, 4096] {
        let files = vec![file.clone(); count];
        let found = issues(field.clone(), &files);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].pointer, "/water/waves/0/frames");
        assert!(found[0].detail.contains("up to number 2 have 6000 frames"));
        assert!(found[0].accepted.contains("4096"));
    }
}

/// The margin of flat water around bounded fields counts, too: it is most of a narrow one.
#[test]
fn narrow_fields_count_with_their_margins() {
    let limits = Limits::default();
    let (meshes, fields) = (MeshStore::new(&limits), FieldStore::new(&limits));
    let file = fields.insert(&npy(&[4, 16_384], &vec![0.0; 4 * 16_384]));
    let id = file.unwrap().field.id.clone();
    let resolve = |count: usize, edges: &str| {
        let mut scene = with(json!({}));
        let field =
            json!({ "kind": "height_field", "frames": [id], "sample_m": 0.1, "edges": edges });
        scene["water"]["waves"] = json!(vec![field; count]);
        let scene = Scene::from_value(scene).unwrap();
        methods::resolve(scene, &limits, (&meshes, &fields))
    };
    // 4 × 16 384 are 2¹⁶, with the margin 40 × 16 420.
    assert!(resolve(100, "periodic").is_ok());
    assert!(resolve(25, "bounded").is_ok());
    let refused = resolve(26, "bounded").unwrap_err();
    assert_eq!(refused.issues[0].pointer, "/water/waves");
    assert!(
        refused.issues[0].detail.contains("17076800 samples"),
        "{refused}"
    );
}

#[test]
fn broken_fields_are_refused_where_they_are_wrong() {
    let good = || npy(&[8, 8], &[0.0; 64]);
    let field = |more: Value| {
        let mut field = json!({ "sample_m": 0.1 });
        for (name, value) in more.as_object().unwrap() {
            field[name] = value.clone();
        }
        field
    };
    let rgb = || files::png([8, 8], png::ColorType::Rgb, 16, &[7; 192]);
    let exr = || files::exr(8, 8, &[("u", vec![0.0; 64]), ("v", vec![0.0; 64])]);
    let mut nan = vec![0.0; 64];
    nan[19] = f64::NAN;
    refused(
        field(json!({})),
        npy(&[8, 8], &nan),
        "frames/0",
        "frame 0, row 2, column 3",
    );
    refused(
        field(json!({})),
        npy(&[8, 8, 2], &[0.0; 128]),
        "frames/0",
        "2 channels",
    );
    refused(
        field(json!({})),
        npy(&[2, 8, 8, 2], &[0.0; 256]),
        "frames/0",
        "2 channels",
    );
    refused(
        field(json!({})),
        npy(&[1, 1], &[0.0]),
        "frames/0",
        "too few samples",
    );
    refused(
        field(json!({})),
        npy(&[3, 8], &[0.0; 24]),
        "frames/0",
        "too few samples along z: 3",
    );
    refused(
        field(json!({ "range_m": [0, 1] })),
        rgb(),
        "frames/0",
        "3 channels",
    );
    refused(
        field(json!({ "channel": "B", "range_m": [0, 1] })),
        exr(),
        "channel",
        "no channel `B`",
    );
    refused(field(json!({})), exr(), "frames/0", "2 channels");
    refused(
        field(json!({ "holds": "slopes" })),
        exr(),
        "frames/0",
        "not clear",
    );
    refused(
        field(json!({ "holds": "slopes" })),
        good(),
        "frames/0",
        "not clear",
    );
    refused(
        field(json!({})),
        npy(&[3, 8, 8], &[0.0; 192]),
        "frames_per_s",
        "3 frames",
    );
    refused(
        field(json!({})),
        files::png([8, 8], png::ColorType::Grayscale, 16, &[7; 64]),
        "range_m",
        "not in the file",
    );
    refused(
        field(json!({ "range_m": [0, 1] })),
        good(),
        "range_m",
        "16 bits",
    );
    refused(
        field(json!({ "scale_m": 1e5 })),
        npy(&[4, 4], &[0.0, 1.0].repeat(8)),
        "frames/0",
        "reach from 0 to 100000 m",
    );
    refused(
        field(json!({ "rest_m": 0 })),
        npy(&[4, 4], &[1234.0; 16]),
        "frames/0",
        "at rest at 0 m",
    );
    refused(
        field(json!({ "holds": "slopes" })),
        npy(&[4, 4, 2], &[101.0; 32]),
        "frames/0",
        "slopes reach from 101",
    );
    refused(
        field(json!({ "rim_m": 0.5 })),
        good(),
        "rim_m",
        "wider than half",
    );
    refused(
        field(json!({ "sample_m": 1e-5 })),
        good(),
        "sample_m",
        "long along x",
    );
    let two = issues(
        field(json!({ "frames_per_s": 1 })),
        &[good(), npy(&[8, 9], &[0.0; 72])],
    );
    assert_eq!(two[0].pointer, "/water/waves/0/frames/1");
    assert!(
        two[0]
            .detail
            .contains("9 columns and 8 rows, the first one 8 and 8"),
        "{two:?}"
    );

    let missing = files::try_scene(with(field(json!({}))), &[]).unwrap_err();
    assert!(missing.issues[0].detail.contains("no frame"), "{missing}");
    let mut scene = with(field(
        json!({ "kind": "height_field", "frames": ["blake3:ff"] }),
    ));
    let resolve = |scene: &Value| {
        let scene = Scene::from_value(scene.clone()).unwrap();
        let nothing = |_: &str| None;
        methods::resolve(scene, &Limits::default(), nothing).unwrap_err()
    };
    let unknown = resolve(&scene);
    assert_eq!(unknown.kind(), IssueKind::UnknownAsset);
    assert_eq!(unknown.issues[0].pointer, "/water/waves/0/frames/0");
    scene["water"]["ior"] = json!(-1);
    assert_eq!(resolve(&scene).kind(), IssueKind::Invalid);
}

#[test]
fn fields_that_contradict_each_other_or_are_out_of_range_are_refused() {
    let good = || npy(&[8, 8], &[0.0; 64]);
    for (more, pointer, words) in [
        (
            json!({ "channels": ["x", "z"] }),
            "channels",
            "no `channels`",
        ),
        (json!({ "slope_scale": 2 }), "slope_scale", "holds heights"),
        (
            json!({ "holds": "slopes", "rest_m": 0 }),
            "rest_m",
            "holds slopes",
        ),
        (
            json!({ "scale_m": 1, "range_m": [0, 1] }),
            "scale_m",
            "scaled twice",
        ),
        (json!({ "scale_m": 0 }), "scale_m", "flat"),
        (json!({ "range_m": [1, 1] }), "range_m", "empty"),
        (
            json!({ "edges": "periodic", "rim_m": 0.3 }),
            "rim_m",
            "no rim",
        ),
        (json!({ "rim_m": 0 }), "rim_m", "0 m is a step"),
        (json!({ "rim_m": 0.19 }), "rim_m", "a step"),
        (json!({ "sample_m": 0 }), "sample_m", "out of range"),
        (
            json!({ "sample_m": [0.1, -1] }),
            "sample_m/1",
            "out of range",
        ),
        (json!({ "frames_per_s": 0 }), "frames_per_s", "out of range"),
        (json!({ "start_s": 1e13 }), "start_s", "out of range"),
        (json!({ "min_m": [0, 1e9] }), "min_m/1", "out of range"),
    ] {
        let mut field = json!({ "sample_m": 0.1 });
        for (name, value) in more.as_object().unwrap() {
            field[name] = value.clone();
        }
        refused(field, good(), pointer, words);
    }
}
