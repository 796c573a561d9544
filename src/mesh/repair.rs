//! Repairs the triangles that were read: moves them to the middle of their bounds, removes those without area and duplicates, and
//! reports what was left out or is doubtful.

use std::collections::{HashMap, HashSet};

use glam::{DVec3, Vec3};

use super::{MeshError, Triangle};
use crate::stats::Warning;

/// A triangle whose height is at most this fraction of its longest edge counts as degenerate (corners on a line): rounding in the
/// cross product alone reaches 10⁻¹⁶.
pub(super) const FLAT: f64 = 1e-12;

/// Codes of the warnings about triangles that were left out.
pub(crate) const LEFT_OUT: [&str; 2] = [DEGENERATE, DUPLICATE];
const DEGENERATE: &str = "mesh_degenerate_triangles";
const DUPLICATE: &str = "mesh_duplicate_triangles";

/// A triangle as read, in file coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawTriangle {
    /// Corners, m.
    pub(super) positions_m: [DVec3; 3],
    /// Normals of any length; zero where the file has none.
    pub(super) normals: [DVec3; 3],
    /// Index into the materials.
    pub(super) material: u32,
}

/// The repaired mesh.
#[derive(Debug)]
pub(super) struct Repaired {
    /// Middle of the bounds in file coordinates, m.
    pub(super) origin_m: DVec3,
    /// Triangles relative to it; at least one.
    pub(super) triangles: Vec<Triangle>,
    /// What was left out or is doubtful.
    pub(super) warnings: Vec<Warning>,
}

/// Moves, cleans and examines the triangles.
pub(super) fn repair(raw: &[RawTriangle]) -> Result<Repaired, MeshError> {
    let no_area = || MeshError::NoArea {
        triangles: raw.len(),
    };
    // Flat triangles are dropped in f64 first, so that they do not move the origin, then again after the corners and after the
    // edges are rounded.
    let solid = || raw.iter().filter(|t| face_normal(t.positions_m).is_some());
    let (min, max) = solid()
        .flat_map(|t| t.positions_m)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
            (min.min(p), max.max(p))
        });
    if !min.is_finite() {
        return Err(no_area());
    }
    let origin_m = 0.5 * min + 0.5 * max;

    let mut welder = Welder::default();
    let mut seen = HashSet::new();
    let mut kept = Vec::new();
    let mut topology = Vec::new();
    let (mut duplicates, mut against) = (0_usize, 0_usize);
    for triangle in solid() {
        // Adding +0 turns −0 into +0, so that equal corners have equal bits.
        let corners = triangle
            .positions_m
            .map(|p| (p - origin_m).as_vec3() + Vec3::ZERO);
        let Some(normal) = face_normal(corners.map(|p| p.as_dvec3())) else {
            continue;
        };
        // The renderer computes edges from the first corner in f32. A needle whose rounded edges have no area between them is hit
        // by no ray.
        let [a, b, c] = corners;
        if face_normal([DVec3::ZERO, (b - a).as_dvec3(), (c - a).as_dvec3()]).is_none() {
            continue;
        }
        let vertices = rotated(corners.map(|p| welder.vertex(p)));
        if !seen.insert(vertices) {
            duplicates += 1;
            continue;
        }
        topology.push(vertices);
        let normals = triangle.normals.map(|n| n.try_normalize());
        if normals
            .iter()
            .all(|n| n.is_some_and(|n| n.dot(normal) < 0.0))
        {
            against += 1;
        }
        kept.push(Triangle {
            positions_m: corners,
            normals: normals.map(|n| n.unwrap_or(normal).as_vec3()),
            material: triangle.material,
        });
    }
    if kept.is_empty() {
        return Err(no_area());
    }
    let degenerate = raw.len() - kept.len() - duplicates;
    let warnings = warnings(degenerate, duplicates, against, &EdgeReport::of(&topology));
    Ok(Repaired {
        origin_m,
        triangles: kept,
        warnings,
    })
}

/// Unit normal by the right-hand rule; `None` if the corners lie on a line, or so close together that an f32 cross product of the
/// edges would underflow.
fn face_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let (u, v, w) = (b - a, c - b, a - c);
    let longest_squared = u
        .length_squared()
        .max(v.length_squared())
        .max(w.length_squared());
    let cross = u.cross(-w);
    let doubled_area = cross.length();
    let has_area =
        doubled_area > FLAT * longest_squared && doubled_area >= f64::from(f32::MIN_POSITIVE);
    has_area.then(|| cross / doubled_area)
}

/// The same cycle of vertices, starting with the smallest. A rotated triangle is the same triangle, a mirrored one is not.
fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Gives corners at the same position the same number.
#[derive(Debug, Default)]
struct Welder {
    vertices: HashMap<[u32; 3], u32>,
}

impl Welder {
    fn vertex(&mut self, p: Vec3) -> u32 {
        let next = self.vertices.len() as u32;
        *self
            .vertices
            .entry(p.to_array().map(f32::to_bits))
            .or_insert(next)
    }
}

/// How triangles share edges.
#[derive(Debug, Default)]
struct EdgeReport {
    /// Edges of one triangle only.
    open: usize,
    /// Edges of more than two triangles.
    crowded: usize,
    /// Edges of two triangles that traverse them in the same direction.
    turned: usize,
}

impl EdgeReport {
    fn of(topology: &[[u32; 3]]) -> Self {
        let mut edges: Vec<(u32, u32, bool)> = topology
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .map(|(from, to)| (from.min(to), from.max(to), from < to))
            .collect();
        edges.sort_unstable();
        let mut report = Self::default();
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            match edge {
                [_] => report.open += 1,
                [first, second] => report.turned += usize::from(first.2 == second.2),
                _ => report.crowded += 1,
            }
        }
        report
    }
}

fn warnings(
    degenerate: usize,
    duplicates: usize,
    against: usize,
    edges: &EdgeReport,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let mut warn = |count: usize, code: &str, sentence: &str| {
        if count > 0 {
            warnings.push(Warning::new(code, format!("{count} {sentence}")));
        }
    };
    warn(
        degenerate,
        DEGENERATE,
        "triangles without area (corners coincide or lie on a line) were left out.",
    );
    warn(
        duplicates,
        DUPLICATE,
        "triangles that repeat another one were left out.",
    );
    warn(
        against,
        "mesh_normals_against_winding",
        "triangles have normals that point away from the side their corners run counter-clockwise on; both were kept as \
         they are.",
    );
    warn(
        edges.open,
        "mesh_open",
        "edges belong to one triangle only: the surface is not closed. It was kept as it is.",
    );
    warn(
        edges.crowded,
        "mesh_non_manifold",
        "edges belong to more than two triangles. They were kept as they are.",
    );
    warn(
        edges.turned,
        "mesh_winding",
        "edges join two triangles that face opposite ways. They were kept as they are.",
    );
    warnings
}
