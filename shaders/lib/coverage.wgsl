// How much of a texel a footprint covers, in closed form. Twin of src/physics/coverage.rs.

// Mean of max(x, 0) for x running evenly from `x_a` to `x_b`.
fn mean_positive(x_a: f32, x_b: f32) -> f32 {
    let m_a = max(x_a, 0.0);
    let m_b = max(x_b, 0.0);
    let d = x_b - x_a;
    let share = select((m_b - m_a) / d, select(0.0, 1.0, x_a > 0.0), d == 0.0);
    return 0.5 * (m_a + m_b) * share;
}

// Mean of clamp(x, 0, w) for x running evenly from `x_a` to `x_b`; keeps its digits where the edge is long against `w`.
fn mean_clamped(x_a: f32, x_b: f32, w: f32) -> f32 {
    let c_a = clamp(x_a, 0.0, w);
    let c_b = clamp(x_b, 0.0, w);
    let d = x_b - x_a;
    if d == 0.0 { return c_a; }
    return (c_b - c_a) / d * 0.5 * (c_a + c_b) + w * ((max(x_b, w) - max(x_a, w)) / d);
}

// Share of a tent density on t_0 ≤ t_peak ≤ t_1 that lies below `t`.
fn tent_share_below(t: f32, t_0: f32, t_peak: f32, t_1: f32) -> f32 {
    if t <= t_0 { return 0.0; }
    if t >= t_1 { return 1.0; }
    let length = t_1 - t_0;
    if t < t_peak { return (t - t_0) / length * ((t - t_0) / (t_peak - t_0)); }
    return 1.0 - (t_1 - t) / length * ((t_1 - t) / (t_1 - t_peak));
}
