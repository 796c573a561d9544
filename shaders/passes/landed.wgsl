// Landed — what lies on the maps, summed where it lies: the one term of the energy account that is not noted on the way.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/flux.wgsl"

struct Span {
    texel_count: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(13) var<uniform> span: Span;

// Texels of an invocation: few workgroups have few sums to add up.
const TEXELS_EACH: u32 = 64u;

var<workgroup> sums: array<vec3f, 64>;

@compute @workgroup_size(64)
fn landed_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let first = (group.y * groups.x + group.x) * (64u * TEXELS_EACH) + invocation;
    var landed = vec3f(0.0);
    for (var i = 0u; i < TEXELS_EACH; i++) {
        let texel = first + 64u * i;
        if texel >= span.texel_count { break; }
        for (var channel = 0u; channel < light.channels; channel++) {
            landed[channel] += flux_counts(texel, channel, light.channels);
        }
    }
    // A fixed order of adding keeps the bytes the same.
    sums[invocation] = landed;
    for (var stride = 32u; stride > 0u; stride = stride >> 1u) {
        workgroupBarrier();
        if invocation < stride { sums[invocation] += sums[invocation + stride]; }
    }
    if invocation == 0u {
        let scale = light.energy_scale / light.flux_scale;
        for (var channel = 0u; channel < light.channels; channel++) {
            add_energy(TERM_LANDED + channel, sums[0][channel] * scale);
        }
    }
}
