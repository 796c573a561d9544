//! Spheres from an icosahedron, and shapes made by moving their points in and out.

use std::collections::HashMap;

use glam::DVec3;

use super::polyhedra::{icosahedron, stellated};
use super::turn::sin_cos;
use super::{Outline, Shape, noise};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "icosphere",
        description: "Sphere of nearly equal triangles",
        triangles: 5_120,
        open_edges: 0,
        build: || icosphere(4),
    },
    Shape {
        name: "urchin",
        description: "Sphere with 320 spikes",
        triangles: 960,
        open_edges: 0,
        build: || stellated(&icosphere(2), 1.7),
    },
    Shape {
        name: "boulder",
        description: "Sphere, flattened and worn by noise",
        triangles: 20_480,
        open_edges: 0,
        build: boulder,
    },
    Shape {
        name: "asteroid",
        description: "Rough sphere with noise down to the size of its triangles",
        triangles: 81_920,
        open_edges: 0,
        build: asteroid,
    },
    Shape {
        name: "pebbles",
        description: "Heap of forty flat stones, some inside each other",
        triangles: 12_800,
        open_edges: 0,
        build: pebbles,
    },
];

/// An icosahedron whose triangles are quartered the given number of times, every point on the unit sphere.
fn icosphere(levels: u32) -> Outline {
    let mut sphere = icosahedron();
    for _ in 0..levels {
        sphere = quartered(&sphere);
    }
    sphere
}

fn quartered(sphere: &Outline) -> Outline {
    let mut finer = Outline {
        positions_m: sphere.positions_m.clone(),
        faces: Vec::with_capacity(4 * sphere.faces.len()),
    };
    let mut middles = HashMap::new();
    for &[a, b, c] in &sphere.faces {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                let sum = sphere.positions_m[p as usize] + sphere.positions_m[q as usize];
                finer.point(sum.normalize())
            })
        });
        finer
            .faces
            .extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    finer
}

fn boulder() -> Outline {
    icosphere(5).map(|p| {
        let radius = 1.0 + 0.30 * noise::octaves(11, 1.3 * p, 5);
        radius * p * DVec3::new(1.0, 0.7, 0.85)
    })
}

fn asteroid() -> Outline {
    icosphere(6).map(|p| (1.0 + 0.25 * noise::octaves(23, 1.7 * p, 7)) * p)
}

fn pebbles() -> Outline {
    let stone = icosphere(2);
    Outline::all((0..40).map(|index| {
        let random = |what: u32| noise::unit(100 + what, index);
        // Higher stones lie nearer the middle: a heap.
        let height = random(0) * random(1);
        let (sin, cos) = sin_cos(random(2));
        let away = (1.0 - height) * random(3).sqrt();
        let (turn_sin, turn_cos) = sin_cos(random(4));
        let size = (0.10 + 0.12 * random(5)) * DVec3::new(1.0, 0.35 + 0.3 * random(6), 0.75);
        let place = DVec3::new(away * cos, 0.5 * height, away * sin);
        stone.clone().map(|p| {
            let p = size * p;
            place
                + DVec3::new(
                    turn_cos * p.x + turn_sin * p.z,
                    p.y,
                    turn_cos * p.z - turn_sin * p.x,
                )
        })
    }))
}
