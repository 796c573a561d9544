//! The shaders without an adapter: files, structs, twins and bindings against the Rust side.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use caustica::gpu::shader::{Access, Module, ShaderSources};
use caustica::gpu::{GpuError, pieces};
use caustica::graph::Layout;
use caustica::methods;
use caustica::physics::registry;
use caustica::stages::Slot;
use wgpu::naga;
use wgpu::naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};

/// Storage buffers that every WebGPU device can bind to one stage.
const BASELINE_STORAGE_BUFFERS: usize = 8;
/// The module of a file below `shaders/`.
pub(crate) fn module(path: &str) -> Module {
    let text = methods::embedded()
        .assemble(path)
        .unwrap_or_else(|error| panic!("{error}"));
    Module::parse(path, text).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether a file is the shader of a pass.
fn is_of_a_pass(path: &&str) -> bool {
    path.starts_with("stages/") || path.starts_with("methods/")
}

/// All pass modules by file.
pub(crate) fn pass_modules() -> Vec<(&'static str, Module)> {
    let sources = methods::embedded();
    let passes = sources.paths().filter(is_of_a_pass);
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
    let sources = methods::embedded();
    let embedded: BTreeSet<String> = sources.paths().map(str::to_owned).collect();
    assert_eq!(embedded, files);
    for path in &files {
        let text = std::fs::read_to_string(folder.join(path)).unwrap();
        assert_eq!(sources.text(path), Some(text.as_str()), "{path}");
    }
}

#[test]
fn every_pass_has_its_shader_and_every_shader_its_pass() {
    let all = methods::all_passes();
    let names: BTreeSet<&str> = all.iter().map(|pass| pass.name).collect();
    assert_eq!(names.len(), all.len(), "a name is used twice");
    let passes: BTreeSet<String> = all.iter().map(|pass| pass.shader.to_owned()).collect();
    for pass in &all {
        assert!(
            pass.shader.ends_with(&format!("/{}.wgsl", pass.name)),
            "{pass:?}"
        );
    }
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
    let sources = methods::embedded();
    let imports: String = sources
        .paths()
        .filter_map(|path| sources.text(path))
        .flat_map(str::lines)
        .filter(|line| line.trim_start().starts_with("#import"))
        .collect();
    for path in sources.paths().filter(|path| !is_of_a_pass(path)) {
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
fn invalid_wgsl_is_an_error_with_its_line() {
    for broken in ["fn a( {}", "fn a() -> f32 { return 1u; }"] {
        let Err(GpuError::Shader { message, .. }) = Module::parse("a.wgsl", broken.to_owned())
        else {
            panic!("`{broken}` passed");
        };
        assert!(message.contains("wgsl:1"), "{message}");
    }
}

/// Layouts of all structs that host and shaders share: uniforms of passes, and elements of slots.
fn layouts() -> Vec<Layout> {
    let mut all: BTreeMap<&str, Layout> = BTreeMap::new();
    for pass in methods::all_passes() {
        let uniforms = pass.uniforms.iter().map(|(_, layout)| *layout);
        for layout in uniforms.chain(pass.slots().filter_map(|slot| slot.element)) {
            let known = all.insert(layout.0, layout);
            assert!(known.is_none_or(|known| known == layout), "{}", layout.0);
        }
    }
    all.into_values().collect()
}

#[test]
fn structs_have_the_same_layout_on_both_sides() {
    let layouts = layouts();
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for (path, module) in pass_modules() {
        for (_, ty) in module.ir.types.iter() {
            let naga::TypeInner::Struct { members, span } = &ty.inner else {
                continue;
            };
            let name = ty.name.as_deref().unwrap_or_default();
            let Some((name, size, fields)) = layouts.iter().find(|(wgsl, _, _)| *wgsl == name)
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
    for (name, _, _) in layouts {
        assert!(seen.contains_key(name), "no shader has {name}");
    }
}

#[test]
fn every_formula_has_a_twin_and_every_twin_a_formula() {
    let sources = methods::embedded();
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

/// Every variable that a pass binds is a slot it declares, a uniform of it or a view of its steps; every slot that it says it reads or
/// writes is bound, or drawn into; and what it writes is among its writes.
#[test]
fn passes_bind_what_they_declare_and_declare_what_they_bind() {
    for pass in methods::all_passes() {
        let path = pass.shader;
        let module = module(path);
        let info = info_of(&module);
        let slots: BTreeSet<&str> = pass.slots().map(|slot| slot.name).collect();
        let written: BTreeSet<&str> = pass.writes.iter().map(|slot| slot.name).collect();
        let uniforms: BTreeSet<&str> = pass.uniforms.iter().map(|(name, _)| *name).collect();
        let mut bound_views = BTreeSet::new();
        let (mut bound_slots, mut bound_uniforms) = (BTreeSet::new(), BTreeSet::new());
        for (index, entry) in module.ir.entry_points.iter().enumerate() {
            let context = format!("{} in {path}", entry.name);
            let bindings = module.bindings(path, &entry.name).unwrap();
            let mut storage = 0;
            for bound in &bindings {
                let name = bound.name.as_str();
                match bound.access {
                    Access::Uniform(_) => {
                        assert!(uniforms.contains(name), "{name} of {context}");
                        bound_uniforms.insert(bound.name.clone());
                    }
                    Access::Texture { .. } | Access::StorageTexture { .. } => {
                        let is_view = pass.views.contains(&name);
                        assert!(slots.contains(name) || is_view, "{name} of {context}");
                        if is_view {
                            bound_views.insert(bound.name.clone());
                        }
                        bound_slots.insert(bound.name.clone());
                    }
                    Access::StorageRead | Access::StorageWrite => {
                        storage += 1;
                        assert!(slots.contains(name), "{name} of {context} is not declared");
                        bound_slots.insert(bound.name.clone());
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
        for slot in pass.slots() {
            // A texture that is written is drawn into.
            let is_drawn = !slot.is_buffer() && written.contains(slot.name);
            // What a pass draws it may leave to the next one to put where it belongs.
            let is_handed_on = pass.name == "level_map" && slot.name == "level_maps";
            assert!(
                is_drawn || is_handed_on || bound_slots.contains(slot.name),
                "{} declares {slot:?} and binds it nowhere",
                pass.name
            );
        }
        for view in pass.views {
            assert!(bound_views.contains(*view), "{view} of {}", pass.name);
        }
        for uniform in uniforms {
            assert!(
                bound_uniforms.contains(uniform),
                "{uniform} of {}",
                pass.name
            );
        }
    }
}

#[test]
fn bindings_of_an_unknown_entry_point_are_an_error() {
    let module = module("stages/hits.wgsl");
    assert!(module.bindings("stages/hits.wgsl", "misses_main").is_err());
}

/// Slots are identified by their names: two with the same name are the same.
#[test]
fn slot_names_are_unique() {
    let mut known: BTreeMap<&str, &'static Slot> = BTreeMap::new();
    for pass in methods::all_passes() {
        for slot in pass.slots() {
            let first = known.entry(slot.name).or_insert(slot);
            assert!(std::ptr::eq(*first, slot), "two slots are called {slot:?}");
        }
    }
    assert!(known.len() > 20, "{}", known.len());
}

/// Every compute entry point that takes builtins can be rewritten to run in pieces, and binds the piece's offset as a uniform.
#[test]
fn every_compute_entry_can_be_run_in_pieces() {
    let mut cut = 0;
    for (path, module) in pass_modules() {
        for entry in &module.ir.entry_points {
            if entry.stage != naga::ShaderStage::Compute || entry.function.arguments.is_empty() {
                continue;
            }
            let piece = pieces::with_piece_offset(&module, path, &entry.name)
                .unwrap_or_else(|error| panic!("{error}"));
            let piece = Module::parse(path, piece).unwrap_or_else(|error| panic!("{error}"));
            let bound = piece.bindings(path, &entry.name).unwrap();
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
    let module = module("stages/hits.wgsl");
    assert!(pieces::with_piece_offset(&module, "stages/hits.wgsl", "misses_main").is_err());
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
