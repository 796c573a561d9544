//! The experiment as a table for programs: a row for each shape, technique and setting.

use std::fmt::Write as _;

use super::study::{Experiment, TechniqueFigures};

/// CSV with a header; what was not measured is empty.
pub fn to_csv(experiment: &Experiment) -> String {
    let mut text = "shape,triangles,way,planes,used,sub_boxes,water_cells,split_levels,ms_median,ms_min,ms_max,own_ms,planned_bytes,peak_bytes,\
        allocated_bytes,relative_l1,luv_to_uniform,texels_apart\n"
        .to_owned();
    for mesh in &experiment.meshes {
        let mut row = |technique: &str,
                       planes: [String; 3],
                       cells: [String; 2],
                       f: &TechniqueFigures,
                       to_uniform: [String; 2]| {
            let optional = |value: Option<String>| value.unwrap_or_default();
            let _ = writeln!(
                text,
                "{},{},{technique},{},{},{},{},{},{},{},{},{},{},{}",
                mesh.name,
                mesh.triangles,
                planes.join(","),
                cells.join(","),
                f.ms.median,
                f.ms.min,
                f.ms.max,
                optional(f.own_ms.map(|v| v.to_string())),
                f.planned_bytes,
                f.peak_bytes,
                optional(f.allocated_bytes.map(|v| v.to_string())),
                optional(f.error.map(|v| v.to_string())),
                to_uniform.join(","),
            );
        };
        for p in &mesh.planes {
            let all = |used: u32, boxes: u32| [p.planes, used, boxes].map(|v| v.to_string());
            let cells = || [experiment.water_cells.to_string(), String::new()];
            let apart = [p.luv_volumetric.to_string(), p.texels_apart.to_string()];
            row(
                "volumetric",
                all(p.planes, 1),
                cells(),
                &p.volumetric,
                apart,
            );
            let none = [String::new(), String::new()];
            row("uniform", all(p.planes, 1), cells(), &p.uniform, none);
            let same = [p.luv_smart.to_string(), String::new()];
            row("smart", all(p.used, p.sub_boxes), cells(), &p.smart, same);
        }
        for hit in &mesh.hits {
            let none = || [String::new(), String::new()];
            row(
                "hit",
                [const { String::new() }; 3],
                [hit.water_cells, hit.split_levels].map(|v| v.to_string()),
                &hit.figures,
                none(),
            );
        }
    }
    text
}
