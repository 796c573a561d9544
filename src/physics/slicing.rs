//! Reference planes across a range of depths (Tipprasert 2006, §4.2.1).

/// Depth of plane `index` of `planes` (at least 2) that are evenly spaced over `s_min` … `s_max`; all depths in the same unit.
///
/// n slices have n + 1 planes, s = (s_max − s_min) / n apart. Source: Tipprasert 2006, eq. 4-6 … 4-9, which count from the far end.
pub fn plane_depth(s_min: f64, s_max: f64, planes: f64, index: f64) -> f64 {
    s_min + (s_max - s_min) * (index / (planes - 1.0))
}

/// The plane whose acceptance interval holds depth `s`: within ε = half the distance of two planes, 0 … `planes` − 1. Intervals
/// are half open, so that each depth has one plane; depths beyond the outermost planes belong to these. If all planes lie at one
/// depth (`s_max` − `s_min` below 10⁻³⁰), the first is taken.
///
/// Source: Tipprasert 2006, eq. 4-15.
pub fn plane_of_depth(s_min: f64, s_max: f64, planes: f64, s: f64) -> f64 {
    let extent = s_max - s_min;
    if extent < 1e-30 {
        return 0.0;
    }
    let halves = ((s - s_min) / extent * (2.0 * (planes - 1.0))).floor();
    (0.5 * halves + 0.5).floor().clamp(0.0, planes - 1.0)
}
