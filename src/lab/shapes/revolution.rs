//! Bodies of revolution about the y axis.

use glam::DVec3;

use super::skin::{End, skin, skin_loop};
use super::turn::sin_cos;
use super::{Outline, Shape};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "sphere",
        description: "Sphere of 32 meridians and 31 parallels",
        triangles: 1_984,
        open_edges: 0,
        build: sphere,
    },
    Shape {
        name: "cylinder",
        description: "Upright cylinder with flat lids",
        triangles: 192,
        open_edges: 0,
        build: || cylinder(0.35, 1.0, 48),
    },
    Shape {
        name: "cone",
        description: "Upright cone",
        triangles: 128,
        open_edges: 0,
        build: || revolved(&[(0.0, 0.0), (0.5, 0.0), (0.0, 1.0)], 64),
    },
    Shape {
        name: "torus",
        description: "Lying ring",
        triangles: 4_608,
        open_edges: 0,
        build: || torus(1.0, 0.35, 96, 24),
    },
    Shape {
        name: "washer",
        description: "Thin flat ring with square edges",
        triangles: 512,
        open_edges: 0,
        build: || hollow(0.22, 0.5, 0.04, 64),
    },
    Shape {
        name: "pipe",
        description: "Upright thin-walled pipe, open at both ends",
        triangles: 640,
        open_edges: 0,
        build: || hollow(0.27, 0.30, 1.0, 80),
    },
    Shape {
        name: "bowl",
        description: "Open bowl with a thick wall",
        triangles: 8_192,
        open_edges: 0,
        build: bowl,
    },
    Shape {
        name: "vase",
        description: "Vase without thickness, open at the top",
        triangles: 6_112,
        open_edges: 32,
        build: vase,
    },
    Shape {
        name: "hourglass",
        description: "Two cups that meet in a narrow neck",
        triangles: 6_048,
        open_edges: 0,
        build: hourglass,
    },
    Shape {
        name: "saucer",
        description: "Flying saucer: lens with a dome",
        triangles: 2_400,
        open_edges: 0,
        build: saucer,
    },
    Shape {
        name: "colonnade",
        description: "Twelve pillars in a ring under a flat ring",
        triangles: 1_536,
        open_edges: 0,
        build: colonnade,
    },
    Shape {
        name: "hammer",
        description: "Hammer on its handle: two cylinders",
        triangles: 272,
        open_edges: 0,
        build: hammer,
    },
];

/// The profile (distance from the axis, height), from below along the outside, turned about the axis; where it touches the
/// axis is a pole, and where it ends away from it an edge.
fn revolved(profile: &[(f64, f64)], segments: u32) -> Outline {
    let end = |place: Option<&(f64, f64)>| match place {
        Some(&(0.0, y)) => End::Point(DVec3::new(0.0, y, 0.0)),
        _ => End::Open,
    };
    let (start, stop) = (end(profile.first()), end(profile.last()));
    skin(&rings(profile, segments), start, stop)
}

/// Rings at the places of a profile that are off the axis.
fn rings(profile: &[(f64, f64)], segments: u32) -> Vec<Vec<DVec3>> {
    let ring = |&(radius, y): &(f64, f64)| {
        (0..segments)
            .map(|k| {
                let (sin, cos) = sin_cos(f64::from(k) / f64::from(segments));
                DVec3::new(radius * cos, y, -radius * sin)
            })
            .collect()
    };
    profile.iter().filter(|p| p.0 > 0.0).map(ring).collect()
}

/// As many triangles as the sphere of Tipprasert (2006), Table 5-2.
fn sphere() -> Outline {
    let profile: Vec<_> = (0..=32)
        .map(|k| {
            let (sin, cos) = sin_cos(f64::from(k) / 64.0);
            (sin, -cos)
        })
        .collect();
    revolved(&profile, 32)
}

/// A cylinder around the origin.
pub(super) fn cylinder(radius_m: f64, height_m: f64, segments: u32) -> Outline {
    let (below, above) = (-0.5 * height_m, 0.5 * height_m);
    revolved(
        &[
            (0.0, below),
            (radius_m, below),
            (radius_m, above),
            (0.0, above),
        ],
        segments,
    )
}

