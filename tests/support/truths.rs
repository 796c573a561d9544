//! Float64 references of scenes, each computed once per test binary and shared by its tests.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use caustica::reference::{
    ReferenceMap, ReferenceSettings, Truth, TruthSettings, irradiance_map, truth,
};
use caustica::scene::ResolvedScene;

/// What was computed, by scene and settings.
struct Table<T>(Mutex<BTreeMap<[u8; 32], Arc<OnceLock<T>>>>);

impl<T: Clone> Table<T> {
    const fn new() -> Self {
        Self(Mutex::new(BTreeMap::new()))
    }

    /// What there is, or else what `compute` gives; who asks for the same meanwhile waits for it.
    fn get(
        &self,
        resolved: &ResolvedScene,
        settings: &dyn Debug,
        compute: impl FnOnce() -> T,
    ) -> T {
        let key = key(resolved, settings);
        let cell = {
            let mut cells = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(cells.entry(key).or_default())
        };
        cell.get_or_init(compute).clone()
    }
}

/// Meshes count with their triangles: tests make some up under one id.
fn key(resolved: &ResolvedScene, settings: &dyn Debug) -> [u8; 32] {
    let meshes = resolved.meshes.iter();
    let meshes: Vec<_> = meshes
        .map(|mesh| (mesh.origin_m, &mesh.triangles))
        .collect();
    *blake3::hash(format!("{:?} {meshes:?} {settings:?}", resolved.scene).as_bytes()).as_bytes()
}

/// The map of the floor.
pub(crate) fn floor_map(resolved: &ResolvedScene, settings: &ReferenceSettings) -> ReferenceMap {
    static MAPS: Table<ReferenceMap> = Table::new();
    let compute = || irradiance_map(resolved, settings, &|_| {}).unwrap();
    MAPS.get(resolved, settings, compute)
}

/// The truth about any output, to a relative error.
pub(crate) fn truth_to(resolved: &ResolvedScene, target_error: f64) -> Truth {
    static TRUTHS: Table<Truth> = Table::new();
    let settings = TruthSettings {
        target_error: Some(target_error),
        ..TruthSettings::default()
    };
    let compute = || truth(resolved, &settings, &|_| {}, &|| false).unwrap();
    TRUTHS.get(resolved, &settings, compute)
}

#[test]
fn a_truth_is_computed_once_for_each_scene_and_setting() {
    let table = Table::new();
    let mut computed = 0;
    let mut get = |resolved: &ResolvedScene, setting: u32| {
        table.get(resolved, &setting, || {
            computed += 1;
            computed
        })
    };
    let plain = crate::scene_files::load("teapot_floor", &[]);
    assert_eq!([get(&plain, 1), get(&plain, 1)], [1, 1]);
    assert_eq!(get(&plain, 2), 2, "other settings");
    let mut later = plain.clone();
    later.scene.time_s = 1.0;
    assert_eq!(get(&later, 1), 3, "another scene");
    let mut other = plain.clone();
    let mut mesh = (*other.meshes[0]).clone();
    mesh.triangles.pop();
    other.meshes[0] = Arc::new(mesh);
    assert_eq!(get(&other, 1), 4, "another mesh of the same id");
    assert_eq!(get(&plain, 1), 1);
}
