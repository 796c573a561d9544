//! Where the light of a sun or point light comes from, and the grid that samples it.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::window::Rect;
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::refraction;
use crate::scene::Light;
use crate::waves::Surface;

/// Largest ratio of cell sizes in a point light's grid.
const MOST_STRETCH: f64 = 9.0;
/// Distance beyond which a light counts as far aside, in sides of the window.
const FAR_ASIDE: f64 = 4.0;
/// Least depth and distance from which a direction is computed, m.
const TINY_M: f64 = 1e-6;

/// Where light comes from, local coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A sun.
    Sun {
        /// Unit direction to it.
        to_light: DVec3,
    },
    /// A point light above the water at its place.
    Point {
        /// Where it is, m.
        position_m: DVec3,
    },
    /// A point light under the water at its place, or on it.
    Submerged {
        /// Where it is, m.
        position_m: DVec3,
    },
}

/// A light that dry surfaces see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirLight {
    /// A sun above the horizon or a point light above the water.
    pub source: Source,
    /// W/m² on a plane facing the sun, or W/sr of the point light.
    pub power: [f64; 3],
}

impl Source {
    /// Source and power of a light around the local origin `origin_m`; `None` for skies and suns at or below the horizon.
    pub fn of(light: &Light, origin_m: DVec3, surface: &Surface) -> Option<(Self, [f64; 3])> {
        match light {
            Light::Sky(_) => None,
            Light::Sun(sun) if sun.elevation_deg <= 0.0 => None,
            Light::Sun(sun) => {
                let to_light = refraction::direction_to_light(
                    sun.elevation_deg.to_radians(),
                    sun.azimuth_deg.to_radians(),
                );
                Some((Self::Sun { to_light }, sun.irradiance_w_m2))
            }
            Light::Point(point) => {
                let position_m = DVec3::from(point.position_m) - origin_m;
                let water_m = surface.at(position_m.x, position_m.z).height_m;
                let source = if position_m.y > water_m {
                    Self::Point { position_m }
                } else {
                    Self::Submerged { position_m }
                };
                Some((source, point.intensity_w_sr))
            }
        }
    }

    /// Unit direction under flat water of the ray that goes through `target_m`; `None` where no light enters the water.
    ///
    /// For a point light above the water the entry point is solved so that the refracted ray hits the target (thesis §4.2.1, eq. 2-8). A
    /// light under water shines straight.
    pub fn direction_at(&self, target_m: DVec3, ior: f64) -> Option<DVec3> {
        match *self {
            Self::Sun { to_light } => refraction::refract_direction(-to_light, DVec3::Y, ior),
            Self::Submerged { position_m } => {
                Some((target_m - position_m).try_normalize().unwrap_or(-DVec3::Y))
            }
            Self::Point { position_m } => {
                let sideways = DVec2::new(target_m.x - position_m.x, target_m.z - position_m.z);
                let distance_m = sideways.length();
                let depth_m = (-target_m.y).max(TINY_M);
                let height_m = position_m.y.max(TINY_M);
                let under_m =
                    distance_m - refraction::entry_distance(height_m, depth_m, distance_m, ior);
                let along = sideways.try_normalize().unwrap_or(DVec2::ZERO) * under_m;
                DVec3::new(along.x, -depth_m, along.y).try_normalize()
            }
        }
    }

    /// Apparent height of a point light above `y_m`, seen from straight below through flat water: h + d/n. For a light under water its
    /// true height above `y_m`.
    pub fn apparent_height_m(&self, y_m: f64, ior: f64) -> f64 {
        match *self {
            Self::Sun { .. } => f64::INFINITY,
            Self::Submerged { position_m } => position_m.y - y_m,
            Self::Point { position_m } => position_m.y.max(0.0) + (-y_m).max(0.0) / ior,
        }
    }

