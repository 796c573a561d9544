//! The rays of one light that may hit an object, parametrised by (s, t). Every unit of (s, t) gets the same number of rays. A unit has the
//! size of a texel, seen through flat water or from a point light under water.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::lattice::{Lattice, Row};
use super::light::{PlacedLight, Source};
use super::place::Place;
use super::refract::{BLOCK, Block, RowRefractor};
use super::rings::Rings;
use super::slanted::Cells;
use super::window::{LightWindow, Target};
use crate::physics::fresnel::fresnel_transmittance;

/// How far rays continue beyond the object, as a share of its size.
const BEYOND: f64 = 1e-3;

/// A ray towards the object.
pub(super) struct Ray {
    pub(super) from_m: DVec3,
    /// A point beyond the object.
    pub(super) to_m: DVec3,
    /// Distance between the two, m.
    pub(super) path_m: f64,
    /// Flux per power of the light, m² of a sun or sr of a point light, for a lattice with one point per unit.
    pub(super) flux: f64,
}

/// Where the rays come from.
enum Origin {
    /// The water, with a sun above in this direction.
    Sun(Cells, DVec3),
    /// The water, with a point light above.
    Lamp(Rings),
    /// A point light under water.
    Cone(Cone),
}

/// Directions from a point light: (1 − cos θ, φ) around an axis, in units that the caller chooses; units are equal solid angles.
struct Cone {
    lamp_m: DVec3,
    axis: DVec3,
    across: [DVec3; 2],
    unit: f64,
}

/// The rays of one lattice.
pub(super) struct Volley<'a> {
    rays: &'a ObjectRays<'a>,
    lattice: Lattice,
    /// Of a sun.
    refractor: Option<RowRefractor>,
}

/// All rays of one light to one object.
pub(super) struct ObjectRays<'a> {
    place: &'a Place,
    light: &'a PlacedLight,
    origin: Origin,
    /// Rectangle of (s, t) that holds all rays that can reach the object.
    pub(super) part: LightWindow,
    bounds: Target,
    /// A plane below the object, m below the water at rest.
    end_m: f64,
}

impl Cone {
    /// The directions from `lamp_m` to the ball of `radius_m` around `middle_m`, and their rectangle of (s, t). A unit is the solid
    /// angle of `square_m2` at the ball.
    fn of(lamp_m: DVec3, middle_m: DVec3, radius_m: f64, square_m2: f64) -> (Self, LightWindow) {
        let way_m = middle_m - lamp_m;
        let distance_m = way_m.length();
        let axis = way_m.try_normalize().unwrap_or(-DVec3::Y);
        let (u, v) = axis.any_orthonormal_pair();
        // From inside the ball these are all directions.
        let from_axis = if distance_m > radius_m {
            let sine = radius_m / distance_m;
            sine * sine / (1.0 + (1.0 - sine * sine).sqrt())
        } else {
            2.0
        };
        let unit = (square_m2 / way_m.length_squared().max(square_m2)).sqrt();
        let part = LightWindow {
            min_m: DVec2::ZERO,
            max_m: DVec2::new(from_axis, TAU) / unit,
        };
        let cone = Self {
            lamp_m,
            axis,
            across: [u, v],
            unit,
        };
        (cone, part)
    }

    fn direction(&self, st: DVec2) -> DVec3 {
        let from_axis = st.x * self.unit;
        let sine = (from_axis * (2.0 - from_axis)).max(0.0).sqrt();
        let (sin, cos) = (st.y * self.unit).sin_cos();
        let [u, v] = self.across;
        self.axis * (1.0 - from_axis) + (u * cos + v * sin) * sine
    }
}

impl<'a> ObjectRays<'a> {
    /// For an object within `bounds` and texels with edges `edges_m` around `corner_m`; `None` when no light can reach it.
    pub(super) fn new(
        place: &'a Place,
        light: &'a PlacedLight,
        bounds: Target,
        (corner_m, edges_m): (DVec3, [DVec3; 2]),
    ) -> Option<Self> {
        let size_m = (bounds.max_m - bounds.min_m).length();
        let middle_m = (bounds.min_m + bounds.max_m) * 0.5;
        let texel = edges_m[0].cross(edges_m[1]);
        let (origin, part) = match light.source {
            Source::Sun { to_light } => {
                let flat = light.source.flat_direction(middle_m, place.ior)?;
                let cells = Cells::of(corner_m, edges_m[0], edges_m[1], flat);
                let part = cells.around(&light.window(place, bounds));
                (Origin::Sun(cells, to_light), part)
            }
            Source::Lamp {
                position_m,
                submerged: false,
            } => {
                // Texels in the middle of the object; others get nearly the same part of the rings.
                let texel = (middle_m, texel.normalize_or_zero(), texel.length());
                let rings = light.rings(place, position_m, texel);
                let part = rings.around_window(&light.window(place, bounds));
                (Origin::Lamp(rings), part)
            }
            Source::Lamp {
                position_m,
                submerged: true,
            } => {
                let (cone, part) = Cone::of(position_m, middle_m, 0.5 * size_m, texel.length());
                (Origin::Cone(cone), part)
            }
        };
        let size = part.max_m - part.min_m;
        (size.is_finite() && size.min_element() > 0.0).then_some(Self {
            place,
            light,
            origin,
            part,
            bounds,
            end_m: -(bounds.min_m.y - BEYOND * size_m),
        })
    }

