// Photon draw — adds each photon's flux to its texel by drawing it as a point with additive blending (Mihálik 2008, ch. 8, GPU approach).
#import "lib/attenuation.wgsl"
#import "shared/light_view.wgsl"

@group(0) @binding(7) var<storage, read> photons: array<vec4f>;

struct Dot {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) flux: vec3f,
}

@vertex
fn photon_draw_vertex(@builtin(vertex_index) index: u32) -> Dot {
    let photon = photons[index];
    // Beside the picture, where nothing is drawn.
    var spot = Dot(vec4f(2.0, 2.0, 0.0, 1.0), vec3f(0.0));
    if photon.z > 0.0 {
        let uv = (floor(photon.xy) + 0.5) / f32(light_view.texels);
        spot.clip = vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0);
        for (var c = 0; c < 3; c++) { spot.flux[c] = photon.z * transmission(light_view.extinction_per_m[c], photon.w); }
    }
    return spot;
}

@fragment
fn photon_draw_fragment(in: Dot) -> @location(0) vec4f {
    return vec4f(in.flux, 1.0);
}
