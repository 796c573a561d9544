//! Checks an OBJ before the OBJ library reads it: refuses, with line numbers, what cannot be used, and rewrites the rest without
//! ambiguities: absolute indices, a normal for every corner, no names but those of materials.
//!
//! Without this, the library would read the line `l 1 2 3` as a triangle, give a corner without a normal that of the previous
//! corner, refuse vertex colours that only some vertices have, and report errors without a line.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use glam::DVec3;

use super::MeshError;
use super::text::{OBJ, corner_syntax, name, number, shorten, syntax, words};
use crate::stats::Warning;

/// Largest coordinate magnitude, m. Beyond it, f32 steps are wider than 50 m even relative to the mesh's own middle.
pub const MAX_COORDINATE_M: f64 = 1e9;

/// The result of the check.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// The rewritten OBJ: `v`, `vn` (the first is zero and means "none"), `usemtl`, and `f` lines with `position//normal`.
    pub(super) text: String,
    /// Names after `usemtl`.
    pub(super) used_materials: BTreeSet<String>,
    /// Name after the first `mtllib`.
    pub(super) library: Option<String>,
    /// What was left out or is doubtful.
    pub(super) warnings: Vec<Warning>,
}

/// Checks an OBJ text. More than `max_triangles` triangles are refused at the line that exceeds the limit.
pub(super) fn scan(text: &str, max_triangles: usize) -> Result<Scan, MeshError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() {
        return Err(MeshError::Empty);
    }
    let mut scanner = Scanner::new(max_triangles);
    // A backslash at the end of a line joins it with the next one.
    let mut joined = String::new();
    let mut joined_from = 0;
    for (index, raw) in text.lines().enumerate() {
        let is_comment = joined.is_empty() && raw.trim_start().starts_with('#');
        match raw.trim_end().strip_suffix('\\') {
            Some(head) if !is_comment => {
                if joined.is_empty() {
                    joined_from = index + 1;
                }
                joined.push_str(head);
                joined.push(' ');
            }
            _ if joined.is_empty() => scanner.line(index + 1, raw)?,
            _ => {
                joined.push_str(raw);
                scanner.line(joined_from, &std::mem::take(&mut joined))?;
            }
        }
    }
    scanner.line(joined_from, &joined)?;
    scanner.finish()
}

/// An index that has to be defined by the end of the file.
#[derive(Clone, Copy, Debug, Default)]
struct Reference {
    index: usize,
    line: usize,
    face: usize,
    before: usize,
}

#[derive(Debug)]
struct Scanner {
    max_triangles: usize,
    positions: Vec<DVec3>,
    normals: usize,
    normal_text: String,
    face_text: String,
    corners: Vec<(usize, usize)>,
    faces: usize,
    triangles: usize,
    highest_position: Reference,
    highest_normal: Reference,
    used_materials: BTreeSet<String>,
    library: Option<String>,
    bad_normals: usize,
    small_faces: usize,
    concave_faces: usize,
    ignored: usize,
    first_ignored: Option<(usize, String)>,
}

impl Scanner {
    fn new(max_triangles: usize) -> Self {
        Self {
            max_triangles,
            positions: Vec::new(),
            normals: 0,
            normal_text: "vn 0 0 0\n".to_owned(),
            face_text: String::new(),
            corners: Vec::new(),
            faces: 0,
            triangles: 0,
            highest_position: Reference::default(),
            highest_normal: Reference::default(),
            used_materials: BTreeSet::new(),
            library: None,
            bad_normals: 0,
            small_faces: 0,
            concave_faces: 0,
            ignored: 0,
            first_ignored: None,
        }
    }

    fn line(&mut self, line: usize, text: &str) -> Result<(), MeshError> {
        let text = text.trim();
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        match keyword {
            "v" => self.position(line, rest),
            "vn" => self.normal(line, rest),
            "f" => self.face(line, rest),
            "usemtl" => {
                let name = name(OBJ, line, keyword, rest)?;
                if !self.used_materials.contains(name) {
                    self.used_materials.insert(name.to_owned());
                }
                let _ = writeln!(self.face_text, "usemtl {name}");
                Ok(())
            }
            "mtllib" => {
                let name = name(OBJ, line, keyword, rest)?;
                self.library.get_or_insert_with(|| name.to_owned());
                Ok(())
            }
            "" | "o" | "g" | "s" | "vt" => Ok(()),
            _ if keyword.starts_with('#') => Ok(()),
            _ => {
                self.ignored += 1;
                self.first_ignored
                    .get_or_insert_with(|| (line, keyword.chars().take(20).collect()));
                Ok(())
            }
        }
    }

