//! Plans: a snapshot for every scene of the project, and no pass that a scene does not need.

use std::path::PathBuf;

use caustica::facts::placement::LevelMapKey;
use caustica::facts::{FieldKey, SceneFacts};
use caustica::graph::{Allocation, BeamSetRun, PlanError, Scope};
use caustica::methods;
use caustica::plan::{self, Cached, Plan, Wanted};
use caustica::scene::ResolvedScene;
use caustica::stages::{self, Pass, Run};
use serde_json::{Value, json};

use super::scene_files;

/// A cache that holds nothing, or everything.
struct FakeCache {
    full: bool,
}

/// Bytes of the arena.
const ARENA: u64 = 64 << 20;

impl Cached for FakeCache {
    fn has_level_map(&self, _: &LevelMapKey) -> bool {
        self.full
    }

    fn arena_bytes(&self, wanted_bytes: u64) -> u64 {
        if wanted_bytes == 0 && !self.full {
            0
        } else {
            ARENA
        }
    }

    fn has_field(&self, _: &FieldKey) -> bool {
        self.full
    }

    fn field_arena_bytes(&self, wanted_bytes: u64) -> u64 {
        if wanted_bytes == 0 && !self.full {
            0
        } else {
            ARENA
        }
    }
}

fn planned(resolved: &ResolvedScene) -> Plan {
    planned_with(resolved, false)
}

fn planned_with(resolved: &ResolvedScene, full: bool) -> Plan {
    let facts = methods::facts_with_warnings(resolved).unwrap();
    let plan = plan::plan_scene(&facts, Wanted::Frame, &FakeCache { full }).unwrap();
    plan.report
}

/// The passes of the default method, in order.
fn default_passes() -> Vec<&'static Pass> {
    methods::ALL[0].pipeline()
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.passes.iter().map(|pass| pass.name.as_str()).collect()
}

fn is_absent(plan: &Plan, name: &str) -> bool {
    plan.absent.iter().any(|pass| pass.name == name)
}

/// A pool with everything in it, seen by a camera.
fn pool() -> Value {
    json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.1 }],
            "absorption_per_m": [0.3, 0.1, 0.05]
        },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [
            { "kind": "sun", "elevation_deg": 50, "irradiance_w_m2": [1, 1, 1] },
            { "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] }
        ],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0] }],
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] },
        "output": { "kind": "view", "width": 96, "height": 64 }
    })
}

fn pool_with(changes: &[(&str, Value)]) -> Plan {
    let mut scene = pool();
    for (key, value) in changes {
        scene[*key] = value.clone();
    }
    planned(&scene_files::scene(scene))
}

/// What places light on meshes by planes.
const PLANE_PASSES: [&str; 2] = ["depth_profile", "plane_deposit"];

/// Names of the default method's passes of these scopes.
fn passes_of(scopes: &[Scope]) -> Vec<&'static str> {
    let all = default_passes().into_iter();
    let found: Vec<&str> = all
        .filter(|pass| scopes.contains(&pass.steps.scope()))
        .map(|pass| pass.name)
        .collect();
    assert!(!found.is_empty(), "no pass runs for {scopes:?}");
    found
}

fn level_map_passes() -> Vec<&'static str> {
    passes_of(&[Scope::LevelMap])
}

/// What follows lights, and compares what came of them.
fn light_passes() -> Vec<&'static str> {
    passes_of(&[
        Scope::BeamSet,
        Scope::FineBeamSet,
        Scope::BeamSetMaps,
        Scope::CoarseBeamSet,
        Scope::Estimate,
    ])
}

fn snapshot(name: &str) -> PathBuf {
    scene_files::folder()
        .join("plans")
        .join(format!("{name}.txt"))
}

#[test]
fn every_scene_has_its_plan() {
    let bless = std::env::var_os("BLESS").is_some();
    for name in scene_files::names() {
        let text = planned(&scene_files::load(&name, &[])).to_string();
        let path = snapshot(&name);
        if bless {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, &text).unwrap();
        }
        let kept = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}; BLESS=1 writes the plan", path.display()));
        assert_eq!(
            kept, text,
            "the plan of {name} has changed; BLESS=1 accepts it"
        );
    }
}

