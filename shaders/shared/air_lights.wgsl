// Lights in the air, for dry places. Needs shared/geometry.wgsl.

struct AirLight {
    source: vec4f, // sun: unit direction to it, w 0; point light: its position, local m, w 1
    power: vec4f,  // irradiance of a plane facing the sun, W/m²; intensity of the point light, W/sr
}

@group(0) @binding(21) var<uniform> air_lights: array<AirLight, 64>;

// Irradiance of a dry place from suns and point lights over the water.
fn lights_in_air(count: u32, instance_count: u32, p: vec3f, normal: vec3f) -> vec3f {
    let from_m = p + normal * 1e-3;
    var sum = vec3f(0.0);
    for (var i = 0u; i < count; i++) {
        var to_light = air_lights[i].source.xyz;
        var reach_m = VERY_FAR_M;
        var per_power = 1.0;
        if air_lights[i].source.w == 1.0 {
            let to_source = air_lights[i].source.xyz - from_m;
            let length2 = max(dot(to_source, to_source), 1e-12);
            reach_m = sqrt(length2);
            to_light = to_source / reach_m;
            per_power = 1.0 / length2;
        }
        let cosine = dot(normal, to_light);
        if cosine <= 0.0 { continue; }
        let blocker = trace_objects(instance_count, from_m, to_light, 0.0, reach_m);
        if blocker.receiver < 0 { sum += air_lights[i].power.xyz * (cosine * per_power); }
    }
    return sum;
}
