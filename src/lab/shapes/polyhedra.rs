//! Few triangles, flat faces.

use glam::DVec3;

use super::skin::{End, skin};
use super::turn::sin_cos;
use super::{Outline, Shape};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "bipyramid",
        description: "Two pyramids over one pentagon",
        triangles: 10,
        open_edges: 0,
        build: bipyramid,
    },
    Shape {
        name: "box",
        description: "Cube",
        triangles: 12,
        open_edges: 0,
        build: || cuboid(DVec3::ONE),
    },
    Shape {
        name: "icosahedron",
        description: "Twenty equilateral triangles",
        triangles: 20,
        open_edges: 0,
        build: icosahedron,
    },
    Shape {
        name: "star",
        description: "Icosahedron with a spike on each face",
        triangles: 60,
        open_edges: 0,
        build: || stellated(&icosahedron(), 1.6),
    },
    Shape {
        name: "gear",
        description: "Upright wheel with sixteen teeth",
        triangles: 256,
        open_edges: 0,
        build: gear,
    },
];

/// A box around the origin.
pub(super) fn cuboid(size_m: DVec3) -> Outline {
    let corner = |bits: u32| {
        let half = |bit: u32| if bits & bit == 0 { -0.5 } else { 0.5 };
        size_m * DVec3::new(half(1), half(2), half(4))
    };
    let mut outline = Outline {
        positions_m: (0..8).map(corner).collect(),
        faces: Vec::new(),
    };
    // Corner i has x, y, z from bits 0, 1, 2 of i.
    for quad in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        outline.quad(quad);
    }
    outline
}

/// A regular icosahedron with its corners on the unit sphere.
pub(super) fn icosahedron() -> Outline {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions_m = Vec::new();
    for (one, other) in [
        (1.0, golden),
        (-1.0, golden),
        (1.0, -golden),
        (-1.0, -golden),
    ] {
        positions_m.extend([
            DVec3::new(0.0, one, other),
            DVec3::new(one, other, 0.0),
            DVec3::new(other, 0.0, one),
        ]);
    }
    // Corners are neighbours at a distance of 2; three neighbours are a face.
    let near = |a: usize, b: usize| {
        let (a, b): (DVec3, DVec3) = (positions_m[a], positions_m[b]);
        a.distance_squared(b) < 5.0
    };
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [p, q, r] = [a, b, c].map(|i| positions_m[i]);
                    let outward = p.dot(q.cross(r)) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    faces.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    Outline { positions_m, faces }.map(DVec3::normalize)
}

/// A body around the origin with a spike on each face. `reach` is the distance of a tip from the origin over that of its face.
pub(super) fn stellated(body: &Outline, reach: f64) -> Outline {
    let mut outline = Outline {
        positions_m: body.positions_m.clone(),
        faces: Vec::new(),
    };
    for &[a, b, c] in &body.faces {
        let sum: DVec3 = [a, b, c].map(|i| body.positions_m[i as usize]).iter().sum();
        let tip = outline.point(reach / 3.0 * sum);
        outline
            .faces
            .extend([[a, b, tip], [b, c, tip], [c, a, tip]]);
    }
    outline
}

fn bipyramid() -> Outline {
    let pentagon = (0..5)
        .map(|k| {
            let (sin, cos) = sin_cos(f64::from(k) / 5.0);
            DVec3::new(0.6 * cos, 0.0, -0.6 * sin)
        })
        .collect();
    let tip = |y: f64| End::Point(DVec3::new(0.0, y, 0.0));
    skin(&[pentagon], tip(-0.5), tip(0.5))
}

fn gear() -> Outline {
    const TEETH: u32 = 16;
    let ring = |z: f64| {
        (0..4 * TEETH)
            .map(|k| {
                let (sin, cos) = sin_cos(f64::from(k) / f64::from(4 * TEETH));
                let radius = if k % 4 < 2 { 0.5 } else { 0.4 };
                DVec3::new(radius * cos, radius * sin, z)
            })
            .collect()
    };
    let middle = |z: f64| End::Point(DVec3::new(0.0, 0.0, z));
    skin(&[ring(-0.09), ring(0.09)], middle(-0.09), middle(0.09))
}
