// Coarse irradiance — irradiance from coarse beam sets at the places that the estimate compares. One invocation per PLACES_EACH places.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/flux.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/comparison.wgsl"

struct CoarseLight {
    power: vec4f,          // as in `Resolve`
    first_group: u32,      // first workgroup of the places that this light reaches
    group_count: u32,
    comparison_count: u32, // of all lights
    adds: u32,             // 1: add to the old value
}

// Linear RGB per place, in the units of the irradiance pass.
@group(0) @binding(12) var<storage, read_write> coarse_irradiance: array<f32>;
@group(0) @binding(13) var<uniform> coarse_light: CoarseLight;

fn coarse_at(c: Comparison, at: vec2u) -> vec3f {
    return flux_colour(c.first_coarse + at.y * c.coarse_width + at.x, light.channels);
}

// The coarse map interpolated at the centre of a fine texel, as for a camera.
fn coarse_between(c: Comparison, at: vec2u) -> vec3f {
    let size = vec2f(f32(c.coarse_width), f32(c.coarse_height));
    let per_fine = size / vec2f(f32(c.fine_width), f32(c.fine_height));
    let q = clamp((vec2f(at) + 0.5) * per_fine - 0.5, vec2f(0.0), size - 1.0);
    let low = vec2u(floor(q));
    let high = min(low + 1u, vec2u(c.coarse_width - 1u, c.coarse_height - 1u));
    let f = q - floor(q);
    let near = mix(coarse_at(c, low), coarse_at(c, vec2u(high.x, low.y)), f.x);
    let far = mix(coarse_at(c, vec2u(low.x, high.y)), coarse_at(c, high), f.x);
    return mix(near, far, f.y);
}

@compute @workgroup_size(64)
fn coarse_irradiance_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let nth_group = group.y * groups.x + group.x;
    if nth_group >= coarse_light.group_count { return; }
    let number = coarse_light.first_group + nth_group;
    let c = comparison_of(number, coarse_light.comparison_count);
    let per_count = receivers[c.receiver].density_per_flux / light.flux_scale * coarse_light.power.xyz;
    for (var i = 0u; i < PLACES_EACH; i++) {
        let nth = rank_of(number - c.first_group, i, invocation);
        if nth >= c.places { break; }
        let at = place_of(c, nth);
        var counts: vec3f;
        if c.blocks == 1u { counts = coarse_at(c, at); } else { counts = coarse_between(c, at); }
        let value = counts * per_count;
        let first = 3u * rank_of(number, i, invocation);
        for (var channel = 0u; channel < 3u; channel++) {
            if coarse_light.adds == 1u {
                coarse_irradiance[first + channel] += value[channel];
            } else {
                coarse_irradiance[first + channel] = value[channel];
            }
        }
    }
}
