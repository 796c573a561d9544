// Planes — light on meshes by reference planes (Tipprasert 2006, §4.4, §4.5). Each beam's triangle on each plane lights the texels whose
// depth is within half a plane distance. One invocation per beam and PLANES_EACH consecutive planes; a plane is tested only if the level map
// has a surface near it under the beam.
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
#import "shared/flux.wgsl"
#import "shared/footprint.wgsl"
#import "shared/wide_footprint.wgsl"
#import "shared/beam.wgsl"
#import "shared/beam_triangle.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid.wgsl"
#import "shared/grid_rays.wgsl"
#import "shared/cull.wgsl"
#import "shared/account.wgsl"

// Per object: number of used planes, number of pieces of the box, two unused words, then the planes in order, then texels per level, then
// the planes near each tile; see depth_profile.wgsl.
@group(0) @binding(18) var<storage, read> plane_lists: array<u32>;
// Per object: beams kept, planes used, pieces of the box, beams with wide footprints.
@group(0) @binding(19) var<storage, read_write> plane_counts: array<vec4u>;

const LIST_HEAD: u32 = 4u;
const MOST_PLANES: u32 = 1024u;
const TILE: i32 = 4;
// Consecutive planes per invocation, which reads its beam once for all of them. 64 invocations × 4 planes × 2²³ counts fit the workgroup's
// account.
const PLANES_EACH: u32 = 4u;

// The texels that currently accept light: those of `accepting`'s level map that belong to plane `accepted`. `taken` is the share of the
// triangle that they took.
var<private> accepting: Receiver;
var<private> accepted: i32;
var<private> taken: f32;

// Adds `share` of the flux at texel (x, y) if the plane accepts it; returns the share that lies outside the map.
fn deposit_share(target_map: Target, x: i32, y: i32, share: f32, triangle_flux: vec3f) -> f32 {
    if x < 0 || y < 0 || x >= target_map.width || y >= target_map.height { return share; }
    if share <= 0.0 || plane_of_texel(accepting, vec2i(x, y)) != accepted { return 0.0; }
    taken += share;
    let texel = target_map.offset + u32(y * target_map.width + x);
    let counts = triangle_flux * (share * target_map.scale);
    add_flux(texel, 0u, target_map.channels, counts.x);
    if target_map.channels == 3u {
        add_flux(texel, 1u, 3u, counts.y);
        add_flux(texel, 2u, 3u, counts.z);
    }
    return 0.0;
}

@compute @workgroup_size(1)
fn planes_share_out() {
    let used = plane_lists[planes.list];
    share_out((used + PLANES_EACH - 1u) / PLANES_EACH, used);
    plane_counts[planes.object] = vec4u(kept_beams(), used, plane_lists[planes.list + 1u], atomicLoad(&beam_queue[WIDE_COUNT]));
}

// The first and the last plane that accept a texel between two crossings of a beam; first > last if there is none.
fn planes_between(r: Receiver, from_uv: mat3x2f, to_uv: mat3x2f) -> vec2u {
    var low = min(min(from_uv[0], min(from_uv[1], from_uv[2])), min(to_uv[0], min(to_uv[1], to_uv[2])));
    var high = max(max(from_uv[0], max(from_uv[1], from_uv[2])), max(to_uv[0], max(to_uv[1], to_uv[2])));
    // Crossings in between lie on straight lines, apart from rounding.
    let margin = 0.01 + 1e-5 * max(abs(low), abs(high));
    low -= margin;
    high += margin;
    let side = f32(r.map_width);
    if any(high < vec2f(0.0)) || any(low >= vec2f(side)) { return vec2u(MOST_PLANES, 0u); }
    let first = vec2i(clamp(low, vec2f(0.0), vec2f(side - 1.0))) / TILE;
    let last = vec2i(clamp(high, vec2f(0.0), vec2f(side - 1.0))) / TILE;
    let tiles = planes.list + LIST_HEAD + 2u * planes.planes;
    var near = vec2u(MOST_PLANES, 0u);
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let word = plane_lists[tiles + u32(y * (i32(r.map_width) / TILE) + x)];
            near = vec2u(min(near.x, word & 0xffffu), max(near.y, word >> 16u));
        }
    }
    return near;
}

@compute @workgroup_size(64)
fn planes_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    accepting = receivers[planes.receiver];
    let list = planes.list + LIST_HEAD;
    let first = group.y * PLANES_EACH;
    let end = min(first + PLANES_EACH, plane_lists[planes.list]);
    let s_first = plane_s(accepting, plane_lists[list + first]);
    let s_last = plane_s(accepting, plane_lists[list + end - 1u]);
    let count = atomicLoad(&beam_queue[NARROW_COUNT]);
    for (var item = group.x * CULL_GROUP + invocation; item < count; item += groups.x * CULL_GROUP) {
        let b = narrow_beam(item);
        let rays = map_rays(b, accepting);
        let c_first = cross_plane(rays, accepting, s_first);
        let c_last = cross_plane(rays, accepting, s_last);
        if !c_last.meets { continue; }
        let near = planes_between(accepting, c_first.uv, c_last.uv);
        for (var i = first; i < end; i++) {
            let plane = plane_lists[list + i];
            if plane < near.x || plane > near.y { continue; }
            let c = cross_plane(rays, accepting, plane_s(accepting, plane));
            if !c.meets { continue; }
            accepted = i32(plane);
            taken = 0.0;
            let arriving = b.transmitted * mean_transmission(c.t);
            deposit_triangle(target_of(accepting), c.uv[0], c.uv[1], c.uv[2], arriving);
            if ATTENUATES { note_losses(Losses(0.0, taken * b.transmitted * mean_extinction(c.t), vec3f(0.0), vec3f(0.0))); }
        }
    }
    workgroupBarrier();
    flush_account(invocation);
}

// Several workgroups (along z) per wide footprint (along x) and plane (along y). Extinguished flux is added directly to the global sums, as
// in deposit.wgsl.
@compute @workgroup_size(64)
fn planes_wide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    accepting = receivers[planes.receiver];
    let plane = plane_lists[planes.list + LIST_HEAD + group.y];
    accepted = i32(plane);
    let s = plane_s(accepting, plane);
    let count = atomicLoad(&beam_queue[WIDE_COUNT]);
    let lane = group.z * 64u + invocation;
    for (var item = group.x; item < count; item += groups.x) {
        let b = wide_beam(item);
        let c = cross_plane(map_rays(b, accepting), accepting, s);
        if !c.meets { continue; }
        taken = 0.0;
        let arriving = b.transmitted * mean_transmission(c.t);
        if is_segment(c.uv[0], c.uv[1], c.uv[2]) {
            if lane == 0u { deposit_segment(target_of(accepting), c.uv[0], c.uv[1], c.uv[2], arriving); }
        } else {
            deposit_texels(target_of(accepting), c.uv, arriving, lane, groups.z * 64u);
        }
        if ATTENUATES && taken > 0.0 {
            let lost = taken * b.transmitted * mean_extinction(c.t);
            for (var channel = 0u; channel < light.channels; channel++) {
                add_energy(TERM_EXTINGUISHED + channel, lost[channel] * light.energy_scale);
            }
        }
    }
}
