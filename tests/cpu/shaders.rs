//! The shaders without an adapter: files, structs, twins and bindings against what the Rust side says of them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use caustica::gpu::shader::{Access, Module, ShaderSources};
use caustica::gpu::{GpuError, pieces};
use caustica::passes::{self, PassDesc, Slot, gpu_data, shaders};
use caustica::physics::registry;
use wgpu::naga;
use wgpu::naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};

use super::shader_constants::steps_of;

/// Storage buffers that every WebGPU device can bind to one stage.
const BASELINE_STORAGE_BUFFERS: usize = 8;
/// Textures that the executor draws into.
const TEXTURES: [&str; 7] = [
    "front_depth",
    "back_depth",
    "front_normal",
    "previous_depth",
    "layer_depth",
    "layer_normal",
    "slice",
];

/// The module of a file below `shaders/`.
pub(crate) fn module(path: &str) -> Module {
    let text = shaders::embedded()
        .assemble(path)
        .unwrap_or_else(|error| panic!("{error}"));
    Module::parse(path, text).unwrap_or_else(|error| panic!("{error}"))
}

/// All pass modules by file.
pub(crate) fn pass_modules() -> Vec<(&'static str, Module)> {
    let sources = shaders::embedded();
    let passes = sources.paths().filter(|path| path.starts_with("passes/"));
    passes.map(|path| (path, module(path))).collect()
}

fn info_of(module: &Module) -> ModuleInfo {
    Validator::new(ValidationFlags::all(), Capabilities::default())
        .validate(&module.ir)
        .unwrap()
}

fn files_below(folder: &Path, prefix: &str, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        if entry.file_type().unwrap().is_dir() {
            files_below(&entry.path(), &format!("{name}/"), found);
        } else {
            found.insert(name);
        }
    }
}

#[test]
fn every_file_is_embedded_as_it_is() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut files = BTreeSet::new();
    files_below(&folder, "", &mut files);
    let sources = shaders::embedded();
    let embedded: BTreeSet<String> = sources.paths().map(str::to_owned).collect();
    assert_eq!(embedded, files);
    for path in &files {
        let text = std::fs::read_to_string(folder.join(path)).unwrap();
        assert_eq!(sources.text(path), Some(text.as_str()), "{path}");
    }
}

#[test]
fn every_pass_has_its_shader_and_every_shader_its_pass() {
    let passes: BTreeSet<String> = passes::ALL
        .iter()
        .map(|pass| format!("passes/{}.wgsl", pass.name))
        .collect();
    assert_eq!(passes.len(), passes::ALL.len(), "a name is used twice");
    let files: BTreeSet<String> = pass_modules()
        .iter()
        .map(|(path, module)| {
            assert!(!module.ir.entry_points.is_empty(), "{path}");
            (*path).to_owned()
        })
        .collect();
    assert_eq!(passes, files);
}

#[test]
fn every_file_is_imported_by_some_pass() {
    let sources = shaders::embedded();
    let imports: String = sources
        .paths()
        .filter_map(|path| sources.text(path))
        .flat_map(str::lines)
        .filter(|line| line.trim_start().starts_with("#import"))
        .collect();
    for path in sources.paths().filter(|path| !path.starts_with("passes/")) {
        assert!(imports.contains(&format!("\"{path}\"")), "{path} is unused");
    }
}

#[test]
fn an_import_that_does_not_exist_is_an_error() {
    let sources = ShaderSources::new(&[("a.wgsl", "#import \"nowhere.wgsl\"\n")]);
    let Err(GpuError::Shader { shader, message }) = sources.assemble("a.wgsl") else {
        panic!("it was found");
    };
    assert_eq!(shader, "a.wgsl");
    assert!(message.contains("nowhere.wgsl"), "{message}");
    assert!(sources.assemble("nowhere.wgsl").is_err());
}

#[test]
fn a_file_is_pasted_once() {
    let sources = ShaderSources::new(&[
        (
            "a.wgsl",
            "#import \"b.wgsl\"\n#import \"c.wgsl\"\nfn a() { b(); c(); }\n",
        ),
        ("b.wgsl", "#import \"c.wgsl\"\nfn b() { c(); }\n"),
        ("c.wgsl", "fn c() {}\n"),
    ]);
    let text = sources.assemble("a.wgsl").unwrap();
    assert_eq!(text.matches("fn c()").count(), 1, "{text}");
    Module::parse("a.wgsl", text).unwrap();
}

#[test]
fn what_is_not_valid_is_an_error_that_shows_where() {
    for broken in ["fn a( {}", "fn a() -> f32 { return 1u; }"] {
        let Err(GpuError::Shader { message, .. }) = Module::parse("a.wgsl", broken.to_owned())
        else {
            panic!("`{broken}` passed");
        };
        assert!(message.contains("wgsl:1"), "{message}");
    }
}

