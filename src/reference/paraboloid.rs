//! The crest of a long wave as a lens: where its focus is, and how bright.

use crate::physics::fresnel::fresnel_transmittance;

/// Water h(r) = −½ κ r², κ above 0, in light from the zenith.
///
/// A ray that enters at r meets a slope tan θ_i = κ r and is turned by δ = θ_i − θ_t towards the axis. For small r, δ is
/// κ r (1 − 1/n), so all rays meet at f = n R / (n − 1) below the crest, R = 1/κ. Source: Hecht, Optics, 5th ed., §5.2.2, eq. 5.8
/// with an object at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParaboloidBump {
    /// κ, 1/m, above 0.
    pub curvature_per_m: f64,
    /// Index of refraction, above 1.
    pub ior: f64,
}

impl ParaboloidBump {
    /// f, m below the crest, for rays near the axis.
    pub fn focal_depth_m(&self) -> f64 {
        self.ior / ((self.ior - 1.0) * self.curvature_per_m)
    }

    /// Signed distance from the axis at which the ray that enters at `r_m` is `depth_m` below the crest; exact.
    pub fn landing_m(&self, r_m: f64, depth_m: f64) -> f64 {
        let slope = self.curvature_per_m * r_m;
        let incidence = slope.atan();
        let deflection = incidence - (incidence.sin() / self.ior).asin();
        let drop_m = depth_m - 0.5 * slope * r_m;
        r_m - drop_m * deflection.tan()
    }

    /// Irradiance on the axis `depth_m` below the crest from the rays near it, per unit of the sun's: T / (1 − d/f)². Infinite
    /// at the focus.
    pub fn axis_irradiance(&self, depth_m: f64) -> f64 {
        fresnel_transmittance(1.0, self.ior) / (1.0 - depth_m / self.focal_depth_m()).powi(2)
    }

    /// Mean irradiance `depth_m` below the crest within `radius_m` of the axis, per unit of the sun's, from rays that enter
    /// within `reach_m`; exact up to the change of Fresnel's transmittance with the angle, which is of fourth order in κ r.
    ///
    /// Beyond the focus rays of the rim may land inside too, hence `reach_m`. `None` where the rays within it land nowhere as far
    /// out as `radius_m`.
    pub fn disc_irradiance(&self, depth_m: f64, radius_m: f64, reach_m: f64) -> Option<f64> {
        let lands_inside = |r: f64| self.landing_m(r, depth_m).abs() < radius_m;
        if lands_inside(reach_m) {
            return None;
        }
        let (mut inside, mut outside) = (0.0, reach_m);
        for _ in 0..100 {
            let middle = 0.5 * (inside + outside);
            if lands_inside(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Some(fresnel_transmittance(1.0, self.ior) * (inside / radius_m).powi(2))
    }
}