/// A ring of circular section around the origin.
pub(super) fn torus(radius_m: f64, tube_m: f64, segments: u32, sides: u32) -> Outline {
    let profile: Vec<_> = (0..sides)
        .map(|k| {
            let (sin, cos) = sin_cos(f64::from(k) / f64::from(sides));
            (radius_m + tube_m * cos, tube_m * sin)
        })
        .collect();
    skin_loop(&rings(&profile, segments))
}

/// A ring of rectangular section around the origin.
fn hollow(inner_m: f64, outer_m: f64, height_m: f64, segments: u32) -> Outline {
    let (below, above) = (-0.5 * height_m, 0.5 * height_m);
    skin_loop(&rings(
        &[
            (inner_m, below),
            (outer_m, below),
            (outer_m, above),
            (inner_m, above),
        ],
        segments,
    ))
}

fn bowl() -> Outline {
    const STEPS: u32 = 32;
    // Half a sphere from its pole to the rim outside, and a smaller one back to its pole inside.
    let quarter = |radius: f64, k: u32| {
        let (sin, cos) = sin_cos(0.25 * f64::from(k) / f64::from(STEPS));
        (radius * sin, -radius * cos)
    };
    let profile: Vec<_> = (0..=STEPS)
        .map(|k| quarter(0.5, k))
        .chain((0..=STEPS).rev().map(|k| quarter(0.46, k)))
        .collect();
    revolved(&profile, 64)
}

fn vase() -> Outline {
    const STEPS: u32 = 96;
    let profile: Vec<_> = (0..=STEPS)
        .map(|k| {
            let t = f64::from(k) / f64::from(STEPS);
            let (wave, _) = sin_cos(0.85 * t);
            let foot = (8.0 * t).min(1.0);
            (foot * (0.17 + 0.13 * wave), t)
        })
        .collect();
    revolved(&profile, 32)
}

fn hourglass() -> Outline {
    const STEPS: u32 = 62;
    let wall = (0..=STEPS).map(|k| {
        let y = 2.0 * f64::from(k) / f64::from(STEPS) - 1.0;
        (0.05 + 0.35 * y * y * (2.0 - y * y), 0.5 * y)
    });
    let profile: Vec<_> = std::iter::once((0.0, -0.5))
        .chain(wall)
        .chain(std::iter::once((0.0, 0.5)))
        .collect();
    revolved(&profile, 48)
}

fn saucer() -> Outline {
    let (mut profile, lens_steps, dome_steps) = (Vec::new(), 16_u32, 10_u32);
    for k in 0..lens_steps {
        let (sin, cos) = sin_cos(0.375 * f64::from(k) / f64::from(lens_steps));
        profile.push((0.5 * sin, -0.11 * cos));
    }
    // The dome starts where the lens has come in to its radius.
    for k in 0..=dome_steps {
        let (sin, cos) = sin_cos(0.25 * f64::from(k) / f64::from(dome_steps));
        let radius = if k == dome_steps { 0.0 } else { 0.2 * cos };
        profile.push((radius, 0.09 + 0.16 * sin));
    }
    revolved(&profile, 48)
}

fn colonnade() -> Outline {
    let pillar = cylinder(0.05, 0.6, 24);
    let pillars = (0..12).map(|k| {
        let (sin, cos) = sin_cos(f64::from(k) / 12.0);
        pillar.clone().moved(0.42 * cos, 0.0, 0.42 * sin)
    });
    // Their tops are inside the ring.
    let ring = hollow(0.35, 0.5, 0.1, 48).moved(0.0, 0.33, 0.0);
    Outline::all(pillars.chain(std::iter::once(ring)))
}

fn hammer() -> Outline {
    let handle = cylinder(0.035, 0.9, 20);
    let head = cylinder(0.09, 0.5, 48).map(|p| DVec3::new(p.y, -p.x, p.z));
    Outline::all([handle, head.moved(0.03, 0.42, 0.0)])
}
