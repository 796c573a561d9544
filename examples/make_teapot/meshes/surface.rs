//! A surface under construction: welded positions, normals that are shared where they agree, and faces; and its OBJ text.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::DVec3;

/// Decimals of a position in the file: micrometres.
const POSITION_DECIMALS: usize = 6;

/// Normals that differ by less than about 20° at one place are one normal.
const SAME_NORMAL_COS: f64 = 0.94;

/// Positions, normals and triangles.
#[derive(Debug, Default)]
pub(crate) struct Surface {
    positions: Vec<String>,
    place_of: HashMap<String, usize>,
    normal_sums: Vec<DVec3>,
    normals_at: Vec<Vec<usize>>,
    faces: Vec<[(usize, usize); 3]>,
}

impl Surface {
    /// A corner: welded to whatever is at the same place, with the normal that is there if it points in the same direction.
    pub(crate) fn corner(&mut self, position_m: DVec3, normal: DVec3) -> (usize, usize) {
        let text = triple(position_m, POSITION_DECIMALS);
        let place = *self.place_of.entry(text).or_insert_with_key(|text| {
            self.positions.push(text.clone());
            self.normals_at.push(Vec::new());
            self.positions.len() - 1
        });
        let known = self.normals_at[place].iter().copied().find(|&n| {
            let sum: DVec3 = self.normal_sums[n];
            sum.normalize().dot(normal) > SAME_NORMAL_COS
        });
        let index = known.unwrap_or_else(|| {
            self.normal_sums.push(DVec3::ZERO);
            self.normals_at[place].push(self.normal_sums.len() - 1);
            self.normal_sums.len() - 1
        });
        self.normal_sums[index] += normal;
        (place, index)
    }

    /// A quadrilateral as two triangles, counter-clockwise from outside; a triangle with two corners at one place (at
    /// the poles of the surface) is left out.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [(usize, usize); 4]) {
        for [p, q, r] in [[a, b, c], [a, c, d]] {
            if p.0 != q.0 && q.0 != r.0 && r.0 != p.0 {
                self.faces.push([p, q, r]);
            }
        }
    }

    /// The OBJ text: `header` as comments and statements, then positions, normals, faces.
    pub(crate) fn obj(&self, header: &str) -> String {
        let mut text = header.to_owned();
        for position in &self.positions {
            let _ = writeln!(text, "v {position}");
        }
        for sum in &self.normal_sums {
            let _ = writeln!(text, "vn {}", triple(sum.normalize(), 4));
        }
        for face in &self.faces {
            let [a, b, c] = face.map(|(p, n)| format!("{}//{}", p + 1, n + 1));
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        text
    }
}

/// Three numbers with the given number of decimals, without negative zeros.
pub(crate) fn triple(p: DVec3, decimals: usize) -> String {
    let number = |x: f64| {
        let text = format!("{x:.decimals$}");
        match text.strip_prefix('-') {
            Some(rest) if !rest.contains(|c| ('1'..='9').contains(&c)) => rest.to_owned(),
            _ => text,
        }
    };
    format!("{} {} {}", number(p.x), number(p.y), number(p.z))
}
