//! The share of a texel that a footprint covers, in closed form.
//!
//! The area of a triangle inside the texel [x₀, x₁] × row is the sum over its edges of ∫ (max(x − x₀, 0) − max(x − x₁, 0)) dy: no
//! polygon clipping is needed, and every quotient stays in 0 … 1.

/// Mean of max(x, 0) for x running evenly from `x_a` to `x_b`: (m_b − m_a)/(x_b − x_a) · (m_a + m_b)/2 with m = max(x, 0). (Ours.)
pub fn mean_positive(x_a: f64, x_b: f64) -> f64 {
    let m_a = x_a.max(0.0);
    let m_b = x_b.max(0.0);
    let d = x_b - x_a;
    let share = if d == 0.0 {
        if x_a > 0.0 { 1.0 } else { 0.0 }
    } else {
        (m_b - m_a) / d
    };
    0.5 * (m_a + m_b) * share
}

/// Mean of clamp(x, 0, w) for x running evenly from `x_a` to `x_b`, `w` ≥ 0; accurate also if the edge is long compared with `w`.
///
/// With c = clamp(x, 0, w) and m = max(x, w): ((c_b − c_a)(c_a + c_b)/2 + w (m_b − m_a)) / (x_b − x_a). (Ours.)
pub fn mean_clamped(x_a: f64, x_b: f64, w: f64) -> f64 {
    let c_a = x_a.clamp(0.0, w);
    let c_b = x_b.clamp(0.0, w);
    let d = x_b - x_a;
    if d == 0.0 {
        return c_a;
    }
    (c_b - c_a) / d * 0.5 * (c_a + c_b) + w * ((x_b.max(w) - x_a.max(w)) / d)
}

/// Share of a tent density on `t_0` ≤ `t_peak` ≤ `t_1` that lies below `t`. The tent is the flux density of a triangle along its
/// longest side, in the limit of vanishing area. 0 at t_0, (t_peak − t_0)/(t_1 − t_0) at the peak, 1 at t_1. (Ours.)
pub fn tent_share_below(t: f64, t_0: f64, t_peak: f64, t_1: f64) -> f64 {
    let length = t_1 - t_0;
    if t <= t_0 {
        0.0
    } else if t >= t_1 {
        1.0
    } else if t < t_peak {
        (t - t_0) / length * ((t - t_0) / (t_peak - t_0))
    } else {
        1.0 - (t_1 - t) / length * ((t_1 - t) / (t_1 - t_peak))
    }
}

/// Share of that density between `t_a` ≤ `t_b`: for each side, the length of the piece times the sum of the densities at its
/// ends. Also the share of a triangle between two heights, if the three positions are those of its corners. (Ours.)
pub fn tent_share_between(t_a: f64, t_b: f64, t_0: f64, t_peak: f64, t_1: f64) -> f64 {
    let length = t_1 - t_0;
    let side = |from: f64, to: f64, ends: f64, side_length: f64| {
        if to > from {
            (to - from) / length * (ends / side_length)
        } else {
            0.0
        }
    };
    let (rise_a, rise_b) = (t_a.clamp(t_0, t_peak), t_b.clamp(t_0, t_peak));
    let (fall_a, fall_b) = (t_a.clamp(t_peak, t_1), t_b.clamp(t_peak, t_1));
    side(
        rise_a,
        rise_b,
        (rise_a - t_0) + (rise_b - t_0),
        t_peak - t_0,
    ) + side(
        fall_a,
        fall_b,
        (t_1 - fall_a) + (t_1 - fall_b),
        t_1 - t_peak,
    )
}
