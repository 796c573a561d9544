// Coverage of a texel by a footprint, in closed form. Twin of src/physics/coverage.rs. Coordinates and widths up to 10³⁰.

// Smallest normal number. A GPU may flush smaller numbers to 0, even in only one part of a quotient, which would give 0/0.
const SMALLEST_NORMAL = 0x1p-126f;

// Mean of max(x, 0) for x running evenly from `x_a` to `x_b`.
fn mean_positive(x_a: f32, x_b: f32) -> f32 {
    let m_a = max(x_a, 0.0);
    let m_b = max(x_b, 0.0);
    let d = x_b - x_a;
    if abs(d) < SMALLEST_NORMAL { return m_a; }
    return (m_b - m_a) / d * (0.5 * (m_a + m_b));
}

// Mean of clamp(x, 0, w) for x running evenly from `x_a` to `x_b`; stays precise if the edge is long compared with `w`.
fn mean_clamped(x_a: f32, x_b: f32, w: f32) -> f32 {
    let c_a = clamp(x_a, 0.0, w);
    let c_b = clamp(x_b, 0.0, w);
    let d = x_b - x_a;
    if abs(d) < SMALLEST_NORMAL { return c_a; }
    return (c_b - c_a) / d * (0.5 * (c_a + c_b)) + w * ((max(x_b, w) - max(x_a, w)) / d);
}

// Share of a tent density on t_0 ≤ t_peak ≤ t_1 that lies below `t`.
fn tent_share_below(t: f32, t_0: f32, t_peak: f32, t_1: f32) -> f32 {
    if t <= t_0 { return 0.0; }
    if t >= t_1 { return 1.0; }
    let length = max(t_1 - t_0, SMALLEST_NORMAL);
    if t < t_peak { return (t - t_0) / length * ((t - t_0) / max(t_peak - t_0, SMALLEST_NORMAL)); }
    return 1.0 - (t_1 - t) / length * ((t_1 - t) / max(t_1 - t_peak, SMALLEST_NORMAL));
}

// Share of that density between heights `t_a` ≤ `t_b`. Unlike a difference of two shares below, it stays precise if the interval is short
// compared with the tent.
fn tent_share_between(t_a: f32, t_b: f32, t_0: f32, t_peak: f32, t_1: f32) -> f32 {
    let length = max(t_1 - t_0, SMALLEST_NORMAL);
    let rise = clamp(vec2f(t_a, t_b), vec2f(t_0), vec2f(t_peak));
    let fall = clamp(vec2f(t_a, t_b), vec2f(t_peak), vec2f(t_1));
    return (rise.y - rise.x) / length * (((rise.x - t_0) + (rise.y - t_0)) / max(t_peak - t_0, SMALLEST_NORMAL))
        + (fall.y - fall.x) / length * (((t_1 - fall.x) + (t_1 - fall.y)) / max(t_1 - t_peak, SMALLEST_NORMAL));
}
