// Volumetric — light on meshes by an image of every slice (Tipprasert 2006, §5.2.1). For each plane, the part of the mesh nearest to it is
// drawn, a caustics map is made from all beams without any test, and the slice masks it. The first slice that holds a texel wins.
#import "lib/attenuation.wgsl"
#import "lib/coverage.wgsl"
#import "lib/slicing.wgsl"
#import "lib/solid_angle.wgsl"
#import "shared/light.wgsl"
#import "shared/planes_uniform.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/reference_planes.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/level_map_view.wgsl"
#import "shared/flux.wgsl"
#import "shared/deposit_share.wgsl"
#import "shared/footprint.wgsl"
#import "shared/wide_footprint.wgsl"
#import "shared/beam.wgsl"
#import "shared/beam_triangle.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid.wgsl"
#import "shared/grid_rays.wgsl"
#import "shared/cull.wgsl"

@group(0) @binding(19) var<storage, read_write> plane_counts: array<vec4u>;
// Per texel of the current object: the colour of the first slice that holds it, RGBA8; 0: none yet.
@group(0) @binding(20) var<storage, read_write> combined: array<u32>;
@group(0) @binding(26) var slice: texture_2d<f32>;

struct SliceVertex {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) albedo: vec3f,
}

// The view's s_min and s_max are half way to the neighbouring planes; everything beyond is clipped.
@vertex
fn slice_vertex(@builtin(vertex_index) index: u32) -> SliceVertex {
    let triangle = instances[planes.object].first_triangle + 4u * (index / 3u);
    let p = vec4f(bitcast<vec3f>(geometry[triangle + index % 3u].xyz), 1.0);
    let u = dot(level_map_view.u_row, p);
    let v = dot(level_map_view.v_row, p);
    let s = dot(level_map_view.s_row, p);
    let size = f32(level_map_view.texels);
    let depth = (s - level_map_view.s_min) / (level_map_view.s_max - level_map_view.s_min);
    var out: SliceVertex;
    out.clip = vec4f(2.0 * u / size - 1.0, 1.0 - 2.0 * v / size, depth, 1.0);
    out.albedo = bitcast<vec3f>(geometry[triangle + 3u].xyz);
    return out;
}

@fragment
fn slice_fragment(in: SliceVertex) -> @location(0) vec4f {
    return vec4f(in.albedo, 1.0);
}

@compute @workgroup_size(1)
fn volumetric_share_out() {
    share_out(1u, 1u);
    plane_counts[planes.object] = vec4u(kept_beams(), planes.planes, 1u, atomicLoad(&beam_queue[WIDE_COUNT]));
}

// The caustics map of one plane.
fn caustics_map(r: Receiver) -> Target {
    return Target(planes.scratch, i32(r.map_width), i32(r.map_height), light.channels, light.flux_scale);
}

@compute @workgroup_size(64)
fn volumetric_deposit(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let r = receivers[planes.receiver];
    let s = plane_s(r, planes.plane);
    let count = atomicLoad(&beam_queue[NARROW_COUNT]);
    for (var item = group.x * CULL_GROUP + invocation; item < count; item += groups.x * CULL_GROUP) {
        let b = narrow_beam(item);
        let c = cross_plane(map_rays(b, r), r, s);
        if !c.meets { continue; }
        deposit_triangle(caustics_map(r), c.uv[0], c.uv[1], c.uv[2], b.transmitted * mean_transmission(c.t));
    }
}

@compute @workgroup_size(64)
fn volumetric_wide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let r = receivers[planes.receiver];
    let s = plane_s(r, planes.plane);
    let count = atomicLoad(&beam_queue[WIDE_COUNT]);
    let lane = group.z * 64u + invocation;
    for (var item = group.x; item < count; item += groups.x) {
        let b = wide_beam(item);
        let c = cross_plane(map_rays(b, r), r, s);
        if !c.meets { continue; }
        let arriving = b.transmitted * mean_transmission(c.t);
        if is_segment(c.uv[0], c.uv[1], c.uv[2]) {
            if lane == 0u { deposit_segment(caustics_map(r), c.uv[0], c.uv[1], c.uv[2], arriving); }
        } else {
            deposit_texels(caustics_map(r), c.uv, arriving, lane, groups.z * 64u);
        }
    }
}

// Masks the caustics map with its slice, front to back, and clears it for the next plane. One invocation per texel.
@compute @workgroup_size(8, 8)
fn volumetric_combine(@builtin(global_invocation_id) id: vec3u) {
    let r = receivers[planes.receiver];
    if id.x >= r.map_width || id.y >= r.map_height { return; }
    let texel = id.y * r.map_width + id.x;
    let color = textureLoad(slice, vec2i(id.xy), 0);
    let before = select(combined[texel], 0u, planes.plane == 0u);
    let wins = before == 0u && color.w > 0.5;
    combined[texel] = select(before, pack4x8unorm(color), wins);
    let words = light.channels * select(1u, 2u, WIDE_SUMS);
    for (var word = 0u; word < words; word++) {
        let sum = atomicExchange(&flux[words * (planes.scratch + texel) + word], 0u);
        if wins { atomicStore(&flux[words * (r.map_offset + texel) + word], sum); }
    }
}
