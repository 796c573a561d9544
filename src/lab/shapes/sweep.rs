//! Sections carried along curves: knots, springs, shells, arches.

use glam::DVec3;

use super::revolution::torus;
use super::skin::{End, skin, skin_loop};
use super::turn::sin_cos;
use super::{Outline, Shape};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "trefoil_knot",
        description: "Tube around the (2, 3) torus knot",
        triangles: 6_400,
        open_edges: 0,
        build: || torus_knot(2, 3, 0.45, 200),
    },
    Shape {
        name: "torus_knot",
        description: "Thin tube around the (5, 8) torus knot",
        triangles: 38_400,
        open_edges: 0,
        build: || torus_knot(5, 8, 0.16, 1_200),
    },
    Shape {
        name: "spring",
        description: "Upright coil of seven turns",
        triangles: 10_776,
        open_edges: 0,
        build: spring,
    },
    Shape {
        name: "nautilus",
        description: "Flat spiral shell, open at its mouth",
        triangles: 17_260,
        open_edges: 20,
        build: nautilus,
    },
    Shape {
        name: "snail",
        description: "Tall spiral shell, open at its mouth",
        triangles: 28_780,
        open_edges: 20,
        build: snail,
    },
    Shape {
        name: "arch",
        description: "Round arch of square section",
        triangles: 280,
        open_edges: 0,
        build: arch,
    },
    Shape {
        name: "chain",
        description: "Five interlocked rings",
        triangles: 7_680,
        open_edges: 0,
        build: chain,
    },
];

/// One place of a sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    /// Where the section's origin comes to lie, m.
    pub(super) centre_m: DVec3,
    /// Where its first axis points, once made perpendicular to the curve.
    pub(super) across: DVec3,
    /// How much it is enlarged.
    pub(super) scale: f64,
}

/// A circle of radius 1 as a section.
pub(super) fn circle(sides: u32) -> Vec<(f64, f64)> {
    (0..sides)
        .map(|k| {
            let (sin, cos) = sin_cos(f64::from(k) / f64::from(sides));
            (cos, sin)
        })
        .collect()
}

/// A section along a curve from the first station to the last.
pub(super) fn swept(stations: &[Station], section: &[(f64, f64)], start: End, end: End) -> Outline {
    let last = stations.len() - 1;
    let rings: Vec<_> = (0..=last)
        .map(|i| ring(stations, i.saturating_sub(1), i, (i + 1).min(last), section))
        .collect();
    skin(&rings, start, end)
}

/// A section along a closed curve.
fn swept_loop(stations: &[Station], section: &[(f64, f64)]) -> Outline {
    let count = stations.len();
    let rings: Vec<_> = (0..count)
        .map(|i| {
            ring(
                stations,
                (i + count - 1) % count,
                i,
                (i + 1) % count,
                section,
            )
        })
        .collect();
    skin_loop(&rings)
}

/// The section at a station; the curve runs there as from the station before to the one after.
fn ring(
    stations: &[Station],
    before: usize,
    at: usize,
    after: usize,
    section: &[(f64, f64)],
) -> Vec<DVec3> {
    let Station {
        centre_m,
        across,
        scale,
    } = stations[at];
    let along = (stations[after].centre_m - stations[before].centre_m).normalize();
    let first = (across - across.dot(along) * along).normalize();
    let second = along.cross(first);
    section
        .iter()
        .map(|&(u, v)| centre_m + scale * (u * first + v * second))
        .collect()
}

/// A tube that winds `around` times around the axis and `through` times through the hole of a torus of radii 2 and 1.
fn torus_knot(around: u32, through: u32, tube_m: f64, steps: u32) -> Outline {
    let stations: Vec<_> = (0..steps)
        .map(|step| {
            let t = f64::from(step) / f64::from(steps);
            let (sin_a, cos_a) = sin_cos(f64::from(around) * t);
            let (sin_t, cos_t) = sin_cos(f64::from(through) * t);
            // The torus's own normal comes back to itself after a turn.
            let across = DVec3::new(cos_t * cos_a, sin_t, cos_t * sin_a);
            Station {
                centre_m: DVec3::new(2.0 * cos_a, 0.0, 2.0 * sin_a) + across,
                across,
                scale: tube_m,
            }
        })
        .collect();
    swept_loop(&stations, &circle(16))
}

