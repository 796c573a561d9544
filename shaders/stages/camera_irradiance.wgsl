// Camera irradiance — irradiance of the surface that each pixel sees. One invocation per pixel: from the receiver's maps under water, from
// the lights directly above it, and from the sky on both sides.
#import "lib/sky.wgsl"
#import "shared/view.wgsl"
#import "shared/points.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/air_lights.wgsl"
#import "shared/receivers.wgsl"
#import "shared/level_maps.wgsl"

// Least |cosine| between surface normal and map axis: below it a surface is seen edge-on from the axis.
const LEAST_COSINE: f32 = 1e-6;

// Receivers of all lights, light by light.
@group(0) @binding(3) var<storage, read> all_receivers: array<Receiver>;
@group(0) @binding(12) var<storage, read> irradiance: array<f32>;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m², w: 1 where the floor's map has no texel

fn texel_value(offset: u32, width: u32, texel: vec2u) -> vec3f {
    let at = 3u * (offset + texel.y * width + texel.x);
    return vec3f(irradiance[at], irradiance[at + 1u], irradiance[at + 2u]);
}

// The floor's map, interpolated between texel centres.
fn floor_irradiance(r: Receiver, uv: vec2f) -> vec3f {
    let size = vec2f(f32(r.map_width), f32(r.map_height));
    let q = clamp(uv - 0.5, vec2f(0.0), size - 1.0);
    let low = vec2u(floor(q));
    let high = min(low + 1u, vec2u(r.map_width - 1u, r.map_height - 1u));
    let f = q - floor(q);
    let near = mix(texel_value(r.irradiance_offset, r.map_width, low), texel_value(r.irradiance_offset, r.map_width, vec2u(high.x, low.y)), f.x);
    let far = mix(texel_value(r.irradiance_offset, r.map_width, vec2u(low.x, high.y)), texel_value(r.irradiance_offset, r.map_width, high), f.x);
    return mix(near, far, f.y);
}

// Interpolates an object's maps, one per layer from receiver `first` on. Only texels of the layer at the point's own depth count, so
// surfaces hidden from the light stay dark and silhouettes take no light from their surroundings. A surface that faces away from the axis
// is lit only by tilted rays and is never the first surface, so it is looked up in the further layers. The steeper the surface, the more
// depth a texel spans; the tolerance grows up to 8 texels of depth per texel.
fn object_irradiance(first: u32, p: vec3f, normal: vec3f) -> vec3f {
    let r = all_receivers[first];
    let towards = -dot(normal, r.axis.xyz);
    let nearest_layer = select(0u, 1u, towards <= 0.0);
    if nearest_layer >= view.layers { return vec3f(0.0); }
    let cosine = max(abs(towards), LEAST_COSINE);
    let m = to_map(r, p);
    let base = floor(m.xy - 0.5);
    let f = m.xy - 0.5 - base;
    let bias = r.s_per_m * inverseSqrt(r.density_per_flux) * (1.0 + 2.0 * min(sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine, 8.0));
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let corner = vec2i(i & 1, i >> 1);
        let texel = vec2i(base) + corner;
        var layer = nearest_layer;
        var gap = abs(layer_depth(r, layer, texel) - m.z);
        for (var k = nearest_layer + 1u; k < view.layers; k++) {
            let other = abs(layer_depth(r, k, texel) - m.z);
            if other < gap {
                gap = other;
                layer = k;
            }
        }
        if gap > bias { continue; }
        let weight = max(select(1.0 - f.x, f.x, corner.x == 1) * select(1.0 - f.y, f.y, corner.y == 1), 1e-4);
        sum += weight * texel_value(all_receivers[first + layer].irradiance_offset, r.map_width, vec2u(texel));
        weights += weight;
    }
    if weights == 0.0 { return vec3f(0.0); }
    return sum * (cosine / weights);
}

@compute @workgroup_size(8, 8)
fn camera_irradiance_main(@builtin(global_invocation_id) id: vec3u) {
    let index = band_pixel(id);
    if index >= view.width * view.row_count { return; }
    let seen = points[index];
    let dry = seen.receiver < -1.5;
    let receiver = select(i32(seen.receiver), -2 - i32(seen.receiver), dry);
    var sum = vec3f(0.0);
    var outside = 0.0;
    if receiver >= 0 {
        let p = seen.position_m;
        let normal = seen.normal;
        if dry {
            sum += lights_in_air(view.air_light_count, view.instance_count, p, normal);
            for (var c = 0; c < 3; c++) { sum[c] += sky_irradiance(view.sky_radiance[c], 1.0, 0.0, 0.0, 1.0, normal.y, 1.0); }
        } else {
            let per_light = 1u + view.instance_count * view.layers;
            for (var s = 0u; s < view.light_count; s++) {
                if receiver == FLOOR {
                    if s > 0u { break; }
                    let r = all_receivers[0];
                    let uv = to_map(r, p).xy;
                    if any(uv < vec2f(0.0)) || any(uv > vec2f(f32(r.map_width), f32(r.map_height))) { outside = 1.0; }
                    sum += floor_irradiance(r, uv);
                } else {
                    sum += object_irradiance(s * per_light + 1u + u32(receiver - 1) * view.layers, p, normal);
                }
            }
            for (var c = 0; c < 3; c++) {
                sum[c] += sky_irradiance(view.sky_radiance[c], view.sky_transmittance, view.extinction_per_m[c], -p.y, view.sky_path_factor, normal.y, 1.0 / (view.ior * view.ior));
            }
        }
    }
    point_irradiance[index] = vec4f(sum, outside);
}
