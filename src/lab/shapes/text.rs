//! An outline as OBJ text.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::DVec3;

use super::{Outline, normals};

/// Steps per metre of a coordinate: micrometres.
const POSITION_STEPS: f64 = 1e6;

/// Steps of a component of a normal.
const NORMAL_STEPS: f64 = 1e4;

/// The OBJ text: `header` as a comment, then positions to the micrometre, normals (each once), and triangles.
pub(super) fn obj(outline: &Outline, header: &str) -> String {
    let mut text = format!("# {header}\n");
    for p in &outline.positions_m {
        let [x, y, z] = steps(*p, POSITION_STEPS).map(|x| decimal(x, 6));
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    let mut number_of = HashMap::new();
    let mut face_text = String::new();
    for (corners, normals) in outline.faces.iter().zip(normals::of(outline)) {
        face_text.push('f');
        for (point, normal) in corners.iter().zip(normals) {
            let normal = steps(normal, NORMAL_STEPS);
            let next = number_of.len() + 1;
            let number = *number_of.entry(normal).or_insert_with(|| {
                let [x, y, z] = normal.map(|x| decimal(x, 4));
                let _ = writeln!(text, "vn {x} {y} {z}");
                next
            });
            let _ = write!(face_text, " {}//{number}", point + 1);
        }
        face_text.push('\n');
    }
    text + &face_text
}

fn steps(p: DVec3, per_unit: f64) -> [i64; 3] {
    p.to_array().map(|x| (x * per_unit).round() as i64)
}

/// A whole number of steps as a decimal number with the given number of decimals; there is no negative zero.
fn decimal(steps: i64, decimals: u32) -> String {
    let (one, sign) = (10_u64.pow(decimals), if steps < 0 { "-" } else { "" });
    let size = steps.unsigned_abs();
    let (whole, rest) = (size / one, size % one);
    format!("{sign}{whole}.{rest:0width$}", width = decimals as usize)
}
