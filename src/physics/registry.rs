//! The twins: every function of `shaders/lib/`, with its f64 original, its domain, and how far f32 may be off.
//!
//! A test lists the functions of `shaders/lib/` and fails for one without a row; the GPU tests and the self-check run every
//! row over its domain.

use glam::DVec3;

use super::{
    attenuation, coverage, fresnel, octahedral, refraction, sky, slicing, solid_angle, turns,
};

/// Range of an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Values that are tried besides the grid.
    pub edges: &'static [f64],
}

const fn range(low: f64, high: f64, edges: &'static [f64]) -> Domain {
    Domain { low, high, edges }
}

/// How far the f32 value may be off: |error| ≤ absolute + relative · |true value|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Absolute part.
    pub absolute: f64,
    /// Relative part.
    pub relative: f64,
    /// Where the figures come from.
    pub reason: &'static str,
}

/// A function in both languages.
#[derive(Clone, Copy, Debug)]
pub struct Twin {
    /// Its name in Rust and WGSL.
    pub name: &'static str,
    /// File below `shaders/`.
    pub file: &'static str,
    /// Its arguments, at most eight.
    pub domain: &'static [Domain],
    /// WGSL expression of type vec4f over `a: array<f32, 8>`.
    pub call: &'static str,
    /// The same in f64; `None` outside the function's domain.
    pub original: fn(&[f64]) -> Option<[f64; 4]>,
    /// How far off f32 may be.
    pub tolerance: Tolerance,
}

const fn tolerance(absolute: f64, relative: f64, reason: &'static str) -> Tolerance {
    Tolerance {
        absolute,
        relative,
        reason,
    }
}

const COSINE: Domain = range(0.0, 1.0, &[0.0, 1e-7, 1e-3, 0.5, 0.999_999, 1.0]);
const INDEX: Domain = range(0.25, 4.0, &[0.75, 1.0, 1.0001, 1.333, 2.4]);
const PLACE: Domain = range(-8.0, 8.0, &[-8.0, -1.0, 0.0, 1e-6, 1.0, 8.0]);

const BOX_TOP: Domain = range(-8.0, -1.0, &[-8.0, -1.0]);
const BOX_BOTTOM: Domain = range(1.0, 8.0, &[1.0, 8.0]);
const PLANE_COUNT: Domain = range(2.0, 1024.0, &[2.0, 3.0, 50.0, 101.0, 1024.0]);

