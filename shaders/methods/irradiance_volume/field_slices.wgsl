// Field slices — the light of all beams of a set on one horizontal slice: first sums of flux and of flux × drift per texel, then the kept field.
//
// Rays are cut with the slice as straight lines, also above their starts, so every beam has a footprint on every slice, and the slices in the
// waves, above some rays' starts, have all light too. Only the path under water attenuates.
#import "lib/attenuation.wgsl"
#import "lib/coverage.wgsl"
#import "lib/solid_angle.wgsl"
#import "shared/light.wgsl"
#import "shared/footprint.wgsl"
#import "shared/wide_footprint.wgsl"
#import "shared/beam.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid.wgsl"
#import "shared/grid_rays.wgsl"
#import "shared/account.wgsl"
#import "shared/cell_account.wgsl"
#import "shared/queue.wgsl"
#import "shared/light_fields.wgsl"

struct Slice {
    height_m: f32,
    index: u32,
    field: u32,          // number of the beam set
    sum_scale: f32,      // counts per unit flux in the sums
    density_per_flux: f32, // 1 / (area of a texel, m²)
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(1) var<uniform> slice: Slice;
// Per texel: flux per channel, then flux × drift along x and z; 64-bit sums of addends that fit 32 bits, (low, high).
@group(0) @binding(22) var<storage, read_write> slice_sums: array<atomic<u32>>;
@group(0) @binding(23) var<storage, read_write> slice_energy: array<atomic<u32>>;
@group(0) @binding(24) var<storage, read_write> slice_queue: array<atomic<u32>>;
@group(0) @binding(27) var<storage, read_write> light_field: array<u32>;

// Rays that fall less than a metre per kilometre are not cut: light's window leaves them out too.
const LEAST_FALL: f32 = 1e-3;
// Words of a slice's account.
const ACCOUNT_WORDS: u32 = 36u;
// Texels that one invocation finishes.
const TEXELS_EACH: u32 = 16u;

// Where the drift of the beam lies between −`most_drift` and `most_drift`: 0 … 1.
var<private> drift_share: vec2f;

fn add_sum(place: u32, counts: f32) {
    let low = u32(counts + 0.5);
    if low == 0u { return; }
    let before = atomicAdd(&slice_sums[2u * place], low);
    if before + low < before { atomicAdd(&slice_sums[2u * place + 1u], 1u); }
}

// Adds a share of a beam to a texel; returns the share that lies outside the box.
fn deposit_share(target_map: Target, x: i32, y: i32, share: f32, triangle_flux: vec3f) -> f32 {
    if x < 0 || y < 0 || x >= target_map.width || y >= target_map.height { return share; }
    let first = u32(y * target_map.width + x) * (light.channels + 2u);
    let counts = triangle_flux * (share * target_map.scale);
    add_sum(first, counts.x);
    var mean = counts.x;
    if light.channels == 3u {
        add_sum(first + 1u, counts.y);
        add_sum(first + 2u, counts.z);
        mean = (counts.x + counts.y + counts.z) / 3.0;
    }
    add_sum(first + light.channels, mean * drift_share.x);
    add_sum(first + light.channels + 1u, mean * drift_share.y);
    return 0.0;
}

// Adds `counts` (0 … 2⁶²) to a term of the slice's account.
fn add_energy(term: u32, counts: f32) {
    let place = slice.index * ACCOUNT_WORDS + 2u * term;
    let high = u32(floor(counts / 4294967296.0));
    let low = u32(clamp(counts - f32(high) * 4294967296.0, 0.0, 4294967040.0));
    let before = atomicAdd(&slice_energy[place], low);
    let carry = select(0u, 1u, before + low < before);
    if high + carry > 0u { atomicAdd(&slice_energy[place + 1u], high + carry); }
}

// The intersection of a beam with the slice.
struct Cut {
    uv: mat3x2f,  // corners, texels
    t: vec3f,     // path lengths under water, m
    drift: vec2f, // mean of its rays
    falls: bool,  // whether all its rays do
}

fn cut_of(b: Beam, f: LightField) -> Cut {
    var c: Cut;
    c.falls = true;
    for (var k = 0; k < 3; k++) {
        let d = b.direction[k];
        let falls = d.y < -LEAST_FALL;
        let t = select(0.0, (b.origin[k].y - slice.height_m) / -d.y, falls);
        c.uv[k] = (b.origin[k].xz + d.xz * t - f.min_m) * f.texels_per_m;
        c.t[k] = max(t, 0.0);
        c.drift += select(vec2f(0.0), d.xz / -d.y, falls) / 3.0;
        c.falls = c.falls && falls;
    }
    return c;
}

fn target_of(f: LightField) -> Target {
    return Target(0u, i32(f.width), i32(f.height), light.channels, slice.sum_scale);
}

fn set_drift(f: LightField, drift: vec2f) {
    drift_share = clamp(0.5 + drift / (2.0 * f.most_drift), vec2f(0.0), vec2f(1.0));
}

struct CellSums {
    emitted: f32,
    reflected: f32,
    losses: Losses,
}

fn cut_beam(cell: vec2u, half: u32) -> CellSums {
    let b = grid_rays(cell, half);
    var sums = CellSums(b.unit_flux, b.unit_flux - b.transmitted, NO_LOSSES);
    if b.transmitted == 0.0 { return sums; }
    let f = light_fields[slice.field];
    let c = cut_of(b, f);
    if !c.falls {
        sums.losses.missed = b.transmitted;
        return sums;
    }
    sums.losses.extinguished = b.transmitted * mean_extinction(c.t);
    let arriving = b.transmitted * mean_transmission(c.t);
    let target_map = target_of(f);
    let box = texel_box(target_map, c.uv[0], c.uv[1], c.uv[2]);
    let extent = vec2u(box.last - box.first + 1);
    if extent.x * extent.y > light.wide_texels || is_segment(c.uv[0], c.uv[1], c.uv[2]) {
        let place = atomicAdd(&slice_queue[QUEUE_COUNT], 1u);
        atomicStore(&slice_queue[QUEUE_HEAD + place], 2u * (cell.y * light.cells + cell.x) + half);
        atomicMax(&slice_queue[0], min(place + 1u, MOST_GROUPS));
        return sums;
    }
    set_drift(f, c.drift);
    sums.losses.left = arriving * deposit_area(target_map, c.uv[0], c.uv[1], c.uv[2], arriving);
    return sums;
}

// One invocation per water cell, in squares of 8 × 8.
@compute @workgroup_size(64)
fn slices_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let cell = group.xy * 8u + vec2u(invocation & 7u, invocation >> 3u);
    var emitted = 0.0;
    var reflected = 0.0;
    var losses = NO_LOSSES;
    if all(cell < vec2u(light.cells)) {
        for (var half = 0u; half < 2u; half++) {
            let sums = cut_beam(cell, half);
            emitted += sums.emitted;
            reflected += sums.reflected;
            losses.missed += sums.losses.missed;
            losses.extinguished += sums.losses.extinguished;
            losses.left += sums.losses.left;
        }
    }
    atomicMax(&largest, bitcast<u32>(emitted));
    workgroupBarrier();
    finer = finer_for(bitcast<f32>(atomicLoad(&largest)));
    note_term(TERM_EMITTED, emitted);
    note_term(TERM_REFLECTED, reflected);
    note_losses(losses);
    workgroupBarrier();
    flush_account(invocation);
}