#[test]
fn no_plan_is_left_without_its_scene() {
    let names = scene_files::names();
    for entry in std::fs::read_dir(scene_files::folder().join("plans")).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        let name = file.strip_suffix(".txt").unwrap_or(&file);
        assert!(
            names.iter().any(|n| n == name),
            "{file} belongs to no scene"
        );
    }
}

#[test]
fn a_full_scene_needs_every_pass() {
    // Waves so steep that light comes out of the water again.
    let steep = json!({
        "waves": [{ "kind": "sine", "amplitude_m": 0.6, "wavelength_m": 1 }],
        "absorption_per_m": [0.3, 0.1, 0.05]
    });
    let plan = pool_with(&[
        ("quality", json!({ "estimate_error": true })),
        ("water", steep),
    ]);
    let all: Vec<&str> = default_passes().iter().map(|pass| pass.name).collect();
    // Points are what the pixels see, the method does not compute their irradiance itself, and the picture is the only output.
    let others = ["texel_points", "sky_and_air_lights", "water_map"];
    let needed: Vec<&str> = all
        .into_iter()
        .filter(|name| !others.contains(name))
        .collect();
    assert_eq!(names(&plan), needed);
    let absent: Vec<&str> = plan.absent.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(absent, others);
    assert!(plan.passes.iter().all(|pass| !pass.reason.is_empty()));
}

/// A pass is in where the scene wants it and something reads what it writes: the output, or a later pass that is in.
#[test]
fn every_pass_is_in_or_out_with_a_reason() {
    let of = |resolved: &ResolvedScene| methods::facts_with_warnings(resolved).unwrap();
    let mut all: Vec<(String, SceneFacts, Wanted)> = scene_files::names()
        .into_iter()
        .map(|name| {
            (
                name.clone(),
                of(&scene_files::load(&name, &[])),
                Wanted::Frame,
            )
        })
        .collect();
    let level_maps = of(&scene_files::scene(pool()));
    let name = "the level maps of a pool".to_owned();
    all.push((name, level_maps, Wanted::LevelMaps));
    let (mut refused, mut unread) = (0, 0);
    let passes = default_passes();
    for (name, facts, asked) in all {
        let plan = plan::plan_scene(&facts, asked, &FakeCache { full: false }).unwrap();
        let plan = plan.report;
        let is_in = |pass: &Pass| names(&plan).contains(&pass.name);
        let awaited = plan::awaited(&facts, asked);
        for (index, pass) in passes.iter().copied().enumerate() {
            let context = format!("{} in {name}", pass.name);
            let is_read = pass.writes.iter().any(|slot| {
                let later = passes[index + 1..].iter().filter(|later| is_in(later));
                let mut read =
                    later.flat_map(|later| later.reads.iter().chain(later.reads_if_present));
                awaited.contains(slot) || read.any(|read| read == slot)
            });
            let wanted = (pass.wanted)(&facts);
            assert_eq!(is_in(pass), wanted.is_ok() && is_read, "{context}");
            assert_ne!(is_in(pass), is_absent(&plan, pass.name), "{context}");
            let reason = reason_of(&plan, pass.name);
            match wanted {
                Ok(wanted) if is_read => assert_eq!(reason, wanted, "{context}"),
                Ok(_) => {
                    assert!(
                        reason.starts_with("nothing in this frame reads"),
                        "{context}"
                    );
                    unread += 1;
                }
                Err(refusal) => {
                    assert_eq!(reason, refusal, "{context}");
                    refused += 1;
                }
            }
        }
        let there = plan.passes.iter().map(|pass| &pass.reason);
        let mut reasons = there.chain(plan.absent.iter().map(|pass| &pass.reason));
        assert!(reasons.all(|reason| reason.len() > 10), "{name}");
        // A pass that is in once runs in the order of the list.
        let listed = passes.iter().filter(|pass| is_in(pass));
        assert!(listed.map(|pass| pass.name).eq(names(&plan)), "{name}");
    }
    // Both reasons for absence were covered.
    assert!(refused > 0 && unread > 0, "{refused}, {unread}");
}

