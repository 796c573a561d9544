//! Model coordinates: the space in which the front of the light moves at speed 1.
//!
//! The paper lets light enter the water along the surface's normal, as if the water's index were infinite. Then the fronts are parallel
//! surfaces of the water. It leaves finite indices to future work and suggests to scale the field along the mean refracted direction.
//! Two answers are here.
//!
//! **Scaled.** Light that meets the water at the angle θi and goes on at θt is deflected, for a small slope s of the surface, by
//! g s / cos³ θt in the plane of incidence and by g s / cos θt across it, per depth, with g = cos θt − cos θi / n. The normal is
//! deflected by s. So a parallel surface becomes a front of the light if depth is scaled by g / cos θt, columns are sheared along the
//! refracted ray, and lengths in the plane of incidence are multiplied by cos θt, as they appear along that ray. Under the zenith this
//! is the factor 1 − 1/n alone. Exact to first order in the slopes.
//!
//! **Snell.** The front inside the water starts where the light arrives: φ = d·q / n at the point q of the surface, for light that
//! travels along the unit vector d. The eikonal equation carries it on. Exact for every slope, without any scaling; coordinates are
//! only rotated, so that the mean refracted ray runs along the axis of depth.
//!
//! Source: Mercier, "Eikonal Approximation for Real-Time Height Field Caustics", §3 and §6; the formulas follow from Snell's law,
//! differentiated.

use glam::{DMat3, DVec2, DVec3};

use super::FrontError;

/// Maps from world to model coordinates. Both are (x, z, depth); depth grows downwards from the level of the water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Model from world coordinates, for points under water.
    pub model_from_world: DMat3,
    /// Model from world coordinates, for points of the surface.
    pub model_from_surface: DMat3,
    /// Gradient of the time at which light reaches the surface, in model coordinates; 0 if the whole surface is lit at once.
    pub slowness: DVec3,
}

/// Directions in air and water.
struct Refracted {
    /// Horizontal unit vector of the light's travel.
    along: DVec2,
    cos_i: f64,
    cos_t: f64,
    sin_t: f64,
}

impl Refracted {
    fn of(travel: DVec3, ior: f64) -> Result<Self, FrontError> {
        let refuse = |reason| FrontError::Light {
            travel: travel.to_array(),
            ior,
            reason,
        };
        if !(travel.is_normalized() && travel.z > 0.0) {
            return Err(refuse(
                "the direction has to be a unit vector that points down",
            ));
        }
        if !(ior.is_finite() && ior >= 1.01) {
            return Err(refuse("the index has to be at least 1.01"));
        }
        let sin_t = travel.truncate().length() / ior;
        Ok(Self {
            along: travel.truncate().try_normalize().unwrap_or(DVec2::X),
            cos_i: travel.z,
            cos_t: (1.0 - sin_t * sin_t).sqrt(),
            sin_t,
        })
    }

    /// Rows x and z of both maps: what is seen along the refracted ray.
    fn across(&self) -> [DVec2; 3] {
        let u = self.along;
        let column = |axis: DVec2| axis + u * ((self.cos_t - 1.0) * axis.dot(u));
        [column(DVec2::X), column(DVec2::Y), -self.sin_t * u]
    }
}

impl Frame {
    /// The paper's: light from the zenith enters along the normals.
    pub const NORMAL: Self = Self {
        model_from_world: DMat3::IDENTITY,
        model_from_surface: DMat3::IDENTITY,
        slowness: DVec3::ZERO,
    };

    /// Light that travels along the unit vector `travel` in the air, (x, z, depth), into water of index `ior` (1.01 …): parallel
    /// surfaces in scaled and sheared coordinates.
    ///
    /// # Errors
    /// Light that does not go down; an index below 1.01.
    pub fn scaled(travel: DVec3, ior: f64) -> Result<Self, FrontError> {
        let light = Refracted::of(travel, ior)?;
        let [x, z, depth] = light.across();
        let scale = (light.cos_t - light.cos_i / ior) / light.cos_t;
        let with = |scale| DMat3::from_cols(x.extend(0.0), z.extend(0.0), depth.extend(scale));
        Ok(Self {
            model_from_world: with(scale),
            model_from_surface: with(1.0),
            slowness: DVec3::ZERO,
        })
    }

    /// The same light with exact refraction: coordinates are rotated, and the front starts when the light arrives.
    ///
    /// # Errors
    /// As [`Frame::scaled`].
    pub fn snell(travel: DVec3, ior: f64) -> Result<Self, FrontError> {
        let light = Refracted::of(travel, ior)?;
        let [x, z, depth] = light.across();
        let along = light.along * light.sin_t;
        let rotation = DMat3::from_cols(
            x.extend(along.x),
            z.extend(along.y),
            depth.extend(light.cos_t),
        );
        Ok(Self {
            model_from_world: rotation,
            model_from_surface: rotation,
            slowness: rotation * travel / ior,
        })
    }

    /// Model coordinates of a point under water, m.
    pub fn model_m(&self, world_m: DVec3) -> DVec3 {
        self.model_from_world * world_m
    }

    /// Path of the light in the model from the water to a point that it reaches at `time_m` along the unit vector `direction`, m.
    ///
    /// With the slowness e and the point q where it entered, φ = e·q + ℓ and q = p − ℓ u, so ℓ = (φ − e·p) / (1 − e·u).
    pub fn path_m(&self, model_m: DVec3, time_m: f64, direction: DVec3) -> f64 {
        (time_m - self.slowness.dot(model_m)) / (1.0 - self.slowness.dot(direction))
    }

    /// World coordinates of a point of the model, m.
    pub fn world_m(&self, model_m: DVec3) -> DVec3 {
        self.model_from_world.inverse() * model_m
    }
}
