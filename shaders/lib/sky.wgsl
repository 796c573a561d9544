// Diffuse light of a uniform sky. Twin of src/physics/sky.rs.
#import "lib/solid_angle.wgsl"

// Irradiance from a cone of uniform radiance around the zenith on a plane whose normal has the upward component `normal_y` (−1 … 1), as a
// share of that on a horizontal plane; `sin2_cone` (1/16 … 1) is the square of the sine of the cone's half angle. Angles use point_angle,
// because WGSL allows an error of 7·10⁻⁵ in acos.
fn cone_share(normal_y: f32, sin2_cone: f32) -> f32 {
    let sin_cone = sqrt(sin2_cone);
    if normal_y >= sin_cone { return normal_y; }
    if normal_y <= -sin_cone { return 0.0; }
    let x = sqrt((1.0 - sin2_cone) / sin2_cone);
    let sin_tilt = sqrt(max((1.0 - normal_y) * (1.0 + normal_y), 0.0));
    let y = clamp(-x * normal_y / sin_tilt, -1.0, 1.0);
    let sine = sqrt(max((1.0 - y) * (1.0 + y), 0.0));
    let reach = sin_tilt * sine;
    return ((normal_y * point_angle(sine, y) - x * reach) * sin2_cone + point_angle(reach, x)) / (3.14159265 * sin2_cone);
}

// Irradiance from a uniform sky of `radiance` on a surface whose normal has the upward component `normal_y`, `depth_m` under flat water with
// `transmittance` and extinction `c_per_m` (1/m), along paths `path_factor` times the depth. The sky fills a cone of `sin2_cone`: 1/n² under
// water, 1 in air.
fn sky_irradiance(radiance: f32, transmittance: f32, c_per_m: f32, depth_m: f32, path_factor: f32, normal_y: f32, sin2_cone: f32) -> f32 {
    return 3.14159265 * radiance * transmittance * exp(-c_per_m * path_factor * max(depth_m, 0.0)) * cone_share(normal_y, sin2_cone);
}