#[test]
fn clear_water_attenuates_nothing() {
    let clear = pool_with(&[("water", json!({}))]);
    assert!(is_absent(&clear, "attenuation"));
    assert!(is_absent(&clear, "spectral_flux"));
    let grey = pool_with(&[("water", json!({ "absorption_per_m": [0.1, 0.1, 0.1] }))]);
    assert!(!is_absent(&grey, "attenuation"));
    assert!(is_absent(&grey, "spectral_flux"));
}

#[test]
fn one_channel_takes_a_third_of_the_flux_sums() {
    let flux = |plan: &Plan| plan.slots.iter().find(|s| s.name == "flux").unwrap().bytes;
    let clear = pool_with(&[("water", json!({}))]);
    let waves = json!({ "absorption_per_m": [0.3, 0.1, 0.05] });
    let tinted = pool_with(&[("water", waves)]);
    assert_eq!(3 * flux(&clear), flux(&tinted));
}

#[test]
fn without_meshes_there_are_no_level_maps() {
    let plan = pool_with(&[("objects", json!([]))]);
    for pass in level_map_passes() {
        assert!(is_absent(&plan, pass), "{pass}");
    }
    assert!(is_absent(&plan, "split"));
    assert!(
        plan.slots
            .iter()
            .all(|slot| slot.name != "level_maps" || slot.bytes <= 16)
    );
}

#[test]
fn cached_level_maps_are_not_built_again() {
    let plan = planned_with(&scene_files::scene(pool()), true);
    for pass in level_map_passes() {
        assert!(is_absent(&plan, pass), "{pass}");
    }
    assert!(names(&plan).contains(&"split"));
    assert!(
        plan.slots
            .iter()
            .any(|slot| slot.name == "level_maps" && slot.bytes == ARENA)
    );
}

#[test]
fn an_irradiance_map_needs_no_camera() {
    let plan = pool_with(&[(
        "output",
        json!({ "kind": "irradiance_map", "receiver": "floor" }),
    )]);
    for pass in passes_of(&[Scope::Band]) {
        assert!(is_absent(&plan, pass), "{pass}");
    }
}

#[test]
fn nothing_under_water_means_no_caustics() {
    let plan = planned(&scene_files::load("dry", &[]));
    for pass in light_passes().into_iter().chain(level_map_passes()) {
        assert!(is_absent(&plan, pass), "{pass}");
    }
}

#[test]
fn no_sun_means_no_caustics() {
    for elevation in [-10.0, 0.0] {
        let sun =
            json!([{ "kind": "sun", "elevation_deg": elevation, "irradiance_w_m2": [1, 1, 1] }]);
        let plan = pool_with(&[("lights", sun)]);
        for pass in light_passes().into_iter().chain(level_map_passes()) {
            assert!(is_absent(&plan, pass), "{pass} at {elevation}");
        }
    }
}

#[test]
fn geometry_layers_need_no_light() {
    for layers in [json!(["depth"]), json!(["normal", "position", "albedo"])] {
        let output =
            json!({ "kind": "view", "width": 96, "height": 64, "layers": layers, "format": "exr" });
        let plan = pool_with(&[("output", output)]);
        assert_eq!(names(&plan), ["camera_hits"]);
    }
}

#[test]
fn irradiance_alone_is_not_shaded() {
    let output = json!({ "kind": "view", "width": 96, "height": 64, "layers": ["irradiance"], "format": "exr" });
    let plan = pool_with(&[("output", output)]);
    assert!(is_absent(&plan, "shade"));
    assert!(names(&plan).contains(&"camera_irradiance"));
}

