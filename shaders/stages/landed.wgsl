// Landed — sums the flux on the maps: the only term of the energy account that is not noted when beams are deposited.
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

// Texels per invocation; fewer workgroups mean fewer additions to the global account.
const TEXELS_EACH: u32 = 64u;

// Sums of 16-bit pieces of the counts, so that they stay integers: in floats, equal addends would round the same way and their errors
// would add up.
var<workgroup> sums: array<array<vec4u, 3>, 64>;

fn pieces(texel: u32, channel: u32) -> vec4u {
    let words = flux_words(texel, channel, light.channels);
    return vec4u(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu, words.y >> 16u);
}

@compute @workgroup_size(64)
fn landed_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let first = (group.y * groups.x + group.x) * (64u * TEXELS_EACH) + invocation;
    var landed = array<vec4u, 3>(vec4u(0u), vec4u(0u), vec4u(0u));
    for (var i = 0u; i < TEXELS_EACH; i++) {
        let texel = first + 64u * i;
        if texel >= span.texel_count { break; }
        for (var channel = 0u; channel < light.channels; channel++) {
            landed[channel] += pieces(texel, channel);
        }
    }
    sums[invocation] = landed;
    for (var stride = 32u; stride > 0u; stride = stride >> 1u) {
        workgroupBarrier();
        if invocation < stride {
            for (var channel = 0u; channel < light.channels; channel++) {
                sums[invocation][channel] += sums[invocation + stride][channel];
            }
        }
    }
    if invocation == 0u {
        let scale = light.energy_scale / light.flux_scale;
        for (var channel = 0u; channel < light.channels; channel++) {
            let sum = vec4f(sums[0][channel]) * vec4f(1.0, 65536.0, 4294967296.0, 281474976710656.0);
            add_energy(TERM_LANDED + channel, (sum.x + sum.y + (sum.z + sum.w)) * scale);
        }
    }
}