/// All twins.
pub const TWINS: [Twin; 13] = [
    Twin {
        name: "plane_depth",
        file: "lib/slicing.wgsl",
        domain: &[
            BOX_TOP,
            BOX_BOTTOM,
            PLANE_COUNT,
            range(0.0, 1.0, &[0.0, 0.5, 1.0]),
        ],
        call: "vec4f(plane_depth(a[0], a[1], a[2], a[3] * (a[2] - 1.0)), 0.0, 0.0, 0.0)",
        original: |a| {
            let depth = slicing::plane_depth(a[0], a[1], a[2], a[3] * (a[2] - 1.0));
            Some([depth, 0.0, 0.0, 0.0])
        },
        tolerance: tolerance(4e-6, 0.0, "four roundings of numbers up to 16"),
    },
    Twin {
        name: "plane_of_depth",
        file: "lib/slicing.wgsl",
        domain: &[BOX_TOP, BOX_BOTTOM, PLANE_COUNT, PLACE],
        call: "vec4f(plane_of_depth(a[0], a[1], a[2], a[3]), 0.0, 0.0, 0.0)",
        original: |a| {
            // At the border of two intervals either is right.
            let halves = (a[3] - a[0]) * (2.0 * (a[2] - 1.0) / (a[1] - a[0]));
            let clear = (halves - halves.round()).abs() > 0.01;
            clear.then(|| {
                [
                    slicing::plane_of_depth(a[0], a[1], a[2], a[3]),
                    0.0,
                    0.0,
                    0.0,
                ]
            })
        },
        tolerance: tolerance(1e-3, 0.0, "a whole number, clear of the intervals' borders"),
    },
    Twin {
        name: "sin_cos_turns",
        file: "lib/turns.wgsl",
        domain: &[range(
            -16.0,
            16.0,
            &[0.0, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0, -0.25, -0.5, 15.75],
        )],
        call: "vec4f(sin_cos_turns(a[0]), 0.0, 0.0)",
        original: |a| {
            let (sin, cos) = turns::sin_cos_turns(a[0]);
            Some([sin, cos, 0.0, 0.0])
        },
        tolerance: tolerance(
            4e-7,
            0.0,
            "polynomials of 1 ulp plus the rounding of 2π times the reduced turn",
        ),
    },
    Twin {
        name: "fresnel_reflectance",
        file: "lib/fresnel.wgsl",
        domain: &[COSINE, INDEX],
        call: "vec4f(fresnel_reflectance(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| {
            outside_critical(a).then(|| [fresnel::fresnel_reflectance(a[0], a[1]), 0.0, 0.0, 0.0])
        },
        tolerance: tolerance(
            1e-4,
            0.0,
            "near the critical angle cos θ_t is a root of a rounded difference, 3ε/(2 cos θ_t) off at cos θ_t = 0.01, and the p wave takes that times 2/n, up to 8; seen: 8·10⁻⁵ in 20 000 samples",
        ),
    },
    Twin {
        name: "fresnel_transmittance",
        file: "lib/fresnel.wgsl",
        domain: &[COSINE, INDEX],
        call: "vec4f(fresnel_transmittance(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| {
            outside_critical(a).then(|| [fresnel::fresnel_transmittance(a[0], a[1]), 0.0, 0.0, 0.0])
        },
        tolerance: tolerance(
            1e-4,
            2e-6,
            "as the reflectance; towards grazing the error is relative",
        ),
    },
    Twin {
        name: "refract_direction",
        file: "lib/refraction.wgsl",
        domain: &[
            COSINE,
            range(0.0, 1.0, &[0.0, 0.25, 0.5]),
            PLACE,
            PLACE,
            INDEX,
        ],
        call: "refract_direction(incident(a[0], a[1], normal_from_slope(a[2], a[3])), normal_from_slope(a[2], a[3]), a[4])",
        original: |a| {
            if !outside_critical(&[a[0], a[4]]) {
                return None;
            }
            let normal = refraction::normal_from_slope(a[2], a[3]);
            match refraction::refract_direction(incident(a[0], a[1], normal), normal, a[4]) {
                Some(t) => Some([t.x, t.y, t.z, 1.0]),
                None => Some([0.0; 4]),
            }
        },
        tolerance: tolerance(
            3e-5,
            0.0,
            "near the critical angle as the reflectance; elsewhere rounding of unit vectors",
        ),
    },
    Twin {
        name: "reflect_direction",
        file: "lib/refraction.wgsl",
        domain: &[COSINE, range(0.0, 1.0, &[0.0, 0.25, 0.5]), PLACE, PLACE],
        call: "vec4f(reflect_direction(incident(a[0], a[1], normal_from_slope(a[2], a[3])), normal_from_slope(a[2], a[3])), 0.0)",
        original: |a| {
            let normal = refraction::normal_from_slope(a[2], a[3]);
            let r = refraction::reflect_direction(incident(a[0], a[1], normal), normal);
            Some([r.x, r.y, r.z, 0.0])
        },
        tolerance: tolerance(2e-6, 0.0, "rounding of unit vectors"),
    },
    Twin {
        name: "normal_from_slope",
        file: "lib/refraction.wgsl",
        domain: &[
            range(-20.0, 20.0, &[0.0, 1e-8, 20.0]),
            range(-20.0, 20.0, &[0.0, 1e-8, 20.0]),
        ],
        call: "vec4f(normal_from_slope(a[0], a[1]), 0.0)",
        original: |a| {
            let n = refraction::normal_from_slope(a[0], a[1]);
            Some([n.x, n.y, n.z, 0.0])
        },
        tolerance: tolerance(4e-7, 0.0, "rounding of a unit vector"),
    },
    Twin {
        name: "transmission",
        file: "lib/attenuation.wgsl",
        domain: &[
            range(0.0, 8.0, &[0.0, 1e-9, 1e-3]),
            range(0.0, 8.0, &[0.0, 1e-6]),
        ],
        call: "vec4f(transmission(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| Some([attenuation::transmission(a[0], a[1]), 0.0, 0.0, 0.0]),
        tolerance: tolerance(
            1e-6,
            1e-5,
            "WGSL lets exp be 3 + 2|x| ulp off; driver polynomials were seen at 4·10⁻⁶",
        ),
    },
    Twin {
        name: "extinction",
        file: "lib/attenuation.wgsl",
        domain: &[
            range(0.0, 8.0, &[0.0, 1e-9, 1e-3]),
            range(0.0, 8.0, &[0.0, 1e-6]),
        ],
        call: "vec4f(extinction(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| Some([attenuation::extinction(a[0], a[1]), 0.0, 0.0, 0.0]),
        tolerance: tolerance(
            1e-30,
            2e-5,
            "a series below 0.06; there exp's error of 10⁻⁶ is 2·10⁻⁵ of what is left",
        ),
    },
    Twin {
        name: "mean_positive",
        file: "lib/coverage.wgsl",
        domain: &[PLACE, PLACE],
        call: "vec4f(mean_positive(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| Some([coverage::mean_positive(a[0], a[1]), 0.0, 0.0, 0.0]),
        tolerance: tolerance(1e-6, 1e-6, "five roundings of values up to 8"),
    },
    Twin {
        name: "mean_clamped",
        file: "lib/coverage.wgsl",
        domain: &[PLACE, PLACE, range(0.0, 2.0, &[0.0, 1.0])],
        call: "vec4f(mean_clamped(a[0], a[1], a[2]), 0.0, 0.0, 0.0)",
        original: |a| Some([coverage::mean_clamped(a[0], a[1], a[2]), 0.0, 0.0, 0.0]),
        tolerance: tolerance(
            1e-6,
            1e-6,
            "six roundings of values up to 2 with quotients below 1",
        ),
    },
    Twin {
        name: "tent_share_below",
        file: "lib/coverage.wgsl",
        domain: &[
            range(-0.5, 1.5, &[0.0, 1e-6, 1.0]),
            range(0.0, 1.0, &[0.0, 0.5, 1.0]),
        ],
        call: "vec4f(tent_share_below(a[0], 0.0, a[1], 1.0), 0.0, 0.0, 0.0)",
        original: |a| {
            Some([
                coverage::tent_share_below(a[0], 0.0, a[1], 1.0),
                0.0,
                0.0,
                0.0,
            ])
        },
        tolerance: tolerance(1e-6, 0.0, "five roundings of values up to 1"),
    },
];

