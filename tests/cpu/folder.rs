//! A temporary directory for a test, and the small files that tests of the command line write there.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

/// A directory of its own for a test, gone afterwards.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path =
            std::env::temp_dir().join(format!("caustica-cli-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub(crate) const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl red\nf 1 2 3\n";

/// A small, valid scene with one object.
pub(crate) fn scene_text(mesh: &str) -> String {
    format!(
        r#"{{ "floor": {{ "depth_m": 2, "size_m": [4, 4] }}, "objects": [{{ "mesh": "{mesh}" }}],
        "output": {{ "kind": "irradiance_map", "receiver": "floor", "width": 4, "height": 4 }} }}"#
    )
}
