// Flux of a light of unit power through a triangle of the grid.

// For a sun the area projected towards it, m² (at 1 W/m²); for a point light the solid angle, sr (at 1 W/sr), exact at any distance.
// Negative where the water faces away.
fn signed_unit_flux(origin: mat3x3f, direction: mat3x3f) -> f32 {
    if light.kind == SUBMERGED {
        return solid_angle(direction[0], direction[1] - direction[0], direction[2] - direction[0]);
    }
    let ab = origin[1] - origin[0];
    let ac = origin[2] - origin[0];
    if light.kind == SUN { return 0.5 * dot(cross(ac, ab), light.source.xyz); }
    return solid_angle(origin[0] - light.source.xyz, ab, ac);
}

// The same where the water faces the light, else 0.
fn triangle_unit_flux(origin: mat3x3f, direction: mat3x3f) -> f32 {
    return max(signed_unit_flux(origin, direction), 0.0);
}
