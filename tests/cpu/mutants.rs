//! The planted errors of `make mutants` match the present sources, tests and hard cases.

use std::path::Path;

use caustica::lab::hard_cases::{self, Family};
use caustica::methods;

use super::shader_plants::Red;
use super::{plants, shader_plants};

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
    }
    let sources = methods::embedded();
    for plant in shader_plants::ALL {
        let source = sources
            .text(plant.file)
            .unwrap_or_else(|| panic!("there is no {}", plant.file));
        let count = source.matches(plant.from).count();
        assert_eq!(count, 1, "{} in {}", plant.from, plant.file);
        assert_ne!(plant.from, plant.to, "{}", plant.what);
    }
    // Two planted errors with the same description could not be distinguished.
    let in_shaders = shader_plants::ALL.iter().map(|plant| plant.what);
    let mut names: Vec<&str> = plants::ALL
        .iter()
        .map(|plant| plant.what)
        .chain(in_shaders)
        .collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
    assert!(names.iter().all(|name| !name.is_empty()));
}

#[test]
fn every_plant_has_tests_that_exist() {
    for plant in plants::ALL {
        assert!(["cpu", "gpu"].contains(&plant.binary), "{}", plant.what);
        assert!(!plant.tests.is_empty(), "{}", plant.what);
        for test in plant.tests {
            if let Some(case) = test.strip_prefix("hard_cases::") {
                assert_eq!(plant.binary, "gpu", "{}", plant.what);
                let (family, name) = case.split_once("::").expect("family::case");
                assert_eq!(is_known_to_hold(name), family, "{name}");
                continue;
            }
            let (module, name) = test.split_once("::").expect("file::name");
            let source = text(&format!("tests/{}/{module}.rs", plant.binary));
            assert!(
                source.contains(&format!("#[test]\nfn {name}()")),
                "{test} does not exist"
            );
        }
    }
    for plant in shader_plants::ALL {
        let (Red::Only(names) | Red::AllBut(names)) = plant.red;
        for name in names {
            is_known_to_hold(name);
        }
        let mut own = hard_cases::all().filter(|case| case.family.name() == plant.family);
        assert!(own.any(|case| plant.red.holds(case.name)), "{}", plant.what);
    }
}

/// The family of a hard case that can notice something: it is not known to fail.
fn is_known_to_hold(name: &str) -> &'static str {
    let case = hard_cases::find(name).unwrap_or_else(|| panic!("there is no case {name}"));
    assert_eq!(case.known_failure, None, "{name}");
    case.family.name()
}

#[test]
fn reference_metrics_choices_and_every_family_are_planted() {
    for folder in [
        "src/reference/",
        "src/accuracy/",
        "src/tuning/",
        "src/waves/",
    ] {
        let planted = plants::ALL.iter().filter(|p| p.file.starts_with(folder));
        assert!(planted.count() > 0, "nothing is planted in {folder}");
    }
    // Shaders have nothing to do with what befalls a machine.
    for family in Family::ALL {
        let name = family.name();
        let planted = shader_plants::ALL.iter().any(|plant| plant.family == name);
        assert_eq!(planted, family != Family::Machine, "{name}");
    }
    let machine = format!("hard_cases::{}::", Family::Machine.name());
    let mut tests = plants::ALL.iter().flat_map(|plant| plant.tests);
    assert!(tests.any(|test| test.starts_with(&machine)));
}
