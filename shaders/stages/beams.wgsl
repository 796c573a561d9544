// Beams — direction of the refracted light and transmittance at each water vertex. One invocation per grid vertex.
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/octahedral.wgsl"
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "shared/entry.wgsl"

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
// Per vertex: unit direction under water, transmittance T (0 where the surface faces away from the light).
@group(0) @binding(9) var<storage, read_write> beams: array<vec4f>;

@compute @workgroup_size(64)
fn beams_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let side = light.cells + 1u;
    let id = vertex_of(group, groups, invocation, side);
    if id.y >= side { return; }
    let vertex = id.y * side + id.x;
    let entry = entry_at(vec2f(id), surface[vertex].xyz);
    beams[vertex] = vec4f(entry.direction, entry.transmittance);
}
