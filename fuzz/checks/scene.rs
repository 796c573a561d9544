//! Any bytes as a scene, through all steps without a GPU: reading, validation, resolving, facts, plan.

use std::sync::{Arc, OnceLock};

use caustica::config::Limits;
use caustica::fields::{self, Field};
use caustica::mesh::{Mesh, obj};
use caustica::plan::{self, NothingCached, WarmCache};
use caustica::scene::{Assets, Scene, SceneError};

/// The mesh of every object: a tetrahedron.
const MESH: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Reads `bytes`. An accepted scene must have a finite plan; a refusal must state where, what, and what is accepted.
pub(crate) fn check(bytes: &[u8]) {
    let scene = match Scene::from_json(bytes) {
        Ok(scene) => scene,
        Err(error) => return says_why(&error),
    };
    reads_back(&scene);
    let resolved = match caustica::methods::resolve(scene, &Limits::default(), Anything) {
        Ok(resolved) => resolved,
        Err(error) => return says_why(&error),
    };
    let facts = match caustica::methods::facts(&resolved) {
        Ok(facts) => facts,
        Err(error) => return says_why(&error),
    };
    let text = format!("{facts:?}");
    assert!(!text.contains("NaN"), "{text}");
    let cold = NothingCached {
        arena_bytes: 64 << 20,
        field_arena_bytes: 64 << 20,
    };
    let planned = [
        plan::plan_scene(&facts, plan::Wanted::Frame, &cold),
        plan::plan_scene(&facts, plan::Wanted::Frame, &WarmCache),
    ];
    for plan in planned {
        let plan = plan.unwrap_or_else(|error| panic!("{error}"));
        let held = plan.report.slots.iter().map(|slot| slot.bytes).max();
        assert!(plan.report.peak_bytes >= held.unwrap_or_default());
        let reasons = plan.report.passes.iter().map(|pass| &pass.reason);
        let absences = plan.report.absent.iter().map(|pass| &pass.reason);
        assert!(reasons.chain(absences).all(|reason| !reason.is_empty()));
    }
}

/// A scene that was read is written, and reads back as the same scene.
fn reads_back(scene: &Scene) {
    let written = serde_json::to_vec(scene).unwrap_or_else(|error| panic!("{error}"));
    match Scene::from_json(&written) {
        Ok(again) => assert_eq!(&again, scene),
        Err(error) => panic!("what was written is refused: {error}"),
    }
}

fn says_why(error: &SceneError) {
    assert!(!error.issues.is_empty());
    for issue in &error.issues {
        let is_pointer = issue.pointer.is_empty() || issue.pointer.starts_with('/');
        assert!(is_pointer, "{issue:?}");
        assert!(
            !issue.detail.is_empty() && !issue.accepted.is_empty(),
            "{issue:?}"
        );
    }
}

/// Has a file for every id.
struct Anything;

impl Assets for Anything {
    fn mesh(&self, _: &str) -> Option<Arc<Mesh>> {
        Some(mesh())
    }

    fn field(&self, _: &str) -> Option<Arc<Field>> {
        Some(field())
    }
}

/// The file of every height field: two frames of 8 × 8 samples.
fn field() -> Arc<Field> {
    static SHARED: OnceLock<Arc<Field>> = OnceLock::new();
    let read = || {
        let mut file = b"\x93NUMPY\x01\x00\x3d\x00".to_vec();
        file.extend(b"{'descr': '<u2', 'fortran_order': False, 'shape': (2, 8, 8)}\n");
        file.extend((0..256_u32).map(|i| (i * i % 251) as u8));
        match fields::read(&file) {
            Ok(field) => Arc::new(field),
            Err(error) => panic!("{error}"),
        }
    };
    Arc::clone(SHARED.get_or_init(read))
}

fn mesh() -> Arc<Mesh> {
    static SHARED: OnceLock<Arc<Mesh>> = OnceLock::new();
    let read = || match obj::read(MESH, &[], &Limits::default()) {
        Ok(mesh) => Arc::new(mesh),
        Err(error) => panic!("{error}"),
    };
    Arc::clone(SHARED.get_or_init(read))
}
