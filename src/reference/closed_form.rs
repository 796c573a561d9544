//! Exact formulas for simple scenes: flat water, and a single sine under a sun in the zenith.

use std::f64::consts::TAU;

pub use super::paraboloid::ParaboloidBump;
use crate::physics::attenuation::transmission;
use crate::physics::fresnel::fresnel_transmittance;
use crate::scene::{Sun, Water};

/// Irradiance per channel, W/m², on a floor `depth_m` (0 …) under flat water: E cos θ_i T(θ_i) e^(−c d), with d along the
/// refracted ray. 0 for a sun at or below the horizon. The waves of `water` are ignored.
pub fn flat_water_irradiance(water: &Water, depth_m: f64, sun: &Sun) -> [f64; 3] {
    let cos_i = sun.elevation_deg.to_radians().sin();
    if cos_i <= 0.0 {
        return [0.0; 3];
    }
    let sin_t = sun.elevation_deg.to_radians().cos() / water.ior;
    let path_m = depth_m / (1.0 - sin_t * sin_t).sqrt();
    let transmittance = fresnel_transmittance(cos_i, water.ior);
    std::array::from_fn(|c| {
        let extinction_per_m = water.absorption_per_m[c] + water.scattering_per_m[c];
        sun.irradiance_w_m2[c] * cos_i * transmittance * transmission(extinction_per_m, path_m)
    })
}

/// Points at which the map from surface to floor is searched for folds, per period.
const SAMPLES: u32 = 4096;
/// Halvings of an interval: to the last bit.
const HALVINGS: u32 = 100;
/// Pieces of a period over which Gauss's rule is exact to the last digits.
const PIECES: f64 = 32.0;

/// h(x) = A sin(2πx/λ + φ) under a vertical sun of 1 W/m²; everything depends on x only.
///
/// A ray that enters at x with slope angle θ_i = atan h′ is turned by δ = θ_i − θ_t towards rising x and lands at
/// X = x + (depth + h) tan δ. Irradiance at X is the sum over all such x of T e^(−c d)/|dX/dx|: folds, where dX/dx = 0,
/// are the caustics (Berry & Upstill, Progress in Optics 18, 1980, §2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineUnderZenith {
    /// A, m.
    pub amplitude_m: f64,
    /// λ, m, above 0.
    pub wavelength_m: f64,
    /// φ, rad.
    pub phase_rad: f64,
    /// Index of refraction, 1 …
    pub ior: f64,
    /// Floor below the water at rest, m, above A.
    pub depth_m: f64,
    /// c, 1/m, 0 …
    pub extinction_per_m: f64,
}

impl SineUnderZenith {
    /// Where the ray that enters at `x_m` lands, m.
    pub fn landing_m(&self, x_m: f64) -> f64 {
        let (height_m, slope, _) = self.surface(x_m);
        x_m + (self.depth_m + height_m) * self.deflection(slope).0.tan()
    }

    /// dX/dx at `x_m`.
    pub fn stretch(&self, x_m: f64) -> f64 {
        let (height_m, slope, curvature) = self.surface(x_m);
        let (deflection, per_slope) = self.deflection(slope);
        let secant2 = 1.0 / deflection.cos().powi(2);
        1.0 + slope * deflection.tan() + (self.depth_m + height_m) * secant2 * per_slope * curvature
    }

    /// Flux per dx of the ray that enters at `x_m`, at the floor: T e^(−c d), W/m².
    pub fn flux_density(&self, x_m: f64) -> f64 {
        let (height_m, slope, _) = self.surface(x_m);
        let cos_i = 1.0 / slope.hypot(1.0);
        let path_m = (self.depth_m + height_m) / self.deflection(slope).0.cos();
        // cos θ_i of the tilted surface times its larger area is 1 under a vertical sun.
        fresnel_transmittance(cos_i, self.ior) * transmission(self.extinction_per_m, path_m)
    }

