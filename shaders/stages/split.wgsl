// Split — one halving of the beams whose corners end on different receivers: three more rays, at the middles of the sides, make four parts
// of each. Parts that end on one receiver are deposited there. Parts that still straddle are queued for the next halving; after the last
// halving they are unresolved pieces, whose flux is shared by the receivers of their corners. One invocation per queued beam or part.
#import "lib/turns.wgsl"
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/attenuation.wgsl"
#import "lib/slicing.wgsl"
#import "lib/coverage.wgsl"
#import "lib/octahedral.wgsl"
#import "lib/solid_angle.wgsl"
#import "shared/light.wgsl"
#import "shared/entry.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/reference_planes.wgsl"
#import "shared/trace_light.wgsl"
#import "shared/flux.wgsl"
#import "shared/deposit_share.wgsl"
#import "shared/footprint.wgsl"
#import "shared/wide_footprint.wgsl"
#import "shared/beam.wgsl"
#import "shared/beam_triangle.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid.wgsl"
#import "shared/account.wgsl"
#import "shared/queue.wgsl"

struct Split {
    level: u32,        // number of halvings of the parts made here; 0: beams are not halved
    source: u32,       // first word of the queued beams or parts
    destination: u32,  // first word of the parts queued for the next level
    capacity: u32,     // number of parts that fit there
    wide: u32,         // first word of the queued wide footprints
    wide_capacity: u32,
    pad_0: u32,
    pad_1: u32,
}

@group(0) @binding(6) var<storage, read_write> split_queue: array<atomic<u32>>;
@group(0) @binding(7) var<uniform> split: Split;

// Largest deviation of the depth half way between two points from their mean, as a share of their difference in depth, that counts as
// smooth; at a step it is 0.5.
const SMOOTH_SHARE: f32 = 0.25;

// Start and hit of a ray.
struct Corner {
    origin: vec3f,
    direction: vec3f,
    transmittance: f32,
    hit: Hit,
}

fn corner_at(cells: vec2f) -> Corner {
    var c: Corner;
    var water = vec3f(0.0);
    if light.kind != SUBMERGED { water = water_surface_at(vertex_m(cells)); }
    let entry = entry_at(cells, water);
    c.origin = entry.origin;
    c.direction = entry.direction;
    c.transmittance = entry.transmittance;
    c.hit = trace_light(c.origin, c.direction, light.object_count, light.has_floor == 1u);
    return c;
}

// Corners, in cells, of a part of a beam. `path` has two bits per halving, the first halving's highest: the part at one of the corners
// (0 … 2) or the middle part (3). Fractions are dyadic, so that neighbours get identical corners to the bit.
fn part_corners(beam_index: u32, path: u32, level: u32) -> mat3x2f {
    let cell_index = beam_index >> 1u;
    let cell = vec2u(cell_index % light.cells, cell_index / light.cells);
    let corners = beam_corners(cell, beam_index & 1u);
    var c = mat3x2f(
        vec2f(cell + corner_of(corners, 0u)),
        vec2f(cell + corner_of(corners, 1u)),
        vec2f(cell + corner_of(corners, 2u)));
    for (var l = level; l > 0u; l--) {
        let k = (path >> (2u * l - 2u)) & 3u;
        let sum = c[0] + c[1] + c[2];
        if k == 3u {
            c = mat3x2f((sum - c[0]) * 0.5, (sum - c[1]) * 0.5, (sum - c[2]) * 0.5);
        } else {
            let kept = select(select(c[0], c[1], k == 1u), c[2], k == 2u);
            c = mat3x2f((c[0] + kept) * 0.5, (c[1] + kept) * 0.5, (c[2] + kept) * 0.5);
        }
    }
    return c;
}

// Index of corner `j` of part `k` among the six points: three corners, then the middles of the sides opposite to them.
fn point_of(k: u32, j: u32) -> u32 {
    if split.level == 0u { return j; }
    if k == 3u { return 3u + j; }
    return select(6u - j - k, k, j == k);
}

fn part_of(points: ptr<function, array<Corner, 6>>, k: u32) -> Beam {
    var b: Beam;
    var transmittance = 0.0;
    for (var j = 0u; j < 3u; j++) {
        let c = (*points)[point_of(k, j)];
        b.origin[j] = c.origin;
        b.direction[j] = c.direction;
        b.uv[j] = c.hit.uv;
        b.t[j] = c.hit.t;
        b.receiver[j] = c.hit.receiver;
        transmittance += c.transmittance;
    }
    b.unit_flux = triangle_unit_flux(b.origin, b.direction);
    b.transmitted = b.unit_flux * (transmittance / 3.0);
    return b;
}

