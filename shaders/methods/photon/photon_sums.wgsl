// Photon sums — adds each photon's flux to its texel, as integers. One invocation per photon.
#import "lib/attenuation.wgsl"
#import "shared/light_view.wgsl"

@group(0) @binding(7) var<storage, read> photons: array<vec4f>;
// Low and high word per texel and channel. A photon has at most 2³⁰ counts and there are at most 2²⁴ of them: no sum overflows.
@group(0) @binding(8) var<storage, read_write> photon_sums: array<atomic<u32>>;

@compute @workgroup_size(64)
fn photon_sums_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let index = (group.y * groups.x + group.x) * 64u + invocation;
    if index >= light_view.cells * light_view.cells { return; }
    let photon = photons[index];
    if photon.z <= 0.0 { return; }
    let texel = u32(photon.y) * light_view.texels + u32(photon.x);
    for (var c = 0u; c < light_view.channels; c++) {
        let left = photon.z * transmission(light_view.extinction_per_m[c], photon.w);
        let counts = u32(left * light_view.sum_scale + 0.5);
        let low = 2u * (texel * light_view.channels + c);
        let before = atomicAdd(&photon_sums[low], counts);
        if before + counts < before { atomicAdd(&photon_sums[low + 1u], 1u); }
    }
}
