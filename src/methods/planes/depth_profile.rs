//! Depth profile — selects the planes of an object. With smart slicing (Tipprasert 2006, §4.7.2) these are the planes whose acceptance
//! interval holds a texel of the level map, otherwise all planes. Also lists, per tile of the map, the planes near the surface.

use crate::stages::level_map::LEVEL_MAPS;
use crate::stages::queues::MOST_GROUPS;
use crate::stages::receivers::RECEIVERS;
use crate::stages::reference_planes::{
    PLANE_LISTS, PLANE_TILE_TEXELS, Planes, objects_of, planes_uniform, wanted_for_planes,
};
use crate::stages::{Groups, Pass, Step, Steps};

/// Texels of a workgroup, as in the shader.
pub const TEXELS_PER_GROUP: u32 = 64 * 16;

/// See the module.
pub static PASS: Pass = Pass {
    name: "depth_profile",
    shader: "methods/planes/depth_profile.wgsl",
    reads: &[&RECEIVERS, &LEVEL_MAPS],
    reads_if_present: &[],
    writes: &[&PLANE_LISTS],
    uniforms: &[("planes", Planes::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_planes(facts)?;
        let planes = facts.method.reference_planes;
        Ok(if facts.method.skips_empty_planes {
            format!("of {planes} planes, those without a surface near them are skipped")
        } else {
            format!("all {planes} planes are used")
        })
    },
    steps: Steps::BeamSet(|facts, set| {
        let mut steps = Vec::new();
        for (object, texels) in objects_of(facts, set.index) {
            let mut add = |entry, groups| {
                let uniforms = vec![("planes", planes_uniform(facts, object, 0))];
                steps.push(Step::compute(entry, Groups::Direct(groups), uniforms));
            };
            if facts.method.skips_empty_planes {
                let groups = (texels * texels).div_ceil(TEXELS_PER_GROUP);
                let columns = groups.min(MOST_GROUPS);
                add("profile_count", [columns, groups.div_ceil(columns), 1]);
            }
            add("profile_compact", [1, 1, 1]);
            let tiles = (texels / PLANE_TILE_TEXELS).div_ceil(8);
            add("profile_tiles", [tiles, tiles, 1]);
        }
        steps
    }),
    work: |facts| {
        let objects = facts.wet_objects();
        let texels = objects.map(|index| facts.receivers.objects[index].map_texels);
        texels.map(|texels| f64::from(texels).powi(2)).sum()
    },
};
