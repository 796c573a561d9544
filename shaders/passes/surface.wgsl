// Surface — where is the water, and how does it tilt? One invocation per grid vertex.
#import "lib/turns.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/light.wgsl"
#import "lib/attenuation.wgsl"

// Per vertex: height above the water at rest (m), ∂h/∂x, ∂h/∂z, 0.
@group(0) @binding(8) var<storage, read_write> surface: array<vec4f>;

@compute @workgroup_size(64)
fn surface_main(@builtin(global_invocation_id) id: vec3u) {
    let side = light.cells + 1u;
    if id.x >= side || id.y >= side { return; }
    surface[id.y * side + id.x] = vec4f(water_surface_at(vertex_m(vec2f(id.xy)), light.wave_count), 0.0);
}
