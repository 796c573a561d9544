// Sky and air lights — irradiance at points that does not depend on the method: the sky's, and that of the lights in the air on dry
// surfaces. One invocation per point of a band.
#import "lib/sky.wgsl"
#import "shared/points.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/air_lights.wgsl"

struct Surroundings {
    sky_radiance: vec4f,
    extinction_per_m: vec4f,
    map_sky: vec4f,          // irradiance by the sky of every texel, W/m², if the points are texels of a map
    width: u32,
    row_count: u32,          // of this band
    are_texels: u32,
    instance_count: u32,
    air_light_count: u32,
    ior: f32,
    sky_transmittance: f32,
    sky_path_factor: f32,
}

@group(0) @binding(0) var<uniform> surroundings: Surroundings;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m²

@compute @workgroup_size(8, 8)
fn sky_and_air_lights_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= surroundings.width || id.y >= surroundings.row_count { return; }
    let index = id.y * surroundings.width + id.x;
    if surroundings.are_texels == 1u {
        point_irradiance[index] = vec4f(surroundings.map_sky.xyz, 0.0);
        return;
    }
    let seen = points[index];
    let dry = seen.receiver < -1.5;
    let s = surroundings;
    var sum = vec3f(0.0);
    if dry {
        sum = lights_in_air(s.air_light_count, s.instance_count, seen.position_m, seen.normal);
        for (var c = 0; c < 3; c++) { sum[c] += sky_irradiance(s.sky_radiance[c], 1.0, 0.0, 0.0, 1.0, seen.normal.y, 1.0); }
    } else if seen.receiver >= 0.0 {
        for (var c = 0; c < 3; c++) {
            sum[c] = sky_irradiance(s.sky_radiance[c], s.sky_transmittance, s.extinction_per_m[c], -seen.position_m.y, s.sky_path_factor, seen.normal.y, 1.0 / (s.ior * s.ior));
        }
    }
    point_irradiance[index] = vec4f(sum, 0.0);
}
