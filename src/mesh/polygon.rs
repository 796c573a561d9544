//! Cuts polygons into triangles.

use std::collections::HashMap;

use earcut::Earcut;
use glam::{DVec2, DVec3};

use super::repair::FLAT;

/// How far the triangles' area may be from the polygon's, relative to it, before the polygon counts as one that crosses itself.
const AREA_TOLERANCE: f64 = 1e-6;

/// Most corners of a polygon whose ears are cut. The time grows with their square in the worst case (a spiral of two arms: 4 ns times
/// the square of its corners).
pub(super) const MAX_CORNERS: usize = 10_000;

/// Most of the sum of such squares in a mesh: a few seconds.
const MAX_SQUARES: usize = 1_000_000_000;

/// Cuts polygons into triangles; keeps its memory between polygons.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    ears: Vec<usize>,
    squares: usize,
}

/// How a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// The triangles cover the polygon.
    Whole,
    /// The polygon crosses itself or is far from flat: no set of triangles covers exactly it.
    Crossed,
    /// A fan does not cover the polygon, and it has more than [`MAX_CORNERS`] corners, or the mesh has too many of its kind: it was not
    /// cut.
    TooLarge,
}

impl Cutter {
    pub(super) fn new() -> Self {
        Self {
            earcut: Earcut::new(),
            flat: Vec::new(),
            ears: Vec::new(),
            squares: 0,
        }
    }

    /// Cuts a polygon of three or more corners; `triangles` receives indices of corners, in the polygon's own direction.
    ///
    /// If a fan around a corner covers the polygon, it is used; else the polygon is projected onto its plane, and its ears are cut off.
    /// Every corner is in a triangle with an area, also one in the middle of a straight edge, because a neighbour may end there.
    pub(super) fn cut(&mut self, corners: &[DVec3], triangles: &mut Vec<[usize; 3]>) -> Cut {
        triangles.clear();
        let fan = |apex: usize| {
            let turned = move |i: usize| (apex + i) % corners.len();
            (1..corners.len() - 1).map(move |i| [apex, turned(i), turned(i + 1)])
        };
        // Around the first corner, or the second if the first lies on a straight edge with its neighbours.
        if let Some(apex) = (0..corners.len().min(3)).find(|apex| fan_covers(corners, *apex)) {
            triangles.extend(fan(apex));
            return Cut::Whole;
        }
        self.squares += corners.len().saturating_mul(corners.len());
        if corners.len() > MAX_CORNERS || self.squares > MAX_SQUARES {
            return Cut::TooLarge;
        }
        let normal = newell_normal(corners);
        let Some(axis) = normal.try_normalize() else {
            triangles.extend(fan(0));
            return Cut::Crossed;
        };
        let (right, up) = axis.any_orthonormal_pair();
        // With `right` × `up` = `axis`, the flat polygon runs counter-clockwise.
        let up = if right.cross(up).dot(axis) < 0.0 {
            -up
        } else {
            up
        };
        self.flat.clear();
        self.flat.extend(
            corners
                .iter()
                .map(|p| *p - corners[0])
                .map(|p| [p.dot(right), p.dot(up)]),
        );
        self.earcut
            .earcut(self.flat.iter().copied(), &[], &mut self.ears);

        let at = |i: usize| DVec2::from(self.flat[i]);
        let doubled_area = |[a, b, c]: [usize; 3]| (at(b) - at(a)).perp_dot(at(c) - at(a));
        let mut covered = 0.0;
        for ear in self.ears.chunks_exact(3) {
            let ear = [ear[0], ear[1], ear[2]];
            let doubled = doubled_area(ear);
            covered += doubled.abs();
            triangles.push(if doubled < 0.0 {
                [ear[0], ear[2], ear[1]]
            } else {
                ear
            });
        }
        if triangles.is_empty() {
            triangles.extend(fan(0));
            return Cut::Crossed;
        }
        insert_left_out_corners(corners.len(), triangles);
        let whole = normal.length();
        if (covered - whole).abs() <= AREA_TOLERANCE * whole {
            Cut::Whole
        } else {
            Cut::Crossed
        }
    }
}

