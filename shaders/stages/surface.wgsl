// Surface — height and slope of the water. One invocation per grid vertex.
#import "lib/turns.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "lib/attenuation.wgsl"

// Per vertex: height above the water at rest (m), ∂h/∂x, ∂h/∂z, 0.
@group(0) @binding(8) var<storage, read_write> surface: array<vec4f>;

@compute @workgroup_size(64)
fn surface_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let side = light.cells + 1u;
    let id = vertex_of(group, groups, invocation, side);
    if id.y >= side { return; }
    surface[id.y * side + id.x] = vec4f(water_surface_at(vertex_m(vec2f(id))), 0.0);
}
