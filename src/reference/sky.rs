//! The sum of all skies of a scene.

use crate::physics::fresnel::diffuse_transmittance;
use crate::physics::sky::{sky_irradiance, sky_path_factor};
use crate::scene::{Light, Scene};

/// Sky light in the air and, as under flat water, below the surface.
pub(super) struct Sky {
    /// Of all skies, W/(m² sr).
    pub(super) radiance: [f64; 3],
    ior: f64,
    extinction_per_m: [f64; 3],
    /// Share of it that flat water lets through.
    transmittance: f64,
    /// Its mean path per depth.
    path_factor: f64,
}

impl Sky {
    /// The skies of `scene`, whose water has this extinction.
    pub(super) fn of(scene: &Scene, extinction_per_m: [f64; 3]) -> Self {
        let mut radiance = [0.0; 3];
        for light in &scene.lights {
            if let Light::Sky(sky) = light {
                for (sum, own) in radiance.iter_mut().zip(sky.radiance_w_m2_sr) {
                    *sum += own;
                }
            }
        }
        let ior = scene.water.ior;
        Self {
            radiance,
            ior,
            extinction_per_m,
            transmittance: diffuse_transmittance(ior),
            path_factor: sky_path_factor(ior),
        }
    }

    /// Irradiance in the air on a surface whose unit normal has the upward component `normal_y`, W/m².
    pub(super) fn in_air_w_m2(&self, normal_y: f64) -> [f64; 3] {
        self.radiance
            .map(|radiance| sky_irradiance(radiance, 1.0, 0.0, 0.0, 1.0, normal_y, 1.0))
    }

    /// Like the above, `depth_m` under the water at rest.
    pub(super) fn under_water_w_m2(&self, depth_m: f64, normal_y: f64) -> [f64; 3] {
        std::array::from_fn(|c| {
            sky_irradiance(
                self.radiance[c],
                self.transmittance,
                self.extinction_per_m[c],
                depth_m,
                self.path_factor,
                normal_y,
                1.0 / (self.ior * self.ior),
            )
        })
    }
}