// Whether a wide footprint covers a small part of its box, and is not so much larger than the slice that rounding of its rows would show. Steep
// waves make many such: row by row they cost only the texels that they cover.
fn is_sliver(target_map: Target, uv: mat3x2f) -> bool {
    let e1 = uv[1] - uv[0];
    let e2 = uv[2] - uv[0];
    let extent = max(uv[0], max(uv[1], uv[2])) - min(uv[0], min(uv[1], uv[2]));
    let is_near = all(extent < 4.0 * vec2f(f32(target_map.width), f32(target_map.height)));
    return is_near && 2.0 * abs(e1.x * e2.y - e1.y * e2.x) < extent.x * extent.y;
}

// Several workgroups (along y) per wide or flat footprint (along x).
@compute @workgroup_size(64)
fn slices_wide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let count = atomicLoad(&slice_queue[QUEUE_COUNT]);
    let lane = group.y * 64u + invocation;
    let f = light_fields[slice.field];
    let target_map = target_of(f);
    for (var item = group.x; item < count; item += groups.x) {
        let b = numbered_rays(atomicLoad(&slice_queue[QUEUE_HEAD + item]));
        let c = cut_of(b, f);
        let arriving = b.transmitted * mean_transmission(c.t);
        set_drift(f, c.drift);
        var beside = 0.0;
        if is_segment(c.uv[0], c.uv[1], c.uv[2]) {
            if lane == 0u { beside = deposit_segment(target_map, c.uv[0], c.uv[1], c.uv[2], arriving); }
        } else if is_sliver(target_map, c.uv) {
            let own = footprint_of(target_map, c.uv[0], c.uv[1], c.uv[2]);
            for (var y = own.box.first.y + i32(lane); y <= own.box.last.y; y += i32(groups.y * 64u)) {
                beside += deposit_row(target_map, own, y, arriving);
            }
        } else {
            beside = deposit_texels(target_map, c.uv, arriving, lane, groups.y * 64u);
        }
        if beside > 0.0 {
            for (var channel = 0u; channel < light.channels; channel++) {
                add_energy(TERM_LEFT + channel, arriving[channel] * beside * light.energy_scale);
            }
        }
    }
}

