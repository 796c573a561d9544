//! Fish and their like: a body of elliptical sections along x, nose first, with fins that start inside it. The dolphin has as
//! many triangles as that of Tipprasert (2006), Table 5-2.

use glam::DVec3;

use super::skin::{End, skin};
use super::sweep::{Station, circle, swept};
use super::{Outline, Shape};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "dolphin",
        description: "Slender body with flukes, a back fin and two flippers",
        triangles: 4_442,
        open_edges: 0,
        build: dolphin,
    },
    Shape {
        name: "angelfish",
        description: "High, narrow body with long upright fins",
        triangles: 4_800,
        open_edges: 0,
        build: angelfish,
    },
    Shape {
        name: "manta",
        description: "Flat body with wide wings and a whip of a tail",
        triangles: 4_976,
        open_edges: 0,
        build: manta,
    },
];

/// A place along a body: x, height of the middle, half height, half width, m.
type Section = [f64; 4];

/// A body through sections, from nose to tail; ends in points there.
fn body(sections: &[Section], rings: u32, sides: u32) -> Outline {
    let ellipse = |[x, y, half_height, half_width]: Section| {
        circle(sides)
            .into_iter()
            // From nose to tail is +x: by the right hand, y turns to z.
            .map(|(c, s)| DVec3::new(x, y + half_height * c, half_width * s))
            .collect::<Vec<_>>()
    };
    let tip = |[x, y, ..]: Section| End::Point(DVec3::new(x, y, 0.0));
    let rings: Vec<_> = (1..=rings)
        .map(|k| ellipse(between(sections, f64::from(k) / f64::from(rings + 1))))
        .collect();
    skin(
        &rings,
        tip(between(sections, 0.0)),
        tip(between(sections, 1.0)),
    )
}

/// Sections at 0 … 1 of their row, by Catmull and Rom's spline (1974).
fn between(sections: &[Section], t: f64) -> Section {
    let last = sections.len() - 1;
    let place = t * last as f64;
    let from = (place.floor() as usize).min(last - 1);
    let t = place - from as f64;
    let at = |i: usize, a: usize| sections[i.min(last)][a];
    [0, 1, 2, 3].map(|a| {
        let (before, p, q, after) = (
            at(from.saturating_sub(1), a),
            at(from, a),
            at(from + 1, a),
            at(from + 2, a),
        );
        p + 0.5
            * t
            * ((q - before)
                + t * ((2.0 * before - 5.0 * p + 4.0 * q - after)
                    + t * (3.0 * (p - q) + after - before)))
    })
}

/// A fin: flat elliptical sections from `root` to `tip`, whose middles bow out from the chord.
#[derive(Clone, Copy, Debug)]
struct Fin {
    root_m: DVec3,
    tip_m: DVec3,
    /// How far at the middle, m.
    bow_m: f64,
    /// From the leading edge to the trailing one, at the root.
    chord_m: DVec3,
    rings: u32,
    sides: u32,
}

/// Thickness of a fin over its width.
const FIN_THICKNESS: f64 = 0.12;

impl Fin {
    fn outline(&self) -> Outline {
        let span_m = self.tip_m - self.root_m;
        let width_m = self.chord_m.length();
        let stations: Vec<_> = (0..self.rings)
            .map(|ring| {
                let t = f64::from(ring) / f64::from(self.rings);
                let ahead = self.bow_m * 4.0 * t * (1.0 - t) / width_m;
                Station {
                    centre_m: self.root_m + t * span_m - ahead * self.chord_m,
                    across: self.chord_m,
                    // An ellipse's outline: blunt, then fast to the tip.
                    scale: 0.5 * width_m * (1.0 - t * t).sqrt(),
                }
            })
            .collect();
        let section: Vec<_> = circle(self.sides)
            .into_iter()
            .map(|(c, s)| (c, FIN_THICKNESS * s))
            .collect();
        swept(
            &stations,
            &section,
            End::Point(self.root_m),
            End::Point(self.tip_m),
        )
    }

    /// This fin and the one on the other side.
    fn pair(&self) -> [Outline; 2] {
        [self.outline(), self.outline().mirrored(2)]
    }
}

