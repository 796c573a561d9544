//! The twins.

use glam::DVec3;

use super::super::{
    attenuation, coverage, fresnel, interpolated_flux, octahedral, refraction, sky, slicing,
    solid_angle, turns,
};
use super::bounds::{self, SMALLEST_NORMAL, U};
use super::{Domain, Spacing, Tolerance, Twin};

const fn even(low: f64, high: f64, edges: &'static [f64]) -> Domain {
    Domain {
        low,
        high,
        spacing: Spacing::Even,
        edges,
    }
}

const fn decades(low: f64, between: [f64; 2], high: f64, edges: &'static [f64]) -> Domain {
    Domain {
        low,
        high,
        spacing: Spacing::Decades(between[0], between[1]),
        edges,
    }
}

const fn tolerance(
    absolute: f64,
    relative: f64,
    conditioning: fn(&[f64]) -> f64,
    reason: &'static str,
) -> Tolerance {
    Tolerance {
        absolute,
        relative,
        conditioning,
        reason,
    }
}

/// The neighbours of 1 in f32.
const BELOW_ONE: f64 = 1.0 - U;
const ABOVE_ONE: f64 = 1.0 + 2.0 * U;
/// The smallest f32 above 0, and one between it and the smallest normal number.
const SMALLEST: f64 = 1.401_298_464_324_817e-45;
const SUBNORMAL: f64 = 1e-40;

const COSINE: Domain = even(
    0.0,
    1.0,
    &[
        0.0,
        -0.0,
        SMALLEST,
        SUBNORMAL,
        SMALLEST_NORMAL,
        1e-20,
        1e-10,
        1e-7,
        1.7e-4,
        1e-3,
        0.5,
        0.661_3,
        0.999_999,
        BELOW_ONE,
        1.0,
    ],
);
const INDEX: Domain = even(
    0.25,
    4.0,
    &[
        0.25,
        0.75,
        0.750_187_5,
        0.9999,
        BELOW_ONE,
        1.0,
        ABOVE_ONE,
        1.0001,
        1.333,
        2.4,
        4.0,
    ],
);
const TURN: Domain = even(0.0, 1.0, &[0.0, 0.125, 0.25, 0.5, 1.0]);
const SLOPE: Domain = decades(
    -1e18,
    [1e-4, 1e4],
    1e18,
    &[
        0.0,
        -0.0,
        SUBNORMAL,
        -SMALLEST_NORMAL,
        1e-8,
        1.0,
        -1.0,
        20.0,
        1e6,
        -1e18,
        1e18,
    ],
);
const DEPTH: Domain = decades(
    -1e6,
    [1e-3, 1e6],
    1e6,
    &[
        0.0,
        -0.0,
        SUBNORMAL,
        -SMALLEST_NORMAL,
        1.0,
        ABOVE_ONE,
        -1.0,
        1e6,
        -1e6,
    ],
);
const PLANE_COUNT: Domain = even(2.0, 1024.0, &[2.0, 3.0, 50.0, 101.0, 1024.0]);
const PLACE: Domain = decades(
    -1e30,
    [1e-5, 1e5],
    1e30,
    &[
        0.0,
        -0.0,
        SMALLEST,
        -SUBNORMAL,
        SMALLEST_NORMAL,
        1.3e-38,
        -SMALLEST_NORMAL,
        1e-6,
        BELOW_ONE,
        1.0,
        ABOVE_ONE,
        -1.0,
        8192.0,
        -1e30,
        1e30,
    ],
);
const WIDTH: Domain = decades(
    0.0,
    [1e-5, 1e5],
    1e30,
    &[
        0.0,
        SMALLEST,
        SUBNORMAL,
        SMALLEST_NORMAL,
        1e-6,
        BELOW_ONE,
        1.0,
        ABOVE_ONE,
        1e30,
    ],
);
const ATTENUATION: Domain = decades(
    0.0,
    [1e-4, 1e3],
    1e6,
    &[
        0.0,
        SMALLEST,
        SUBNORMAL,
        SMALLEST_NORMAL,
        1e-20,
        1e-9,
        1e-3,
        0.06,
        1.0,
        9.0,
        87.0,
        1e6,
    ],
);
const COORDINATE: Domain = decades(
    -1e37,
    [1e-4, 1e4],
    1e37,
    &[
        0.0,
        -0.0,
        SMALLEST,
        -SMALLEST,
        SUBNORMAL,
        -SUBNORMAL,
        SMALLEST_NORMAL,
        -SMALLEST_NORMAL,
        1.3e-38,
        1e-30,
        -1e-6,
        1.0,
        ABOVE_ONE,
        -1.0,
        1e37,
        -1e37,
    ],
);
const UPWARD: Domain = even(
    -1.0,
    1.0,
    &[
        -1.0, -BELOW_ONE, -0.75, -0.0, 0.0, SMALLEST, -SUBNORMAL, 1e-6, 0.25, 0.75, BELOW_ONE, 1.0,
    ],
);
const CONE: Domain = even(
    0.0625,
    1.0,
    &[0.0625, 0.25, 0.5625, 0.562_781, BELOW_ONE, 1.0],
);
const SIDE: Domain = decades(
    -1e6,
    [1e-2, 1e2],
    1e6,
    &[0.0, -0.0, 1e-6, -1e-6, 0.1, 1.0, -1.0, 1e6, -1e6],
);
const SQUARE: Domain = even(
    -1.0,
    1.0,
    &[
        -1.0,
        -BELOW_ONE,
        -0.5,
        -SUBNORMAL,
        -0.0,
        0.0,
        SMALLEST,
        SMALLEST_NORMAL,
        1e-6,
        0.5,
        BELOW_ONE,
        1.0,
    ],
);

