//! Formulas against textbook values and against their own symmetries.

use std::f64::consts::{FRAC_PI_4, TAU};

use caustica::physics::attenuation::{extinction, transmission};
use caustica::physics::constants::GRAVITY_M_PER_S2;
use caustica::physics::coverage::{mean_clamped, tent_share_below};
use caustica::physics::dispersion::angular_frequency;
use caustica::physics::fresnel::{
    diffuse_transmittance, fresnel_reflectance, fresnel_transmittance,
};
use caustica::physics::interpolated_flux::interpolated_flux;
use caustica::physics::refraction::{
    direction_to_light, normal_from_slope, reflect_direction, refract_direction,
};
use caustica::physics::slicing::{plane_depth, plane_of_depth};
use caustica::physics::turns::sin_cos_turns;
use glam::DVec3;

const WATER: f64 = 1.333;

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value} is not within {tolerance} of {expected}"
    );
}

/// Directions to the light over the whole upper hemisphere, and normals up to steep.
fn directions_and_normals() -> Vec<(DVec3, DVec3)> {
    let mut pairs = Vec::new();
    for e in 1..18 {
        for a in 0..8 {
            let light = direction_to_light(
                f64::from(e * 5).to_radians(),
                f64::from(a * 45 + 7).to_radians(),
            );
            for s in 0..25 {
                let slope = (f64::from(s % 5 - 2) * 0.4, f64::from(s / 5 - 2) * 0.4);
                let normal = normal_from_slope(slope.0, slope.1);
                if normal.dot(light) > 1e-3 {
                    pairs.push((-light, normal));
                }
            }
        }
    }
    pairs
}

// Born & Wolf, Principles of Optics, 7th ed., §1.5.3, eq. 35: R = ((n − 1)/(n + 1))² at normal incidence.
#[test]
fn fresnel_at_normal_incidence() {
    for n in [1.1, WATER, 1.5, 2.417] {
        let expected = ((n - 1.0) / (n + 1.0f64)).powi(2);
        near(fresnel_reflectance(1.0, n), expected, 1e-15);
        near(fresnel_transmittance(1.0, n), 1.0 - expected, 1e-15);
    }
    // The everyday figures: glass reflects 4 %, water 2 %.
    near(fresnel_reflectance(1.0, 1.5), 0.04, 1e-15);
    near(fresnel_reflectance(1.0, WATER), 0.0204, 1e-4);
}

// Hecht, Optics, 5th ed., §4.6.3: air to glass (1.5) at 45° has R_s = 0.0920, and always R_p = R_s² there.
#[test]
fn fresnel_at_45_degrees() {
    let r_s = 0.092_013;
    near(
        fresnel_reflectance(FRAC_PI_4.cos(), 1.5),
        0.5 * (r_s + r_s * r_s),
        1e-6,
    );
}

// Born & Wolf §1.5.3, eq. 36: at tan θ = n nothing of the p part is reflected; of the s part ((n² − 1)/(n² + 1))².
#[test]
fn fresnel_at_brewsters_angle() {
    for n in [WATER, 1.5, 2.0] {
        let cos_i = f64::atan(n).cos();
        let r_s = (n * n - 1.0) / (n * n + 1.0);
        near(fresnel_reflectance(cos_i, n), 0.5 * r_s * r_s, 1e-14);
    }
    near(f64::atan(WATER).to_degrees(), 53.12, 5e-3);
}

#[test]
fn fresnel_at_grazing_incidence() {
    assert_eq!(fresnel_reflectance(0.0, WATER), 1.0);
    assert_eq!(fresnel_transmittance(0.0, WATER), 0.0);
    // First order in cos θ: T = 4 cos θ_i (η + 1/η) / (2 η cos θ_t …); compare with a hand-expanded limit.
    let cos_i = 1e-9;
    let cos_t = (1.0 - 1.0 / (WATER * WATER)).sqrt();
    let slope = 2.0 * (1.0 / (WATER * cos_t) + WATER / cos_t);
    near(
        fresnel_transmittance(cos_i, WATER) / cos_i / slope,
        1.0,
        1e-7,
    );
}

