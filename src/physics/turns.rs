//! Angles in turns (1 = 2π): phases reduce exactly by dropping whole turns.

/// sin and cos of 2π `turns`.
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    let reduced = turns - turns.round();
    (reduced * std::f64::consts::TAU).sin_cos()
}