// The receiver and footprint of a part's light. A resolved part has one. In an unresolved piece each corner carries a third of the flux to
// its own receiver, over the footprint that the whole part has at that depth.
struct Piece {
    receiver: i32,  // NO_RECEIVER: it hits none
    uv: mat3x2f,
    lengths_m: vec3f,
}

fn piece_of(b: Beam, k: i32, is_unresolved: bool) -> Piece {
    var piece = Piece(b.receiver[k], b.uv, b.t);
    if b.receiver[k] == NO_RECEIVER || (!is_unresolved && hits_nothing(b)) {
        piece.receiver = NO_RECEIVER;
        return piece;
    }
    if !is_unresolved { return piece; }
    piece.lengths_m = vec3f(b.t[k]);
    let r = receivers[b.receiver[k]];
    for (var corner = 0; corner < 3; corner++) {
        var t = b.t[k];
        if b.receiver[k] == FLOOR {
            let own = floor_distance(r, b.origin[corner], b.direction[corner]);
            t = select(t, own, own >= 0.0);
        }
        piece.uv[corner] = map_uv(r, b.origin[corner], b.direction[corner], t);
    }
    return piece;
}

// The second word of a queued footprint: the path with 2 bits per halving, then from bit 16 on the number of halvings (4 bits), whether it
// is unresolved (1 bit), and its corner (2 bits). The first word is the beam.
fn wide_word(path: u32, level: u32, is_unresolved: bool, k: i32) -> u32 {
    return path | (level << 16u) | (u32(is_unresolved) << 20u) | (u32(k) << 21u);
}

// Queues a wide footprint; false if there is no room left.
fn push_wide(beam_index: u32, word: u32) -> bool {
    let slot = atomicAdd(&split_queue[SPLIT_WIDE_COUNT], 1u);
    if slot >= split.wide_capacity { return false; }
    let at = split.wide + 2u * slot;
    atomicStore(&split_queue[at], beam_index);
    atomicStore(&split_queue[at + 1u], word);
    atomicMax(&split_queue[SPLIT_WIDE_GROUPS], min(slot + 1u, MOST_GROUPS));
    atomicMax(&split_queue[SPLIT_WIDE_GROUPS + 1u], SPLIT_WIDE_SHARE);
    atomicMax(&split_queue[SPLIT_WIDE_GROUPS + 2u], 1u);
    return true;
}

// Deposits the part of a beam that `path` and `level` identify. There is only one call that deposits, see `deposit_row`.
fn deposit_part(b: Beam, is_unresolved: bool, beam_index: u32, path: u32, level: u32) -> Losses {
    var losses = NO_LOSSES;
    let pieces = select(1, 3, is_unresolved);
    let flux = b.transmitted / f32(pieces);
    for (var k = 0; k < pieces; k++) {
        let piece = piece_of(b, k, is_unresolved);
        if piece.receiver == NO_RECEIVER {
            losses.missed += flux;
            continue;
        }
        if PLANES && piece.receiver > FLOOR { continue; }
        let target_map = target_of(receivers[piece.receiver]);
        let arriving = flux * mean_transmission(piece.lengths_m);
        losses.extinguished += flux * mean_extinction(piece.lengths_m);
        if target_map.offset == NOWHERE {
            losses.landed += arriving;
            continue;
        }
        let box = texel_box(target_map, piece.uv[0], piece.uv[1], piece.uv[2]);
        let extent = vec2u(box.last - box.first + 1);
        if extent.x * extent.y > light.wide_texels && push_wide(beam_index, wide_word(path, level, is_unresolved, k)) { continue; }
        losses.left += arriving * deposit_triangle(target_map, piece.uv[0], piece.uv[1], piece.uv[2], arriving);
    }
    return losses;
}

fn push_part(beam_index: u32, path: u32) {
    let slot = atomicAdd(&split_queue[QUEUE_COUNT + split.level], 1u);
    let word = split.destination + 2u * slot;
    atomicStore(&split_queue[word], beam_index);
    atomicStore(&split_queue[word + 1u], path);
    atomicMax(&split_queue[0], min(slot / SPLIT_GROUP + 1u, MOST_GROUPS));
}

// Whether all six points lie on one smooth part of a mesh: then the depth at the middle of each side is about the mean of its ends. Across a
// step the middle is as deep as one of the ends. This distinguishes a steep face from a step at the first halving; the slope cannot.
fn is_smooth(points: ptr<function, array<Corner, 6>>) -> bool {
    let receiver = (*points)[0].hit.receiver;
    for (var i = 0u; i < 3u; i++) {
        let a = (*points)[(i + 1u) % 3u].hit;
        let b = (*points)[(i + 2u) % 3u].hit;
        let middle = (*points)[3u + i].hit;
        if a.receiver != receiver || middle.receiver != receiver { return false; }
        if abs(middle.t - 0.5 * (a.t + b.t)) > SMOOTH_SHARE * abs(a.t - b.t) + 1e-5 { return false; }
    }
    return receiver > FLOOR;
}