    /// Irradiance at floor point `floor_x_m`, W/m²; infinite on a fold.
    pub fn irradiance_at(&self, floor_x_m: f64) -> f64 {
        let mut total = 0.0;
        for branch in self.branches() {
            for shift_m in self.shifts(&branch, floor_x_m, floor_x_m) {
                let (low, high) = branch.floor_m(self);
                let wanted = floor_x_m - shift_m;
                if (low..=high).contains(&wanted) {
                    let x_m = self.entry_m(&branch, wanted);
                    total += self.flux_density(x_m) / self.stretch(x_m).abs();
                }
            }
        }
        total
    }

    /// Mean irradiance of `count` texels from `min_m` on, W/m²: the flux of every stretch of surface that maps into a texel,
    /// integrated, over the texel's width.
    pub fn texel_means(&self, min_m: f64, texel_m: f64, count: usize) -> Vec<f64> {
        let edge = |j: usize| min_m + j as f64 * texel_m;
        let mut flux = vec![0.0; count];
        for branch in self.branches() {
            let (low, high) = branch.floor_m(self);
            for shift_m in self.shifts(&branch, min_m, edge(count)) {
                let first = ((low + shift_m - min_m) / texel_m).floor().max(0.0) as usize;
                for (j, flux) in flux.iter_mut().enumerate().skip(first) {
                    let from = (edge(j) - shift_m).max(low);
                    let to = (edge(j + 1) - shift_m).min(high);
                    if from > high {
                        break;
                    }
                    if from < to {
                        let (a, b) = (self.entry_m(&branch, from), self.entry_m(&branch, to));
                        *flux += self.flux_between(a.min(b), a.max(b));
                    }
                }
            }
        }
        flux.iter().map(|flux| flux / texel_m).collect()
    }

    /// Mean irradiance of the whole floor, W/m².
    pub fn mean_irradiance(&self) -> f64 {
        self.flux_between(0.0, self.wavelength_m) / self.wavelength_m
    }

    /// Entry points within a period (0 … λ) whose light lands on a caustic: dX/dx = 0, in order, m.
    pub fn folds_m(&self) -> Vec<f64> {
        let step_m = self.wavelength_m / f64::from(SAMPLES);
        (0..SAMPLES)
            .filter_map(|i| {
                let (a, b) = (f64::from(i) * step_m, f64::from(i + 1) * step_m);
                let (at_a, at_b) = (self.stretch(a), self.stretch(b));
                ((at_a < 0.0) != (at_b < 0.0))
                    .then(|| bisect(a, b, |x| (self.stretch(x) < 0.0) == (at_a < 0.0)))
            })
            .collect()
    }

    /// Stretches of one period of surface that map to the floor one to one.
    fn branches(&self) -> Vec<Branch> {
        let folds = self.folds_m();
        let Some(&first) = folds.first() else {
            return vec![Branch {
                from_m: 0.0,
                to_m: self.wavelength_m,
            }];
        };
        let mut ends = folds[1..].to_vec();
        ends.push(first + self.wavelength_m);
        folds
            .iter()
            .zip(ends)
            .map(|(&from_m, to_m)| Branch { from_m, to_m })
            .collect()
    }

    /// Whole wavelengths by which `branch` must be moved to light some of `low_m` … `high_m`.
    fn shifts(&self, branch: &Branch, low_m: f64, high_m: f64) -> impl Iterator<Item = f64> {
        let (low, high) = branch.floor_m(self);
        let first = ((low_m - high) / self.wavelength_m).floor() as i64;
        let last = ((high_m - low) / self.wavelength_m).ceil() as i64;
        let wavelength_m = self.wavelength_m;
        (first..=last).map(move |n| n as f64 * wavelength_m)
    }

    /// The point of `branch` whose light lands at `floor_x_m`.
    fn entry_m(&self, branch: &Branch, floor_x_m: f64) -> f64 {
        let rising = self.landing_m(branch.from_m) < self.landing_m(branch.to_m);
        bisect(branch.from_m, branch.to_m, |x| {
            (self.landing_m(x) < floor_x_m) == rising
        })
    }

