//! The box of a kept field, and plans with and without it.

use caustica::facts::placement::LevelMapKey;
use caustica::facts::{FieldBox, FieldKey, Product, SceneFacts};
use caustica::methods;
use caustica::plan::{self, Cached, Plan, Wanted};
use serde_json::{Value, json};

use super::scene_files;

/// A GPU that holds some of the fields, and no level map.
struct Holds(Vec<FieldKey>);

impl Cached for Holds {
    fn has_level_map(&self, _: &LevelMapKey) -> bool {
        false
    }

    fn arena_bytes(&self, wanted_bytes: u64) -> u64 {
        wanted_bytes
    }

    fn has_field(&self, key: &FieldKey) -> bool {
        self.0.contains(key)
    }

    fn field_arena_bytes(&self, wanted_bytes: u64) -> u64 {
        wanted_bytes
    }
}

/// Name of the first method that makes a field.
fn field_method() -> &'static str {
    let mut all = methods::ALL.into_iter();
    let found = all.find(|method| method.facts_of_default().product == Product::Field);
    found.expect("a method makes fields").name
}

fn facts(mut scene: Value) -> SceneFacts {
    scene["quality"]["method"] = json!(field_method());
    methods::facts(&scene_files::scene(scene)).unwrap()
}

fn field(scene: Value) -> FieldBox {
    facts(scene).field.expect("there is a field")
}

fn pool(objects: Value, camera_m: [f64; 3]) -> Value {
    json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1 }] },
        "floor": { "depth_m": 2, "size_m": [40, 30] },
        "lights": [
            { "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] },
            { "kind": "sun", "elevation_deg": 40, "irradiance_w_m2": [1, 1, 1] }
        ],
        "objects": objects,
        "camera": { "position_m": camera_m, "target_m": [0, -1, 0], "vertical_fov_deg": 30 },
        "output": { "kind": "view", "width": 64, "height": 48 }
    })
}

fn box_at(at_m: [f64; 3]) -> Value {
    json!([{ "mesh": "box.obj", "translation_m": at_m, "scale": 0.4 }])
}

#[test]
fn a_map_of_the_floor_is_the_lowest_slice() {
    let mut scene = pool(json!([]), [0.0, 3.0, 1.0]);
    scene["output"] = json!({ "kind": "irradiance_map", "receiver": "floor",
        "min_m": [3, 4], "max_m": [7, 6], "width": 256, "height": 128 });
    let own = facts(scene);
    let (field, map) = (own.field.unwrap(), own.receivers.floor_map.unwrap());
    assert_eq!(field.rect, map.rect);
    assert_eq!([field.width, field.height], [256, 128]);
    assert_eq!(field.bottom_m, -2.0);
    assert!((field.top_m - 0.02).abs() < 1e-12);
    let due = field.top_m - field.bottom_m;
    assert!((field.spacing_m() * f64::from(field.slices - 1) - due).abs() < 1e-12);
}

#[test]
fn the_box_holds_what_is_lit_and_does_not_follow_it() {
    let own = facts(pool(box_at([0.2, -1.0, 0.1]), [0.0, 3.0, 1.0]));
    let first = own.field.unwrap();
    let seen = own.receivers.floor_map.unwrap().rect;
    for lit in [seen.min, seen.max] {
        assert!(lit.cmpge(first.rect.min).all() && lit.cmple(first.rect.max).all());
    }
    for step in 0..20 {
        let aside_m = 0.02 * f64::from(step);
        let next = pool(
            box_at([0.2 - aside_m, -1.2, aside_m]),
            [0.1 * aside_m, 3.0, 1.0],
        );
        assert_eq!(field(next), first, "after {aside_m} m");
    }
    // Far from the others, but in the box.
    let far = field(pool(box_at([9.0, -1.0, 0.0]), [0.0, 3.0, 1.0]));
    assert!(far.rect.max.x >= 9.2, "{far:?}");
}

#[test]
fn the_lowest_slice_is_below_what_the_floor_does_not_hide() {
    let beside = field(pool(box_at([25.0, -4.0, 0.0]), [0.0, 3.0, 1.0]));
    assert!(
        beside.bottom_m <= -4.2 && beside.bottom_m >= -8.0,
        "{beside:?}"
    );
    let sunk = field(pool(box_at([0.0, -2.1, 0.0]), [0.0, 3.0, 1.0]));
    assert_eq!(sunk.bottom_m, -2.0, "the floor hides what is below it");
    let mut floorless = pool(box_at([0.0, -1.0, 0.0]), [0.0, 3.0, 1.0]);
    floorless.as_object_mut().unwrap().remove("floor");
    let floorless = field(floorless);
    assert!(
        floorless.bottom_m <= -1.2 && floorless.bottom_m >= -2.0,
        "{floorless:?}"
    );
}

fn plan_of(facts: &SceneFacts, kept: &[FieldKey]) -> Plan {
    let cached = Holds(kept.to_vec());
    plan::plan_scene(facts, Wanted::Frame, &cached)
        .unwrap()
        .report
}

#[test]
fn what_makes_a_kept_field_is_absent() {
    let own = facts(pool(box_at([0.2, -1.0, 0.1]), [0.0, 3.0, 1.0]));
    let keys: Vec<FieldKey> = plan::fields(&own).into_iter().cloned().collect();
    assert_eq!(keys.len(), 2, "one for each sun");
    let of_light = |plan: &Plan| -> Vec<u32> {
        let passes = plan.passes.iter();
        passes
            .filter(|pass| ["surface", "beams"].contains(&pass.name.as_str()))
            .map(|pass| pass.runs)
            .collect()
    };
    assert_eq!(of_light(&plan_of(&own, &[])), [2, 2]);
    assert_eq!(
        of_light(&plan_of(&own, &keys[..1])),
        [1, 1],
        "the other sun's"
    );
    let warm = plan_of(&own, &keys);
    assert_eq!(of_light(&warm), Vec::<u32>::new());
    let reasons = warm.absent.iter().map(|pass| pass.reason.as_str());
    assert!(
        reasons
            .into_iter()
            .any(|r| r == "its output (light_field) is cached")
    );
    let held = warm
        .slots
        .iter()
        .find(|slot| slot.name == "light_field")
        .unwrap();
    assert_eq!(held.bytes, keys.iter().map(|key| key.bytes).sum::<u64>());
}