#[test]
fn reflected_and_transmitted_make_one() {
    for eta in [1.0 / 1.5, 1.0 / WATER, 1.0, 1.01, WATER, 1.5, 4.0] {
        for i in 1..=1000 {
            let cos_i = f64::from(i) / 1000.0;
            let (r, t) = (
                fresnel_reflectance(cos_i, eta),
                fresnel_transmittance(cos_i, eta),
            );
            near(r + t, 1.0, 1e-14);
            assert!((0.0..=1.0).contains(&r) && (0.0..=1.0 + 1e-15).contains(&t));
        }
    }
}

// Stokes: the same share is reflected from either side of the boundary along the same path.
#[test]
fn fresnel_is_reciprocal() {
    for i in 1..100 {
        let cos_i = f64::from(i) / 100.0;
        let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (WATER * WATER)).sqrt();
        near(
            fresnel_reflectance(cos_i, WATER),
            fresnel_reflectance(cos_t, 1.0 / WATER),
            1e-13,
        );
        near(
            fresnel_transmittance(cos_i, WATER),
            fresnel_transmittance(cos_t, 1.0 / WATER),
            1e-13,
        );
    }
}

// sin θ_c = 1/n: 48.6° for water (Hecht §4.7).
#[test]
fn total_reflection_beyond_the_critical_angle() {
    let critical = (1.0 / WATER).asin();
    near(critical.to_degrees(), 48.6, 0.05);
    for (offset, total) in [(1e-6, true), (0.1, true), (-1e-6, false), (-0.1, false)] {
        let angle: f64 = critical + offset;
        let down = DVec3::new(angle.sin(), -angle.cos(), 0.0);
        assert_eq!(
            refract_direction(down, DVec3::Y, 1.0 / WATER).is_none(),
            total
        );
        assert_eq!(
            fresnel_reflectance(angle.cos(), 1.0 / WATER) == 1.0,
            total,
            "{offset}"
        );
        assert_eq!(
            fresnel_transmittance(angle.cos(), 1.0 / WATER) == 0.0,
            total,
            "{offset}"
        );
    }
}

// Preisendorfer, Hydrologic Optics VI (1976), §12.1: still water reflects 6.6 % of a uniform sky. By reciprocity the way out
// passes 1/n² of that.
#[test]
fn diffuse_transmittance_of_water() {
    near(diffuse_transmittance(WATER), 0.934, 1e-3);
    near(
        diffuse_transmittance(1.0 / WATER),
        diffuse_transmittance(WATER) / (WATER * WATER),
        1e-4,
    );
    near(diffuse_transmittance(1.0), 1.0, 1e-12);
}

#[test]
fn refraction_obeys_snell() {
    for eta in [WATER, 1.5, 1.0 / WATER] {
        for (d, n) in directions_and_normals() {
            let Some(t) = refract_direction(d, n, eta) else {
                assert!(eta < 1.0, "light enters a denser medium at any angle");
                continue;
            };
            near(t.length(), 1.0, 1e-14);
            // n_1 sin θ_1 = n_2 sin θ_2, as vectors: n × d = η n × t; this also keeps t in the plane of incidence.
            assert!((n.cross(d) - n.cross(t) * eta).length() < 1e-13);
            assert!(
                t.dot(n) < 0.0,
                "refracted light goes on through the boundary"
            );
        }
    }
}

#[test]
fn refraction_is_reversible() {
    for (d, n) in directions_and_normals() {
        let t = refract_direction(d, n, WATER).unwrap();
        let back = refract_direction(-t, -n, 1.0 / WATER).unwrap();
        // Near the critical angle rounding grows by 1/cos θ.
        assert!((back + d).length() < 1e-11);
    }
}

#[test]
fn without_contrast_light_goes_straight_on() {
    for (d, n) in directions_and_normals() {
        assert!((refract_direction(d, n, 1.0).unwrap() - d).length() < 1e-12);
    }
}