    fn position(&mut self, line: usize, rest: &str) -> Result<(), MeshError> {
        let words: Vec<&str> = words(rest).collect();
        // Three coordinates, alone, with a weight that divides them, or with three colour values, which are not used.
        if !matches!(words.len(), 3 | 4 | 6) {
            return Err(syntax(
                line,
                format!(
                    "a vertex has {} values; expected `v x y z`, `v x y z w` or `v x y z r g b`",
                    words.len()
                ),
            ));
        }
        let mut values = [0.0, 0.0, 0.0, 1.0];
        for (value, word) in values.iter_mut().zip(&words[..words.len().min(4)]) {
            *value = number(line, word)?;
        }
        let weight = if words.len() == 4 { values[3] } else { 1.0 };
        if weight == 0.0 || !weight.is_finite() {
            return Err(syntax(
                line,
                format!(
                    "the weight `{}` cannot divide a position; expected a finite number other than 0",
                    words[3]
                ),
            ));
        }
        for (value, word) in values.iter_mut().zip(&words[..3]) {
            *value /= weight;
            if !value.is_finite() {
                return Err(MeshError::NonFinite {
                    line,
                    text: shorten(word),
                });
            }
            if value.abs() > MAX_COORDINATE_M {
                return Err(MeshError::TooLarge {
                    line,
                    text: shorten(word),
                    limit: MAX_COORDINATE_M,
                });
            }
        }
        self.positions
            .push(DVec3::new(values[0], values[1], values[2]));
        Ok(())
    }

    fn normal(&mut self, line: usize, rest: &str) -> Result<(), MeshError> {
        let mut values = [0.0; 3];
        let mut count = 0;
        for word in words(rest) {
            if let Some(value) = values.get_mut(count) {
                *value = number(line, word)?;
            }
            count += 1;
        }
        if count != 3 {
            return Err(syntax(
                line,
                format!("a normal has {count} values; expected `vn x y z`"),
            ));
        }
        self.normals += 1;
        let largest = values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        if values.iter().all(|v| v.is_finite()) && largest > 0.0 {
            let [x, y, z] = values.map(|v| v / largest);
            let _ = writeln!(self.normal_text, "vn {x} {y} {z}");
        } else {
            self.bad_normals += 1;
            self.normal_text.push_str("vn 0 0 0\n");
        }
        Ok(())
    }

    fn face(&mut self, line: usize, rest: &str) -> Result<(), MeshError> {
        self.faces += 1;
        self.corners.clear();
        for word in words(rest) {
            let corner = self.corner(line, word)?;
            self.corners.push(corner);
        }
        if self.corners.len() < 3 {
            self.small_faces += 1;
            return Ok(());
        }
        self.triangles += self.corners.len() - 2;
        if self.triangles > self.max_triangles {
            return Err(MeshError::TooManyTriangles {
                line,
                limit: self.max_triangles,
            });
        }
        if self.corners.len() > 3 && self.is_concave() {
            self.concave_faces += 1;
        }
        self.face_text.push('f');
        for (position, normal) in &self.corners {
            let _ = write!(self.face_text, " {position}//{normal}");
        }
        self.face_text.push('\n');
        Ok(())
    }

