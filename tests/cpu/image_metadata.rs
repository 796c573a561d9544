//! Metadata of image files: everything reproducible, nothing else.

use caustica::image::Metadata;
use caustica::stats::{AbsentPass, PassStats, Stats, Warning};
use serde_json::Value;

use super::image_support::stats;

fn parsed(stats: &Stats) -> Value {
    serde_json::from_str(&Metadata::of(stats).stats_json(&[])).expect("JSON")
}

fn pass(name: &str) -> PassStats {
    PassStats {
        name: name.to_owned(),
        reason: "why".to_owned(),
        runs: 1,
        gpu_ms: Some(0.5),
    }
}

#[test]
fn everything_reproducible_is_there() {
    let mut stats = stats(0.5);
    stats.energy.push(caustica::stats::EnergyAccount {
        light: 2,
        emitted_w: [1.0, 2.0, 3.0],
        ..Default::default()
    });
    stats.absent.push(AbsentPass {
        name: "sky".to_owned(),
        reason: "no sky".to_owned(),
    });
    let found = parsed(&stats);
    assert_eq!(found["version"], "9.8.7");
    assert_eq!(found["scene_hash"], "blake3:0123");
    assert_eq!(found["adapter"]["software"], true);
    assert_eq!(found["passes"][0]["name"], "surface");
    assert_eq!(found["absent"][0]["reason"], "no sky");
    assert_eq!(found["energy"][0]["emitted_w"][2], 3.0);
    assert_eq!(found["exposure"]["scale"], 0.5);
    assert_eq!(found["warnings"][0]["code"], "scattering");
    assert_eq!(found["planned_peak_bytes"], 4096);
}

#[test]
fn times_and_counts_of_runs_are_not() {
    let text = Metadata::of(&stats(1.0)).stats_json(&[]);
    for word in ["_ms", "runs", "17.5", "hits", "peak_bytes\":0"] {
        assert!(!text.contains(word), "{word} in {text}");
    }
}

#[test]
fn a_cache_hit_does_not_change_the_file() {
    let mut cold = stats(1.0);
    cold.passes = vec![pass("level_map"), pass("level_map_pyramid"), pass("beams")];
    cold.memory.level_maps.misses = 1;
    cold.memory.planned_peak_bytes = 9000;
    let mut warm = stats(1.0);
    warm.passes = vec![pass("beams")];
    warm.absent = vec![AbsentPass {
        name: "level_map".to_owned(),
        reason: "cached".to_owned(),
    }];
    warm.memory.level_maps.hits = 1;
    warm.memory.planned_peak_bytes = 5000;
    assert_eq!(
        Metadata::of(&cold).stats_json(&[]),
        Metadata::of(&warm).stats_json(&[])
    );
    // The other passes do count.
    warm.passes.push(pass("view"));
    assert_ne!(Metadata::of(&cold), Metadata::of(&warm));
}

#[test]
fn keys_are_sorted_at_every_depth_and_the_text_is_ascii() {
    let text = Metadata::of(&stats(1.0)).stats_json(&[Warning::new("late", "größer")]);
    assert!(text.is_ascii(), "{text}");
    assert!(!text.contains('\n'));
    let value: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(value["adapter"]["name"], "Übersichtskarte 水");
    assert_eq!(value["warnings"][1]["message"], "größer");
    // `Value` sorts its keys, so writing it again must give the same text.
    let sorted: std::collections::BTreeMap<String, Value> =
        serde_json::from_str(&text).expect("an object");
    let mut at = 0;
    for key in sorted.keys() {
        let found = text.find(&format!("\"{key}\":")).expect("the key");
        assert!(found >= at, "{key} stands too early in {text}");
        at = found;
    }
    let adapter = text.find("\"backend\"").zip(text.find("\"software\""));
    assert!(adapter.is_some_and(|(a, b)| a < b));
}
