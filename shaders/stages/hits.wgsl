// Hits — the first receiver that each ray hits. One invocation per grid vertex.
#import "lib/attenuation.wgsl"
#import "lib/slicing.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/reference_planes.wgsl"
#import "shared/trace_light.wgsl"

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
@group(0) @binding(9) var<storage, read> beams: array<vec4f>;
// Per vertex: (u, v) on the receiver's map in texels, path length (m), receiver index (−1: none).
@group(0) @binding(10) var<storage, read_write> hits: array<vec4f>;

@compute @workgroup_size(64)
fn hits_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let side = light.cells + 1u;
    let id = vertex_of(group, groups, invocation, side);
    if id.y >= side { return; }
    let vertex = id.y * side + id.x;
    let origin = origin_at(vec2f(id), surface[vertex].x);
    let hit = trace_light(origin, beams[vertex].xyz, light.object_count, light.has_floor == 1u);
    hits[vertex] = vec4f(hit.uv, hit.t, f32(hit.receiver));
}
