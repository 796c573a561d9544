// Photon map — irradiance of a plane facing the sun, from the flux summed per texel. One invocation per texel.
#import "shared/light_view.wgsl"

@group(0) @binding(8) var<storage, read> photon_sums: array<u32>;
@group(0) @binding(24) var photon_dots: texture_2d<f32>;
// All beam sets' maps, one behind the other; W/m².
@group(0) @binding(9) var<storage, read_write> photon_map: array<vec4f>;

fn put(id: vec3u, unit_flux: vec3f) {
    // A texel's area across the light.
    let area_m2 = light_view.map_texel_m.x * light_view.map_texel_m.y * light_view.to_light.y;
    let texel = light_view.first_texel + id.y * light_view.texels + id.x;
    photon_map[texel] = vec4f(unit_flux / area_m2 * light_view.power.xyz, 0.0);
}

@compute @workgroup_size(8, 8)
fn photon_map_of_sums(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= vec2u(light_view.texels)) { return; }
    let first = (id.y * light_view.texels + id.x) * light_view.channels;
    var counts = vec3f(0.0);
    for (var c = 0u; c < 3u; c++) {
        let low = 2u * (first + min(c, light_view.channels - 1u));
        counts[c] = f32(photon_sums[low + 1u]) * 4294967296.0 + f32(photon_sums[low]);
    }
    put(id, counts / light_view.sum_scale);
}

@compute @workgroup_size(8, 8)
fn photon_map_of_dots(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= vec2u(light_view.texels)) { return; }
    put(id, textureLoad(photon_dots, vec2i(id.xy), 0).xyz);
}
