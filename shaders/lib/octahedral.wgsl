// Octahedral map of all directions on a square. Twin of src/physics/octahedral.rs.

// Unit direction of the point (u, v), each −1 … 1: straight down in the middle, level on |u| + |v| = 1, straight up in the corners.
fn octahedral_direction(u: f32, v: f32) -> vec3f {
    let rise = abs(u) + abs(v) - 1.0;
    let fold = max(rise, 0.0);
    return normalize(vec3f(u - select(-fold, fold, u >= 0.0), rise, v - select(-fold, fold, v >= 0.0)));
}