#[test]
fn reflection_keeps_the_angle_and_the_plane() {
    for (d, n) in directions_and_normals() {
        let r = reflect_direction(d, n);
        near(r.length(), 1.0, 1e-14);
        near(r.dot(n), -d.dot(n), 1e-15);
        assert!((n.cross(r) - n.cross(d)).length() < 1e-14);
    }
}

#[test]
fn directions_by_hand() {
    let half_root = 0.5f64.sqrt();
    for (elevation, azimuth, expected) in [
        (0.0, 0.0, DVec3::X),
        (0.0, 90.0, DVec3::Z),
        (90.0, 123.0, DVec3::Y),
        (45.0, 180.0, DVec3::new(-half_root, half_root, 0.0)),
    ] {
        let l = direction_to_light(f64::to_radians(elevation), f64::to_radians(azimuth));
        assert!((l - expected).length() < 1e-15, "{elevation} {azimuth}");
    }
    // A surface that rises towards +X leans back towards −X.
    let n = normal_from_slope(1.0, 0.0);
    assert!((n - DVec3::new(-half_root, half_root, 0.0)).length() < 1e-15);
}

// Lamb, Hydrodynamics, 6th ed., §229: deep water, λ = g T²/2π, so 1.56 m for 1 s.
#[test]
fn deep_water_waves() {
    let length_m = GRAVITY_M_PER_S2 / TAU;
    near(length_m, 1.56, 1e-3);
    let k = TAU / length_m;
    near(angular_frequency(k, f64::INFINITY), TAU, 1e-14);
    near(angular_frequency(k, length_m), TAU, 1e-4);
}

// Lamb §229: long waves run with √(g d), whatever their length.
#[test]
fn shallow_water_waves() {
    for (length_m, depth_m) in [(1000.0, 0.5), (1e5, 4.0)] {
        let k = TAU / length_m;
        let speed = angular_frequency(k, depth_m) / k;
        near(speed / (GRAVITY_M_PER_S2 * depth_m).sqrt(), 1.0, 1e-5);
    }
    assert_eq!(angular_frequency(3.0, 0.0), 0.0);
}

#[test]
fn whole_turns_change_nothing() {
    for turns in [0.0, 0.125, 0.25, -0.375, 0.49] {
        let exact = sin_cos_turns(turns);
        for whole in [1.0, -1.0, 1e6, -1e6] {
            // The sum is rounded to 2⁻³³ turns; the reduction itself adds nothing.
            let sum: f64 = turns + whole;
            let expected = sin_cos_turns(sum - whole);
            assert_eq!(sin_cos_turns(sum), expected);
            near(expected.0, exact.0, 1e-9);
            near(expected.1, exact.1, 1e-9);
        }
    }
    let (sin, cos) = sin_cos_turns(1e6 + 0.25);
    near(sin, 1.0, 1e-15);
    near(cos, 0.0, 1e-15);
    let (sin, cos) = sin_cos_turns(1.0 / 12.0);
    near(sin, 0.5, 1e-15);
    near(cos, 0.75f64.sqrt(), 1e-15);
}

#[test]
fn attenuation_by_hand() {
    assert_eq!(transmission(0.0, 1e9), 1.0);
    near(transmission(0.35, 2.0), (-0.7f64).exp(), 1e-16);
    near(
        transmission(0.35, 2.0) * transmission(0.35, 3.0),
        transmission(0.35, 5.0),
        1e-15,
    );
    for (c, d) in [(0.35, 2.0), (1e4, 1e4), (1e-9, 1e-9)] {
        near(transmission(c, d) + extinction(c, d), 1.0, 1e-15);
    }
    // Tiny losses keep their digits.
    near(extinction(1e-9, 1e-9) / 1e-18, 1.0, 1e-15);
}

