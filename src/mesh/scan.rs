//! Checks an OBJ before the OBJ library reads it: refuses, with line numbers, what the geometry cannot do without, leaves out the rest
//! with a warning, and rewrites the text without ambiguities: absolute indices, triangles, a normal for every corner, no names.
//!
//! Without this, the library would refuse a file for one byte of a comment, read the line `l 1 2 3` as a triangle, give a corner
//! without a normal that of the previous corner, cut concave polygons into fans, refuse vertex colours that only some vertices have,
//! and report errors without a line.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::DVec3;

use super::MeshError;
use super::polygon::{Cut, Cutter, MAX_CORNERS};
use super::text::{
    Lines, Skipped, Statement, corner_syntax, keyword_of, number, shorten, syntax, words,
};
use crate::stats::Warning;

/// Largest coordinate magnitude, m. Beyond it, f32 steps are wider than 50 m even relative to the mesh's own middle.
pub const MAX_COORDINATE_M: f64 = 1e9;

/// A normal that the file does not have, or that cannot be used: the face's is used instead.
const NO_NORMAL: u32 = 0;

/// Highest index; higher ones name nothing in any file.
const MAX_INDEX: usize = u32::MAX as usize;

/// The result of the check.
#[derive(Debug)]
pub(super) struct Scan {
    /// Names after `usemtl`, in the order of their first use.
    pub(super) used_materials: Vec<String>,
    /// What stands after each `mtllib`.
    pub(super) libraries: Vec<String>,
    /// What was left out or is doubtful.
    pub(super) warnings: Vec<Warning>,
    positions: Vec<DVec3>,
    /// Text of the `vn` lines; the first is zero and means [`NO_NORMAL`].
    normal_text: String,
    faces: Vec<Face>,
    corners: Vec<Corner>,
}

/// A polygon.
#[derive(Clone, Copy, Debug)]
struct Face {
    line: usize,
    /// Index of its first corner.
    start: usize,
    /// Number of corners, 3 or more.
    count: usize,
    /// Index into `used_materials`; `None` before the first `usemtl` or after one without a name.
    material: Option<usize>,
}

/// A corner of a face: index of its position, counted from 1, and of its normal, or [`NO_NORMAL`].
#[derive(Clone, Copy, Debug)]
struct Corner {
    position: u32,
    normal: u32,
}

impl Scan {
    /// The OBJ as the library reads it: `v`, `vn`, `usemtl`, and triangles `f position//normal …`. `material_of` gives the number that
    /// replaces a material's name. Polygons that cross themselves are counted in `warnings`.
    ///
    /// # Errors
    /// [`MeshError::PolygonTooLarge`].
    pub(super) fn rewritten(
        &mut self,
        material_of: impl Fn(&str) -> Option<usize>,
    ) -> Result<String, MeshError> {
        let mut text = String::with_capacity(
            self.positions.len() * 32 + self.normal_text.len() + self.corners.len() * 12,
        );
        // Writing to a string cannot fail.
        for p in &self.positions {
            let _ = writeln!(text, "v {:e} {:e} {:e}", p.x, p.y, p.z);
        }
        text.push_str(&self.normal_text);
        let numbers: Vec<Option<usize>> = self
            .used_materials
            .iter()
            .map(|name| material_of(name))
            .collect();
        let mut cutter = Cutter::new();
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        let mut crossed = Skipped::default();
        let mut current = None;
        for face in &self.faces {
            let material = face.material.and_then(|used| numbers[used]);
            if material != current {
                current = material;
                match material {
                    Some(number) => _ = writeln!(text, "usemtl {}", name_of_material(number)),
                    None => text.push_str("usemtl none\n"),
                }
            }
            let corners = &self.corners[face.start..face.start + face.count];
            points.clear();
            points.extend(
                corners
                    .iter()
                    .map(|corner| self.positions[corner.position as usize - 1]),
            );
            match cutter.cut(&points, &mut triangles) {
                Cut::Whole => {}
                Cut::Crossed => crossed.add(|| format!("on line {}", face.line)),
                Cut::TooLarge => {
                    return Err(MeshError::PolygonTooLarge {
                        line: face.line,
                        corners: face.count,
                        limit: MAX_CORNERS,
                    });
                }
            }
            for triangle in &triangles {
                text.push('f');
                for corner in triangle.map(|index| corners[index]) {
                    // The library counts from 1, and its first normal is the zero of `NO_NORMAL`.
                    let _ = write!(text, " {}//{}", corner.position, corner.normal + 1);
                }
                text.push('\n');
            }
        }
        self.warnings.extend(crossed.warning(
            "mesh_crossed_polygons",
            "polygons cross themselves or are far from flat; their triangles cover another area. Triangulate the mesh before sending it.",
        ));
        Ok(text)
    }
}