    fn flux_between(&self, from_m: f64, to_m: f64) -> f64 {
        /// Nodes and weights of the five-point rule on −1 … 1. Abramowitz & Stegun, table 25.4.
        const GAUSS: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let pieces = ((to_m - from_m) / self.wavelength_m * PIECES)
            .ceil()
            .max(1.0);
        let half_m = 0.5 * (to_m - from_m) / pieces;
        let mut flux = 0.0;
        for piece in 0..pieces as u32 {
            let middle_m = from_m + f64::from(2 * piece + 1) * half_m;
            for (node, weight) in GAUSS {
                flux += weight * half_m * self.flux_density(middle_m + node * half_m);
            }
        }
        flux
    }

    /// h, h′ and h″.
    fn surface(&self, x_m: f64) -> (f64, f64, f64) {
        let k = TAU / self.wavelength_m;
        let (sin, cos) = (k * x_m + self.phase_rad).sin_cos();
        let a = self.amplitude_m;
        (a * sin, a * k * cos, -a * k * k * sin)
    }

    /// δ = θ_i − θ_t and dδ/dh′ for a slope h′ = tan θ_i.
    fn deflection(&self, slope: f64) -> (f64, f64) {
        let incidence = slope.atan();
        let sin_t = incidence.sin() / self.ior;
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        let refraction_per_incidence = incidence.cos() / (self.ior * cos_t);
        (
            incidence - sin_t.asin(),
            (1.0 - refraction_per_incidence) / (1.0 + slope * slope),
        )
    }
}

#[derive(Clone, Copy, Debug)]
struct Branch {
    from_m: f64,
    to_m: f64,
}

impl Branch {
    /// Low and high end of the interval that it lights, m.
    fn floor_m(&self, sine: &SineUnderZenith) -> (f64, f64) {
        let (a, b) = (sine.landing_m(self.from_m), sine.landing_m(self.to_m));
        (a.min(b), a.max(b))
    }
}

/// The point between `a` and `b` up to which `before` holds.
fn bisect(mut a: f64, mut b: f64, before: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if middle <= a || middle >= b {
            break;
        }
        if before(middle) {
            a = middle;
        } else {
            b = middle;
        }
    }
    0.5 * (a + b)
}

/// A point light of 1 W/sr over flat water, or under it; everything depends on the distance from the point below it only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampOverFlatWater {
    /// Height of the light above the water, m; negative under water.
    pub height_m: f64,
    /// Floor below the water, m, above 0 and deeper than the light.
    pub depth_m: f64,
    /// Index of refraction, 1 …
    pub ior: f64,
    /// c, 1/m, 0 …
    pub extinction_per_m: f64,
}

impl LampOverFlatWater {
    /// Irradiance of the floor `distance_m` (0 …) away from the point below the light, W/m² per W/sr.
    ///
    /// A ray that enters at ρ lands at r(ρ) = ρ + D tan θ_t. What goes through the ring dρ of the water, I h/(ρ² + h²)^(3/2) · 2πρ dρ,
    /// spreads over the ring 2πr dr: E = I T h/(ρ² + h²)^(3/2) · (ρ/r)/(dr/dρ) · e^(−c d). Under water: I H/(r² + H²)^(3/2) · e^(−c d).
    pub fn irradiance_at(&self, distance_m: f64) -> f64 {
        if self.height_m <= 0.0 {
            let down_m = self.depth_m + self.height_m;
            let path_m = down_m.hypot(distance_m);
            return down_m / path_m.powi(3) * transmission(self.extinction_per_m, path_m);
        }
        let (h, n) = (self.height_m, self.ior);
        // tan θ_t = ρ/g and its derivative n²h²/g³, g² = (n² − 1)ρ² + n²h².
        let g = |rho: f64| ((n * n - 1.0) * rho * rho + n * n * h * h).sqrt();
        let rho_m = bisect(0.0, distance_m, |rho| {
            rho + self.depth_m * rho / g(rho) < distance_m
        });
        let g = g(rho_m);
        let slant_m = rho_m.hypot(h);
        let path_m = self.depth_m * (rho_m / g).hypot(1.0);
        let per_ring = 1.0 / (1.0 + self.depth_m / g);
        let stretch = 1.0 + self.depth_m * n * n * h * h / g.powi(3);
        fresnel_transmittance(h / slant_m, n) * h / slant_m.powi(3) * per_ring / stretch
            * transmission(self.extinction_per_m, path_m)
    }
}
