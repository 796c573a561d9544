// Irradiance — the sums of one light become W/m² and join what other lights brought. One invocation per texel.
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

@compute @workgroup_size(64)
fn irradiance_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let index = (group.y * groups.x + group.x) * 64u + invocation;
    if index >= resolve.texel_count { return; }
    for (var channel = 0u; channel < 3u; channel++) {
        let carried = select(0u, channel, light.channels == 3u);
        let counts = flux_counts(resolve.first_texel + index, carried, light.channels);
        let value = counts * (resolve.density_per_flux / light.flux_scale) * resolve.light_w_m2[channel];
        let at = 3u * (resolve.first_output + index) + channel;
        if resolve.adds == 1u { irradiance[at] += value; } else { irradiance[at] = value; }
    }
}
