//! Sheets over a square: terrain, cloth. None has a thickness; all have an edge.

use glam::DVec3;

use super::turn::sin_cos;
use super::{Outline, Shape, noise};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "terrain",
        description: "Hills and valleys of noise, finely meshed",
        triangles: 299_538,
        open_edges: 1_548,
        build: || height_field(387, terrain),
    },
    Shape {
        name: "coarse_terrain",
        description: "The same hills and valleys, coarsely meshed",
        triangles: 4_608,
        open_edges: 192,
        build: || height_field(48, terrain),
    },
    Shape {
        name: "ripples",
        description: "Sand ripples that bend and join",
        triangles: 51_200,
        open_edges: 640,
        build: || height_field(160, ripples),
    },
    Shape {
        name: "crater",
        description: "Crater with a rim and a peak in its middle",
        triangles: 12_800,
        open_edges: 320,
        build: || height_field(80, crater),
    },
    Shape {
        name: "cloth",
        description: "Wavy cloth that hangs over at its folds",
        triangles: 16_200,
        open_edges: 360,
        build: || sheet(90, 90, cloth),
    },
    Shape {
        name: "curtain",
        description: "Hanging cloth in deep folds",
        triangles: 12_800,
        open_edges: 464,
        build: || sheet(200, 32, curtain),
    },
];

/// A sheet without thickness: the points of (u, v), both 0 … 1. Its outside is where u, v and the normal are a right hand.
pub(super) fn sheet(u_cells: u32, v_cells: u32, place: impl Fn(f64, f64) -> DVec3) -> Outline {
    let mut outline = Outline::default();
    for u in 0..=u_cells {
        for v in 0..=v_cells {
            outline.point(place(
                f64::from(u) / f64::from(u_cells),
                f64::from(v) / f64::from(v_cells),
            ));
        }
    }
    let node = |u: u32, v: u32| u * (v_cells + 1) + v;
    for u in 0..u_cells {
        for v in 0..v_cells {
            outline.quad([
                node(u, v),
                node(u + 1, v),
                node(u + 1, v + 1),
                node(u, v + 1),
            ]);
        }
    }
    outline
}

/// Heights over x and z, both −1 … 1, seen from above.
fn height_field(cells: u32, height: impl Fn(f64, f64) -> f64) -> Outline {
    sheet(cells, cells, |u, v| {
        let (x, z) = (2.0 * u - 1.0, 1.0 - 2.0 * v);
        DVec3::new(x, height(x, z), z)
    })
}

fn terrain(x: f64, z: f64) -> f64 {
    0.3 * noise::octaves(77, DVec3::new(1.7 * x, 0.5, 1.7 * z), 7)
}

fn ripples(x: f64, z: f64) -> f64 {
    let bend = noise::octaves(31, DVec3::new(1.5 * x, 0.5, 1.5 * z), 3);
    let (wave, _) = sin_cos(4.0 * x + 0.9 * bend);
    0.03 * wave + 0.06 * bend
}

fn crater(x: f64, z: f64) -> f64 {
    let away_squared = x * x + z * z;
    // Bells of (1 + r²)⁻³: one for the hole, one for the rim around it, one for the peak.
    let bell = |squared: f64| 1.0 / ((1.0 + squared) * (1.0 + squared) * (1.0 + squared));
    let rim = away_squared.sqrt() - 0.6;
    0.25 * bell(40.0 * rim * rim) - 0.3 * bell(3.0 * away_squared)
        + 0.25 * bell(90.0 * away_squared)
}

fn cloth(u: f64, v: f64) -> DVec3 {
    let (x, z) = (2.0 * u - 1.0, 1.0 - 2.0 * v);
    let (sin, cos) = sin_cos(1.5 * x + 0.4 * z);
    let (slow, _) = sin_cos(0.8 * z + 0.3);
    // Crests lean over the troughs: steeper than any height field.
    DVec3::new(
        x - 0.16 * cos * (1.0 + 0.3 * slow),
        0.15 * sin + 0.1 * slow,
        z,
    )
}

fn curtain(u: f64, v: f64) -> DVec3 {
    let (sin, _) = sin_cos(7.0 * u);
    let (twice, _) = sin_cos(14.0 * u);
    let depth = 0.06 + 0.05 * (1.0 - v);
    DVec3::new(u - 0.012 * twice, v, depth * sin)
}