// Takes a sum and leaves 0 for the next slice.
fn taken(place: u32) -> vec2u {
    return vec2u(atomicExchange(&slice_sums[2u * place], 0u), atomicExchange(&slice_sums[2u * place + 1u], 0u));
}

fn counts_of(words: vec2u) -> f32 {
    return f32(words.y) * 4294967296.0 + f32(words.x);
}

// Drift of an undisturbed ray, about: for texels without light.
fn drift_at_rest(xz: vec2f) -> vec2f {
    var to_light = light.source.xyz;
    if light.kind != SUN { to_light = light.source.xyz - vec3f(xz.x, slice.height_m, xz.y); }
    let sine = to_light.xz * inverseSqrt(max(dot(to_light, to_light), 1e-30)) / light.ior;
    return -sine * inverseSqrt(max(1.0 - dot(sine, sine), 1e-6));
}

// Sums of the flux in 16-bit pieces, so that they stay integers, per channel.
var<workgroup> landed: array<array<vec4u, 3>, 64>;

// One workgroup per 64 × TEXELS_EACH texels. Finishes the slice: its part of the field, and the flux through it.
@compute @workgroup_size(64)
fn slices_finish(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let number = group.y * groups.x + group.x;
    let f = light_fields[slice.field];
    let texels = f.width * f.height;
    var own = array<vec4u, 3>(vec4u(0u), vec4u(0u), vec4u(0u));
    for (var i = 0u; i < TEXELS_EACH; i++) {
        let texel = (number * TEXELS_EACH + i) * 64u + invocation;
        if texel >= texels { break; }
        let first = texel * (light.channels + 2u);
        let word = f.first_word + (slice.index * texels + texel) * (light.channels + 1u);
        var weight = 0.0;
        for (var channel = 0u; channel < light.channels; channel++) {
            let sum = taken(first + channel);
            own[channel] += vec4u(sum.x & 0xffffu, sum.x >> 16u, sum.y & 0xffffu, sum.y >> 16u);
            let counts = counts_of(sum);
            weight += counts / f32(light.channels);
            light_field[word + channel] = bitcast<u32>(counts * (slice.density_per_flux / slice.sum_scale));
        }
        let drifts = vec2f(counts_of(taken(first + light.channels)), counts_of(taken(first + light.channels + 1u)));
        let middle = (vec2f(f32(texel % f.width), f32(texel / f.width)) + 0.5) / f.texels_per_m + f.min_m;
        var drift = drift_at_rest(middle);
        if weight > 0.0 { drift = (2.0 * drifts / weight - 1.0) * f.most_drift; }
        light_field[word + light.channels] = pack2x16snorm(drift / f.most_drift);
    }
    landed[invocation] = own;
    for (var stride = 32u; stride > 0u; stride = stride >> 1u) {
        workgroupBarrier();
        if invocation < stride {
            for (var channel = 0u; channel < light.channels; channel++) {
                landed[invocation][channel] += landed[invocation + stride][channel];
            }
        }
    }
    if invocation == 0u {
        let scale = light.energy_scale / slice.sum_scale;
        for (var channel = 0u; channel < light.channels; channel++) {
            let sum = vec4f(landed[0][channel]) * vec4f(1.0, 65536.0, 4294967296.0, 281474976710656.0);
            add_energy(TERM_LANDED + channel, (sum.x + sum.y + (sum.z + sum.w)) * scale);
        }
        // The queue is empty for the next slice.
        if number == 0u {
            atomicStore(&slice_queue[0], 0u);
            atomicStore(&slice_queue[QUEUE_COUNT], 0u);
        }
    }
}