#[test]
fn passes_run_once_per_sun_level_map_and_band() {
    let suns: Vec<Value> = [20.0, 50.0, 80.0]
        .iter()
        .map(|e| json!({ "kind": "sun", "elevation_deg": e, "irradiance_w_m2": [1, 1, 1] }))
        .collect();
    let output = json!({ "kind": "view", "width": 4096, "height": 4096 });
    let plan = pool_with(&[("lights", json!(suns)), ("output", output)]);
    let runs = |name: &str| plan.passes.iter().find(|p| p.name == name).unwrap().runs;
    assert_eq!(runs("deposit"), 3);
    assert_eq!(runs("level_map"), 3);
    assert_eq!(
        runs("shade"),
        8,
        "32 MiB are 512 rows of 4096 pixels of 16 bytes"
    );
}

#[test]
fn equal_meshes_under_one_sun_share_a_level_map() {
    let objects = json!([
        { "mesh": "box.obj", "translation_m": [0, -1, 0] },
        { "mesh": "box.obj", "translation_m": [2, -1, 0] }
    ]);
    let plan = pool_with(&[("objects", objects)]);
    let level_map = plan.passes.iter().find(|p| p.name == "level_map").unwrap();
    assert_eq!(level_map.runs, 1);
}

#[test]
fn layers_multiply_the_maps_of_objects() {
    let plan = |layers: u32| pool_with(&[("quality", json!({ "layers": layers }))]);
    let (one, three) = (plan(1), plan(3));
    let bytes = |plan: &Plan, name: &str| plan.slots.iter().find(|s| s.name == name).unwrap().bytes;
    let map = 256 * 256;
    let more = |name: &str| bytes(&three, name) - bytes(&one, name);
    assert_eq!(more("flux"), 2 * 8 * 3 * map);
    assert_eq!(more("irradiance"), 2 * 12 * map);
    for target in ["layer_depth", "layer_normal"] {
        assert_eq!(more(target), 2 * 4 * map, "{target}");
    }
    let level_map = three.passes.iter().find(|p| p.name == "level_map").unwrap();
    assert!(
        level_map.reason.contains("in 3 layers"),
        "{}",
        level_map.reason
    );
    let irradiance = three
        .passes
        .iter()
        .find(|p| p.name == "irradiance")
        .unwrap();
    assert!(
        irradiance.reason.contains("3 for each object"),
        "{}",
        irradiance.reason
    );
}

/// Boxes in a row away from the camera, one beside its picture, and one behind it.
fn row_of_boxes(detail: f64) -> Value {
    let mut scene = pool();
    let boxes = [
        [0.0, 0.0],
        [0.0, -6.0],
        [0.0, -30.0],
        [60.0, -30.0],
        [0.0, 20.0],
    ];
    scene["objects"] = boxes
        .iter()
        .map(|[x, z]| json!({ "mesh": "box.obj", "translation_m": [x, -1, z] }))
        .collect();
    scene["quality"] = json!({ "level_of_detail": detail });
    scene["output"] = json!({ "kind": "view", "width": 480, "height": 320 });
    scene["camera"] = json!({ "position_m": [0, 2, 4], "target_m": [0, -1, -2] });
    scene
}

#[test]
fn maps_go_by_the_size_on_the_picture() {
    let sizes = |detail: f64| -> Vec<u32> {
        let mut scene = row_of_boxes(detail);
        scene["quality"]["method"] = json!("planes");
        let facts = methods::facts(&scene_files::scene(scene)).unwrap();
        let sizes: Vec<u32> = facts
            .receivers
            .objects
            .iter()
            .map(|o| o.map_texels)
            .collect();
        for (object, &texels) in sizes.iter().enumerate() {
            assert_eq!(facts.detail_of(object), f64::from(texels) / 256.0);
            // 51 planes, 50 distances, as many fewer as the map is smaller.
            let distances = (50.0 * f64::from(texels) / 256.0).round() as u32;
            assert_eq!(facts.planes_of(object), 1 + distances.max(1));
        }
        sizes
    };
    assert_eq!(sizes(0.0), [256; 5], "it is off unless asked for");
    let one = sizes(1.0);
    println!("{one:?}");
    assert!(
        one[0] >= 128 && one[0] > one[1] && one[1] > one[2],
        "{one:?}"
    );
    assert_eq!(
        one[3..],
        [16, 16],
        "beside the picture and behind the camera"
    );
    let two = sizes(2.0);
    for (one, two) in one[..3].iter().zip(&two) {
        assert_eq!((2 * one).min(256), *two, "{two:?}");
    }
    let plan = planned(&scene_files::scene(row_of_boxes(1.0)));
    for name in ["level_map", "irradiance"] {
        let reason = &plan.passes.iter().find(|p| p.name == name).unwrap().reason;
        assert!(
            reason.contains("with smaller maps by quality.level_of_detail"),
            "{reason}"
        );
    }
}

