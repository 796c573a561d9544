//! Tolerances that depend on the arguments: the roundings of each step, propagated to the result.
//!
//! WGSL rounds sums and products correctly (u = 2⁻²⁴ relative), lets a quotient be 2.5 ulp off (5 u), an inverse square root 2
//! ulp and a square root by way of it 4.5 ulp (9 u). Errors are propagated to first order; each bound has a few u to spare.

use glam::DVec3;

use super::super::refraction::refracted_square;

/// Half the distance from 1 to its upper neighbour.
pub(super) const U: f64 = 1.0 / 16_777_216.0;

/// 2⁻¹²⁶: numbers below it may be flushed to 0.
pub(super) const SMALLEST_NORMAL: f64 = f32::MIN_POSITIVE as f64;

/// No part depends on the arguments.
pub(super) fn none(_: &[f64]) -> f64 {
    0.0
}

/// Depths s_min, s_max.
pub(super) fn depths(a: &[f64]) -> f64 {
    // The quotient 5 u, three more roundings of what is at most |s_max − s_min|, and that of the sum.
    10.0 * U * (a[0].abs() + a[1].abs())
}

/// Of (η cos θ_t)² from cos θ_i and η.
pub(super) fn square(a: &[f64]) -> f64 {
    let contrast = (a[1] - 1.0) * (a[1] + 1.0);
    4.0 * U * contrast.abs() + 2.0 * U * a[0] * a[0] + SMALLEST_NORMAL
}

/// Of a root whose square is off by `off`: first order far from 0, √`off` at 0.
fn root(square: f64, off: f64) -> f64 {
    let root = square.max(0.0).sqrt();
    off / (root + off.sqrt()) + 9.0 * U * root
}

/// Of the reflectance for cos θ_i and η.
pub(super) fn reflectance(a: &[f64]) -> f64 {
    let (c, eta) = (a[0], a[1]);
    let g2 = refracted_square(c, eta);
    let (g, off) = (g2.max(0.0).sqrt(), root(g2, square(a)));
    let (s, p) = (c + g, eta * eta * c + g);
    if s <= 0.0 {
        return 0.0;
    }
    // R = ½ (r_s² + r_p²), dr_s/dg = −2 c/(c + g)², dr_p/dg = −2 η² c/(η² c + g)². At g = 0 both are at most 2 off/(c + off).
    let slope_s = 2.0 * c * off / (s * (s + off)).max(off * off);
    let slope_p = 2.0 * eta * eta * c * off / (p * (p + off)).max(off * off);
    let (r_s, r_p) = ((c - g) / s, (eta * eta * c - g) / p);
    let rounding = 16.0 * U;
    let of = |r: f64, slope: f64| {
        let e = slope.min(2.0) + rounding;
        r.abs() * e + 0.5 * e * e
    };
    of(r_s, slope_s) + of(r_p, slope_p)
}

/// Of the transmittance for cos θ_i and η.
pub(super) fn transmittance(a: &[f64]) -> f64 {
    let (c, eta) = (a[0], a[1]);
    let g2 = refracted_square(c, eta);
    let (g, off) = (g2.max(0.0).sqrt(), root(g2, square(a)));
    let (s, p) = (c + g, eta * c + g / eta);
    if c <= 0.0 || s <= 0.0 {
        return SMALLEST_NORMAL;
    }
    // T = 2 c g (1/s² + 1/p²): what g is off counts once in front, and once in each sum, which only lessens it.
    let both = 1.0 / (s * s) + 1.0 / (p * p);
    2.0 * c * both * (off + 32.0 * U * g) + SMALLEST_NORMAL
}

/// Error of the square of η cos θ_t in a refraction whose cosine comes from two rounded unit vectors.
pub(super) fn square_of_vectors(c: f64, eta: f64) -> f64 {
    square(&[c, eta]) + 32.0 * U * c + 256.0 * U * U
}

/// Of the refracted direction for (cos θ_i, turn, slopes, η).
pub(super) fn refracted(a: &[f64]) -> f64 {
    let (c, eta) = (a[0], a[4]);
    let g2 = refracted_square(c, eta);
    let off = root(g2, square_of_vectors(c, eta));
    let along_normal = (c - g2.max(0.0).sqrt()).abs();
    // d + (c − g) n, of length η: unit vectors 10 u each, the cosine 16 u.
    (off + 30.0 * U + 8.0 * U * along_normal) / eta + 16.0 * U
}

