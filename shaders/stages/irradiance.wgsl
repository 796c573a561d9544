// Irradiance — the sums of one light become W/m² and join what other lights brought. One invocation per texel.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/flux.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/resolve.wgsl"

// Linear RGB per texel: on the floor irradiance, W/m²; on an object the flux through the map's plane, W/m², which times the
// cosine between surface and map axis is irradiance.
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
