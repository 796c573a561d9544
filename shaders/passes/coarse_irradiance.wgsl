// Coarse irradiance — as the irradiance pass, for the light that is done again coarsely. One invocation per texel.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/flux.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/resolve.wgsl"

@group(0) @binding(12) var<storage, read_write> coarse_irradiance: array<f32>;

@compute @workgroup_size(64)
fn coarse_irradiance_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let index = (group.y * groups.x + group.x) * 64u + invocation;
    if index >= resolve.texel_count { return; }
    let resolved = resolved_w_m2(index);
    for (var channel = 0u; channel < 3u; channel++) {
        let value = resolved[channel];
        let at = 3u * (resolve.first_output + index) + channel;
        if resolve.adds == 1u { coarse_irradiance[at] += value; } else { coarse_irradiance[at] = value; }
    }
}
