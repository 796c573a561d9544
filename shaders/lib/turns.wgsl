// Angles in turns (1 = 2π). Twin of src/physics/turns.rs.

// (sin, cos) of 2π `turns`; any number (beyond 2²⁴ all are integers). Own polynomials, because WGSL leaves the error of sin and cos to the
// driver; coefficients of the single-precision Cephes library (Moshier 1992) on ±π/4.
fn sin_cos_turns(turns: f32) -> vec2f {
    let reduced = turns - round(turns);
    let quarters = round(reduced * 4.0);
    let x = (reduced - quarters * 0.25) * 6.2831853;
    let x2 = x * x;
    let s = x + x * x2 * (-1.6666654611e-1 + x2 * (8.3321608736e-3 - x2 * 1.9515295891e-4));
    let c = 1.0 - 0.5 * x2 + x2 * x2 * (4.166664568298827e-2 + x2 * (-1.388731625493765e-3 + x2 * 2.443315711809948e-5));
    // Quarter turns swap and negate: 0 (s, c), 1 (c, −s), 2 (−s, −c), 3 (−c, s).
    let quadrant = u32(i32(quarters)) & 3u;
    let swapped = select(vec2f(s, c), vec2f(c, s), (quadrant & 1u) == 1u);
    let sin_sign = select(1.0, -1.0, quadrant >= 2u);
    let cos_sign = select(1.0, -1.0, quadrant == 1u || quadrant == 2u);
    return swapped * vec2f(sin_sign, cos_sign);
}