/// Of e^(−c d): WGSL's 3 + 2 |x| ulp, and the rounding of the product.
pub(super) fn transmission(a: &[f64]) -> f64 {
    exponential(a[0] * a[1], 1.0)
}

/// Of 1 − e^(−c d): for large enough products, the error of the exponential.
pub(super) fn extinction(a: &[f64]) -> f64 {
    let x = a[0] * a[1];
    // The border in f32 is that of a rounded product.
    if x < 0.06 * (1.0 - 4.0 * U) {
        0.0
    } else {
        exponential(x, 1.0)
    }
}

/// Of e^(−x) for an x with the given number of roundings.
fn exponential(x: f64, roundings: f64) -> f64 {
    (-x).exp() * (2.0 * U * (3.0 + 2.0 * x) + roundings * U * x) + SMALLEST_NORMAL
}

/// Of a tent's share for (t, and the tent's three positions in any order).
pub(super) fn tent(a: &[f64]) -> f64 {
    let low = a[1].min(a[2]).min(a[3]);
    let high = a[1].max(a[2]).max(a[3]);
    // Sides shorter than the smallest normal number are treated as having that length.
    (4.0 * SMALLEST_NORMAL / (high - low)).min(1.0)
}

/// Of a tent's share for (two heights, and the tent's three positions in any order).
pub(super) fn tent_piece(a: &[f64]) -> f64 {
    2.0 * tent(&a[1..])
}

/// Of a cone's share for (n_y, sin²σ).
pub(super) fn cone(a: &[f64]) -> f64 {
    // Terms of the size of sin σ are added up, and divided by π sin²σ.
    8.0 * U / a[1].sqrt()
}

/// Of the irradiance from a sky.
pub(super) fn sky(a: &[f64]) -> f64 {
    let x = a[2] * a[4] * a[3].max(0.0);
    let bright = std::f64::consts::PI * a[0] * a[1];
    bright * ((-x).exp() * cone(&a[5..]) + exponential(x, 3.0) + (-x).exp() * 8.0 * U)
        + SMALLEST_NORMAL
}

/// Of an angle whose coordinates may each be flushed below the smallest normal number.
pub(super) fn angle(a: &[f64]) -> f64 {
    (4.0 * SMALLEST_NORMAL / a[0].hypot(a[1])).min(std::f64::consts::TAU)
}

/// A triangle's triple product and sum, and the error of each.
fn solid_angle_parts(a: DVec3, ab: DVec3, ac: DVec3) -> [f64; 4] {
    let (b, c) = (a + ab, a + ac);
    let size = a.length() * b.length() * c.length();
    let triple = a.dot(ab.cross(ac));
    let sum = size + a.dot(b) * c.length() + a.dot(c) * b.length() + b.dot(c) * a.length();
    // The corners b and c are rounded sums themselves.
    let spread = (a.length() + ab.length()) * (a.length() + ac.length());
    let triple_off = 8.0 * U * a.length() * ab.length() * ac.length() + SMALLEST_NORMAL;
    let sum_off = 16.0 * U * (size + a.length() * spread) + SMALLEST_NORMAL;
    [triple, sum, triple_off, sum_off]
}

/// Whether rounding decides the solid angle: if the origin lies in the triangle, the angle jumps between −2π and 2π; on an edge
/// it may have any value.
pub(super) fn solid_angle_is_open(a: DVec3, ab: DVec3, ac: DVec3) -> bool {
    let [triple, sum, triple_off, sum_off] = solid_angle_parts(a, ab, ac);
    let is_within = sum <= sum_off && triple.abs() <= triple_off;
    is_within || triple_off + sum_off > 0.1 * triple.hypot(sum)
}

/// Of the solid angle of the triangle at `a`, with sides `ab` and `ac`.
pub(super) fn solid_angle(a: DVec3, ab: DVec3, ac: DVec3) -> f64 {
    let [triple, sum, triple_off, sum_off] = solid_angle_parts(a, ab, ac);
    // 2 atan2(triple, sum); a tenth of both is off at most, which the second order takes a fifth for.
    2.4 * (triple_off * sum.abs() + sum_off * triple.abs()) / (triple * triple + sum * sum)
}
