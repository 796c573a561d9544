//! Scenes and meshes for requests.

use serde_json::{Value, json};

/// A tetrahedron.
pub(crate) const OBJ: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A small view of a flat pool.
pub(crate) fn small() -> Value {
    json!({
        "floor": { "depth_m": 2.0, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1000, 1000, 1000] }],
        "camera": { "position_m": [0, 2.5, 4], "target_m": [0, -1.5, 0] },
        "output": { "kind": "view", "width": 8, "height": 6 }
    })
}

/// The same with one value replaced; `pointer` must exist.
pub(crate) fn small_with(pointer: &str, value: Value) -> Value {
    let mut scene = small();
    *scene.pointer_mut(pointer).expect("the pointer exists") = value;
    scene
}

/// The same with a mesh.
pub(crate) fn small_with_mesh(id: &str) -> Value {
    let mut scene = small();
    scene["objects"] = json!([{ "mesh": id, "translation_m": [0, -1, 0] }]);
    scene
}
