// Irradiance — converts the flux sums of one beam set to W/m² and adds them to those of others. One invocation per texel.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/flux.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/resolve.wgsl"

// Linear RGB per texel. On the floor: irradiance, W/m². On an object: flux through the map's plane, W/m²; times the cosine between surface
// normal and map axis it is irradiance.
@group(0) @binding(12) var<storage, read_write> irradiance: array<f32>;

@compute @workgroup_size(64)
fn irradiance_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let index = (group.y * groups.x + group.x) * 64u + invocation;
    if index >= resolve.texel_count { return; }
    let resolved = resolved_w_m2(index);
    for (var channel = 0u; channel < 3u; channel++) {
        let value = resolved[channel];
        let at = 3u * (resolve.first_output + index) + channel;
        if resolve.adds == 1u { irradiance[at] += value; } else { irradiance[at] = value; }
    }
}