fn spring() -> Outline {
    const TURNS: f64 = 7.0;
    const STEPS: u32 = 448;
    let stations: Vec<_> = (0..=STEPS)
        .map(|step| {
            let t = f64::from(step) / f64::from(STEPS);
            let (sin, cos) = sin_cos(TURNS * t);
            Station {
                centre_m: DVec3::new(0.3 * cos, t, 0.3 * sin),
                across: DVec3::new(cos, 0.0, sin),
                scale: 0.04,
            }
        })
        .collect();
    let (start, end) = flat_ends(&stations);
    swept(&stations, &circle(12), start, end)
}

/// Lids at both ends of a sweep.
pub(super) fn flat_ends(stations: &[Station]) -> (End, End) {
    let lid = |station: Option<&Station>| station.map_or(End::Open, |s| End::Point(s.centre_m));
    (lid(stations.first()), lid(stations.last()))
}

/// Rings of a spiral shell in one turn.
const SHELL_STEPS: u32 = 144;

/// A tube on a logarithmic spiral from a point to an open mouth at distance 1 from the axis. Each of the `steps` rings is
/// `growth` times as large as the one before; the tip lies up to `rise` above the mouth, which has the radius `tube`.
fn shell(growth: f64, steps: u32, rise: f64, tube: f64) -> Outline {
    let mut size = 1.0;
    let mut stations: Vec<_> = (0..steps)
        .map(|step| {
            let (sin, cos) = sin_cos(f64::from(step) / f64::from(SHELL_STEPS));
            let station = Station {
                centre_m: size * DVec3::new(cos, -rise, sin),
                across: DVec3::new(cos, 0.0, sin),
                scale: size * tube,
            };
            size /= growth;
            station
        })
        .collect();
    stations.reverse();
    let (tip, _) = flat_ends(&stations);
    swept(&stations, &circle(20), tip, End::Open)
}

fn nautilus() -> Outline {
    // Three times as large after each turn, so that a tube half as wide as the spiral touches itself.
    let lying = shell(1.007_66, 3 * SHELL_STEPS, 0.0, 0.51);
    lying.map(|p| DVec3::new(p.x, p.z, -p.y))
}

fn snail() -> Outline {
    shell(1.003_27, 5 * SHELL_STEPS, 2.0, 0.53)
}

fn arch() -> Outline {
    const STEPS: u32 = 32;
    let station = |x: f64, y: f64| Station {
        centre_m: DVec3::new(x, y, 0.0),
        across: DVec3::Z,
        scale: 0.1,
    };
    let bow = (0..=STEPS).map(|k| {
        let (sin, cos) = sin_cos(0.5 * f64::from(k) / f64::from(STEPS));
        station(0.4 * cos, 0.4 * sin)
    });
    let stations: Vec<_> = std::iter::once(station(0.4, -0.4))
        .chain(bow)
        .chain(std::iter::once(station(-0.4, -0.4)))
        .collect();
    let square = [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let (start, end) = flat_ends(&stations);
    swept(&stations, &square, start, end)
}

fn chain() -> Outline {
    let link = torus(1.0, 0.25, 64, 12);
    Outline::all((0..5).map(|k| {
        let along = 1.4 * f64::from(k);
        // Every other link stands upright; turned about the chain, not mirrored.
        let link = link.clone();
        let turned = if k % 2 == 0 {
            link
        } else {
            link.map(|p| DVec3::new(p.x, p.z, -p.y))
        };
        turned.map(|p| DVec3::new(1.25 * p.x + along, p.y, p.z))
    }))
}
