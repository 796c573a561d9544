//! Leaves, and what floats like them.

use glam::DVec3;

use super::height_field::sheet;
use super::skin::End;
use super::sweep::{Station, circle, flat_ends, swept};
use super::turn::sin_cos;
use super::{Outline, Shape, noise, skin};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "leaf",
        description: "Bent leaf without thickness",
        triangles: 1_536,
        open_edges: 128,
        build: leaf,
    },
    Shape {
        name: "kelp",
        description: "Eleven twisted upright blades without thickness",
        triangles: 4_224,
        open_edges: 1_144,
        build: kelp,
    },
    Shape {
        name: "jellyfish",
        description: "Bell with eight arms",
        triangles: 9_376,
        open_edges: 0,
        build: jellyfish,
    },
];

/// Half the width of a blade at 0 … 1 of its length: 0.1 at the ends, 1 in between; never without width.
fn blade_width(t: f64) -> f64 {
    0.1 + 3.6 * t * (1.0 - t)
}

fn leaf() -> Outline {
    sheet(48, 16, |u, v| {
        let side = 2.0 * v - 1.0;
        let lift = 0.5 * u * (1.0 - u) + 0.1 * side * side;
        DVec3::new(u, lift, -0.22 * blade_width(u) * side)
    })
}

fn kelp() -> Outline {
    Outline::all((0..11).map(|blade| {
        let random = |what: u32| noise::unit(80 + what, blade);
        let (foot_sin, foot_cos) = sin_cos(f64::from(blade) / 11.0);
        let foot = (0.05 + 0.25 * random(0)) * DVec3::new(foot_cos, 0.0, foot_sin);
        let (height, start) = (0.7 + 0.3 * random(1), random(2));
        sheet(4, 48, |u, v| {
            let (sin, cos) = sin_cos(start + 0.6 * v);
            let (sway, drift) = sin_cos(random(3) + 0.8 * v);
            let side = 0.05 * blade_width(v) * (2.0 * u - 1.0);
            foot + DVec3::new(
                side * cos + 0.1 * v * sway,
                height * v,
                side * sin + 0.1 * v * drift,
            )
        })
    }))
}

fn jellyfish() -> Outline {
    const STEPS: u32 = 28;
    // From the pole inside down to the rim, and up the outside to the pole there.
    let side = |radius: f64, height: f64, k: u32| {
        let (sin, cos) = sin_cos(0.27 * f64::from(k) / f64::from(STEPS));
        (radius * sin, height * cos)
    };
    let profile = (1..=STEPS)
        .map(|k| side(0.36, 0.24, k))
        .chain((1..=STEPS).rev().map(|k| side(0.4, 0.3, k)));
    let rings: Vec<Vec<DVec3>> = profile
        .map(|(radius, y)| {
            circle(48)
                .into_iter()
                .map(|(c, s)| DVec3::new(radius * c, y, -radius * s))
                .collect()
        })
        .collect();
    let pole = |y: f64| End::Point(DVec3::new(0.0, y, 0.0));
    let bell = skin::skin(&rings, pole(0.24), pole(0.3));
    let arms = (0..8).map(|arm| {
        let (sin, cos) = sin_cos(f64::from(arm) / 8.0);
        let stations: Vec<_> = (0..=24)
            .map(|k| {
                let t = f64::from(k) / 24.0;
                let (sway, drift) = sin_cos(0.9 * t + 0.37 * f64::from(arm));
                let out = 0.25 - 0.08 * t;
                Station {
                    centre_m: DVec3::new(
                        out * cos + 0.07 * t * sway,
                        0.2 - 0.75 * t,
                        out * sin + 0.07 * t * drift,
                    ),
                    across: DVec3::X,
                    scale: 0.022 - 0.015 * t,
                }
            })
            .collect();
        let (start, end) = flat_ends(&stations);
        swept(&stations, &circle(10), start, end)
    });
    Outline::all(std::iter::once(bell).chain(arms))
}