/// The name of a material in rewritten texts.
pub(super) fn name_of_material(number: usize) -> String {
    format!("material{number}")
}

/// Checks an OBJ. More than `max_triangles` triangles are refused at the line that exceeds the limit.
pub(super) fn scan(bytes: &[u8], max_triangles: usize) -> Result<Scan, MeshError> {
    let lines = Lines::of(bytes);
    if lines.are_blank() {
        return Err(MeshError::Empty);
    }
    let mut scanner = Scanner::new(max_triangles);
    for Statement { line, text } in lines.statements(may_go_on) {
        scanner.line(line, &text)?;
    }
    scanner.finish(&lines)
}

/// The text after each `mtllib` of an OBJ: names of material libraries, usually one.
pub(super) fn libraries(bytes: &[u8]) -> Vec<String> {
    let lines = Lines::of(bytes);
    let named = lines.numbered().filter_map(|(_, line)| {
        let (keyword, rest) = keyword_of(&line);
        (keyword == "mtllib" && !rest.is_empty()).then(|| rest.to_owned())
    });
    named.collect()
}

/// Whether a line may be joined with the next one: not comments and names.
fn may_go_on(line: &str) -> bool {
    let (keyword, _) = keyword_of(line);
    !keyword.starts_with('#') && !matches!(keyword, "o" | "g" | "usemtl")
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
    /// Indices, counted from 1, and lines of positions that cannot be read. They are refused if a face uses them.
    bad_positions: Vec<(u32, u32)>,
    normals: usize,
    normal_text: String,
    faces: Vec<Face>,
    corners: Vec<Corner>,
    face_count: usize,
    triangles: usize,
    highest_position: Reference,
    materials: BTreeMap<String, usize>,
    material: Option<usize>,
    libraries: Vec<String>,
    bad_normals: Skipped,
    corners_without_normal: Skipped,
    small_faces: Skipped,
    extra_values: Skipped,
    vertex_colours: Skipped,
    bad_weights: Skipped,
    trailing: Skipped,
    ignored: Skipped,
}

impl Scanner {
    fn new(max_triangles: usize) -> Self {
        Self {
            max_triangles,
            positions: Vec::new(),
            bad_positions: Vec::new(),
            normals: 0,
            normal_text: "vn 0 0 0\n".to_owned(),
            faces: Vec::new(),
            corners: Vec::new(),
            face_count: 0,
            triangles: 0,
            highest_position: Reference::default(),
            materials: BTreeMap::new(),
            material: None,
            libraries: Vec::new(),
            bad_normals: Skipped::default(),
            corners_without_normal: Skipped::default(),
            small_faces: Skipped::default(),
            extra_values: Skipped::default(),
            vertex_colours: Skipped::default(),
            bad_weights: Skipped::default(),
            trailing: Skipped::default(),
            ignored: Skipped::default(),
        }
    }

    fn line(&mut self, line: usize, text: &str) -> Result<(), MeshError> {
        let (keyword, rest) = keyword_of(text);
        match keyword {
            "v" => self.vertex(line, rest),
            "vn" => self.normal(line, rest),
            "f" => self.face(line, rest)?,
            "usemtl" => self.use_material(rest),
            "mtllib" if !rest.is_empty() => self.libraries.push(rest.to_owned()),
            "" | "o" | "g" | "s" | "vt" | "mtllib" => {}
            _ if keyword.starts_with('#') => {}
            _ => self.ignored.add(|| {
                let keyword: String = keyword.chars().take(20).collect();
                format!("line {line} (`{keyword}`)")
            }),
        }
        Ok(())
    }

    fn use_material(&mut self, name: &str) {
        self.material = match self.materials.get(name) {
            _ if name.is_empty() => None,
            Some(known) => Some(*known),
            None => {
                let next = self.materials.len();
                self.materials.insert(name.to_owned(), next);
                Some(next)
            }
        };
    }

    fn vertex(&mut self, line: usize, rest: &str) {
        let position = match position(line, rest) {
            Ok(Vertex {
                position,
                values,
                weight,
            }) => {
                match values {
                    3 | 4 => {}
                    6 => self.vertex_colours.add(|| format!("line {line}")),
                    _ => self.extra_values.add(|| format!("line {line}")),
                }
                if weight == Weight::Unusable {
                    self.bad_weights.add(|| format!("line {line}"));
                }
                position
            }
            Err(_) => {
                let index = self.positions.len() + 1;
                let fits = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
                self.bad_positions.push((fits(index), fits(line)));
                DVec3::ZERO
            }
        };
        self.positions.push(position);
    }

