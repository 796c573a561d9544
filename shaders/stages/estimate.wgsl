// Estimate — differences between the maps and those of the coarse beam sets. One invocation compares PLACES_EACH places; each workgroup
// stores its sums, added in a fixed order.
#import "shared/comparison.wgsl"

struct Estimate {
    comparison_count: u32,
    group_count: u32,
    pad_0: u32,
    pad_1: u32,
}

@group(0) @binding(11) var<storage, read> irradiance: array<f32>;
@group(0) @binding(12) var<storage, read> coarse_irradiance: array<f32>;
// Per workgroup: Σ|fine − coarse|, Σ fine, both in W/m² times fine texels, channels added.
@group(0) @binding(13) var<storage, read_write> differences: array<vec4f>;
@group(0) @binding(15) var<uniform> estimate: Estimate;

var<workgroup> sums: array<vec2f, 64>;

fn total(v: vec3f) -> f32 {
    return v.x + v.y + v.z;
}

// Sum of the fine texels of a place: a block, or one texel.
fn fine_sum(c: Comparison, at: vec2u, side: vec2u) -> vec3f {
    var sum = vec3f(0.0);
    for (var j = 0u; j < side.y; j++) {
        for (var i = 0u; i < side.x; i++) {
            let texel = 3u * (c.first_fine + (at.y * side.y + j) * c.fine_width + at.x * side.x + i);
            sum += vec3f(irradiance[texel], irradiance[texel + 1u], irradiance[texel + 2u]);
        }
    }
    return sum;
}

@compute @workgroup_size(64)
fn estimate_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let number = group.y * groups.x + group.x;
    let is_one = number < estimate.group_count;
    let c = comparison_of(min(number, estimate.group_count - 1u), estimate.comparison_count);
    var side = vec2u(1u);
    if c.blocks == 1u { side = vec2u(c.fine_width / c.coarse_width, c.fine_height / c.coarse_height); }
    var held = vec2f(0.0);
    for (var i = 0u; i < PLACES_EACH && is_one; i++) {
        let nth = rank_of(number - c.first_group, i, invocation);
        if nth >= c.places { break; }
        let fine = fine_sum(c, place_of(c, nth), side);
        let first = 3u * rank_of(number, i, invocation);
        let coarse = vec3f(coarse_irradiance[first], coarse_irradiance[first + 1u], coarse_irradiance[first + 2u]);
        held += vec2f(total(abs(fine - coarse * f32(side.x * side.y))), total(fine));
    }
    sums[invocation] = held;
    for (var stride = 32u; stride > 0u; stride = stride >> 1u) {
        workgroupBarrier();
        if invocation < stride { sums[invocation] += sums[invocation + stride]; }
    }
    if invocation == 0u && is_one { differences[number] = vec4f(sums[0], 0.0, 0.0); }
}