/// A scalar in the first component.
const fn scalar(value: f64) -> Option<[f64; 4]> {
    Some([value, 0.0, 0.0, 0.0])
}

fn vector(v: DVec3, last: f64) -> Option<[f64; 4]> {
    Some([v.x, v.y, v.z, last])
}

/// Area of a cut of a caustic volume, as a share of the largest.
const AREA: Domain = even(-1.0, 1.0, &[-1.0, -0.25, 0.0, -0.0, SMALLEST, 0.25, 1.0]);
const DENSITY: Domain = decades(0.0, [1e-6, 1.0], 1.0, &[0.0, SMALLEST, 1e-6, 1.0]);

/// All twins.
pub const TWINS: [Twin; 23] = [
    Twin {
        name: "cubic_before",
        file: "lib/interpolated_flux.wgsl",
        domain: &[AREA, AREA, AREA, AREA, even(0.0, 1.0, &[0.0, 0.5, 1.0])],
        call: "vec4f(cubic_before(vec4f(a[0], a[1], a[2], a[3]), a[4]), 0.0, 0.0, 0.0)",
        original: |a| {
            scalar(interpolated_flux::cubic_before(
                [a[0], a[1], a[2], a[3]],
                a[4],
            ))
        },
        tolerance: tolerance(
            16.0 * U,
            0.0,
            bounds::none,
            "derived: three levels of four roundings and a sum of four, of coefficients up to 1",
        ),
    },
    Twin {
        name: "quotient_below_2",
        file: "lib/interpolated_flux.wgsl",
        domain: &[AREA, AREA],
        call: "vec4f(quotient_below_2(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| {
            // At 2 rounding decides; both numbers flushed to 0 have the quotient 2.
            if (a[0].abs() - 2.0 * a[1].abs()).abs() <= 4.0 * U * a[0].abs() {
                return (a[0] == 0.0).then_some([2.0, 0.0, 0.0, 0.0]);
            }
            scalar(interpolated_flux::quotient_below_2(a[0], a[1]))
        },
        tolerance: tolerance(
            SMALLEST_NORMAL,
            6.0 * U,
            bounds::none,
            "derived: a quotient",
        ),
    },
    Twin {
        name: "interpolated_flux",
        file: "lib/interpolated_flux.wgsl",
        domain: &[AREA, AREA, AREA, DENSITY, DENSITY],
        call: "vec4f(interpolated_flux(a[0], a[1], a[2], a[3], a[4]), 0.0, 0.0, 0.0)",
        original: |a| {
            scalar(interpolated_flux::interpolated_flux(
                a[0], a[1], a[2], a[3], a[4],
            ))
        },
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            |a| 96.0 * U * (a[3] + a[4]),
            "derived: five integrals of coefficients up to the sum of the densities; zeros are off by less than what that changes",
        ),
    },
    Twin {
        name: "plane_depth",
        file: "lib/slicing.wgsl",
        domain: &[
            DEPTH,
            DEPTH,
            PLANE_COUNT,
            even(0.0, 1.0, &[0.0, 0.5, BELOW_ONE, 1.0]),
        ],
        call: "vec4f(plane_depth(a[0], a[1], a[2], a[3] * (a[2] - 1.0)), 0.0, 0.0, 0.0)",
        original: |a| scalar(slicing::plane_depth(a[0], a[1], a[2], a[3] * (a[2] - 1.0))),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::depths,
            "derived: nine roundings of the planes' range",
        ),
    },
    Twin {
        name: "plane_of_depth",
        file: "lib/slicing.wgsl",
        domain: &[DEPTH, DEPTH, PLANE_COUNT, DEPTH],
        call: "vec4f(plane_of_depth(a[0], a[1], a[2], a[3]), 0.0, 0.0, 0.0)",
        original: |a| {
            // At the border of two intervals either plane is right: eight roundings of the position in half intervals.
            let halves = (a[3] - a[0]) / (a[1] - a[0]) * (2.0 * (a[2] - 1.0));
            let is_clear = (halves - halves.round()).abs() > 8.0 * U * halves.abs();
            let is_exact = halves == 0.0 || a[1] <= a[0];
            if is_clear || is_exact || halves.is_nan() {
                scalar(slicing::plane_of_depth(a[0], a[1], a[2], a[3]))
            } else {
                None
            }
        },
        tolerance: tolerance(
            1e-3,
            0.0,
            bounds::none,
            "derived: a whole number, clear of the intervals' borders",
        ),
    },
    Twin {
        name: "sin_cos_turns",
        file: "lib/turns.wgsl",
        domain: &[decades(
            -16_777_216.0,
            [1e-3, 1e5],
            16_777_216.0,
            &[
                0.0,
                -0.0,
                SMALLEST,
                -SUBNORMAL,
                SMALLEST_NORMAL,
                0.125,
                0.25,
                0.375,
                0.5,
                0.75,
                BELOW_ONE,
                1.0,
                ABOVE_ONE,
                -0.125,
                -0.25,
                -0.5,
                15.75,
                8_388_607.5,
                -8_388_607.5,
                16_777_215.0,
                -16_777_216.0,
                16_777_216.0,
            ],
        )],
        call: "vec4f(sin_cos_turns(a[0]), 0.0, 0.0)",
        original: |a| {
            let (sin, cos) = turns::sin_cos_turns(a[0]);
            Some([sin, cos, 0.0, 0.0])
        },
        tolerance: tolerance(
            4.0 * U,
            0.0,
            bounds::none,
            "derived: 2π and its product with the reduced turn, up to π/4, are rounded, and polynomials of 1 ulp",
        ),
    },
    Twin {
        name: "refracted_square",
        file: "lib/refraction.wgsl",
        domain: &[COSINE, INDEX],
        call: "vec4f(refracted_square(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(refraction::refracted_square(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::square,
            "derived: four roundings of a product, one of a square",
        ),
    },
    Twin {
        name: "fresnel_reflectance",
        file: "lib/fresnel.wgsl",
        domain: &[COSINE, INDEX],
        call: "vec4f(fresnel_reflectance(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(fresnel::fresnel_reflectance(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::reflectance,
            "derived: η cos θ_t is a root of a rounded difference, steepest at the critical angle; the quotients take 16 roundings more",
        ),
    },
    Twin {
        name: "fresnel_transmittance",
        file: "lib/fresnel.wgsl",
        domain: &[COSINE, INDEX],
        call: "vec4f(fresnel_transmittance(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(fresnel::fresnel_transmittance(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::transmittance,
            "derived: as the reflectance; towards grazing the error is relative",
        ),
    },
    Twin {
        name: "refract_direction",
        file: "lib/refraction.wgsl",
        domain: &[COSINE, TURN, SLOPE, SLOPE, INDEX],
        call: "refract_direction(incident(a[0], a[1], normal_from_slope(a[2], a[3])), normal_from_slope(a[2], a[3]), a[4])",
        original: |a| {
            // At the critical angle either is right.
            let off = bounds::square_of_vectors(a[0], a[4]);
            if refraction::refracted_square(a[0], a[4]).abs() <= off {
                return None;
            }
            let normal = refraction::normal_from_slope(a[2], a[3]);
            match refraction::refract_direction(incident(a[0], a[1], normal), normal, a[4]) {
                Some(t) => vector(t, 1.0),
                None => Some([0.0; 4]),
            }
        },
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::refracted,
            "derived: rounding of unit vectors, carried through the root that the reflectance has as well",
        ),
    },
    Twin {
        name: "reflect_direction",
        file: "lib/refraction.wgsl",
        domain: &[COSINE, TURN, SLOPE, SLOPE],
        call: "vec4f(reflect_direction(incident(a[0], a[1], normal_from_slope(a[2], a[3])), normal_from_slope(a[2], a[3])), 0.0)",
        original: |a| {
            let normal = refraction::normal_from_slope(a[2], a[3]);
            vector(
                refraction::reflect_direction(incident(a[0], a[1], normal), normal),
                0.0,
            )
        },
        tolerance: tolerance(
            1.2e-6,
            0.0,
            bounds::none,
            "measured: 6.1e-7 in 60 000 samples, twice that here",
        ),
    },
    Twin {
        name: "normal_from_slope",
        file: "lib/refraction.wgsl",
        domain: &[SLOPE, SLOPE],
        call: "vec4f(normal_from_slope(a[0], a[1]), 0.0)",
        original: |a| vector(refraction::normal_from_slope(a[0], a[1]), 0.0),
        tolerance: tolerance(
            2.0 * SMALLEST_NORMAL,
            4e-7,
            bounds::none,
            "derived: three roundings of a sum of squares count half, an inverse square root is 4 u off, a product u",
        ),
    },
    Twin {
        name: "transmission",
        file: "lib/attenuation.wgsl",
        domain: &[ATTENUATION, ATTENUATION],
        call: "vec4f(transmission(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(attenuation::transmission(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::transmission,
            "derived: WGSL lets exp be 3 + 2 |x| ulp off, and the product is rounded",
        ),
    },
    Twin {
        name: "extinction",
        file: "lib/attenuation.wgsl",
        domain: &[ATTENUATION, ATTENUATION],
        call: "vec4f(extinction(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(attenuation::extinction(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            8.0 * U,
            bounds::extinction,
            "derived: a series of falling terms below 0.06, else as transmission",
        ),
    },
    Twin {
        name: "mean_positive",
        file: "lib/coverage.wgsl",
        domain: &[PLACE, PLACE],
        call: "vec4f(mean_positive(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(coverage::mean_positive(a[0], a[1])),
        tolerance: tolerance(
            8.0 * SMALLEST_NORMAL,
            12.0 * U,
            bounds::none,
            "derived: a quotient and six more roundings, no difference of rounded numbers",
        ),
    },
    Twin {
        name: "mean_clamped",
        file: "lib/coverage.wgsl",
        domain: &[PLACE, PLACE, WIDTH],
        call: "vec4f(mean_clamped(a[0], a[1], a[2]), 0.0, 0.0, 0.0)",
        original: |a| scalar(coverage::mean_clamped(a[0], a[1], a[2])),
        tolerance: tolerance(
            8.0 * SMALLEST_NORMAL,
            12.0 * U,
            bounds::none,
            "derived: as mean_positive, of two terms that are never below 0",
        ),
    },
    Twin {
        name: "tent_share_below",
        file: "lib/coverage.wgsl",
        domain: &[PLACE, PLACE, PLACE, PLACE],
        call: "vec4f(tent_share_below(a[0], min(min(a[1], a[2]), a[3]), max(min(a[1], a[2]), min(max(a[1], a[2]), a[3])), max(max(a[1], a[2]), a[3])), 0.0, 0.0, 0.0)",
        original: |a| {
            let mut places = [a[1], a[2], a[3]];
            places.sort_by(f64::total_cmp);
            scalar(coverage::tent_share_below(
                a[0], places[0], places[1], places[2],
            ))
        },
        tolerance: tolerance(
            1e-6,
            0.0,
            bounds::tent,
            "derived: two quotients and five more roundings of values up to 1",
        ),
    },
    Twin {
        name: "tent_share_between",
        file: "lib/coverage.wgsl",
        domain: &[PLACE, PLACE, PLACE, PLACE, PLACE],
        call: "vec4f(tent_share_between(min(a[0], a[1]), max(a[0], a[1]), min(min(a[2], a[3]), a[4]), max(min(a[2], a[3]), min(max(a[2], a[3]), a[4])), max(max(a[2], a[3]), a[4])), 0.0, 0.0, 0.0)",
        original: |a| {
            let mut places = [a[2], a[3], a[4]];
            places.sort_by(f64::total_cmp);
            scalar(coverage::tent_share_between(
                a[0].min(a[1]),
                a[0].max(a[1]),
                places[0],
                places[1],
                places[2],
            ))
        },
        tolerance: tolerance(
            SMALLEST_NORMAL,
            16.0 * U,
            bounds::tent_piece,
            "derived: two quotients and six more roundings a side, no difference of rounded numbers",
        ),
    },
    Twin {
        name: "cone_share",
        file: "lib/sky.wgsl",
        domain: &[UPWARD, CONE],
        call: "vec4f(cone_share(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(sky::cone_share(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::cone,
            "measured: 2.5 u / sin σ in 60 000 samples, thrice that here for coarser quotients and roots",
        ),
    },
    Twin {
        name: "sky_irradiance",
        file: "lib/sky.wgsl",
        domain: &[
            decades(0.0, [1e-3, 1e5], 1e9, &[0.0, SUBNORMAL, 1.0, 1e9]),
            even(0.0, 1.0, &[0.0, 0.93, 1.0]),
            decades(0.0, [1e-4, 1e2], 2e4, &[0.0, SUBNORMAL, 0.06, 2e4]),
            decades(-1e4, [1e-3, 1e3], 1.1e4, &[-1.0, -0.0, 0.0, 1.0, 1.1e4]),
            // 1 of an index beyond all bounds, 2 of one that is no bound.
            even(1.0, 2.0, &[1.0, 2.0]),
            UPWARD,
            CONE,
        ],
        call: "vec4f(sky_irradiance(a[0], a[1], a[2], a[3], a[4], a[5], a[6]), 0.0, 0.0, 0.0)",
        original: |a| {
            scalar(sky::sky_irradiance(
                a[0], a[1], a[2], a[3], a[4], a[5], a[6],
            ))
        },
        tolerance: tolerance(
            SMALLEST_NORMAL,
            0.0,
            bounds::sky,
            "derived from those of cone_share and transmission",
        ),
    },
    Twin {
        name: "point_angle",
        file: "lib/solid_angle.wgsl",
        domain: &[COORDINATE, COORDINATE],
        call: "vec4f(point_angle(a[0], a[1]), 0.0, 0.0, 0.0)",
        original: |a| scalar(solid_angle::point_angle(a[0], a[1])),
        tolerance: tolerance(
            SMALLEST_NORMAL,
            6e-7,
            bounds::angle,
            "derived: a division of 2.5 ulp, a polynomial of 1 ulp and the rounding of π",
        ),
    },
    Twin {
        name: "solid_angle",
        file: "lib/solid_angle.wgsl",
        domain: &[SIDE, SIDE, SIDE, SIDE, SIDE, SIDE, SIDE, SIDE],
        call: "vec4f(solid_angle(vec3f(a[0], a[1], a[2]), vec3f(a[3], a[4], a[5]), vec3f(a[6], a[7], a[4])), 0.0, 0.0, 0.0)",
        original: |a| {
            let [corner, ab, ac] = triangle(a);
            if bounds::solid_angle_is_open(corner, ab, ac) {
                return None;
            }
            scalar(solid_angle::solid_angle(corner, ab, ac))
        },
        tolerance: tolerance(
            SMALLEST_NORMAL,
            6e-7,
            |a| {
                let [corner, ab, ac] = triangle(a);
                bounds::solid_angle(corner, ab, ac)
            },
            "derived: rounding of the triple product and of the sum, as they turn the angle; and that of point_angle",
        ),
    },
    Twin {
        name: "octahedral_direction",
        file: "lib/octahedral.wgsl",
        domain: &[SQUARE, SQUARE],
        call: "vec4f(octahedral_direction(a[0], a[1]), 0.0)",
        original: |a| vector(octahedral::octahedral_direction(a[0], a[1]), 0.0),
        tolerance: tolerance(
            5e-7,
            0.0,
            bounds::none,
            "derived: rounding of a unit vector, from a sum that may cancel",
        ),
    },
];

/// A corner and two sides from eight arguments; one argument is used twice.
fn triangle(a: &[f64]) -> [DVec3; 3] {
    [
        DVec3::new(a[0], a[1], a[2]),
        DVec3::new(a[3], a[4], a[5]),
        DVec3::new(a[6], a[7], a[4]),
    ]
}

/// WGSL of the helper with which `call` makes an incident direction; part of the test, not of the library.
pub const CALL_PRELUDE: &str = "
fn incident(cos_i: f32, turns: f32, normal: vec3f) -> vec3f {
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.5);
    let u = normalize(cross(normal, helper));
    let v = cross(normal, u);
    let sc = sin_cos_turns(turns);
    let sin_i = sqrt(max((1.0 - cos_i) * (1.0 + cos_i), 0.0));
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
    let sin_i = ((1.0 - cos_i) * (1.0 + cos_i)).max(0.0).sqrt();
    ((u * cos + v * sin) * sin_i - normal * cos_i).normalize()
}
