// Irradiance — the sums of one light become W/m² and join what other lights brought. One invocation per few texels.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/flux.wgsl"

// Linear RGB per texel: on the floor irradiance, W/m²; on an object the flux through the map's plane, W/m², which times the
// cosine between surface and map axis is irradiance.
@group(0) @binding(12) var<storage, read_write> irradiance: array<f32>;

struct Resolve {
    light_w_m2: vec4f,     // irradiance of the light on a plane facing it
    first_texel: u32,      // piece of the flux sums
    texel_count: u32,
    first_output: u32,     // first texel in `irradiance`
    adds: u32,             // 1: add to what is there
    density_per_flux: f32, // 1/m²
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(13) var<uniform> resolve: Resolve;

// Texels of an invocation: few workgroups have few sums to add up.
const TEXELS_EACH: u32 = 16u;

var<workgroup> sums: array<vec3f, 64>;

@compute @workgroup_size(64)
fn irradiance_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let first = (group.y * groups.x + group.x) * (64u * TEXELS_EACH) + invocation;
    var landed = vec3f(0.0);
    for (var i = 0u; i < TEXELS_EACH; i++) {
        let index = first + 64u * i;
        if index >= resolve.texel_count { break; }
        var counts = vec3f(0.0);
        for (var channel = 0u; channel < light.channels; channel++) {
            let word = 2u * ((resolve.first_texel + index) * light.channels + channel);
            counts[channel] = f32(atomicLoad(&flux[word + 1u])) * 4294967296.0 + f32(atomicLoad(&flux[word]));
        }
        landed += counts;
        var spread = counts;
        if light.channels == 1u { spread = vec3f(counts.x); }
        let value = spread * (resolve.density_per_flux / light.flux_scale) * resolve.light_w_m2.xyz;
        let at = 3u * (resolve.first_output + index);
        for (var channel = 0u; channel < 3u; channel++) {
            var before = 0.0;
            if resolve.adds == 1u { before = irradiance[at + channel]; }
            irradiance[at + channel] = before + value[channel];
        }
    }
    // What landed, summed where it lies; a fixed order keeps the bytes the same.
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
