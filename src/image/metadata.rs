//! Metadata of an image file: the reproducible part of the statistics.

use serde_json::{Value, json};

use crate::stats::{AdapterStats, Stats, Warning};

/// Key of the scene's hash in PNG (iTXt) and EXR (string attribute).
pub const SCENE_HASH_KEY: &str = "caustica:scene_hash";

/// Key of the statistics, compact JSON in ASCII with sorted keys, in PNG (iTXt) and EXR (string attribute).
pub const STATS_KEY: &str = "caustica:stats";

/// Key of the scene as JSON with every default written out, in PNG (iTXt, UTF-8) and EXR (string attribute, ASCII).
pub const SCENE_KEY: &str = "caustica:scene";

/// Prefix of the passes that fill the level-map cache: whether they run depends on earlier frames.
pub const CACHED_PASS_PREFIX: &str = "level_map";

/// Provenance of a picture.
///
/// Times, numbers of runs (a picture may be split into bands depending on time) and everything that depends on the cache are left
/// out, so that the same request gives the same bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// `blake3:…` of the canonical scene.
    pub scene_hash: String,
    /// Program version.
    pub version: String,
    /// The adapter it ran on.
    pub adapter: AdapterStats,
    /// Passes, energy, exposure, camera, planned bytes, warnings: a JSON object.
    pub facts: Value,
}

impl Metadata {
    /// Selects the reproducible part.
    ///
    /// `planned_peak_bytes` is present only for frames without level maps: with them, the plan depends on what was cached.
    pub fn of(stats: &Stats) -> Self {
        let is_reproducible = |name: &str| !name.starts_with(CACHED_PASS_PREFIX);
        let passes: Vec<Value> = stats
            .passes
            .iter()
            .filter(|p| is_reproducible(&p.name))
            .map(|p| json!({ "name": p.name, "reason": p.reason }))
            .collect();
        let absent: Vec<Value> = stats
            .absent
            .iter()
            .filter(|p| is_reproducible(&p.name))
            .map(|p| json!({ "name": p.name, "reason": p.reason }))
            .collect();
        let mut facts = json!({
            "passes": passes,
            "absent": absent,
            "energy": stats.energy,
            "exposure": stats.exposure,
            "warnings": stats.warnings,
        });
        if let Some(camera) = &stats.camera {
            facts["camera"] = json!(camera);
        }
        let level_maps = &stats.memory.level_maps;
        if level_maps.hits + level_maps.misses == 0 {
            facts["planned_peak_bytes"] = json!(stats.memory.planned_peak_bytes);
        }
        Self {
            scene_hash: stats.scene_hash.clone(),
            version: stats.version.clone(),
            adapter: stats.adapter.clone(),
            facts,
        }
    }

    /// `Caustica` and the version.
    pub fn software(&self) -> String {
        format!("Caustica {}", self.version)
    }

    /// The value of [`STATS_KEY`]; `more` are the warnings from encoding the file.
    pub fn stats_json(&self, more: &[Warning]) -> String {
        let mut all = self.facts.clone();
        if !all.is_object() {
            all = json!({ "facts": all });
        }
        all["adapter"] = json!(self.adapter);
        all["scene_hash"] = json!(self.scene_hash);
        all["version"] = json!(self.version);
        let mut warnings = all["warnings"].as_array().cloned().unwrap_or_default();
        warnings.extend(more.iter().map(|warning| json!(warning)));
        all["warnings"] = Value::Array(warnings);
        ascii(&all.to_string())
    }
}

/// Escapes everything outside ASCII (in JSON it occurs only within strings), because EXR readers disagree about other encodings.
pub(super) fn ascii(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for character in json.chars() {
        if character.is_ascii() {
            out.push(character);
        } else {
            let mut units = [0_u16; 2];
            for unit in character.encode_utf16(&mut units) {
                out.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    out
}