#[test]
fn objects_maps_are_finished_in_one_dispatch() {
    let steps = |count: usize| {
        let mut scene = pool();
        let place = |i: usize| json!([i as f64 * 0.1, -1, 0]);
        scene["objects"] = (0..count)
            .map(|i| json!({ "mesh": "box.obj", "translation_m": place(i), "scale": 0.1 }))
            .collect();
        let facts = methods::facts(&scene_files::scene(scene)).unwrap();
        let set = BeamSetRun {
            index: 0,
            wide_sums: false,
        };
        let steps = &stages::irradiance::PASS.steps;
        steps.of(&facts, Run::BeamSet(set)).unwrap().len()
    };
    assert_eq!((steps(0), steps(1), steps(20)), (1, 2, 2));
}

/// Slots that do not live at the same time share memory; nothing else does, and the peak counts each byte once.
#[test]
fn the_peak_counts_shared_memory_once() {
    let mut sharing = 0;
    for name in scene_files::names() {
        let facts = methods::facts_with_warnings(&scene_files::load(&name, &[])).unwrap();
        let plan = plan::plan_scene(&facts, Wanted::Frame, &FakeCache { full: false }).unwrap();
        let slots = &plan.graph.slots;
        for (number, bytes) in plan.graph.buffers.iter().enumerate() {
            let lies_here = |s: &&caustica::graph::PlannedSlot<stages::Caustica>| {
                s.allocation == Allocation::Buffer(number)
            };
            let own: Vec<_> = slots.iter().filter(lies_here).collect();
            assert!(own.iter().all(|slot| slot.bytes <= *bytes), "{name}");
            assert!(
                own.iter().any(|s| s.bytes.next_multiple_of(4) == *bytes),
                "{name}"
            );
            for (k, a) in own.iter().enumerate() {
                for b in &own[k + 1..] {
                    let apart = a.life[1] < b.life[0] || b.life[1] < a.life[0];
                    assert!(apart, "{:?} and {:?} of {name}", a.slot, b.slot);
                    sharing += 1;
                }
            }
        }
        let report = &plan.report;
        let owned = report.slots.iter().filter(|slot| slot.shares.is_none());
        let of_textures = slots
            .iter()
            .filter(|s| s.allocation == Allocation::Textures);
        let textures: u64 = of_textures.map(|slot| slot.bytes).sum();
        let sum: u64 = owned.map(|slot| slot.bytes).sum::<u64>() - textures;
        assert_eq!(report.peak_bytes, sum + plan.graph.texture_bytes, "{name}");
    }
    assert!(sharing > 20, "{sharing}");
}

#[test]
fn a_pass_without_its_source_is_an_error() {
    let facts = methods::facts(&scene_files::scene(pool())).unwrap();
    for gone in ["surface", "camera_hits", "hits"] {
        let mut list = default_passes();
        list.retain(|pass| pass.name != gone);
        let error =
            plan::plan(&list, &facts, Wanted::Frame, &FakeCache { full: false }).unwrap_err();
        let has_name = matches!(error, PlanError::NothingWrites { slot, .. } if !slot.is_empty());
        assert!(has_name, "{gone}: {error}");
    }
    // What is requested needs a pass that makes it.
    let mut list = default_passes();
    list.retain(|pass| pass.name != "irradiance");
    let mut scene = pool();
    scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
    let facts = methods::facts(&scene_files::scene(scene)).unwrap();
    let error = plan::plan(&list, &facts, Wanted::Frame, &FakeCache { full: false }).unwrap_err();
    let expected = PlanError::NothingMakes { slot: "irradiance" };
    assert_eq!(error, expected);
}

