//! The mesh store: ids, budget, threads.

use std::sync::Arc;

use caustica::assets::MeshStore;
use caustica::config::Limits;
use caustica::mesh::MeshError;

fn obj(height: u32) -> String {
    format!("v 0 0 0\nv 1 0 0\nv 0 {height} 0\nf 1 2 3\n")
}

fn store(bytes: u64) -> MeshStore {
    MeshStore::new(&Limits {
        mesh_store_bytes: bytes,
        ..Limits::default()
    })
}

#[test]
fn the_same_bytes_are_kept_once() {
    let store = MeshStore::default();
    let first = store.insert_obj(obj(1).as_bytes(), &[]).unwrap();
    let second = store.insert_obj(obj(1).as_bytes(), &[]).unwrap();
    assert!(first.created && !second.created);
    assert!(Arc::ptr_eq(&first.mesh, &second.mesh));
    let with_mtl = store
        .insert_obj(obj(1).as_bytes(), &[b"newmtl a\n"])
        .unwrap();
    assert!(with_mtl.created);
    assert_ne!(with_mtl.mesh.id, first.mesh.id);
    assert_eq!(store.list().len(), 2);
    assert_eq!(store.bytes(), first.mesh.bytes() + with_mtl.mesh.bytes());
}

#[test]
fn meshes_are_found_listed_and_removed() {
    let store = MeshStore::default();
    let ids: Vec<String> = (1..=5)
        .map(|h| {
            store
                .insert_obj(obj(h).as_bytes(), &[])
                .unwrap()
                .mesh
                .id
                .clone()
        })
        .collect();
    let listed = store.list();
    assert_eq!(listed.len(), 5);
    assert!(listed.is_sorted_by(|a, b| a.id < b.id));
    for info in &listed {
        assert!(ids.contains(&info.id));
        assert_eq!(*info, store.get(&info.id).unwrap().info());
    }
    let tall = store.get(&ids[4]).unwrap().info();
    assert_eq!(
        (tall.triangles, tall.bounds_m.min, tall.bounds_m.max),
        (1, [0.0; 3], [1.0, 5.0, 0.0])
    );
    assert_eq!(tall.materials.len(), 1);
    assert_eq!(tall.warnings[0].code, "mesh_open");

    let held = store.get(&ids[2]).unwrap();
    assert!(store.remove(&ids[2]));
    assert!(!store.remove(&ids[2]));
    assert!(store.get(&ids[2]).is_none());
    assert_eq!(store.list().len(), 4);
    assert_eq!(held.triangles.len(), 1, "a frame under way keeps its mesh");
    assert!(store.insert_obj(obj(3).as_bytes(), &[]).unwrap().created);
    assert!(!store.remove("blake3:nothing"));
}

#[test]
fn info_is_what_the_api_says() {
    let store = MeshStore::default();
    let mesh = store.insert_obj(obj(2).as_bytes(), &[]).unwrap().mesh;
    let json = serde_json::to_value(mesh.info()).unwrap();
    assert_eq!(json["bounds_m"]["max"], serde_json::json!([1.0, 2.0, 0.0]));
    assert_eq!(json["materials"][0]["name"], "");
    assert_eq!(json["bytes"], mesh.bytes());
    assert_eq!(json["triangles"], 1);
}

#[test]
fn bytes_grow_with_the_triangles() {
    let store = MeshStore::default();
    let text = std::fs::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/meshes/teapot.obj"
    ))
    .unwrap();
    let teapot = store.insert_obj(&text, &[]).unwrap().mesh;
    // 76 bytes a triangle and two nodes of 32 bytes.
    let least = teapot.triangles.len() as u64 * (76 + 64) - 32;
    assert!(
        (least..least + 4_096).contains(&teapot.bytes()),
        "{}",
        teapot.bytes()
    );
}

#[test]
fn a_full_store_refuses_and_recovers() {
    let one = MeshStore::default()
        .insert_obj(obj(1).as_bytes(), &[])
        .unwrap()
        .mesh
        .bytes();
    let store = store(2 * one);
    let first = store.insert_obj(obj(1).as_bytes(), &[]).unwrap().mesh;
    store.insert_obj(obj(2).as_bytes(), &[]).unwrap();
    let error = store.insert_obj(obj(3).as_bytes(), &[]).unwrap_err();
    assert_eq!(
        error,
        MeshError::StoreFull {
            needed_bytes: one,
            used_bytes: 2 * one,
            budget_bytes: 2 * one
        }
    );
    assert!(
        error
            .to_string()
            .contains(&format!("holds {} of at most {}", 2 * one, 2 * one))
    );
    assert_eq!(store.list().len(), 2);
    // What is there already needs no room.
    assert!(!store.insert_obj(obj(2).as_bytes(), &[]).unwrap().created);
    assert!(store.remove(&first.id));
    assert_eq!(store.bytes(), one);
    assert!(store.insert_obj(obj(3).as_bytes(), &[]).unwrap().created);
}

#[test]
fn a_bad_mesh_leaves_no_trace() {
    let store = store(u64::MAX);
    assert_eq!(store.insert_obj(b"", &[]).unwrap_err(), MeshError::Empty);
    assert!(store.insert_obj(b"v 0 0 0\nf 1 2 3\n", &[]).is_err());
    assert!(store.list().is_empty());
    assert_eq!(store.bytes(), 0);
}

#[test]
fn the_store_applies_the_triangle_limit() {
    let store = MeshStore::new(&Limits {
        max_triangles: 1,
        ..Limits::default()
    });
    assert!(store.insert_obj(obj(1).as_bytes(), &[]).is_ok());
    let error = store
        .insert_obj(format!("{}f 1 3 2\n", obj(1)).as_bytes(), &[])
        .unwrap_err();
    assert_eq!(error, MeshError::TooManyTriangles { line: 5, limit: 1 });
}

#[test]
fn threads_agree_on_one_mesh() {
    let store = MeshStore::default();
    let created: usize = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8)
            .map(|_| {
                scope.spawn(|| {
                    (1..=20)
                        .filter(|h| store.insert_obj(obj(*h).as_bytes(), &[]).unwrap().created)
                        .count()
                })
            })
            .collect();
        threads.into_iter().map(|t| t.join().unwrap()).sum()
    });
    assert_eq!(created, 20);
    let sum: u64 = store.list().iter().map(|info| info.bytes).sum();
    assert_eq!(store.bytes(), sum);
}