fn dolphin() -> Outline {
    let body = body(
        &[
            [-1.00, -0.02, 0.000, 0.000],
            [-0.96, -0.02, 0.030, 0.035],
            [-0.84, -0.015, 0.045, 0.045],
            [-0.76, 0.01, 0.105, 0.095],
            [-0.60, 0.02, 0.165, 0.145],
            [-0.35, 0.015, 0.205, 0.185],
            [-0.05, 0.01, 0.210, 0.190],
            [0.25, 0.015, 0.175, 0.150],
            [0.50, 0.03, 0.115, 0.090],
            [0.75, 0.04, 0.060, 0.040],
            [0.92, 0.04, 0.030, 0.022],
            [1.00, 0.04, 0.000, 0.000],
        ],
        69,
        28,
    );
    let fluke = Fin {
        root_m: DVec3::new(0.88, 0.04, 0.005),
        tip_m: DVec3::new(1.08, 0.04, 0.27),
        bow_m: 0.03,
        chord_m: 0.20 * DVec3::X,
        rings: 6,
        sides: 12,
    };
    let flipper = Fin {
        root_m: DVec3::new(-0.42, -0.10, 0.10),
        tip_m: DVec3::new(-0.17, -0.26, 0.38),
        bow_m: 0.04,
        chord_m: 0.16 * DVec3::X,
        rings: 5,
        sides: 10,
    };
    let back = Fin {
        root_m: DVec3::new(0.05, 0.17, 0.0),
        tip_m: DVec3::new(0.24, 0.40, 0.0),
        bow_m: 0.04,
        chord_m: 0.26 * DVec3::X,
        rings: 5,
        sides: 9,
    };
    let fins = [fluke, flipper].into_iter().flat_map(|fin| fin.pair());
    Outline::all([body, back.outline()].into_iter().chain(fins))
}

fn angelfish() -> Outline {
    let body = body(
        &[
            [-0.50, 0.00, 0.000, 0.000],
            [-0.44, 0.00, 0.060, 0.025],
            [-0.30, 0.01, 0.190, 0.060],
            [-0.05, 0.02, 0.330, 0.075],
            [0.20, 0.01, 0.240, 0.055],
            [0.36, 0.00, 0.090, 0.025],
            [0.44, 0.00, 0.060, 0.015],
            [0.50, 0.00, 0.000, 0.000],
        ],
        48,
        32,
    );
    let fin = |root: [f64; 2], tip: [f64; 2], chord_m: f64| Fin {
        root_m: DVec3::new(root[0], root[1], 0.0),
        tip_m: DVec3::new(tip[0], tip[1], 0.0),
        bow_m: 0.05,
        chord_m: chord_m * DVec3::X,
        rings: 12,
        sides: 12,
    };
    let belly = Fin {
        root_m: DVec3::new(-0.15, -0.22, 0.01),
        tip_m: DVec3::new(0.10, -0.70, 0.10),
        chord_m: 0.06 * DVec3::X,
        ..fin([0.0; 2], [0.0; 2], 0.0)
    };
    let upright = [
        fin([0.08, 0.22], [0.48, 0.75], 0.34),
        fin([0.08, -0.20], [0.48, -0.68], 0.34),
        fin([0.42, 0.02], [0.78, 0.22], 0.16),
        fin([0.42, -0.02], [0.78, -0.22], 0.16),
    ];
    Outline::all(
        std::iter::once(body)
            .chain(upright.map(|fin| fin.outline()))
            .chain(belly.pair()),
    )
}

fn manta() -> Outline {
    let body = body(
        &[
            [-0.45, 0.00, 0.000, 0.000],
            [-0.42, 0.00, 0.030, 0.120],
            [-0.25, 0.01, 0.085, 0.200],
            [0.00, 0.02, 0.105, 0.210],
            [0.25, 0.01, 0.070, 0.140],
            [0.45, 0.00, 0.025, 0.040],
            [0.70, 0.00, 0.012, 0.012],
            [1.00, 0.02, 0.008, 0.008],
            [1.30, 0.05, 0.000, 0.000],
        ],
        56,
        28,
    );
    let wing = Fin {
        root_m: DVec3::new(0.0, 0.01, 0.02),
        tip_m: DVec3::new(0.22, 0.14, 1.0),
        bow_m: 0.10,
        chord_m: 0.72 * DVec3::X,
        rings: 20,
        sides: 20,
    };
    let horn = Fin {
        root_m: DVec3::new(-0.36, 0.0, 0.12),
        tip_m: DVec3::new(-0.62, -0.02, 0.10),
        bow_m: 0.0,
        chord_m: 0.06 * DVec3::Y,
        rings: 6,
        sides: 10,
    };
    Outline::all(std::iter::once(body).chain(wing.pair()).chain(horn.pair()))
}
