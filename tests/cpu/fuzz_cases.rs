//! Finds and seeds of fuzzing: the checks of the fuzz targets hold for all of them.

use std::path::Path;

use caustica::lab::hard_cases;
use serde_json::{Value, json};

use super::fuzz_checks;

/// Runs `check` on every file of a folder of `fuzz/regressions`, and counts them.
fn replay(folder: &str, check: fn(&[u8])) -> usize {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/regressions")
        .join(folder);
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        println!("{}", path.display());
        check(&std::fs::read(&path).unwrap());
        count += 1;
    }
    count
}

#[test]
fn scenes_that_fuzzing_has_found_are_read_or_refused() {
    assert!(replay("scene", fuzz_checks::scene::check) > 0);
}

#[test]
fn meshes_that_fuzzing_has_found_are_read_or_refused() {
    assert!(replay("obj", fuzz_checks::obj::check) > 0);
}

#[test]
fn fields_are_read_or_refused() {
    assert!(replay("../../tests/fixtures/fields", fuzz_checks::field::check) > 0);
}

#[test]
fn height_fields_of_any_file_are_planned_or_refused() {
    let field = |more: Value| {
        let mut field = json!({ "kind": "height_field", "frames": ["blake3:00"], "sample_m": 0.1, "range_m": [-0.01, 0.01], "frames_per_s": 2 });
        for (name, value) in more.as_object().unwrap() {
            field[name] = value.clone();
        }
        let scene = json!({
            "water": { "waves": [field] },
            "floor": { "depth_m": 1, "size_m": [2, 2] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "output": { "kind": "irradiance_map", "receiver": "floor" },
            "time_s": 0.3
        });
        scene.to_string()
    };
    for more in [
        json!({}),
        json!({ "edges": "periodic", "rows_along": "z", "first_row": "max" }),
        json!({ "frames": ["blake3:00", "blake3:01"], "after": "loop", "rim_m": 0.2, "rest_m": 0 }),
        json!({ "holds": "slopes" }),
        json!({ "frames": [] }),
    ] {
        fuzz_checks::scene::check(field(more).as_bytes());
    }
}

#[test]
fn the_hard_cases_have_scenes_to_begin_with() {
    for case in hard_cases::all() {
        let mut scene = hard_cases::scene(case).unwrap_or_else(|| panic!("{} has none", case.name));
        for object in scene["objects"].as_array_mut().into_iter().flatten() {
            fuzz_checks::obj::check(object["mesh"].as_str().unwrap().as_bytes());
            object["mesh"] = Value::from("a_mesh");
        }
        fuzz_checks::scene::check(scene.to_string().as_bytes());
    }
}