#[test]
fn structs_have_the_same_layout_on_both_sides() {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for (path, module) in pass_modules() {
        for (_, ty) in module.ir.types.iter() {
            let naga::TypeInner::Struct { members, span } = &ty.inner else {
                continue;
            };
            let name = ty.name.as_deref().unwrap_or_default();
            let Some((name, size, fields)) =
                gpu_data::LAYOUTS.iter().find(|(wgsl, _, _)| *wgsl == name)
            else {
                continue;
            };
            *seen.entry(name).or_default() += 1;
            let found: Vec<(&str, usize)> = members
                .iter()
                .map(|m| (m.name.as_deref().unwrap_or_default(), m.offset as usize))
                .collect();
            assert_eq!(found, *fields, "{name} in {path}");
            assert_eq!(*span as usize, *size, "size of {name} in {path}");
        }
    }
    for (name, _, _) in gpu_data::LAYOUTS {
        assert!(seen.contains_key(name), "no shader has {name}");
    }
}

#[test]
fn every_formula_has_a_twin_and_every_twin_a_formula() {
    let sources = shaders::embedded();
    let mut in_shaders = BTreeSet::new();
    for path in sources.paths().filter(|path| path.starts_with("lib/")) {
        for (_, function) in module(path).ir.functions.iter() {
            let name = function.name.clone().unwrap_or_default();
            // Those of imported files have their row there.
            let is_own = sources.text(path).unwrap().contains(&format!("fn {name}("));
            assert!(!is_own || in_shaders.insert((path.to_owned(), name)));
        }
    }
    let in_registry: BTreeSet<(String, String)> = registry::all()
        .map(|twin| (twin.file.to_owned(), twin.name.to_owned()))
        .collect();
    assert_eq!(in_registry, in_shaders);
    assert_eq!(in_registry.len(), registry::all().count(), "a row twice");
    for twin in registry::all() {
        assert!(twin.call.contains(twin.name), "{}", twin.name);
        assert!(twin.domain.len() <= 8, "{}", twin.name);
        let reason = twin.tolerance.reason;
        assert!(
            ["derived", "measured"]
                .iter()
                .any(|word| reason.starts_with(word)),
            "{}: {reason}",
            twin.name
        );
    }
}

#[test]
fn samples_keep_to_the_domain_and_reach_its_edges() {
    for twin in registry::all() {
        let samples = registry::samples(twin, 2000);
        assert!(samples.len() >= 2000);
        for (k, domain) in twin.domain.iter().enumerate() {
            let f32_of = |end: f64| f64::from(end as f32);
            let inside = |v: f64| v >= f32_of(domain.low) && v <= f32_of(domain.high);
            assert!(samples.iter().all(|args| inside(args[k])), "{}", twin.name);
            for edge in domain.edges {
                let edge = f64::from(*edge as f32);
                assert!(samples.iter().any(|args| args[k] == edge), "{}", twin.name);
            }
        }
    }
}

/// What `pass` may bind, and what of it may be written.
fn allowed(pass: &PassDesc) -> (BTreeSet<&'static str>, BTreeSet<&'static str>) {
    let names = |slots: &[Slot]| -> Vec<&'static str> {
        slots.iter().map(|slot| slot.info().name).collect()
    };
    let written: BTreeSet<&str> = names(pass.writes).into_iter().collect();
    let mut all = written.clone();
    all.extend(names(pass.reads));
    all.extend(names(pass.reads_if_present));
    (all, written)
}

#[test]
fn passes_bind_what_they_declare() {
    for pass in passes::ALL {
        let path = format!("passes/{}.wgsl", pass.name);
        let module = module(&path);
        let info = info_of(&module);
        let (slots, written) = allowed(pass);
        let steps = steps_of(pass);
        let brought = steps.iter().flat_map(|step| &step.uniforms);
        let uniforms: BTreeSet<&str> = brought.map(|(name, _)| *name).collect();
        let mut bound_anywhere = BTreeSet::new();
        for (index, entry) in module.ir.entry_points.iter().enumerate() {
            let context = format!("{} in {path}", entry.name);
            let bindings = module.bindings(&path, &entry.name).unwrap();
            let mut storage = 0;
            for bound in &bindings {
                let name = bound.name.as_str();
                match bound.access {
                    Access::Uniform(_) => assert!(uniforms.contains(name), "{name} of {context}"),
                    Access::Texture(_) => assert!(TEXTURES.contains(&name), "{name} of {context}"),
                    Access::StorageRead | Access::StorageWrite => {
                        storage += 1;
                        assert!(slots.contains(name), "{name} of {context} is not declared");
                        assert!(Slot::by_name(name).is_some(), "{name} of {context}");
                        bound_anywhere.insert(bound.name.clone());
                    }
                }
            }
            assert!(
                storage <= BASELINE_STORAGE_BUFFERS,
                "{storage} in {context}"
            );
            for (handle, variable) in module.ir.global_variables.iter() {
                let writes = info.get_entry_point(index)[handle].contains(GlobalUse::WRITE);
                let is_storage = matches!(variable.space, naga::AddressSpace::Storage { .. });
                let name = variable.name.as_deref().unwrap_or_default();
                if writes && is_storage {
                    assert!(written.contains(name), "{context} writes {name}");
                }
            }
        }
        let draws = pass.name == "level_map";
        for slot in pass.writes {
            let name = slot.info().name;
            let draws = draws || *slot == Slot::Slices;
            assert!(
                draws || bound_anywhere.contains(name),
                "{} says it writes {name} and binds it nowhere",
                pass.name
            );
        }
    }
}

