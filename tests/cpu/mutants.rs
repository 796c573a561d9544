//! The plants of `make mutants` fit the sources and the tests as they are.

use std::path::Path;

use super::plants;

fn text(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_plant_stands_in_its_file_once_and_changes_it() {
    for plant in plants::ALL {
        let source = text(plant.file);
        let count = source.matches(plant.from).count();
        assert_eq!(count, 1, "{} in {}", plant.from, plant.file);
        assert_ne!(plant.from, plant.to, "{}", plant.what);
        assert!(!plant.what.is_empty());
    }
    // Two plants of one description could not be told apart.
    let mut names: Vec<&str> = plants::ALL.iter().map(|plant| plant.what).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), plants::ALL.len());
}

#[test]
fn every_plant_has_tests_that_exist() {
    for plant in plants::ALL {
        assert!(["cpu", "gpu"].contains(&plant.binary), "{}", plant.what);
        assert!(!plant.tests.is_empty(), "{}", plant.what);
        for test in plant.tests {
            let (module, name) = test.split_once("::").expect("file::name");
            let source = text(&format!("tests/{}/{module}.rs", plant.binary));
            assert!(
                source.contains(&format!("#[test]\nfn {name}()")),
                "{test} does not exist"
            );
        }
    }
}

#[test]
fn reference_shaders_metrics_and_choices_are_all_planted() {
    for folder in ["src/reference/", "src/accuracy/", "src/tuning/", "shaders/"] {
        let planted = plants::ALL.iter().filter(|p| p.file.starts_with(folder));
        assert!(planted.count() > 0, "nothing is planted in {folder}");
    }
}