#[test]
fn mean_clamped_is_the_mean() {
    const STEPS: u32 = 20_000;
    let ends = [-3.0, -0.2, 0.0, 0.1, 0.5, 0.999, 1.0, 1.3, 7.0];
    for w in [0.0, 0.25, 1.0] {
        for a in ends {
            for b in ends {
                let mean = (0..STEPS)
                    .map(|i| {
                        let s = (f64::from(i) + 0.5) / f64::from(STEPS);
                        (a + (b - a) * s).clamp(0.0, w)
                    })
                    .sum::<f64>()
                    / f64::from(STEPS);
                near(mean_clamped(a, b, w), mean, 1e-7);
                near(mean_clamped(a, b, w), mean_clamped(b, a, w), 1e-15);
            }
        }
    }
}

#[test]
fn mean_clamped_of_vertical_and_nearly_vertical_edges() {
    for x in [-5.0, 0.0, 0.3, 1.0, 1e6] {
        assert_eq!(mean_clamped(x, x, 1.0), x.clamp(0.0, 1.0));
        for d in [f64::EPSILON, 1e-12, 1e-300] {
            let value = mean_clamped(x, x + d, 1.0);
            near(value, x.clamp(0.0, 1.0), 1e-11);
            assert!((0.0..=1.0).contains(&value), "{x} {d}: {value}");
        }
    }
}

#[test]
fn tent_shares_are_the_integral() {
    const STEPS: u32 = 20_000;
    for (t_0, t_peak, t_1) in [
        (0.0, 0.3, 1.0),
        (-2.0, -2.0, 1.0),
        (1.0, 4.0, 4.0),
        (0.0, 0.5, 1.0),
    ] {
        let density = |t: f64| {
            let height = 2.0 / (t_1 - t_0);
            if t < t_peak {
                height * (t - t_0) / (t_peak - t_0)
            } else {
                height * (t_1 - t) / (t_1 - t_peak)
            }
        };
        for part in 0..=10 {
            let t = t_0 + (t_1 - t_0) * f64::from(part) / 10.0;
            let step = (t - t_0) / f64::from(STEPS);
            let share: f64 = (0..STEPS)
                .map(|i| density(t_0 + (f64::from(i) + 0.5) * step) * step)
                .sum();
            near(tent_share_below(t, t_0, t_peak, t_1), share, 1e-6);
        }
        assert_eq!(tent_share_below(t_0 - 1.0, t_0, t_peak, t_1), 0.0);
        assert_eq!(tent_share_below(t_1 + 1.0, t_0, t_peak, t_1), 1.0);
        near(
            tent_share_below(t_peak, t_0, t_peak, t_1),
            (t_peak - t_0) / (t_1 - t_0),
            1e-15,
        );
    }
}

#[test]
fn a_tent_without_width_is_a_step() {
    assert_eq!(tent_share_below(0.999, 1.0, 1.0, 1.0), 0.0);
    assert_eq!(tent_share_below(1.001, 1.0, 1.0, 1.0), 1.0);
    assert!(tent_share_below(1.0, 1.0, 1.0, 1.0).is_finite());
}

/// The closed form of a tilted plane under a bright cone against a sum over directions.
#[test]
fn the_share_of_a_cone_is_the_sum_over_its_directions() {
    use caustica::physics::sky::cone_share;
    for sin2_cone in [0.1, 1.0 / (1.333 * 1.333), 0.9, 1.0_f64] {
        for tilt in 0..=12 {
            let tilt = f64::from(tilt) * std::f64::consts::PI / 12.0;
            let (sin_t, cos_t) = tilt.sin_cos();
            // Directions (θ, φ) of the cone, by midpoints.
            let half_angle = sin2_cone.sqrt().asin();
            let (rings, spokes) = (400, 800);
            let mut sum = 0.0;
            for i in 0..rings {
                let (sin_i, cos_i) =
                    (half_angle * (f64::from(i) + 0.5) / f64::from(rings)).sin_cos();
                for k in 0..spokes {
                    let phi = TAU * (f64::from(k) + 0.5) / f64::from(spokes);
                    sum += (sin_i * phi.cos() * sin_t + cos_i * cos_t).max(0.0) * sin_i;
                }
            }
            let each = half_angle * TAU / f64::from(rings * spokes);
            let expected = sum * each / (std::f64::consts::PI * sin2_cone);
            let found = cone_share(cos_t, sin2_cone);
            assert!(
                (found - expected).abs() < 1e-4,
                "tilt {tilt}, sin² {sin2_cone}: {found}, not {expected}"
            );
        }
    }
    // The hemisphere of a dry plane, and water's cone on a wall (about a fifth).
    assert!((cone_share(0.0, 1.0) - 0.5).abs() < 1e-12);
    assert!((cone_share(0.0, 0.5628) - 0.2).abs() < 0.02);
}