// Halves one beam or part. Losses are noted one by one: float sums over several parts would depend on the queue's order.
fn halve(beam_index: u32, path: u32, is_last: bool) {
    let above = max(split.level, 1u) - 1u;
    let c = part_corners(beam_index, path, above);
    let sum = c[0] + c[1] + c[2];
    var points: array<Corner, 6>;
    let is_whole_beam = split.level == 0u;
    for (var i = 0u; i < select(6u, 3u, is_whole_beam); i++) {
        let own = c[i % 3u];
        points[i] = corner_at(select(own, (sum - own) * 0.5, i >= 3u));
    }
    let one_piece = !PLANES && !is_whole_beam && is_smooth(&points);
    for (var k = 0u; k < select(4u, 1u, is_whole_beam); k++) {
        let b = part_of(&points, k);
        let straddles = !one_piece && !is_whole(b);
        if straddles && !is_last {
            push_part(beam_index, 4u * path + k);
            continue;
        }
        note_term(TERM_EMITTED, b.unit_flux);
        note_term(TERM_REFLECTED, b.unit_flux - b.transmitted);
        if b.transmitted == 0.0 { continue; }
        if straddles {
            add_energy(TERM_UNRESOLVED, b.transmitted * light.energy_scale);
            atomicAdd(&energy[2u * TERM_UNRESOLVED_COUNT], 1u);
            if split.level < light.split_levels { add_energy(TERM_CUT, b.transmitted * light.energy_scale); }
        }
        let own_path = select(4u * path + k, 0u, is_whole_beam);
        note_losses(deposit_part(b, straddles, beam_index, own_path, split.level));
    }
}

@compute @workgroup_size(64)
fn split_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let above = max(split.level, 1u) - 1u;
    // A part has 4^−level of a beam's flux, and a workgroup at most 256 of them (twice that for the parts of whole beams).
    finer = min(f32(1u << (2u * above)), light.energy_scale / light.triangle_scale);
    is_direct = light.kind == POINT;
    let count = atomicLoad(&split_queue[QUEUE_COUNT + above]);
    // Whether the next level fits is decided from this level's count before anything is queued, so that the same pieces stay unresolved in
    // every run.
    let is_last = split.level >= light.split_levels || count > split.capacity / 4u;
    for (var item = group.x * SPLIT_GROUP + invocation; item < count; item += groups.x * SPLIT_GROUP) {
        if above == 0u {
            halve(atomicLoad(&split_queue[split.source + item]), 0u, is_last);
        } else {
            let word = split.source + 2u * item;
            halve(atomicLoad(&split_queue[word]), atomicLoad(&split_queue[word + 1u]), is_last);
        }
    }
    workgroupBarrier();
    flush_account(invocation);
}

// Several workgroups (along y) per wide footprint (along x), as in `deposit_wide`. Runs with `split.level` 0, so that part_of() takes the
// three corners as they are.
@compute @workgroup_size(64)
fn split_wide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let count = min(atomicLoad(&split_queue[SPLIT_WIDE_COUNT]), split.wide_capacity);
    let lane = group.y * 64u + invocation;
    for (var item = group.x; item < count; item += groups.x) {
        let beam_index = atomicLoad(&split_queue[split.wide + 2u * item]);
        let word = atomicLoad(&split_queue[split.wide + 2u * item + 1u]);
        let c = part_corners(beam_index, word & 0xffffu, (word >> 16u) & 15u);
        var points: array<Corner, 6>;
        for (var i = 0u; i < 3u; i++) { points[i] = corner_at(c[i]); }
        let b = part_of(&points, 0u);
        let is_unresolved = ((word >> 20u) & 1u) == 1u;
        let piece = piece_of(b, i32((word >> 21u) & 3u), is_unresolved);
        let target_map = target_of(receivers[piece.receiver]);
        let arriving = b.transmitted / select(1.0, 3.0, is_unresolved) * mean_transmission(piece.lengths_m);
        var beside = 0.0;
        if is_segment(piece.uv[0], piece.uv[1], piece.uv[2]) {
            if lane == 0u { beside = deposit_segment(target_map, piece.uv[0], piece.uv[1], piece.uv[2], arriving); }
        } else {
            beside = deposit_texels(target_map, piece.uv, arriving, lane, groups.y * 64u);
        }
        if beside > 0.0 {
            for (var channel = 0u; channel < light.channels; channel++) {
                add_energy(TERM_LEFT + channel, arriving[channel] * beside * light.energy_scale);
            }
        }
    }
}