/// The twins of the sky's light, whose arguments are of very different size.
pub const SKY_TWINS: [Twin; 2] = [
    Twin {
        name: "cone_share",
        file: "lib/sky.wgsl",
        domain: &[
            range(-1.0, 1.0, &[-1.0, 0.0, 1.0]),
            range(0.06, 1.0, &[0.5625, 1.0]),
        ],
        call: "vec4f(cone_share(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| Some([sky::cone_share(a[0], a[1]), 0.0, 0.0, 0.0]),
        tolerance: tolerance(
            2e-3,
            0.0,
            "WGSL lets acos be 6.8·10⁻⁵ off; the two terms cancel and are divided by sin²σ ≥ 0.06",
        ),
    },
    Twin {
        name: "sky_irradiance",
        file: "lib/sky.wgsl",
        domain: &[
            range(0.0, 100.0, &[0.0]),
            range(0.0, 1.0, &[1.0]),
            range(0.0, 2.0, &[0.0]),
            range(-1.0, 6.0, &[0.0]),
            range(1.0, 1.5, &[1.0]),
            range(-1.0, 1.0, &[-1.0, 0.0, 1.0]),
            range(0.25, 1.0, &[0.5625, 1.0]),
        ],
        call: "vec4f(sky_irradiance(a[0], a[1], a[2], a[3], a[4], a[5], a[6]), 0.0, 0.0, 0.0)",
        original: |a| {
            Some([
                sky::sky_irradiance(a[0], a[1], a[2], a[3], a[4], a[5], a[6]),
                0.0,
                0.0,
                0.0,
            ])
        },
        tolerance: tolerance(
            0.2,
            2e-5,
            "cone_share's 5·10⁻⁴ at sin²σ ≥ 0.25 times values up to 314",
        ),
    },
];

const SIDEWAYS: Domain = range(-4.0, 4.0, &[0.0, 1e-6, 0.25]);
const SMALL_SIDE: Domain = range(-0.5, 0.5, &[0.0, 1e-4, 0.5]);
const SMALL_RISE: Domain = range(-0.25, 0.25, &[0.0, 1e-5]);

