//! Flux through a caustic volume between two of its cuts, where the density is interpolated between them.
//!
//! The rays of a volume are straight, so the signed area of its cut is a quadratic of the depth, and the flux between two cuts has a closed
//! form. Source: own derivation.

/// ∫₀^`end` of a cubic with these Bernstein coefficients, for `end` 0 … 1: `end` times the mean of the coefficients of its part before
/// `end` (de Casteljau).
pub fn cubic_before(c: [f64; 4], end: f64) -> f64 {
    let mix = |a: f64, b: f64| a + (b - a) * end;
    let near = [mix(c[0], c[1]), mix(c[1], c[2]), mix(c[2], c[3])];
    let middle = [mix(near[0], near[1]), mix(near[1], near[2])];
    0.25 * end * (c[0] + near[0] + middle[0] + mix(middle[0], middle[1]))
}

/// `above` / `below`, or 2 where its magnitude is not below 2.
pub fn quotient_below_2(above: f64, below: f64) -> f64 {
    if above.abs() < 2.0 * below.abs() {
        above / below
    } else {
        2.0
    }
}

/// ∫₀¹ |area(t)| density(t) dt for area(t) = `upper` (1 − t)² + `mixed` 2 t (1 − t) + `lower` t² (−1 … 1) and density(t) =
/// `upper_density` (1 − t) + `lower_density` t (0 … 1).
///
/// `upper` and `lower` are the signed areas of the cuts, `mixed` is half the sum of the products of the sides of one with those of the
/// other. If the area keeps its sign and is linear, and densities are 1 / |area|, it is (r + 1/r + 4) / 6 for areas of the ratio r: more than
/// the flux 1 that the volume carries.
pub fn interpolated_flux(
    upper: f64,
    mixed: f64,
    lower: f64,
    upper_density: f64,
    lower_density: f64,
) -> f64 {
    let c = [
        upper * upper_density,
        (upper * lower_density + 2.0 * mixed * upper_density) / 3.0,
        (2.0 * mixed * lower_density + lower * upper_density) / 3.0,
        lower * lower_density,
    ];
    let b = mixed - upper;
    let root = (mixed * mixed - upper * lower).max(0.0).sqrt();
    let far = -(b + if b >= 0.0 { root } else { -root });
    let zeros = [
        quotient_below_2(far, upper - 2.0 * mixed + lower).clamp(0.0, 1.0),
        quotient_below_2(upper, far).clamp(0.0, 1.0),
    ];
    let first = cubic_before(c, zeros[0].min(zeros[1]));
    let second = cubic_before(c, zeros[0].max(zeros[1]));
    first.abs() + (second - first).abs() + (cubic_before(c, 1.0) - second).abs()
}
