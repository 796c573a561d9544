//! Shading normals of an outline: smooth over the surface, apart where it has an edge.

use glam::DVec3;

use super::Outline;

/// Cosine of 40°: faces that meet at a wider angle meet at an edge. The faces of an icosahedron are 41.8° apart, the
/// sides of a cylinder of ten 36°.
const EDGE_COS: f64 = 0.766;

/// Normals at the three corners of each face, of unit length.
///
/// Each is a sum over the faces around the point that hang together with this one across smooth edges and are within 40°
/// of it. The weights are those of Max, *Weights for Computing Vertex Normals from Facet Normals*, Journal of Graphics
/// Tools 4(2), 1999: the cross product of the two edges over the squares of their lengths, which is exact on spheres.
pub(super) fn of(outline: &Outline) -> Vec<[DVec3; 3]> {
    let around = wedges_around(outline);
    let mut normals = vec![[DVec3::ZERO; 3]; outline.faces.len()];
    for wedges in &around {
        for (start, wedge) in wedges.iter().enumerate() {
            let sum: DVec3 = smooth_with(wedges, start).map(|w| w.weighted).sum();
            normals[wedge.face][wedge.corner] = sum.normalize_or_zero();
        }
    }
    normals
}

/// What a face is at one of its corners.
#[derive(Clone, Copy, Debug)]
struct Wedge {
    face: usize,
    corner: usize,
    /// The face's next corner and its last.
    next: u32,
    last: u32,
    /// Unit normal of the face.
    normal: DVec3,
    /// The same with the corner's weight.
    weighted: DVec3,
}

/// For each point the wedges around it.
fn wedges_around(outline: &Outline) -> Vec<Vec<Wedge>> {
    let mut around = vec![Vec::new(); outline.positions_m.len()];
    for (face, corners) in outline.faces.iter().enumerate() {
        for corner in 0..3 {
            let [at, next, last] = [0, 1, 2].map(|k| corners[(corner + k) % 3]);
            let [p, q, r] = [at, next, last].map(|i| outline.positions_m[i as usize]);
            let cross = (q - p).cross(r - p);
            around[at as usize].push(Wedge {
                face,
                corner,
                next,
                last,
                normal: cross.normalize_or_zero(),
                weighted: cross / (p.distance_squared(q) * p.distance_squared(r)),
            });
        }
    }
    around
}

/// Those of the wedges around a point that are smooth with one of them, in the order of the faces.
fn smooth_with(wedges: &[Wedge], start: usize) -> impl Iterator<Item = &Wedge> {
    let within = |a: usize, b: usize| wedges[a].normal.dot(wedges[b].normal) > EDGE_COS;
    let mut reached = vec![false; wedges.len()];
    let mut waiting = vec![start];
    while let Some(from) = waiting.pop() {
        if std::mem::replace(&mut reached[from], true) {
            continue;
        }
        waiting.extend((0..wedges.len()).filter(|&to| {
            let share_an_edge =
                wedges[from].next == wedges[to].last || wedges[from].last == wedges[to].next;
            share_an_edge && within(from, to) && within(start, to)
        }));
    }
    wedges
        .iter()
        .zip(reached)
        .filter_map(|(wedge, reached)| reached.then_some(wedge))
}