/// The twins of point lights.
pub const LAMP_TWINS: [Twin; 3] = [
    Twin {
        name: "point_angle",
        file: "lib/solid_angle.wgsl",
        domain: &[
            range(-8.0, 8.0, &[0.0, 1e-30, 1e-6, -1e-6, 1.0]),
            range(-8.0, 8.0, &[0.0, 1e-30, 1e-6, -1e-6, 1.0]),
        ],
        call: "vec4f(point_angle(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| Some([solid_angle::point_angle(a[0], a[1]), 0.0, 0.0, 0.0]),
        tolerance: tolerance(
            1e-37,
            6e-7,
            "a division of 2.5 ulp, a polynomial of 1 ulp and the rounding of π",
        ),
    },
    Twin {
        name: "solid_angle",
        file: "lib/solid_angle.wgsl",
        domain: &[
            SIDEWAYS,
            range(-8.0, -0.5, &[-0.5, -1.0]),
            SIDEWAYS,
            SMALL_SIDE,
            SMALL_RISE,
            SMALL_SIDE,
            SMALL_RISE,
            SMALL_SIDE,
        ],
        call: "vec4f(solid_angle(vec3f(a[0], a[1], a[2]), vec3f(a[3], a[4], 0.1), vec3f(a[5], a[6], a[7])), 0.0, 0.0, 0.0)",
        original: |a| {
            let omega = solid_angle::solid_angle(
                DVec3::new(a[0], a[1], a[2]),
                DVec3::new(a[3], a[4], f64::from(0.1_f32)),
                DVec3::new(a[5], a[6], a[7]),
            );
            Some([omega, 0.0, 0.0, 0.0])
        },
        tolerance: tolerance(
            1e-6,
            2e-6,
            "rounding of the triple product of sides up to 0.5 m at a distance of 0.5 m, over the distance squared",
        ),
    },
    Twin {
        name: "octahedral_direction",
        file: "lib/octahedral.wgsl",
        domain: &[
            range(-1.0, 1.0, &[-1.0, 0.0, 1e-6, 0.5, 1.0]),
            range(-1.0, 1.0, &[-1.0, 0.0, 1e-6, 0.5, 1.0]),
        ],
        call: "vec4f(octahedral_direction(a[0], a[1]), 0.0)",
        original: |a| {
            let d = octahedral::octahedral_direction(a[0], a[1]);
            Some([d.x, d.y, d.z, 0.0])
        },
        tolerance: tolerance(5e-7, 0.0, "rounding of a unit vector"),
    },
];

/// All twins, those of skies and point lights included.
pub fn all() -> impl Iterator<Item = &'static Twin> {
    TWINS.iter().chain(&SKY_TWINS).chain(&LAMP_TWINS)
}

/// WGSL of the helper that calls use to make an incident direction; it is part of the test, not of the library.
pub const CALL_PRELUDE: &str = "
fn incident(cos_i: f32, turns: f32, normal: vec3f) -> vec3f {
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.5);
    let u = normalize(cross(normal, helper));
    let v = cross(normal, u);
    let sc = sin_cos_turns(turns);
    let sin_i = sqrt(max(1.0 - cos_i * cos_i, 0.0));
    return normalize((u * sc.y + v * sc.x) * sin_i - normal * cos_i);
}
";

/// The same in f64.
fn incident(cos_i: f64, turns: f64, normal: DVec3) -> DVec3 {
    let helper = if normal.x.abs() > 0.5 {
        DVec3::Y
    } else {
        DVec3::X
    };
    let u = normal.cross(helper).normalize();
    let v = normal.cross(u);
    let (sin, cos) = turns::sin_cos_turns(turns);
    let sin_i = (1.0 - cos_i * cos_i).max(0.0).sqrt();
    ((u * cos + v * sin) * sin_i - normal * cos_i).normalize()
}

/// Whether (cos_i, eta) keeps clear of the critical angle by more than f32 can tell.
fn outside_critical(a: &[f64]) -> bool {
    let sin2_t = (1.0 - a[0] * a[0]) / (a[1] * a[1]);
    (sin2_t - 1.0).abs() > 1e-4
}

/// Argument lists that cover a twin's domain: all combinations of edges with a low-discrepancy filling, `count` at least.
pub fn samples(twin: &Twin, count: usize) -> Vec<[f64; 8]> {
    let mut all = Vec::new();
    // The golden ratio's generalisation (Roberts 2018): one irrational step per argument.
    let mut g: f64 = 1.5;
    for _ in 0..32 {
        g = (1.0 + g).powf(1.0 / (twin.domain.len() as f64 + 1.0));
    }
    for index in 0..count {
        let mut args = [0.0; 8];
        for (k, domain) in twin.domain.iter().enumerate() {
            let share = (0.5 + index as f64 * g.powi(-(k as i32) - 1)).fract();
            args[k] = domain.low + share * (domain.high - domain.low);
        }
        all.push(args);
        // Every other sample sits on an edge in one argument.
        let k = index % twin.domain.len();
        let edges = twin.domain[k].edges;
        if !edges.is_empty() {
            args[k] = edges[(index / twin.domain.len()) % edges.len()];
            all.push(args);
        }
    }
    // What f32 cannot hold is not asked of it.
    for args in &mut all {
        for a in args {
            *a = f64::from(*a as f32);
        }
    }
    all
}
