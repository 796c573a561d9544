//! Writes the seeds of fuzzing: the project's scenes, the scenes of the hard cases, one scene per method, meshes, and files of numbers.
//! `make fuzz` runs it.
//!
//! Usage: `fuzz_seeds FOLDER`; files go to `FOLDER/scene`, `FOLDER/obj` and `FOLDER/field`.

use std::error::Error;
use std::path::Path;

use caustica::lab::hard_cases;
use caustica::methods;
use caustica::scene::MethodChoice;
use serde_json::{Value, json};

/// Largest seed; larger ones make every run slow.
const MOST_BYTES: usize = 16 << 10;

/// OBJ files with more than plain triangles.
const OBJS: [(&str, &str); 10] = [
    ("relative", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"),
    (
        "normals",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2/1/1 3/1/1\nf 3//1 2//1 1//1\n",
    ),
    (
        "polygon",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 0.2 0\nv 0 1 0\nf 1 2 3 4 5\n",
    ),
    (
        "broken",
        "# all that is mended\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e-30 0 0\nf 1 1 2\nf 1 2 3\nf 2 3 1\nf 1 2\nf 1 4 2\nl 1 2\ns off\n",
    ),
    (
        "numbers",
        "v 1e6 -1e-6 .5 1.0\nv 1e6 1 0\nv 1000001 0 +0\nvn 0 0 0\nvn 1e300 0 1e-300\nf 1//1 2//2 3//1 \\\n",
    ),
    (
        "materials",
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl none\nf 3 2 1\nusemtl red\n\0\0newmtl red\nKd 0.8 0.1 2\nnewmtl blue\nmap_Kd a.png\nKd 1\n",
    ),
    (
        "two_libraries",
        "mtllib a.mtl b.mtl\rv 0 0 0\rv 1 0 0\rv 0 1 0\rusemtl\rusemtl röd\rf 1 2 3\r\0\0newmtl röd\nd 0.5\nillum 4\nKs 1 1 1\n\0\0newmtl röd\nKd 1 0 0\n",
    ),
    (
        "wall_with_a_door",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8 9\nf 9 8 7 6 5 4 3 2 1\nf 1 5 2 6 3\n",
    ),
    (
        "not_a_number",
        "v 0 0 0 1 0 0 1\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 1 2\nvn -nan(ind) 0 1\nvn 1.#QNAN 0\nf 1//0 2//1 3//9\nvp 0 1\nend\n",
    ),
    (
        "utf_16",
        "v\0 \x000\0 \x000\0 \x000\0\n\0f\0 \x001\0 \x001\0 \x001\0",
    ),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: fuzz_seeds FOLDER")?;
    let (scenes, objs) = (
        Path::new(&folder).join("scene"),
        Path::new(&folder).join("obj"),
    );
    std::fs::create_dir_all(&scenes)?;
    std::fs::create_dir_all(&objs)?;
    for entry in std::fs::read_dir("scenes")? {
        let path = entry?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == "json")
        {
            std::fs::copy(&path, scenes.join(entry_name(&path)))?;
        }
    }
    for case in hard_cases::all() {
        let Some(mut scene) = hard_cases::scene(case) else {
            continue;
        };
        for (index, object) in scene["objects"]
            .as_array_mut()
            .into_iter()
            .flatten()
            .enumerate()
        {
            let mesh = object["mesh"].as_str().unwrap_or_default();
            if mesh.len() <= MOST_BYTES {
                std::fs::write(objs.join(format!("{}_{index}", case.name)), mesh)?;
            }
            object["mesh"] = Value::from("a_mesh");
        }
        std::fs::write(scenes.join(case.name), serde_json::to_vec(&scene)?)?;
    }
    for method in methods::ALL {
        // With every dial, so that fuzzing can change each.
        let mut choice = MethodChoice::named(method.name);
        for dial in method.dials {
            choice = choice.with(dial, dial.default_value());
        }
        let scene = json!({
            "floor": { "depth_m": 1, "size_m": [2, 2] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "objects": [{ "mesh": "a_mesh", "translation_m": [0, -0.8, 0], "scale": 0.3 }],
            "quality": { "method": choice },
            "output": { "kind": "irradiance_map", "receiver": 0 }
        });
        let name = format!("method_{}", method.name);
        std::fs::write(scenes.join(name), serde_json::to_vec(&scene)?)?;
    }
    for (name, text) in OBJS {
        std::fs::write(objs.join(name), text)?;
    }
    std::fs::copy("scenes/meshes/box.obj", objs.join("box"))?;
    let fields = Path::new(&folder).join("field");
    std::fs::create_dir_all(&fields)?;
    for entry in std::fs::read_dir("tests/fixtures/fields")? {
        let path = entry?.path();
        std::fs::copy(&path, fields.join(entry_name(&path)))?;
    }
    Ok(())
}

fn entry_name(path: &Path) -> &std::ffi::OsStr {
    path.file_name().unwrap_or_default()
}
