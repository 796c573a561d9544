// Start and direction of a light's ray under water.

struct Entry {
    origin: vec3f,
    direction: vec3f,
    transmittance: f32, // 0 where the surface faces away from the light
}

// Unit direction from `p` to the light; up if `p` is at the light.
fn light_at(p: vec3f) -> vec3f {
    if light.kind == SUN { return light.source.xyz; }
    let to_light = light.source.xyz - p;
    let length2 = dot(to_light, to_light);
    if length2 < 1e-30 { return vec3f(0.0, 1.0, 0.0); }
    return to_light * inverseSqrt(length2);
}

// The ray of grid place `ij` through water of (height, ∂h/∂x, ∂h/∂z), which is unused for a light under water.
fn entry_at(ij: vec2f, water: vec3f) -> Entry {
    let origin = origin_at(ij, water.x);
    if light.kind == SUBMERGED {
        let place = grid_place(ij);
        return Entry(origin, octahedral_direction(place.x, place.y), 1.0);
    }
    let normal = normal_from_slope(water.y, water.z);
    let to_light = light_at(origin);
    let refracted = refract_direction(-to_light, normal, light.ior);
    return Entry(origin, refracted.xyz, fresnel_transmittance(dot(normal, to_light), light.ior));
}