/// The scope decides when a pass runs, not only its place in the list.
#[test]
fn a_pass_of_an_earlier_scope_cannot_read_what_comes_later() {
    static EARLY: Pass = Pass {
        name: "early",
        shader: "none.wgsl",
        reads: &[&stages::beams::BEAMS],
        reads_if_present: &[],
        writes: &[&stages::split::SPLIT_QUEUE],
        uniforms: &[],
        views: &[],
        wanted: |_| Ok("a test".to_owned()),
        steps: stages::Steps::Frame(|_| Vec::new()),
        work: |_| 0.0,
    };
    let facts = methods::facts(&scene_files::scene(pool())).unwrap();
    let mut list = default_passes();
    let place = list.iter().position(|pass| pass.name == "hits").unwrap();
    list.insert(place, &EARLY);
    let error = plan::plan(&list, &facts, Wanted::Frame, &FakeCache { full: false }).unwrap_err();
    let expected = PlanError::NothingWrites {
        pass: "early",
        slot: "beams",
    };
    assert_eq!(error, expected);
}

#[test]
fn a_pass_before_its_source_is_an_error() {
    let facts = methods::facts(&scene_files::scene(pool())).unwrap();
    let mut list = default_passes();
    let place = |name: &str| list.iter().position(|p| p.name == name).unwrap();
    let (beams, hits) = (place("beams"), place("hits"));
    list.swap(beams, hits);
    let error = plan::plan(&list, &facts, Wanted::Frame, &FakeCache { full: false }).unwrap_err();
    let expected = PlanError::NothingWrites {
        pass: "hits",
        slot: "beams",
    };
    assert_eq!(error, expected);
}

#[test]
fn scenes_are_fast_with_narrow_sums_and_extremes_are_exact_with_wide_ones() {
    for name in scene_files::names() {
        for cells in ["64", "256", "512", "1024"] {
            let scene = scene_files::load(&name, &[("/quality/water_cells", cells)]);
            let facts = methods::facts(&scene).unwrap();
            for sun in 0..facts.lights.beam_sets.len() {
                let wide = stages::light::needs_wide_sums(&facts, sun);
                if facts.lights.beam_sets[sun].source.position_m().is_some() {
                    continue; // beams of a lamp differ in size: wide sums are common
                }
                // 512² cells are 128 beams for each of the 64² texels of flat.json.
                let crowded = name == "flat" && matches!(cells, "512" | "1024");
                assert_eq!(wide, crowded, "{name}, {cells}");
            }
        }
    }
    // The reef's boxes are small for its pool: where their maps are asked for too, their texels would count too coarsely.
    let mut facts = methods::facts(&scene_files::load("reef", &[])).unwrap();
    facts.output.receiver = None;
    assert!(stages::light::needs_wide_sums(&facts, 0));
    for (cells, side) in [("1024", "4"), ("2", "2048")] {
        let changes = [
            ("/quality/water_cells", cells),
            ("/output/width", side),
            ("/output/height", side),
        ];
        let facts = methods::facts(&scene_files::load("flat", &changes)).unwrap();
        assert!(
            stages::light::needs_wide_sums(&facts, 0),
            "{cells} cells, {side}²"
        );
    }
}

/// Bytes of a slot of a plan.
fn bytes_of(plan: &Plan, slot: &str) -> Option<u64> {
    let found = plan.slots.iter().find(|s| s.name == slot);
    found.map(|s| s.bytes)
}

fn reason_of(plan: &Plan, pass: &str) -> String {
    let there = plan.passes.iter().map(|p| (&p.name, &p.reason));
    let absent = plan.absent.iter().map(|p| (&p.name, &p.reason));
    let found = there.chain(absent).find(|(name, _)| *name == pass);
    found.unwrap().1.clone()
}