    /// The rays that start at the points of `lattice`.
    pub(super) fn volley(&'a self, lattice: Lattice) -> Volley<'a> {
        let place = self.place;
        let refractor = match &self.origin {
            Origin::Sun(cells, to_light) => Some(RowRefractor::new(
                &place.surface,
                cells.basis_m * lattice.step_m(),
                *to_light,
                place.ior,
                self.end_m,
            )),
            Origin::Lamp(_) | Origin::Cone(_) => None,
        };
        Volley {
            rays: self,
            lattice,
            refractor,
        }
    }

    /// The latest point where a ray leaves the ball that contains the object.
    fn beyond(&self, from_m: DVec3, direction: DVec3) -> (DVec3, f64) {
        let middle_m = (self.bounds.min_m + self.bounds.max_m) * 0.5;
        let size_m = (self.bounds.max_m - self.bounds.min_m).length();
        let path_m = from_m.distance(middle_m) + (0.5 + BEYOND) * size_m;
        (from_m + direction * path_m, path_m)
    }

    /// The ray of a point light through a place that represents `m2` of water.
    fn through_water(&self, (water_m, m2): (DVec2, f64)) -> Option<Ray> {
        let bent = self.light.bend(self.place, water_m)?;
        // Light that is refracted upwards is lost, as for a sun.
        if bent.direction.y >= -1e-9 {
            return None;
        }
        let (to_m, path_m) = self.beyond(bent.from_m, bent.direction);
        Some(Ray {
            from_m: bent.from_m,
            to_m,
            path_m,
            flux: m2 * bent.facing * fresnel_transmittance(bent.cos_i, self.place.ior),
        })
    }
}

impl Volley<'_> {
    /// Sends the rays of `row`, each to `each`.
    pub(super) fn send(&self, row: Row, each: &mut dyn FnMut(&Ray)) {
        let step = self.lattice.step_m();
        match (&self.rays.origin, &self.refractor) {
            (Origin::Sun(cells, _), Some(refractor)) => {
                self.send_blocks(cells, refractor, row, each);
            }
            (Origin::Sun(..), None) => {}
            (Origin::Lamp(rings), _) => {
                for i in 0..row.count {
                    let water = rings.place(row.start_m + step * i as f64);
                    if let Some(ray) = self.rays.through_water(water) {
                        each(&ray);
                    }
                }
            }
            (Origin::Cone(cone), _) => {
                for i in 0..row.count {
                    let direction = cone.direction(row.start_m + step * i as f64);
                    let (to_m, path_m) = self.rays.beyond(cone.lamp_m, direction);
                    each(&Ray {
                        from_m: cone.lamp_m,
                        to_m,
                        path_m,
                        flux: cone.unit * cone.unit,
                    });
                }
            }
        }
    }

    fn send_blocks(
        &self,
        cells: &Cells,
        refractor: &RowRefractor,
        row: Row,
        each: &mut dyn FnMut(&Ray),
    ) {
        let step_m = cells.basis_m * self.lattice.step_m();
        let row_m = cells.water_m(row.start_m);
        let mut block = Block::new();
        let mut done = 0;
        while done < row.count {
            let start_m = row_m + step_m * done as f64;
            let count = (row.count - done).min(BLOCK as u64);
            refractor.send(start_m, &mut block);
            for i in 0..count as usize {
                if block.x_m[i].is_nan() || block.entered[i] <= 0.0 {
                    continue;
                }
                let top_m = start_m + step_m * i as f64;
                each(&Ray {
                    from_m: DVec3::new(top_m.x, block.water.height_m[i], top_m.y),
                    to_m: DVec3::new(block.x_m[i], -self.rays.end_m, block.z_m[i]),
                    path_m: block.path_m[i],
                    flux: block.entered[i] * cells.area_m2(),
                });
            }
            done += count;
        }
    }
}