    /// Upper bound of the flux of a light of unit power onto an area of `area_m2` across its rays around a place under flat water, without
    /// absorption: m² for a sun, sr for a point light, at most half of all directions.
    pub(super) fn most_onto(&self, middle_m: DVec3, area_m2: f64, ior: f64) -> f64 {
        let within = |distance2_m2: f64| {
            if area_m2 > 0.0 {
                area_m2 / (distance2_m2 + area_m2 / TAU)
            } else {
                0.0
            }
        };
        match *self {
            Self::Sun { to_light } => {
                let enters = fresnel_transmittance(to_light.y, ior) * to_light.y;
                self.direction_at(middle_m, ior)
                    .map_or(0.0, |direction| area_m2 * enters / -direction.y)
            }
            Self::Point { position_m } => {
                let sideways =
                    DVec2::new(middle_m.x - position_m.x, middle_m.z - position_m.z).length();
                within(
                    sideways
                        .hypot(self.apparent_height_m(middle_m.y, ior))
                        .powi(2),
                )
            }
            Self::Submerged { position_m } => within((middle_m - position_m).length_squared()),
        }
    }

    /// Position of a point light; `None` for a sun.
    pub fn position_m(&self) -> Option<DVec3> {
        match *self {
            Self::Sun { .. } => None,
            Self::Point { position_m } | Self::Submerged { position_m } => Some(position_m),
        }
    }
}

/// Mapping of the grid onto the water: x = foot + s (1 + β s²) along both axes. Cells are smaller under a near light, where its rays
/// diverge most. Shaders evaluate the same polynomial for any vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Range of s, m; for a light under water the range of the octahedral coordinates.
    pub places: Rect,
    /// The point under the light, local (x, z); (0, 0) for suns, lights far aside and lights under water.
    pub foot_m: DVec2,
    /// β, 1/m²; 0: all cells have the same size.
    pub bend_per_m2: f64,
}

impl Grid {
    /// The grid over `window` for light from `source`.
    pub fn over(window: Rect, source: &Source) -> Self {
        let even = Self {
            places: window,
            foot_m: DVec2::ZERO,
            bend_per_m2: 0.0,
        };
        let Source::Point { position_m } = *source else {
            return even;
        };
        let foot_m = DVec2::new(position_m.x, position_m.z);
        let (low, high) = (window.min - foot_m, window.max - foot_m);
        let reach_m = low.abs().max(high.abs()).max_element();
        if reach_m > FAR_ASIDE * window.size().max_element() {
            // Its light changes little over the window, and f32 could not resolve coordinates relative to such a distant foot.
            return even;
        }
        let steep = reach_m / position_m.y.max(TINY_M * reach_m);
        let stretch = (1.0 + 0.25 * steep * steep).min(MOST_STRETCH);
        // x(S) = reach with x′(S) = stretch.
        let end = 3.0 * reach_m / (stretch + 2.0);
        let bend_per_m2 = (stretch - 1.0) / (3.0 * end * end);
        let place = |x: f64| {
            let (mut s_low, mut s_high) = (-end, end);
            for _ in 0..100 {
                let s = 0.5 * (s_low + s_high);
                if s * (1.0 + bend_per_m2 * s * s) < x {
                    s_low = s;
                } else {
                    s_high = s;
                }
            }
            0.5 * (s_low + s_high)
        };
        let place2 = |p: DVec2| DVec2::new(place(p.x), place(p.y));
        Self {
            places: Rect {
                min: place2(low),
                max: place2(high),
            },
            foot_m,
            bend_per_m2,
        }
    }

    /// dx/ds.
    pub fn stretch(&self, s: f64) -> f64 {
        1.0 + 3.0 * self.bend_per_m2 * s * s
    }

    /// Longest side of any cell of a grid of `cells` × `cells`, m.
    pub fn widest_cell_m(&self, cells: u32) -> f64 {
        let farthest = self.places.min.abs().max(self.places.max.abs());
        let step = self.places.size() / f64::from(cells);
        (step.x * self.stretch(farthest.x)).max(step.y * self.stretch(farthest.y))
    }
}

/// Irradiance of a plane facing a point light, W/m², in the middle of the output's region, at the height of the floor (of the water at
/// rest where there is no floor). Exposure uses it. Distances below 0.1 m count as 0.1 m.
pub(super) fn facing_w_m2(position_m: DVec3, floor_y_m: Option<f64>, intensity_w_sr: f64) -> f64 {
    const NEAREST_M: f64 = 0.1;
    let middle_m = DVec3::new(0.0, floor_y_m.unwrap_or(0.0), 0.0);
    intensity_w_sr / (position_m - middle_m).length().max(NEAREST_M).powi(2)
}
