// Diffuse light of a uniform sky. Twin of src/physics/sky.rs.

// Irradiance from a uniform sky of `radiance` on a surface whose normal has the upward component `normal_y`, `depth_m` under flat
// water that lets `transmittance` through and takes c (1/m) away along paths `path_factor` times the depth.
fn sky_irradiance(radiance: f32, transmittance: f32, c_per_m: f32, depth_m: f32, path_factor: f32, normal_y: f32) -> f32 {
    return 3.14159265 * radiance * transmittance * exp(-c_per_m * path_factor * max(depth_m, 0.0)) * 0.5 * (1.0 + normal_y);
}
