// The receivers of the current light, and intersection of rays with the floor.

@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;

// Distance along the ray to the floor plane, m; < 0: it never hits it.
fn floor_distance(r: Receiver, origin: vec3f, direction: vec3f) -> f32 {
    let s = dot(r.s_row, vec4f(origin, 1.0));
    let rate = dot(r.s_row.xyz, direction);
    if rate <= 1e-6 { return -1.0; }
    return max(-s / rate, 0.0);
}

// (u, v) of a ray on a receiver at distance `t`.
fn map_uv(r: Receiver, origin: vec3f, direction: vec3f, t: f32) -> vec2f {
    return to_map(r, origin + direction * t).xy;
}