    /// One corner `position[/texture][/normal]`: absolute position index, and index into the rewritten normals.
    fn corner(&mut self, line: usize, word: &str) -> Result<(usize, usize), MeshError> {
        let mut parts = word.split('/');
        let position = parts.next().unwrap_or_default();
        let texture = parts.next().unwrap_or_default();
        let normal = parts.next().unwrap_or_default();
        let whole = |part: &str| part.parse::<i64>().ok();
        let (Some(position), true, None) = (
            whole(position),
            texture.is_empty() || whole(texture).is_some(),
            parts.next(),
        ) else {
            return Err(corner_syntax(line, word));
        };
        let before = self.positions.len();
        let position = self.reference(line, "position", position, before)?;
        if normal.is_empty() {
            return Ok((position, 1));
        }
        let Some(normal) = whole(normal) else {
            return Err(corner_syntax(line, word));
        };
        let normal = self.reference(line, "normal", normal, self.normals)?;
        Ok((position, normal + 1))
    }

    /// Turns an index as written into an absolute one. An index beyond those read so far is checked at the end.
    fn reference(
        &mut self,
        line: usize,
        what: &'static str,
        index: i64,
        before: usize,
    ) -> Result<usize, MeshError> {
        let face = self.faces;
        let absolute = if index < 0 {
            usize::try_from(index.unsigned_abs())
                .ok()
                .and_then(|back| (before + 1).checked_sub(back))
        } else {
            usize::try_from(index).ok()
        };
        let Some(absolute) = absolute.filter(|&i| i > 0) else {
            return Err(MeshError::FaceIndex {
                line,
                face,
                what,
                index,
                available: before,
                available_before: before,
            });
        };
        let highest = match what {
            "normal" => &mut self.highest_normal,
            _ => &mut self.highest_position,
        };
        if absolute > highest.index {
            *highest = Reference {
                index: absolute,
                line,
                face,
                before,
            };
        }
        Ok(absolute)
    }

    /// Whether the triangles of the fan around the first corner face different directions. The fan then covers the wrong area.
    fn is_concave(&self) -> bool {
        let at = |i: usize| self.positions.get(self.corners[i].0 - 1).copied();
        let mut first: Option<DVec3> = None;
        for i in 1..self.corners.len() - 1 {
            let (Some(a), Some(b), Some(c)) = (at(0), at(i), at(i + 1)) else {
                return false;
            };
            let turn = (b - a).cross(c - a);
            match first {
                None if turn != DVec3::ZERO => first = Some(turn),
                Some(first) if first.dot(turn) < 0.0 => return true,
                _ => {}
            }
        }
        false
    }

    fn finish(mut self) -> Result<Scan, MeshError> {
        for (what, highest, available) in [
            ("position", self.highest_position, self.positions.len()),
            ("normal", self.highest_normal, self.normals),
        ] {
            if highest.index > available {
                return Err(MeshError::FaceIndex {
                    line: highest.line,
                    face: highest.face,
                    what,
                    index: i64::try_from(highest.index).unwrap_or(i64::MAX),
                    available,
                    available_before: highest.before,
                });
            }
        }
        if self.triangles == 0 {
            return Err(MeshError::NoFaces {
                vertices: self.positions.len(),
            });
        }
        let warnings = self.warnings();
        let mut text = String::with_capacity(
            self.positions.len() * 32 + self.normal_text.len() + self.face_text.len(),
        );
        for p in &self.positions {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        text.push_str(&std::mem::take(&mut self.normal_text));
        text.push_str(&std::mem::take(&mut self.face_text));
        Ok(Scan {
            text,
            used_materials: self.used_materials,
            library: self.library,
            warnings,
        })
    }

    fn warnings(&self) -> Vec<Warning> {
        let (line, keyword) = self.first_ignored.clone().unwrap_or_default();
        let ignored = format!(
            "lines are not used, the first is line {line} (`{keyword}`); only v, vn, f, usemtl and mtllib are."
        );
        [
            (
                self.small_faces,
                "mesh_small_faces",
                "faces with fewer than three corners were left out.",
            ),
            (
                self.concave_faces,
                "mesh_concave_polygons",
                "polygons are concave or twisted; they were cut into a fan around their first corner, which covers \
                 another area. Triangulate the mesh before sending it.",
            ),
            (
                self.bad_normals,
                "mesh_bad_normals",
                "normals are zero or not finite; face normals are used instead.",
            ),
            (self.ignored, "mesh_ignored_lines", &ignored),
        ]
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, code, sentence)| Warning::new(code, format!("{count} {sentence}")))
        .collect()
    }
}