/// Whether all triangles of the fan around a corner have an area and face the same way; they then cover the polygon. A triangle whose
/// corners coincide is no obstacle, because leaving it out loses no corner.
fn fan_covers(corners: &[DVec3], apex: usize) -> bool {
    let count = corners.len();
    let at = |i: usize| corners[(apex + i) % count];
    let mut first: Option<DVec3> = None;
    for i in 1..count - 1 {
        let (u, v) = (at(i) - at(0), at(i + 1) - at(0));
        let turn = u.cross(v);
        let coincide = u == DVec3::ZERO || v == DVec3::ZERO || u == v;
        if coincide || count == 3 {
            continue;
        }
        // As in `repair`: a height of at most this fraction of the longest edge counts as none.
        let longest = u
            .length_squared()
            .max(v.length_squared())
            .max((v - u).length_squared());
        let is_flat = turn.length() <= FLAT * longest;
        if is_flat || first.is_some_and(|first| first.dot(turn) < 0.0) {
            return false;
        }
        first.get_or_insert(turn);
    }
    true
}

/// Normal of a polygon whose length is twice its area. Source: Newell's method (Sutherland, Sproull and Schumacker, "A
/// Characterization of Ten Hidden-Surface Algorithms", 1974).
fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let mut previous = corners[corners.len() - 1] - corners[0];
    let mut sum = DVec3::ZERO;
    for corner in corners {
        let corner = *corner - corners[0];
        sum += previous.cross(corner);
        previous = corner;
    }
    sum
}

/// Splits triangles at the corners that ear cutting leaves out because they lie in the middle of a straight edge.
fn insert_left_out_corners(count: usize, triangles: &mut Vec<[usize; 3]>) {
    let mut is_used = vec![false; count];
    for corner in triangles.iter().flatten() {
        is_used[*corner] = true;
    }
    let Some(start) = is_used.iter().position(|used| *used) else {
        return;
    };
    if is_used.iter().all(|used| *used) {
        return;
    }
    let mut edges = Edges::of(triangles);
    let mut from = start;
    let mut between = Vec::new();
    for step in 1..=count {
        let corner = (start + step) % count;
        if !is_used[corner] {
            between.push(corner);
            continue;
        }
        if !between.is_empty() {
            edges.split(triangles, [from, corner], &between);
            between.clear();
        }
        from = corner;
    }
}

/// The triangle of each directed edge.
struct Edges(HashMap<[usize; 2], usize>);

impl Edges {
    fn of(triangles: &[[usize; 3]]) -> Self {
        let mut edges = Self(HashMap::with_capacity(3 * triangles.len()));
        for (index, triangle) in triangles.iter().enumerate() {
            edges.add(index, *triangle);
        }
        edges
    }

    fn add(&mut self, index: usize, [a, b, c]: [usize; 3]) {
        for edge in [[a, b], [b, c], [c, a]] {
            self.0.insert(edge, index);
        }
    }

    /// Replaces the triangle that has the edge `from` → `to` by a fan over the corners `between`.
    fn split(
        &mut self,
        triangles: &mut Vec<[usize; 3]>,
        [from, to]: [usize; 2],
        between: &[usize],
    ) {
        let Some(&index) = self.0.get(&[from, to]) else {
            return;
        };
        let opposite = triangles[index]
            .into_iter()
            .find(|corner| *corner != from && *corner != to);
        let Some(opposite) = opposite else {
            return;
        };
        let mut last = from;
        for (step, corner) in between.iter().copied().chain([to]).enumerate() {
            let piece = [last, corner, opposite];
            let place = if step == 0 { index } else { triangles.len() };
            if step == 0 {
                triangles[index] = piece;
            } else {
                triangles.push(piece);
            }
            self.add(place, piece);
            last = corner;
        }
    }
}
