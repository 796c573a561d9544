// Depth profile — the planes of an object that have a surface near them (Tipprasert 2006, §4.7.2). A level is the acceptance interval of a
// plane. Levels without a texel are dropped; adjacent valid levels form a piece of the box. A piece of m levels is m plane distances high,
// and with ε half a plane distance eq. 4-22 gives it m planes: those in the middle of its levels.
#import "lib/slicing.wgsl"
#import "shared/planes_uniform.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/reference_planes.wgsl"

// Per object: number of used planes, number of pieces of the box, two unused words, then the planes in order, then texels per level, then
// per tile of TILE² texels the first and the last plane that accept one of its texels, in 16 bits each.
@group(0) @binding(18) var<storage, read_write> plane_lists: array<atomic<u32>>;

const LIST_HEAD: u32 = 4u;
const MOST_PLANES: u32 = 1024u;
const TEXELS_EACH: u32 = 16u;
const TILE: u32 = 4u;

var<workgroup> counts: array<atomic<u32>, MOST_PLANES>;

// The histogram: one invocation counts TEXELS_EACH texels.
@compute @workgroup_size(64)
fn profile_count(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let r = receivers[planes.receiver];
    let texels = r.map_width * r.map_height;
    let first = (group.y * groups.x + group.x) * (64u * TEXELS_EACH) + invocation;
    for (var i = 0u; i < TEXELS_EACH; i++) {
        let texel = first + 64u * i;
        if texel >= texels { break; }
        let plane = plane_of_texel(r, vec2i(i32(texel % r.map_width), i32(texel / r.map_width)));
        if plane >= 0 { atomicAdd(&counts[plane], 1u); }
    }
    workgroupBarrier();
    for (var level = invocation; level < planes.planes; level += 64u) {
        let count = atomicLoad(&counts[level]);
        if count > 0u { atomicAdd(&plane_lists[planes.list + LIST_HEAD + planes.planes + level], count); }
    }
}

// The list, in order: a single invocation, so that the order is always the same.
@compute @workgroup_size(1)
fn profile_compact() {
    var used = 0u;
    var pieces = 0u;
    var before = false;
    for (var level = 0u; level < planes.planes; level++) {
        let valid = planes.smart == 0u || atomicLoad(&plane_lists[planes.list + LIST_HEAD + planes.planes + level]) > 0u;
        if valid {
            atomicStore(&plane_lists[planes.list + LIST_HEAD + used], level);
            used += 1u;
            if !before { pieces += 1u; }
        }
        before = valid;
    }
    atomicStore(&plane_lists[planes.list], used);
    atomicStore(&plane_lists[planes.list + 1u], pieces);
}

// The planes near each tile, one invocation per tile: beams are tested only against these.
@compute @workgroup_size(8, 8)
fn profile_tiles(@builtin(global_invocation_id) id: vec3u) {
    let r = receivers[planes.receiver];
    let side = r.map_width / TILE;
    if id.x >= side || id.y >= side { return; }
    var first = MOST_PLANES;
    var last = 0u;
    for (var i = 0u; i < TILE * TILE; i++) {
        let plane = plane_of_texel(r, vec2i(TILE * id.xy + vec2u(i % TILE, i / TILE)));
        if plane >= 0 {
            first = min(first, u32(plane));
            last = max(last, u32(plane));
        }
    }
    let tile = planes.list + LIST_HEAD + 2u * planes.planes + id.y * side + id.x;
    atomicStore(&plane_lists[tile], first | (last << 16u));
}
