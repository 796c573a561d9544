// Deposit — adds the flux of beams to the receivers' maps. One invocation per water cell, which deposits the cell's two beams. Beams that
// straddle receivers go to the split queue, footprints of very many texels or without area to the wide queue.
#import "lib/attenuation.wgsl"
#import "lib/coverage.wgsl"
#import "lib/solid_angle.wgsl"
#import "shared/light.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/flux.wgsl"
#import "shared/deposit_share.wgsl"
#import "shared/footprint.wgsl"
#import "shared/wide_footprint.wgsl"
#import "shared/beam.wgsl"
#import "shared/beam_triangle.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid.wgsl"
#import "shared/grid_rays.wgsl"
#import "shared/grid_beam.wgsl"
#import "shared/account.wgsl"
#import "shared/cell_account.wgsl"
#import "shared/queue.wgsl"

@group(0) @binding(6) var<storage, read_write> split_queue: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> wide_queue: array<atomic<u32>>;

fn push_split(beam_index: u32) {
    let slot = atomicAdd(&split_queue[QUEUE_COUNT], 1u);
    atomicStore(&split_queue[SPLIT_HEAD + slot], beam_index);
    atomicMax(&split_queue[0], min(slot / SPLIT_GROUP + 1u, MOST_GROUPS));
}

fn push_wide(beam_index: u32) {
    let slot = atomicAdd(&wide_queue[QUEUE_COUNT], 1u);
    atomicStore(&wide_queue[QUEUE_HEAD + slot], beam_index);
    atomicMax(&wide_queue[0], min(slot + 1u, MOST_GROUPS));
}

struct CellSums {
    emitted: f32,
    reflected: f32,
    losses: Losses,
}

fn deposit_beam(cell: vec2u, half: u32) -> CellSums {
    let b = grid_beam(cell, half);
    var sums = CellSums(b.unit_flux, b.unit_flux - b.transmitted, NO_LOSSES);
    let beam_index = 2u * (cell.y * light.cells + cell.x) + half;
    if b.transmitted == 0.0 { return sums; }
    if !is_whole(b) {
        // The split pass accounts for its parts, because their water surface differs slightly from the beam's.
        push_split(beam_index);
        return CellSums(0.0, 0.0, sums.losses);
    }
    if hits_nothing(b) {
        sums.losses.missed = b.transmitted;
        return sums;
    }
    // With reference planes another pass lights the meshes.
    if PLANES && b.receiver.x > FLOOR { return sums; }
    sums.losses.extinguished = b.transmitted * mean_extinction(b.t);
    let arriving = b.transmitted * mean_transmission(b.t);
    let target_map = target_of(receivers[b.receiver.x]);
    if target_map.offset == NOWHERE {
        sums.losses.landed = arriving;
        return sums;
    }
    let box = texel_box(target_map, b.uv[0], b.uv[1], b.uv[2]);
    let extent = vec2u(box.last - box.first + 1);
    if extent.x * extent.y > light.wide_texels || is_segment(b.uv[0], b.uv[1], b.uv[2]) {
        push_wide(beam_index);
        return sums;
    }
    sums.losses.left = arriving * deposit_area(target_map, b.uv[0], b.uv[1], b.uv[2], arriving);
    return sums;
}

@compute @workgroup_size(64)
fn deposit_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let cell = group.xy * 8u + vec2u(invocation & 7u, invocation >> 3u);
    var emitted = 0.0;
    var reflected = 0.0;
    var losses = NO_LOSSES;
    if all(cell < vec2u(light.cells)) {
        for (var half = 0u; half < 2u; half++) {
            let sums = deposit_beam(cell, half);
            emitted += sums.emitted;
            reflected += sums.reflected;
            losses.missed += sums.losses.missed;
            losses.extinguished += sums.losses.extinguished;
            losses.left += sums.losses.left;
            losses.landed += sums.losses.landed;
        }
    }
    // The flux of cells differs by many powers of ten: for a near light between near and far cells, for a low sun by slope.
    atomicMax(&largest, bitcast<u32>(emitted));
    workgroupBarrier();
    finer = finer_for(bitcast<f32>(atomicLoad(&largest)));
    note_term(TERM_EMITTED, emitted);
    note_term(TERM_REFLECTED, reflected);
    note_losses(losses);
    workgroupBarrier();
    flush_account(invocation);
}

// Several workgroups (along y) per wide or flat footprint (along x). Flux outside the map is added directly to the global sums, per lane and
// beam: a small share is far below the workgroup account's smallest count, and float sums over several beams would depend on the queue's
// order.
@compute @workgroup_size(64)
fn deposit_wide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let count = atomicLoad(&wide_queue[QUEUE_COUNT]);
    let lane = group.y * 64u + invocation;
    for (var item = group.x; item < count; item += groups.x) {
        let beam_index = atomicLoad(&wide_queue[QUEUE_HEAD + item]);
        let cell_index = beam_index >> 1u;
        let b = grid_beam(vec2u(cell_index % light.cells, cell_index / light.cells), beam_index & 1u);
        let arriving = b.transmitted * mean_transmission(b.t);
        let target_map = target_of(receivers[b.receiver.x]);
        var beside = 0.0;
        if is_segment(b.uv[0], b.uv[1], b.uv[2]) {
            if lane == 0u { beside = deposit_segment(target_map, b.uv[0], b.uv[1], b.uv[2], arriving); }
        } else {
            beside = deposit_texels(target_map, b.uv, arriving, lane, groups.y * 64u);
        }
        if beside > 0.0 {
            for (var channel = 0u; channel < light.channels; channel++) {
                add_energy(TERM_LEFT + channel, arriving[channel] * beside * light.energy_scale);
            }
        }
    }
}
