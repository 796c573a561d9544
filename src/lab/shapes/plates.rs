//! Thin plates and sheets, which a map from above shows as almost nothing, or at a single depth.

use glam::DVec3;

use super::height_field::sheet;
use super::polyhedra::cuboid;
use super::{Outline, Shape};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "plate",
        description: "Lying plate, a hundredth as thick as wide",
        triangles: 12,
        open_edges: 0,
        build: || cuboid(DVec3::new(1.0, 0.01, 1.0)),
    },
    Shape {
        name: "tilted_plate",
        description: "The same plate, tilted by 37°",
        triangles: 12,
        open_edges: 0,
        build: tilted_plate,
    },
    Shape {
        name: "sheets",
        description: "Stack of ten sheets without thickness, each shifted",
        triangles: 320,
        open_edges: 160,
        build: sheets,
    },
    Shape {
        name: "blinds",
        description: "Fifteen upright plates side by side, edge on from above",
        triangles: 180,
        open_edges: 0,
        build: blinds,
    },
];

fn tilted_plate() -> Outline {
    // The angle of the triangle of sides 3, 4, 5: 36.87°.
    cuboid(DVec3::new(1.0, 0.01, 1.0))
        .map(|p| DVec3::new(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y, p.z))
}

fn sheets() -> Outline {
    Outline::all((0..10).map(|layer| {
        let height = f64::from(layer);
        sheet(4, 4, move |u, v| DVec3::new(u, 0.0, -v)).moved(
            0.04 * height,
            0.05 * height,
            0.03 * f64::from(layer % 3),
        )
    }))
}

fn blinds() -> Outline {
    let blade = cuboid(DVec3::new(0.004, 0.5, 1.0));
    Outline::all((0..15).map(|k| blade.clone().moved(f64::from(k) / 14.0, 0.0, 0.0)))
}
