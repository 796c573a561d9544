// The water surface as a sum of sine components.

struct Wave {
    amplitude_m: f32,
    frequency_x_per_m: f32, // turns per metre
    frequency_z_per_m: f32,
    phase_turns: f32,
}

@group(0) @binding(1) var<storage, read> waves: array<Wave>;

// (height above the water at rest in m, ∂h/∂x, ∂h/∂z) at local (x, z) in m; `count` components.
fn water_surface_at(p_m: vec2f, count: u32) -> vec3f {
    var surface = vec3f(0.0);
    for (var i = 0u; i < count; i++) {
        let w = waves[i];
        let sc = sin_cos_turns(p_m.x * w.frequency_x_per_m + p_m.y * w.frequency_z_per_m + w.phase_turns);
        let slope_scale = 6.2831853 * w.amplitude_m * sc.y;
        surface += vec3f(w.amplitude_m * sc.x, slope_scale * w.frequency_x_per_m, slope_scale * w.frequency_z_per_m);
    }
    return surface;
}