    fn normal(&mut self, line: usize, rest: &str) {
        self.normals += 1;
        let mut values = [f64::NAN; 3];
        for (value, word) in values.iter_mut().zip(words(rest)) {
            *value = number(word).unwrap_or(f64::NAN);
        }
        let largest = values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        // Writing to a string cannot fail.
        if values.iter().all(|v| v.is_finite()) && largest > 0.0 {
            let [x, y, z] = values.map(|v| v / largest);
            // In scientific notation: a tiny number would have hundreds of zeros.
            let _ = writeln!(self.normal_text, "vn {x:e} {y:e} {z:e}");
        } else {
            self.bad_normals.add(|| format!("line {line}"));
            self.normal_text.push_str("vn 0 0 0\n");
        }
    }

    fn face(&mut self, line: usize, rest: &str) -> Result<(), MeshError> {
        self.face_count += 1;
        let start = self.corners.len();
        for word in words(rest) {
            match self.corner(line, word) {
                Ok(corner) => self.corners.push(corner),
                // What does not begin like a corner is no part of the geometry: `f 1 2 3 // front`, `f 1 2 3;`.
                Err(_)
                    if self.corners.len() - start >= 3
                        && !word.starts_with(|c: char| c.is_ascii_digit() || c == '-') =>
                {
                    self.trailing
                        .add(|| format!("`{}` on line {line}", shorten(word)));
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        let count = self.corners.len() - start;
        if count < 3 {
            self.corners.truncate(start);
            self.small_faces.add(|| format!("line {line}"));
            return Ok(());
        }
        self.triangles += count - 2;
        if self.triangles > self.max_triangles {
            return Err(MeshError::TooManyTriangles {
                line,
                limit: self.max_triangles,
            });
        }
        self.faces.push(Face {
            line,
            start,
            count,
            material: self.material,
        });
        Ok(())
    }

    /// One corner `position[/texture][/normal]`. The geometry needs the position only; a normal that is not there is the face's.
    fn corner(&mut self, line: usize, word: &str) -> Result<Corner, MeshError> {
        let mut parts = word.trim_end_matches([';', ',']).split('/');
        let whole = |part: &str| part.parse::<i64>().ok();
        let position = parts
            .next()
            .and_then(whole)
            .ok_or_else(|| corner_syntax(line, word))?;
        let position = self.position_index(line, position)?;
        let normal = parts.nth(1).unwrap_or_default();
        let index = match whole(normal) {
            Some(index) if index < 0 => back(self.normals, index),
            Some(index) => usize::try_from(index).ok(),
            None => None,
        };
        let index = index.filter(|&index| (1..MAX_INDEX).contains(&index));
        if index.is_none() && !normal.is_empty() {
            self.corners_without_normal
                .add(|| format!("`{}` on line {line}", shorten(word)));
        }
        Ok(Corner {
            position,
            normal: index.map_or(NO_NORMAL, |index| index as u32),
        })
    }

    /// The absolute index of a position. An index beyond those read so far is checked at the end.
    fn position_index(&mut self, line: usize, index: i64) -> Result<u32, MeshError> {
        let before = self.positions.len();
        let absolute = if index < 0 {
            back(before, index)
        } else {
            usize::try_from(index).ok()
        };
        let Some(absolute) = absolute.filter(|&index| index > 0) else {
            return Err(MeshError::FaceIndex {
                line,
                face: self.face_count,
                index,
                available: before,
                available_before: before,
            });
        };
        if absolute > self.highest_position.index {
            self.highest_position = Reference {
                index: absolute,
                line,
                face: self.face_count,
                before,
            };
        }
        // An index that does not fit is refused at the end: no file has so many vertices.
        Ok(absolute.min(MAX_INDEX) as u32)
    }

    fn finish(mut self, lines: &Lines<'_>) -> Result<Scan, MeshError> {
        let highest = self.highest_position;
        if highest.index > self.positions.len() {
            return Err(MeshError::FaceIndex {
                line: highest.line,
                face: highest.face,
                index: i64::try_from(highest.index).unwrap_or(i64::MAX),
                available: self.positions.len(),
                available_before: highest.before,
            });
        }
        if self.faces.is_empty() {
            return Err(MeshError::NoFaces {
                vertices: self.positions.len(),
            });
        }
        self.refuse_bad_positions(lines)?;
        self.drop_missing_normals();
        let warnings = self.warnings(lines);
        let mut used_materials = vec![String::new(); self.materials.len()];
        for (name, index) in std::mem::take(&mut self.materials) {
            used_materials[index] = name;
        }
        Ok(Scan {
            used_materials,
            libraries: self.libraries,
            warnings,
            positions: self.positions,
            normal_text: self.normal_text,
            faces: self.faces,
            corners: self.corners,
        })
    }

    /// Refuses the file if a face uses a vertex that cannot be read; one that no face uses is harmless.
    fn refuse_bad_positions(&self, lines: &Lines<'_>) -> Result<(), MeshError> {
        if self.bad_positions.is_empty() {
            return Ok(());
        }
        let mut is_used = vec![false; self.positions.len() + 1];
        for corner in &self.corners {
            is_used[corner.position as usize] = true;
        }
        let first_used = self
            .bad_positions
            .iter()
            .find(|(index, _)| is_used[*index as usize]);
        match first_used.and_then(|(_, line)| error_on(lines, *line)) {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    /// Replaces indices of normals that the file does not have.
    fn drop_missing_normals(&mut self) {
        for face in &self.faces {
            for corner in &mut self.corners[face.start..face.start + face.count] {
                if corner.normal as usize > self.normals {
                    let index = corner.normal;
                    self.corners_without_normal
                        .add(|| format!("normal {index} on line {}", face.line));
                    corner.normal = NO_NORMAL;
                }
            }
        }
    }

    fn warnings(&self, lines: &Lines<'_>) -> Vec<Warning> {
        let mut bad_vertices = Skipped::default();
        for (_, line) in &self.bad_positions {
            bad_vertices.add(|| error_on(lines, *line).map_or_else(String::new, |e| e.to_string()));
        }
        [
            bad_vertices.warning(
                "mesh_bad_vertices",
                "vertices cannot be read; no face uses them.",
            ),
            self.small_faces.warning(
                "mesh_small_faces",
                "faces with fewer than three corners were left out.",
            ),
            self.bad_normals.warning(
                "mesh_bad_normals",
                "normals are zero, not finite or incomplete; face normals are used instead.",
            ),
            self.corners_without_normal.warning(
                "mesh_missing_normals",
                "corners of faces name a normal that the file does not have; face normals are used instead.",
            ),
            self.vertex_colours.warning(
                "mesh_vertex_colours_ignored",
                "vertices have a colour, which is not used; `Kd` of materials is.",
            ),
            self.extra_values.warning(
                "mesh_extra_values_ignored",
                "vertices have more values than `x y z`, which are not used.",
            ),
            self.bad_weights.warning(
                "mesh_bad_weights",
                "vertices have a fourth value that cannot be a weight; they are used as without it.",
            ),
            self.trailing.warning(
                "mesh_trailing_words",
                "faces end in words that are no corners; these are not used.",
            ),
            self.ignored.warning(
                "mesh_ignored_lines",
                "lines are not used; only v, vn, f, usemtl and mtllib are.",
            ),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// A vertex as read.
struct Vertex {
    position: DVec3,
    /// Number of values on its line.
    values: usize,
    weight: Weight,
}

/// The fourth of four values.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Weight {
    /// There is none, or it has divided the position.
    Used,
    /// It is no number, not finite, or 0.
    Unusable,
}

/// Three coordinates, alone, with a weight that divides them, or with further values, which are not used.
fn position(line: usize, rest: &str) -> Result<Vertex, MeshError> {
    let mut count = 0;
    let mut first = [""; 4];
    for word in words(rest) {
        if let Some(place) = first.get_mut(count) {
            *place = word;
        }
        count += 1;
    }
    if count < 3 {
        let message = format!(
            "a vertex has {count} values; expected `v x y z`, `v x y z w` or `v x y z r g b`"
        );
        return Err(syntax(line, message));
    }
    let weight = match (count, number(first[3])) {
        (4, Some(weight)) if weight != 0.0 && weight.is_finite() => Some(weight),
        (4, _) => None,
        _ => Some(1.0),
    };
    let mut position = DVec3::ZERO;
    for (axis, word) in first[..3].iter().enumerate() {
        let value = coordinate(line, word)? / weight.unwrap_or(1.0);
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
        position[axis] = value;
    }
    Ok(Vertex {
        position,
        values: count,
        weight: if weight.is_some() {
            Weight::Used
        } else {
            Weight::Unusable
        },
    })
}

/// The error of the vertex on a line, found by reading the line again: errors are not kept, because there may be millions.
fn error_on(lines: &Lines<'_>, line: u32) -> Option<MeshError> {
    let mut statements = lines.statements(may_go_on);
    let statement = statements.find(|statement| statement.line == line as usize)?;
    let (_, rest) = keyword_of(&statement.text);
    position(statement.line, rest).err()
}

/// The absolute index of the negative `index`, counted back from the `before` read so far; `None` before the first.
fn back(before: usize, index: i64) -> Option<usize> {
    let steps = usize::try_from(index.unsigned_abs()).ok()?;
    (before + 1).checked_sub(steps)
}

/// A number of a `v` line; NaN where a C library wrote one.
fn coordinate(line: usize, word: &str) -> Result<f64, MeshError> {
    number(word).ok_or_else(|| {
        let message = format!(
            "`{}` is not a number; expected a decimal number such as -1.25 or 3e-2",
            shorten(word)
        );
        syntax(line, message)
    })
}
