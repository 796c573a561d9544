//! Depth profile — which planes of an object are used: with smart slicing (Tipprasert 2006, §4.7.2) those whose acceptance interval
//! holds a texel of the level map, otherwise all; and which of them come near the surface in each tile of the map.

use super::desc::{Groups, PassDesc, Repeat, Run, Work};
use super::plane_steps::{objects_of, plane_step, wanted_for_planes};
use super::slot::{self, Slot};
use crate::scene::Slicing;

/// Texels of a workgroup, as in the shader.
pub const TEXELS_PER_GROUP: u32 = 64 * 16;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "depth_profile",
    repeat: Repeat::Light,
    reads: &[Slot::Receivers, Slot::LevelMaps],
    reads_if_present: &[],
    writes: &[Slot::PlaneLists],
    wanted: |facts| {
        wanted_for_planes(facts)?;
        if facts.quality.is_volumetric() {
            return Err("quality.method is volumetric: every plane has its image".to_owned());
        }
        Ok(match facts.quality.slicing {
            Slicing::Uniform => format!("all {} planes are used", facts.quality.planes),
            Slicing::Smart => format!(
                "of {} planes those without a surface near them are left out",
                facts.quality.planes
            ),
        })
    },
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        let mut steps = Vec::new();
        for (object, texels) in objects_of(facts, index) {
            let mut add = |entry, groups| {
                let work = Work::Compute(Groups::Direct(groups));
                steps.push(plane_step(
                    facts,
                    (index, wide_sums),
                    (object, 0),
                    entry,
                    work,
                ));
            };
            if facts.quality.slicing == Slicing::Smart {
                let groups = (texels * texels).div_ceil(TEXELS_PER_GROUP);
                let columns = groups.min(slot::MOST_GROUPS);
                add("profile_count", [columns, groups.div_ceil(columns), 1]);
            }
            add("profile_compact", [1, 1, 1]);
            let tiles = (texels / slot::PLANE_TILE_TEXELS).div_ceil(8);
            add("profile_tiles", [tiles, tiles, 1]);
        }
        steps
    },
};