#[test]
fn planes_are_in_where_they_are_asked_for() {
    let hit = pool_with(&[]);
    for pass in PLANE_PASSES {
        assert!(!names(&hit).contains(&pass), "{pass}");
    }
    assert_eq!(bytes_of(&hit, "plane_lists"), None);
    let quality = json!({ "method": { "kind": "planes", "planes": 17 } });
    let planes = pool_with(&[("quality", quality)]);
    assert!(names(&planes).contains(&"depth_profile"));
    assert_eq!(
        reason_of(&planes, "plane_deposit"),
        "1 object under water, cut by 17 planes"
    );
    assert_eq!(
        reason_of(&planes, "depth_profile"),
        "all 17 planes are used"
    );
    assert!(!names(&planes).contains(&"slice_deposit"));
    let quality = json!({ "method": { "kind": "planes", "planes": 17, "slicing": "smart" } });
    let smart = pool_with(&[("quality", quality)]);
    let reason = reason_of(&smart, "depth_profile");
    assert_eq!(
        reason,
        "of 17 planes, those without a surface near them are skipped"
    );
    let dry = pool_with(&[
        ("quality", json!({ "method": "planes" })),
        ("objects", json!([])),
    ]);
    assert_eq!(reason_of(&dry, "plane_deposit"), "no object is under water");
}

#[test]
fn slices_take_memory_for_each_plane_and_level_maps_do_not() {
    let with = |method: &str, planes: u32| {
        let quality =
            json!({ "method": { "kind": method, "planes": planes }, "level_map_texels": 128 });
        pool_with(&[("quality", quality)])
    };
    let image = 4 * 128 * 128;
    for planes in [2, 50, 100] {
        let plan = with("volumetric", planes);
        let slices = bytes_of(&plan, "slices");
        assert_eq!(slices, Some(image * u64::from(planes)));
        // One depth for all of them.
        assert_eq!(bytes_of(&plan, "slice_depth"), Some(image));
        assert_eq!(bytes_of(&plan, "combined"), Some(image));
        for pass in PLANE_PASSES {
            assert!(!names(&plan).contains(&pass), "{pass}");
        }
    }
    let growth = with("volumetric", 100).peak_bytes - with("volumetric", 50).peak_bytes;
    assert_eq!(growth, 50 * image);
    let growth = with("planes", 100).peak_bytes - with("planes", 50).peak_bytes;
    assert_eq!(growth, 50 * 2 * 4, "two words of the list for each plane");
}

#[test]
fn planes_say_what_they_leave_out() {
    let codes = |changes: &[(&str, Value)]| -> Vec<String> {
        let plan = pool_with(changes);
        plan.warnings.iter().map(|w| w.code.clone()).collect()
    };
    let two = json!([
        { "mesh": "box.obj", "translation_m": [0, -1, 0] },
        { "mesh": "box.obj", "translation_m": [2, -1, 0] }
    ]);
    let planes = json!({ "method": "planes", "layers": 2 });
    let found = codes(&[("objects", two.clone()), ("quality", planes)]);
    assert!(found.contains(&"objects_cast_no_shadows_on_objects".to_owned()));
    assert!(found.contains(&"further_layers_stay_dark".to_owned()));
    let found = codes(&[("objects", two)]);
    assert!(
        !found.contains(&"objects_cast_no_shadows_on_objects".to_owned()),
        "{found:?}"
    );
}

#[test]
fn sums_of_planes_are_wide() {
    let mut scene = pool();
    for (quality, wide) in [
        (json!({}), false),
        (json!({ "method": "planes" }), true),
        (json!({ "method": "volumetric" }), true),
    ] {
        scene["quality"] = quality;
        let facts = methods::facts(&scene_files::scene(scene.clone())).unwrap();
        assert_eq!(stages::light::needs_wide_sums(&facts, 0), wide);
    }
}

#[test]
fn steps_of_another_scope_are_an_error() {
    let facts = methods::facts(&scene_files::scene(pool())).unwrap();
    let set = BeamSetRun {
        index: 0,
        wide_sums: false,
    };
    let steps = &stages::beams::PASS.steps;
    assert!(steps.of(&facts, Run::BeamSet(set)).is_ok());
    for run in [Run::Frame, Run::Estimate] {
        let error = steps.of(&facts, run).err().expect("another scope");
        assert_eq!(error.scope, Scope::BeamSet);
        assert!(error.to_string().contains(error.run), "{error}");
    }
}
