// Selects the beams that may reach an object's planes (the thesis's own next step, Tipprasert 2006, §6.1), so that the cost of
// planes × beams is only paid for these beams.
//
// The queue's head holds two dispatches with their counts: of beams with narrow footprints, queued from the front, and of beams with wide
// footprints, queued from the back.

@group(0) @binding(17) var<storage, read_write> beam_queue: array<atomic<u32>>;

const CULL_HEAD: u32 = 8u;
const NARROW_COUNT: u32 = 3u;
const WIDE_COUNT: u32 = 7u;
// Workgroups that share one wide footprint.
const WIDE_GROUPS: u32 = 16u;
const CULL_GROUP: u32 = 64u;
const MOST_CULL_GROUPS: u32 = 65535u;

// The intersection of a beam with a plane.
struct Crossing {
    uv: mat3x2f,  // corners, texels
    t: vec3f,     // path lengths, m
    meets: bool,  // whether all rays go down through the plane, under water
}

// A beam's rays in the map space of a receiver.
struct MapRays {
    origin: mat3x3f,
    direction: mat3x3f,
}

fn map_rays(b: Beam, r: Receiver) -> MapRays {
    var rays: MapRays;
    for (var k = 0; k < 3; k++) {
        rays.origin[k] = to_map(r, b.origin[k]);
        rays.direction[k] = direction_to_map(r, b.direction[k]);
    }
    return rays;
}

fn cross_plane(rays: MapRays, r: Receiver, s: f32) -> Crossing {
    var c: Crossing;
    c.meets = true;
    var sum = 0.0;
    for (var k = 0; k < 3; k++) {
        let o = rays.origin[k];
        let d = rays.direction[k];
        let down = goes_down(r, d);
        let t = select(0.0, (s - o.z) / d.z, down);
        c.uv[k] = (o + d * t).xy;
        c.t[k] = max(t, 0.0);
        c.meets = c.meets && down;
        sum += t;
    }
    // If a plane cuts the water surface, it takes the beams whose mean start is above it.
    c.meets = c.meets && sum >= 0.0;
    return c;
}

// One invocation per water cell. Tests the beam's bounds between the first and the last plane against the map. Its triangle's extent on
// the planes in between is at most the larger of the two.
fn cull_beam(cell: vec2u, half: u32) {
    let b = grid_rays(cell, half);
    if b.transmitted == 0.0 { return; }
    let r = receivers[planes.receiver];
    let rays = map_rays(b, r);
    let first = cross_plane(rays, r, r.s_min);
    let last = cross_plane(rays, r, r.s_max);
    if !last.meets { return; }
    let low_first = min(first.uv[0], min(first.uv[1], first.uv[2]));
    let high_first = max(first.uv[0], max(first.uv[1], first.uv[2]));
    let low_last = min(last.uv[0], min(last.uv[1], last.uv[2]));
    let high_last = max(last.uv[0], max(last.uv[1], last.uv[2]));
    let side = vec2f(f32(r.map_width), f32(r.map_height));
    if any(max(high_first, high_last) < vec2f(0.0)) || any(min(low_first, low_last) > side) { return; }
    let extent = min(max(high_first - low_first, high_last - low_last), side) + 2.0;
    let beam_index = 2u * (cell.y * light.cells + cell.x) + half;
    if extent.x * extent.y > f32(light.wide_texels) {
        let slot = atomicAdd(&beam_queue[WIDE_COUNT], 1u);
        atomicStore(&beam_queue[CULL_HEAD + planes.capacity - 1u - slot], beam_index);
    } else {
        let slot = atomicAdd(&beam_queue[NARROW_COUNT], 1u);
        atomicStore(&beam_queue[CULL_HEAD + slot], beam_index);
    }
}

fn narrow_beam(item: u32) -> Beam {
    return numbered_rays(atomicLoad(&beam_queue[CULL_HEAD + item]));
}

fn wide_beam(item: u32) -> Beam {
    return numbered_rays(atomicLoad(&beam_queue[CULL_HEAD + planes.capacity - 1u - item]));
}

// Number of selected beams.
fn kept_beams() -> u32 {
    return atomicLoad(&beam_queue[NARROW_COUNT]) + atomicLoad(&beam_queue[WIDE_COUNT]);
}

// Writes the dispatches over the queue. Along y they have `narrow_planes` groups of planes for narrow beams and `wide_planes` for wide
// ones.
fn share_out(narrow_planes: u32, wide_planes: u32) {
    let narrow = atomicLoad(&beam_queue[NARROW_COUNT]);
    let wide = atomicLoad(&beam_queue[WIDE_COUNT]);
    atomicStore(&beam_queue[0], min((narrow + CULL_GROUP - 1u) / CULL_GROUP, MOST_CULL_GROUPS));
    atomicStore(&beam_queue[1], narrow_planes);
    atomicStore(&beam_queue[2], 1u);
    atomicStore(&beam_queue[4], min(wide, MOST_CULL_GROUPS));
    atomicStore(&beam_queue[5], wide_planes);
    atomicStore(&beam_queue[6], WIDE_GROUPS);
}

@compute @workgroup_size(1)
fn cull_reset() {
    for (var word = 0u; word < CULL_HEAD; word++) { atomicStore(&beam_queue[word], 0u); }
}

@compute @workgroup_size(64)
fn cull_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let cell = group.xy * 8u + vec2u(invocation & 7u, invocation >> 3u);
    if any(cell >= vec2u(light.cells)) { return; }
    cull_beam(cell, 0u);
    cull_beam(cell, 1u);
}
