//! References kept on disk.

use std::path::{Path, PathBuf};

use caustica::reference::{Truth, TruthSettings, truth};
use caustica::scene::ResolvedScene;

use crate::folder::Folder;
use crate::reference::{SINE_POOL, resolved, set_map};

fn ask(scene: &ResolvedScene, folder: &Path, target_error: f64) -> Truth {
    let settings = TruthSettings {
        target_error: Some(target_error),
        disk: Some(folder.to_owned()),
        ..TruthSettings::default()
    };
    truth(scene, &settings, &|_| (), &|| false).unwrap()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect()
}

#[test]
fn a_truth_is_found_again() {
    let folder = Folder::new();
    let mut scene = resolved(SINE_POOL);
    set_map(&mut scene.scene, 0.5, 16, 16);
    let folder = folder.0.join("made");
    let first = ask(&scene, &folder, 0.05);
    assert!(!first.from_disk);
    // Dials and worse targets have no say; the values are the same to the bit.
    scene.scene.quality.water_cells = 77;
    let again = ask(&scene, &folder, 0.2);
    assert!(again.from_disk);
    assert_eq!(
        Truth {
            from_disk: false,
            ..again
        },
        first
    );
    // A better one is requested: it is computed, and kept instead.
    let better = ask(&scene, &folder, first.relative_error * 0.3);
    assert!(!better.from_disk && better.relative_error < first.relative_error);
    assert!(ask(&scene, &folder, 0.05).relative_error == better.relative_error);
    assert_eq!(files(&folder).len(), 1, "one file, no left-overs");
    // Another scene is another truth.
    scene.scene.time_s = 1.0;
    assert!(!ask(&scene, &folder, 0.05).from_disk);
    assert_eq!(files(&folder).len(), 2);
}

#[test]
fn damaged_and_foreign_files_are_not_believed() {
    let folder = Folder::new();
    let mut scene = resolved(SINE_POOL);
    set_map(&mut scene.scene, 0.5, 8, 8);
    let first = ask(&scene, &folder.0, 0.05);
    let file = files(&folder.0).remove(0);
    let good = std::fs::read(&file).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    let mut version = good.clone();
    version[15] = b'0';
    let body = version.len() - 32;
    let hash = blake3::hash(&version[..body]);
    version[body..].copy_from_slice(hash.as_bytes());
    for bad in [
        flipped,
        version,
        good[..good.len() - 1].to_vec(),
        Vec::new(),
        vec![0; 40],
    ] {
        std::fs::write(&file, bad).unwrap();
        let again = ask(&scene, &folder.0, 0.05);
        assert!(!again.from_disk);
        assert_eq!(again.irradiance, first.irradiance);
        assert!(ask(&scene, &folder.0, 0.05).from_disk, "mended");
    }
    // A whole file of another question under this name.
    scene.scene.time_s = 2.0;
    std::fs::remove_file(&file).unwrap();
    ask(&scene, &folder.0, 0.05);
    std::fs::rename(files(&folder.0).remove(0), &file).unwrap();
    scene.scene.time_s = 0.0;
    assert!(!ask(&scene, &folder.0, 0.05).from_disk);
}

#[test]
fn a_folder_that_cannot_be_written_costs_no_truth() {
    let folder = Folder::new();
    let blocked = folder.0.join("file");
    std::fs::write(&blocked, "no folder").unwrap();
    let mut scene = resolved(SINE_POOL);
    set_map(&mut scene.scene, 0.5, 8, 8);
    assert!(!ask(&scene, &blocked, 0.05).from_disk);
}
