// Deposit — how much light lands where? One invocation per water cell: its two beams are laid on their receiver's map. Beams that
// straddle receivers go to the split queue, footprints of very many texels to the wide queue; where a queue is full the
// invocation does the work itself, so nothing is lost.
#import "lib/attenuation.wgsl"
#import "lib/coverage.wgsl"
#import "shared/light.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/flux.wgsl"
#import "shared/footprint.wgsl"
#import "shared/beam_triangle.wgsl"
#import "shared/grid_beam.wgsl"
#import "shared/account.wgsl"

// Queues: words 0–2 are the workgroups of the pass that empties them, then the items.
@group(0) @binding(6) var<storage, read_write> split_queue: array<atomic<u32>>; // beam index
@group(0) @binding(7) var<storage, read_write> wide_queue: array<atomic<u32>>;  // beam index, slice

const QUEUE_HEAD: u32 = 3u;
const SLICE_TEXELS: u32 = 4096u;

fn push_split(beam_index: u32) -> bool {
    let slot = atomicAdd(&split_queue[0], 1u);
    if slot >= light.queue_capacity {
        atomicSub(&split_queue[0], 1u);
        return false;
    }
    atomicStore(&split_queue[QUEUE_HEAD + slot], beam_index);
    return true;
}

fn push_wide(beam_index: u32, slice: u32) -> bool {
    let slot = atomicAdd(&wide_queue[0], 1u);
    if slot >= light.queue_capacity {
        atomicSub(&wide_queue[0], 1u);
        return false;
    }
    atomicStore(&wide_queue[QUEUE_HEAD + 2u * slot], beam_index);
    atomicStore(&wide_queue[QUEUE_HEAD + 2u * slot + 1u], slice);
    return true;
}

// Texels (border cells included) that a footprint's box covers: first texel, then extent.
struct TexelBox {
    first: vec2i,
    extent: vec2i,
}

fn texel_box(r: Receiver, b: Beam) -> TexelBox {
    let limit = vec2f(f32(r.map_width), f32(r.map_height));
    let low = min(b.uv[0], min(b.uv[1], b.uv[2]));
    let high = max(b.uv[0], max(b.uv[1], b.uv[2]));
    let first = vec2i(floor(clamp(low, vec2f(-1.0), limit)));
    return TexelBox(first, vec2i(floor(clamp(high, vec2f(-1.0), limit))) - first + 1);
}

fn is_segment(b: Beam) -> bool {
    let p = b.uv[1] - b.uv[0];
    let q = b.uv[2] - b.uv[0];
    let side2 = max(dot(p, p), max(dot(q, q), dot(q - p, q - p)));
    return abs(p.x * q.y - p.y * q.x) < SEGMENT_SHAPE * side2;
}

fn deposit_beam(cell: vec2u, half: u32) {
    let b = grid_beam(cell, half);
    if b.flux_m2 == 0.0 { return; }
    note_term(TERM_EMITTED, b.flux_m2);
    note_term(TERM_REFLECTED, b.flux_m2 - b.transmitted_m2);
    if b.transmitted_m2 == 0.0 { return; }
    let beam_index = 2u * (cell.y * light.cells + cell.x) + half;
    if !is_whole(b) {
        if light.split_levels == 0u || !push_split(beam_index) { note_losses(deposit_torn(b)); }
        return;
    }
    if b.receiver.x == NO_RECEIVER {
        note_term(TERM_MISSED, b.transmitted_m2);
        return;
    }
    let box = texel_box(receivers[b.receiver.x], b);
    let texels = u32(box.extent.x) * u32(box.extent.y);
    if texels > light.wide_texels && !is_segment(b) {
        let slices = (texels + SLICE_TEXELS - 1u) / SLICE_TEXELS;
        var pushed = 0u;
        while pushed < slices && push_wide(beam_index, pushed) { pushed++; }
        let arriving = b.transmitted_m2 * mean_transmission(b.t);
        var losses = Losses(0.0, b.transmitted_m2 * mean_extinction(b.t), vec3f(0.0));
        if pushed < slices {
            losses.left = arriving * deposit_texels(b, arriving, pushed * SLICE_TEXELS, texels, 1u);
        }
        note_losses(losses);
        return;
    }
    note_losses(deposit_whole(b));
}

// Deposits texels `first`, `first + stride` … below `end` of a wide footprint's box; returns the share beside the map.
fn deposit_texels(b: Beam, arriving: vec3f, first: u32, end: u32, stride: u32) -> f32 {
    let r = receivers[b.receiver.x];
    let target_map = target_of(r);
    let size = vec2i(target_map.width, target_map.height);
    let box = texel_box(r, b);
    let base = vec2f(box.first);
    let p = b.uv[0] - base;
    let q = b.uv[1] - base;
    let s = b.uv[2] - base;
    let low = min(p, min(q, s));
    let high = max(p, max(q, s));
    let per_area = 2.0 / ((q.x - p.x) * (s.y - p.y) - (q.y - p.y) * (s.x - p.x));
    var beside = 0.0;
    for (var i = first; i < end; i += stride) {
        let texel = box.first + vec2i(i32(i) % box.extent.x, i32(i) / box.extent.x);
        let row = cell_bounds(texel.y, size.y, base.y, low.y, high.y);
        let column = cell_bounds(texel.x, size.x, base.x, low.x, high.x);
        let edges = clip_to_row(p, q, s, row.x, row.y);
        if column.y < row_low(edges) || column.x > row_high(edges) { continue; }
        // Counted from the texel itself and cut off behind it, a long edge costs no digits.
        let share = max(area_within(moved(edges, column.x), column.y - column.x) * per_area, 0.0);
        beside += deposit_share(target_map, texel.x, texel.y, share, arriving);
    }
    return beside;
}

@compute @workgroup_size(64)
fn deposit_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let cell = group.xy * 8u + vec2u(invocation & 7u, invocation >> 3u);
    if all(cell < vec2u(light.cells)) {
        deposit_beam(cell, 0u);
        deposit_beam(cell, 1u);
    }
    workgroupBarrier();
    flush_account(invocation);
}

// One workgroup per slice of a wide footprint.
@compute @workgroup_size(64)
fn deposit_wide(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let item = QUEUE_HEAD + 2u * group.x;
    let beam_index = atomicLoad(&wide_queue[item]);
    let slice = atomicLoad(&wide_queue[item + 1u]);
    let cell_index = beam_index >> 1u;
    let b = grid_beam(vec2u(cell_index % light.cells, cell_index / light.cells), beam_index & 1u);
    let arriving = b.transmitted_m2 * mean_transmission(b.t);
    let box = texel_box(receivers[b.receiver.x], b);
    let texels = u32(box.extent.x) * u32(box.extent.y);
    let end = min((slice + 1u) * SLICE_TEXELS, texels);
    let beside = deposit_texels(b, arriving, slice * SLICE_TEXELS + invocation, end, 64u);
    note_losses(Losses(0.0, vec3f(0.0), arriving * beside));
    workgroupBarrier();
    flush_account(invocation);
}
