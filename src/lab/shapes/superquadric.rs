//! Superquadrics: Barr, *Superquadrics and Angle-Preserving Transformations*, IEEE Computer Graphics and Applications
//! 1(1), 1981: sines and cosines raised to a power in the formulas of ellipsoid and torus.

use glam::DVec3;

use super::skin::{End, skin, skin_loop};
use super::turn::sin_cos;
use super::{Outline, Shape};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "rounded_box",
        description: "Superellipsoid, exponents ¼: a box with round edges",
        triangles: 8_064,
        open_edges: 0,
        build: || superellipsoid(64, quarter_power, quarter_power),
    },
    Shape {
        name: "pillow",
        description: "Superellipsoid, exponents 1 and ½",
        triangles: 8_064,
        open_edges: 0,
        build: || superellipsoid(64, |x| x, half_power).map(|p| p * DVec3::new(1.0, 0.4, 1.0)),
    },
    Shape {
        name: "caltrop",
        description: "Superellipsoid, exponents 3: six tips and hollow sides",
        triangles: 2_520,
        open_edges: 0,
        build: || superellipsoid(36, cube, cube),
    },
    Shape {
        name: "supertoroid",
        description: "Supertoroid, exponents ½ and 2: a square frame of a rounded section",
        triangles: 9_216,
        open_edges: 0,
        build: supertoroid,
    },
];

/// |x| to the power ½, with the sign of x; from square roots, which are exact.
fn half_power(x: f64) -> f64 {
    x.abs().sqrt().copysign(x)
}

fn quarter_power(x: f64) -> f64 {
    half_power(half_power(x))
}

fn cube(x: f64) -> f64 {
    x * x * x
}

/// x = cos^a η cos^b ω, y = sin^a η, z = −cos^a η sin^b ω, with `stacks` steps of η from pole to pole and as many of ω.
fn superellipsoid(stacks: u32, north_south: fn(f64) -> f64, east_west: fn(f64) -> f64) -> Outline {
    let rings: Vec<Vec<DVec3>> = (1..stacks)
        .map(|stack| {
            let (sin, cos) = sin_cos(0.5 * f64::from(stack) / f64::from(stacks) - 0.25);
            ring(north_south(cos), north_south(sin), stacks, east_west)
        })
        .collect();
    let pole = |y: f64| End::Point(DVec3::new(0.0, y, 0.0));
    skin(&rings, pole(-1.0), pole(1.0))
}

fn supertoroid() -> Outline {
    const SIDES: u32 = 48;
    let rings: Vec<Vec<DVec3>> = (0..SIDES)
        .map(|side| {
            let (sin, cos) = sin_cos(f64::from(side) / f64::from(SIDES));
            ring(2.5 + half_power(cos), half_power(sin), 96, |x| x * x.abs())
        })
        .collect();
    skin_loop(&rings)
}

/// A ring at height `y` that is `reach` wide along the axes.
fn ring(reach: f64, y: f64, segments: u32, east_west: fn(f64) -> f64) -> Vec<DVec3> {
    (0..segments)
        .map(|segment| {
            let (sin, cos) = sin_cos(f64::from(segment) / f64::from(segments));
            DVec3::new(reach * east_west(cos), y, -reach * east_west(sin))
        })
        .collect()
}
