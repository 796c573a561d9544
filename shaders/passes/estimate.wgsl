// Estimate — how far do the maps lie from those of the light done coarsely? One invocation compares a few places of a receiver's
// map; each workgroup leaves its sums, in an order that is always the same.

struct Comparison {
    fine_width: u32,
    fine_height: u32,
    coarse_width: u32,
    coarse_height: u32,
    first_fine: u32,    // first texel in `irradiance`
    first_coarse: u32,  // first texel in `coarse_irradiance`
    first_group: u32,   // first place in `differences`
    blocks: u32,        // 1: whole blocks of fine texels against coarse ones; 0: fine texels against the coarse map between its texels
    places: u32,        // how many of those blocks or texels are looked at
    one_in: u32,        // one in so many of them, anywhere among these
    pad_0: u32,
    pad_1: u32,
}

@group(0) @binding(12) var<storage, read> irradiance: array<f32>;
@group(0) @binding(13) var<storage, read> coarse_irradiance: array<f32>;
// Per workgroup: Σ|fine − coarse|, Σ fine, both in W/m² times fine texels, channels added.
@group(0) @binding(14) var<storage, read_write> differences: array<vec4f>;
@group(0) @binding(15) var<uniform> comparison: Comparison;

const PLACES_EACH: u32 = 4u;

var<workgroup> sums: array<vec2f, 64>;

fn fine_at(x: u32, y: u32) -> vec3f {
    let at = 3u * (comparison.first_fine + y * comparison.fine_width + x);
    return vec3f(irradiance[at], irradiance[at + 1u], irradiance[at + 2u]);
}

fn coarse_at(x: u32, y: u32) -> vec3f {
    let at = 3u * (comparison.first_coarse + y * comparison.coarse_width + x);
    return vec3f(coarse_irradiance[at], coarse_irradiance[at + 1u], coarse_irradiance[at + 2u]);
}

// The coarse map between its texels' centres, as a camera looks it up, at the middle of a fine texel.
fn coarse_between(x: u32, y: u32) -> vec3f {
    let size = vec2f(f32(comparison.coarse_width), f32(comparison.coarse_height));
    let per_fine = size / vec2f(f32(comparison.fine_width), f32(comparison.fine_height));
    let q = clamp((vec2f(f32(x), f32(y)) + 0.5) * per_fine - 0.5, vec2f(0.0), size - 1.0);
    let low = vec2u(floor(q));
    let high = min(low + 1u, vec2u(comparison.coarse_width - 1u, comparison.coarse_height - 1u));
    let f = q - floor(q);
    let near = mix(coarse_at(low.x, low.y), coarse_at(high.x, low.y), f.x);
    let far = mix(coarse_at(low.x, high.y), coarse_at(high.x, high.y), f.x);
    return mix(near, far, f.y);
}

fn total(v: vec3f) -> f32 {
    return v.x + v.y + v.z;
}

// Sums over a coarse texel and the block of fine ones it covers.
fn block_sums(x: u32, y: u32) -> vec2f {
    let side = vec2u(comparison.fine_width / comparison.coarse_width, comparison.fine_height / comparison.coarse_height);
    var fine = vec3f(0.0);
    for (var j = 0u; j < side.y; j++) {
        for (var i = 0u; i < side.x; i++) {
            fine += fine_at(x * side.x + i, y * side.y + j);
        }
    }
    let coarse = coarse_at(x, y) * f32(side.x * side.y);
    return vec2f(total(abs(fine - coarse)), total(fine));
}

fn texel_sums(x: u32, y: u32) -> vec2f {
    let fine = fine_at(x, y);
    return vec2f(total(abs(fine - coarse_between(x, y))), total(fine));
}

// A number without pattern for each `i`, so that what is looked at does not keep step with waves: PCG as in Jarzynski and Olano,
// "Hash Functions for GPU Rendering", 2020.
fn scattered(i: u32) -> u32 {
    let state = i * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

@compute @workgroup_size(64)
fn estimate_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let in_blocks = comparison.blocks == 1u;
    let width = select(comparison.fine_width, comparison.coarse_width, in_blocks);
    let height = select(comparison.fine_height, comparison.coarse_height, in_blocks);
    let number = group.y * groups.x + group.x;
    let first = number * (64u * PLACES_EACH) + invocation;
    var held = vec2f(0.0);
    for (var i = 0u; i < PLACES_EACH; i++) {
        let nth = first + 64u * i;
        if nth >= comparison.places { break; }
        let place = min(nth * comparison.one_in + scattered(nth) % comparison.one_in, width * height - 1u);
        if in_blocks { held += block_sums(place % width, place / width); } else { held += texel_sums(place % width, place / width); }
    }
    sums[invocation] = held;
    for (var stride = 32u; stride > 0u; stride = stride >> 1u) {
        workgroupBarrier();
        if invocation < stride { sums[invocation] += sums[invocation + stride]; }
    }
    if invocation == 0u { differences[comparison.first_group + number] = vec4f(sums[0], 0.0, 0.0); }
}