#[test]
fn bindings_of_an_unknown_entry_point_are_an_error() {
    let module = module("passes/hits.wgsl");
    assert!(module.bindings("passes/hits.wgsl", "misses_main").is_err());
}

#[test]
fn slots_have_names_of_their_own() {
    let names: BTreeSet<&str> = passes::slot::SLOTS.iter().map(|s| s.info().name).collect();
    assert_eq!(names.len(), passes::slot::SLOTS.len());
    for slot in passes::slot::SLOTS {
        assert_eq!(Slot::by_name(slot.info().name), Some(slot));
    }
    assert_eq!(Slot::by_name("nothing"), None);
}

/// A workgroup that is told where it is reads nothing else, and every entry point that reads where it is can be told.
#[test]
fn every_compute_entry_can_be_run_in_pieces() {
    let mut cut = 0;
    for (path, module) in pass_modules() {
        for entry in &module.ir.entry_points {
            if entry.stage != naga::ShaderStage::Compute || entry.function.arguments.is_empty() {
                continue;
            }
            let told = pieces::told_its_piece(&module, path, &entry.name)
                .unwrap_or_else(|error| panic!("{error}"));
            let told = Module::parse(path, told).unwrap_or_else(|error| panic!("{error}"));
            let bound = told.bindings(path, &entry.name).unwrap();
            let uniform = bound.iter().find(|bound| bound.name == pieces::PIECE);
            assert_eq!(
                uniform.map(|bound| bound.access),
                Some(Access::Uniform(32)),
                "{} of {path}",
                entry.name
            );
            // On a CPU driver they are storage buffers at an offset, of which WebGPU promises four.
            let uniforms = bound
                .iter()
                .filter(|bound| matches!(bound.access, Access::Uniform(_)));
            assert!(uniforms.count() <= 4, "{} of {path}", entry.name);
            cut += 1;
        }
    }
    assert!(cut >= 15, "{cut}");
    let module = module("passes/hits.wgsl");
    assert!(pieces::told_its_piece(&module, "passes/hits.wgsl", "misses_main").is_err());
}

/// Pieces of any size tile the dispatch: every workgroup once, in order.
#[test]
fn pieces_are_the_whole() {
    for all in [[5, 1, 1], [4, 3, 1], [4, 3, 2], [1, 7, 1], [1, 1, 1]] {
        let [x, y, z] = all;
        for most in 0..30 {
            let mut done = 0;
            let mut seen = Vec::new();
            while let Some(piece) = pieces::Piece::after(all, done, most) {
                assert!(piece.count() <= most.max(1), "{piece:?} of {most}");
                for k in 0..piece.groups[2] {
                    for j in 0..piece.groups[1] {
                        for i in 0..piece.groups[0] {
                            let [a, b, c] = piece.first;
                            seen.push(a + i + x * (b + j + y * (c + k)));
                        }
                    }
                }
                done += piece.count();
            }
            let whole: Vec<u32> = (0..x * y * z).collect();
            assert_eq!(seen, whole, "{all:?} by {most}");
        }
    }
    assert_eq!(pieces::Piece::after([3, 0, 1], 0, 4), None);
}

/// A piece that was too long makes the next one shorter, a short one makes it longer, but not by much at once.
#[test]
fn pieces_are_sized_by_the_last() {
    let longest = pieces::LONGEST_MS;
    assert_eq!(pieces::next_size(1000, longest), 500);
    assert_eq!(pieces::next_size(1000, 100.0 * longest), 5);
    assert_eq!(pieces::next_size(1000, 0.0), 16_000);
    assert_eq!(pieces::next_size(1, 1e9), 1);
}
