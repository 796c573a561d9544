//! A skin over a row of rings: shared by bodies of revolution, tubes and fish.

use glam::DVec3;

use super::Outline;

/// How a row of rings ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// With the last ring as the edge of a hole.
    Open,
    /// With triangles to a point: a tip, a pole, or the middle of a flat lid.
    Point(DVec3),
}

/// A skin over rings with equal numbers of points. The points run around the direction from the first ring to the last by the right-hand
/// rule; then the outside of the skin faces away from that axis.
pub(super) fn skin(rings: &[Vec<DVec3>], start: End, end: End) -> Outline {
    let mut outline = open(rings);
    let sides = sides(rings);
    let last = (rings.len() as u32 - 1) * sides;
    if let End::Point(p) = start {
        let tip = outline.point(p);
        for k in 0..sides {
            outline.faces.push([tip, (k + 1) % sides, k]);
        }
    }
    if let End::Point(p) = end {
        let tip = outline.point(p);
        for k in 0..sides {
            outline.faces.push([tip, last + k, last + (k + 1) % sides]);
        }
    }
    outline
}

/// A skin over rings of which the last is followed by the first.
pub(super) fn skin_loop(rings: &[Vec<DVec3>]) -> Outline {
    let mut outline = open(rings);
    band(&mut outline, rings.len() as u32 - 1, 0, sides(rings));
    outline
}

fn sides(rings: &[Vec<DVec3>]) -> u32 {
    rings.first().map_or(0, |ring| ring.len() as u32)
}

fn open(rings: &[Vec<DVec3>]) -> Outline {
    let mut outline = Outline {
        positions_m: rings.concat(),
        faces: Vec::new(),
    };
    for ring in 1..rings.len() as u32 {
        band(&mut outline, ring - 1, ring, sides(rings));
    }
    outline
}

/// The strip between two rings.
fn band(outline: &mut Outline, from: u32, to: u32, sides: u32) {
    for k in 0..sides {
        let next = (k + 1) % sides;
        outline.quad([
            from * sides + k,
            from * sides + next,
            to * sides + next,
            to * sides + k,
        ]);
    }
}
