//! Angles in turns (1 = 2π): phases reduce exactly by dropping whole turns.

/// sin and cos of 2π `turns`.
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    let reduced = turns - turns.round();
    (reduced * std::f64::consts::TAU).sin_cos()
}

/// The product of `a` and `b` without whole turns, for magnitudes below 10¹⁵⁰: what is left is right to a rounding, however many turns are
/// dropped; it may exceed ½ if the product exceeds 2⁵². Source: Dekker, "A floating-point technique for extending the available
/// precision", Numerische Mathematik 18, 1971.
pub fn fraction_of_product(a: f64, b: f64) -> f64 {
    let halves = |value: f64| {
        let scaled = value * 134_217_729.0; // 2²⁷ + 1
        let high = scaled - (scaled - value);
        (high, value - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let product = a * b;
    let rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product - product.round()) + rest
}
