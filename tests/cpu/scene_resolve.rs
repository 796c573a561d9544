//! Meshes by id, and the hash of a scene.

use std::sync::Arc;

use caustica::config::Limits;
use caustica::mesh::{Material, Mesh};
use caustica::scene::{IssueKind, ResolvedScene, Scene, SceneError};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::scene_validate::{full, with};

fn mesh(id: &str) -> Arc<Mesh> {
    Arc::new(Mesh {
        id: id.to_owned(),
        origin_m: DVec3::ZERO,
        min_m: Vec3::ZERO,
        max_m: Vec3::ONE,
        triangles: Vec::new(),
        materials: vec![Material {
            name: String::new(),
            albedo: [0.8; 3],
        }],
        hierarchy: Vec::new(),
        warnings: Vec::new(),
    })
}

fn resolved(value: Value) -> Result<ResolvedScene, SceneError> {
    let scene = Scene::from_value(value).unwrap();
    caustica::methods::resolve(scene, &Limits::default(), |id: &str| {
        id.starts_with("blake3:0").then(|| mesh(id))
    })
}

#[test]
fn meshes_are_looked_up_in_the_order_of_the_objects() {
    let object = |id: &str| json!({ "mesh": id });
    let scene = with(
        full(),
        "/objects",
        json!([
            object("blake3:01"),
            object("blake3:00"),
            object("blake3:01")
        ]),
    );
    let resolved = resolved(scene).unwrap();
    let ids: Vec<&str> = resolved
        .meshes
        .iter()
        .map(|mesh| mesh.id.as_str())
        .collect();
    assert_eq!(ids, ["blake3:01", "blake3:00", "blake3:01"]);
}

#[test]
fn an_unknown_mesh_is_distinguished_from_an_invalid_scene() {
    let objects =
        json!([{ "mesh": "blake3:00" }, { "mesh": "blake3:ff" }, { "mesh": "teapot.obj" }]);
    let error = resolved(with(full(), "/objects", objects.clone())).unwrap_err();
    assert_eq!(error.kind(), IssueKind::UnknownMesh);
    let pointers: Vec<&str> = error
        .issues
        .iter()
        .map(|issue| issue.pointer.as_str())
        .collect();
    assert_eq!(pointers, ["/objects/1/mesh", "/objects/2/mesh"]);
    assert!(error.issues[0].detail.contains("blake3:ff"));

    let scene = with(with(full(), "/objects", objects), "/water/ior", json!(9));
    let error = resolved(scene).unwrap_err();
    assert_eq!((error.kind(), error.issues.len()), (IssueKind::Invalid, 3));

    let error = resolved(with(full(), "/objects", json!([{ "mesh": "" }]))).unwrap_err();
    assert_eq!((error.kind(), error.issues.len()), (IssueKind::Invalid, 1));
}

#[test]
fn the_hash_is_that_of_the_content() {
    let hash = |value: Value| resolved(value).unwrap().hash();
    let first = hash(full());
    assert!(first.starts_with("blake3:") && first.len() == 71);
    // Spelling, order and written-out defaults make no difference.
    let text = serde_json::to_string(&Scene::from_value(full()).unwrap()).unwrap();
    assert_eq!(hash(serde_json::from_str(&text).unwrap()), first);
    assert_eq!(hash(with(full(), "/output/width", json!(960.0))), first);
    // Everything else does.
    assert_ne!(hash(with(full(), "/time_s", json!(1e-9))), first);
    assert_ne!(
        hash(with(full(), "/objects/0/mesh", json!("blake3:01"))),
        first
    );
}