// Tipprasert 2006, eq. 4-6 … 4-9 and 4-15: n slices of a box of height h have n + 1 planes h/n apart, each accepts within h/2n.
#[test]
fn every_depth_belongs_to_the_plane_within_half_a_distance() {
    let (top, bottom) = (-0.7, 2.3);
    for planes in [2.0, 3.0, 50.0, 1024.0] {
        let distance = (bottom - top) / (planes - 1.0);
        near(plane_depth(top, bottom, planes, 0.0), top, 1e-15);
        near(
            plane_depth(top, bottom, planes, planes - 1.0),
            bottom,
            1e-15,
        );
        for i in 0..=1000 {
            let s = top + (bottom - top) * f64::from(i) / 1000.0;
            let plane = plane_of_depth(top, bottom, planes, s);
            assert_eq!(plane, plane.round());
            let off = (s - plane_depth(top, bottom, planes, plane)).abs();
            assert!(
                off <= 0.5 * distance * (1.0 + 1e-9),
                "{s}: {off} of {distance}"
            );
        }
        // Beyond the box, as far as it may be, the outermost planes.
        assert_eq!(plane_of_depth(top, bottom, planes, top - 9.0), 0.0);
        assert_eq!(
            plane_of_depth(top, bottom, planes, bottom + 9.0),
            planes - 1.0
        );
    }
    // Half way the interval of the next plane begins.
    assert_eq!(plane_of_depth(0.0, 4.0, 5.0, 1.5), 2.0);
    assert_eq!(plane_of_depth(0.0, 4.0, 5.0, 1.5 - 1e-12), 1.0);
}

/// The closed form of a sub-volume's flux is the integral, with and without zeros of the area; and for linear areas that keep their sign it is
/// (r + 1/r + 4) / 6.
#[test]
fn flux_between_two_cuts_is_the_integral() {
    const STEPS: usize = 20_000;
    let mut with_zeros = 0;
    for k in 0..400 {
        let shares = [0.754_877_666, 0.569_840_291, 0.430_159_709, 0.245_122_334];
        let [upper, mixed, lower, density] = shares.map(|g: f64| (0.5 + g * f64::from(k)).fract());
        let (upper, mixed, lower) = (2.0 * upper - 1.0, 4.0 * mixed - 2.0, 2.0 * lower - 1.0);
        let (mut due, mut signs) = (0.0, [false; 2]);
        for step in 0..STEPS {
            let t = (step as f64 + 0.5) / STEPS as f64;
            let area = upper * (1.0 - t) * (1.0 - t) + mixed * 2.0 * t * (1.0 - t) + lower * t * t;
            signs[usize::from(area > 0.0)] = true;
            due += area.abs() * ((1.0 - t) * density + t * 0.7) / STEPS as f64;
        }
        with_zeros += u32::from(signs == [true; 2]);
        let found = interpolated_flux(upper, mixed, lower, density, 0.7);
        assert!((found - due).abs() < 1e-6, "{found} {due}");
    }
    assert!(with_zeros > 100 && with_zeros < 390, "{with_zeros}");
    for r in [1.0, 2.0, 4.0, 8.0] {
        let found = interpolated_flux(1.0 / r, 0.5 * (1.0 / r + 1.0), 1.0, r, 1.0);
        let due = (r + 1.0 / r + 4.0) / 6.0;
        assert!((found - due).abs() < 1e-12, "{r}: {found} {due}");
    }
}
