// Reference planes across a range of depths. Twin of src/physics/slicing.rs. Depths up to 10⁶.

// Depth of plane `index` of `planes` (at least 2) that lie evenly over s_min … s_max.
fn plane_depth(s_min: f32, s_max: f32, planes: f32, index: f32) -> f32 {
    return s_min + (s_max - s_min) * (index / (planes - 1.0));
}

// The plane within half a plane distance of depth `s`, 0 … planes − 1. Intervals are half open, so each depth has one plane. If all planes
// lie at one depth (s_max − s_min below 10⁻³⁰), it is the first.
fn plane_of_depth(s_min: f32, s_max: f32, planes: f32, s: f32) -> f32 {
    let extent = s_max - s_min;
    if extent < 1e-30 { return 0.0; }
    let halves = floor(clamp((s - s_min) / extent, -1.0, 2.0) * (2.0 * (planes - 1.0)));
    return clamp(floor(0.5 * halves + 0.5), 0.0, planes - 1.0);
}
