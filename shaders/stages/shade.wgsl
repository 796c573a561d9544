// Shade — radiance at the camera: diffuse surfaces seen through their media, and the sky reflected or refracted at the water. One
// invocation per pixel.
#import "lib/attenuation.wgsl"
#import "shared/view.wgsl"

@group(0) @binding(18) var<storage, read> visible_albedo: array<vec4f>;
@group(0) @binding(19) var<storage, read> visible_transport: array<vec4f>;
@group(0) @binding(20) var<storage, read> point_irradiance: array<vec4f>;
@group(0) @binding(22) var<storage, read_write> radiance: array<vec4f>; // sums over samples and legs: W/(m² sr), notes

// Whether the water absorbs or scatters any light; if false no exponential is computed.
override ATTENUATES: bool = true;

fn left_after(c_per_m: f32, length_m: f32) -> f32 {
    if ATTENUATES { return transmission(c_per_m, length_m); }
    return 1.0;
}

@compute @workgroup_size(8, 8)
fn shade_main(@builtin(global_invocation_id) id: vec3u) {
    let index = band_pixel(id);
    if index >= view.width * view.row_count { return; }
    let transport = visible_transport[index];
    let albedo = visible_albedo[index];
    var sum = vec3f(0.0);
    for (var c = 0; c < 3; c++) {
        let reflected = albedo[c] * point_irradiance[index][c] / 3.14159265;
        sum[c] = transport.x * reflected * left_after(view.extinction_per_m[c], albedo.w)
            + transport.y * view.sky_radiance[c] * left_after(view.extinction_per_m[c], transport.z);
    }
    var held = vec4f(0.0);
    if view.sample_index > 0u { held = radiance[index]; }
    let outside = select(0u, OUTSIDE_MAP, point_irradiance[index].w > 0.0);
    radiance[index] = vec4f(held.xyz + sum, f32(u32(held.w) | u32(transport.w) | outside));
}
