//! What a camera sees, exactly: through the waves to the first surface, as the camera pass of the renderer is documented to.

use glam::{DVec2, DVec3};

use super::ReferenceError;
use super::place::Place;
use crate::physics::fresnel::fresnel_reflectance;
use crate::physics::refraction::{normal_from_slope, reflect_direction, refract_direction};
use crate::scene::{Camera, DEFAULT_FIELD_OF_VIEW_DEG, Output, ResolvedScene};

/// Above the water by more than this counts as dry, m: rounding of a floor that lies in the water's plane.
const DRY_M: f64 = 1e-9;
/// Distance from the water at which a ray begins that leaves it, m.
const OFF_M: f64 = 1e-9;
/// Smallest and largest side of a pixel's footprint, m.
const SIDES_M: (f64, f64) = (1e-4, 1.0);

/// The point that a pixel shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewPoint {
    /// Local position, m.
    pub(super) position_m: DVec3,
    /// Unit shading normal towards the viewer.
    pub(super) normal: DVec3,
    /// Index of the object; `None`: the floor.
    pub(super) object: Option<usize>,
    /// Whether it stands out of the water.
    pub(super) dry: bool,
    /// Side of the square that the pixel covers there, m.
    pub(super) side_m: f64,
    /// Diffuse reflectance.
    pub(super) albedo: [f64; 3],
}

/// A surface on a ray.
struct Surfaced {
    distance_m: f64,
    position_m: DVec3,
    normal: DVec3,
    object: Option<usize>,
    albedo: [f64; 3],
}

/// What a ray does where it meets the water.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// It is refracted into the other medium.
    Through,
    /// It is reflected.
    Mirrored,
}

/// One way of a camera ray, and where it ends.
#[derive(Clone, Debug)]
pub(super) struct Leg {
    /// Factor on the radiance at its end that the water's surface makes: Fresnel's shares, and n² for each change of medium.
    pub(super) weight: f64,
    /// Length of its parts under water, m.
    pub(super) wet_m: f64,
    /// The point; `None`: the sky.
    pub(super) end: Option<ViewPoint>,
}

/// A ray.
#[derive(Clone, Copy, Debug)]
struct Ray {
    from_m: DVec3,
    direction: DVec3,
}

/// The geometry of a camera: which ray belongs to which place in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Picture {
    /// World position of the camera's target, m.
    target_m: DVec3,
    /// World position of the eye (for parallel rays, of the middle of the image plane), m.
    eye_m: DVec3,
    /// Unit viewing direction.
    forward: DVec3,
    /// Where the axis meets the picture, from its middle, in halves of its width and height (right and up are positive).
    axis_at: DVec2,
    /// From the middle to the right edge of the picture, at unit distance (for parallel rays, m).
    right: DVec3,
    /// From the middle to the upper edge.
    up: DVec3,
    /// Whether all rays are parallel.
    parallel: bool,
    /// Way from the eye to where rays start, m.
    start_m: f64,
    /// Width and height, pixels.
    pixels: DVec2,
}

impl Picture {
    /// The camera of `resolved`.
    pub(super) fn of(resolved: &ResolvedScene) -> Result<Self, ReferenceError> {
        let (Output::View(output), Some(camera)) = (&resolved.scene.output, &resolved.scene.camera)
        else {
            return Err(ReferenceError::NoCamera);
        };
        let (eye_m, target_m, up) = camera.pose();
        let (eye_m, target_m) = (DVec3::from(eye_m), DVec3::from(target_m));
        let forward = (target_m - eye_m).normalize();
        let right = forward.cross(DVec3::from(up)).normalize();
        let pixels = DVec2::new(f64::from(output.width), f64::from(output.height));
        let square =
            |half_height: f64| DVec2::new(half_height * (pixels.x / pixels.y), half_height);
        let mut axis_at = DVec2::ZERO;
        let start_m = match camera {
            Camera::Perspective(c) => c.dome_radius_m,
            Camera::Orthographic(_) => 0.0,
        };
        let (half, parallel) = match camera {
            Camera::Perspective(c) => match (c.intrinsics, c.vertical_fov_deg) {
                (Some(lens), _) => {
                    let center = DVec2::new(lens.cx, lens.cy);
                    axis_at = (2.0 * center / pixels - 1.0) * DVec2::new(1.0, -1.0);
                    (0.5 * pixels / DVec2::new(lens.fx, lens.fy), false)
                }
                (None, degrees) => {
                    let degrees = degrees.unwrap_or(DEFAULT_FIELD_OF_VIEW_DEG);
                    (square((0.5 * degrees.to_radians()).tan()), false)
                }
            },
            Camera::Orthographic(c) => (square(0.5 * c.height_m), true),
        };
        Ok(Self {
            target_m,
            eye_m,
            forward,
            axis_at,
            right: right * half.x,
            up: right.cross(forward) * half.y,
            parallel,
            start_m,
            pixels,
        })
    }

    /// World (x, z) of the camera's target, m.
    pub(super) fn middle_m(&self) -> DVec2 {
        DVec2::new(self.target_m.x, self.target_m.z)
    }
}

/// A camera in its place.
#[derive(Clone)]
pub(super) struct Viewer<'a> {
    place: &'a Place,
    picture: &'a Picture,
    /// The eye in local coordinates, m.
    eye_m: DVec3,
    /// Whether a ray starts above the water is decided per ray, because an image plane may dip into the waves.
    stack: Vec<usize>,
}

impl<'a> Viewer<'a> {
    pub(super) fn of(place: &'a Place, picture: &'a Picture) -> Self {
        Self {
            place,
            picture,
            eye_m: picture.eye_m - place.origin_m,
            stack: Vec::new(),
        }
    }

    /// What the middle of a pixel shows; pixels are numbered from the upper left. `None`: no surface.
    ///
    /// Where a ray from below shows an object in the air, that is the point, not the mirror image of what is under water.
    pub(super) fn point(&mut self, pixel: [u32; 2]) -> Option<ViewPoint> {
        let at = middle_of(pixel);
        let ray = self.pixel_ray(at);
        let above = self.place.over_water_m(ray.from_m) >= 0.0;
        let until_m = self.meet_water(ray, above).unwrap_or(f64::MAX);
        if let Some(found) = self.first_surface(ray, until_m, true) {
            return Some(self.finish(&found, at, &[]));
        }
        if until_m == f64::MAX {
            return None;
        }
        let turns: &[Turn] = if above {
            &[Turn::Through]
        } else {
            &[Turn::Through, Turn::Mirrored]
        };
        for &turn in turns {
            let in_air = !above && turn == Turn::Through;
            if let Some((ray, _)) = self.turned(at, &[turn])
                && let Some(found) = self.first_surface(ray, f64::MAX, !in_air)
            {
                return Some(self.finish(&found, at, &[turn]));
            }
        }
        None
    }

    /// All ways of the ray through the middle of a pixel that meet the water at most `bounces` times. Beyond, a ray in the air ends at the
    /// water and shows the sky, and one in the water goes straight on.
    pub(super) fn legs(&mut self, pixel: [u32; 2], bounces: u32) -> Vec<Leg> {
        let at = middle_of(pixel);
        let ray = self.pixel_ray(at);
        let above = self.place.over_water_m(ray.from_m) >= 0.0;
        let mut all = Vec::new();
        let start = Way {
            turns: Vec::new(),
            ray,
            above,
            weight: 1.0,
            wet_m: 0.0,
        };
        self.follow(at, &start, bounces, &mut all);
        all
    }

    /// Adds the ways that continue `way`.
    fn follow(&mut self, at: DVec2, way: &Way, bounces: u32, all: &mut Vec<Leg>) {
        let may_turn = (way.turns.len() as u32) < bounces;
        let meets = self.meet_water(way.ray, way.above);
        let until_m = match meets {
            Some(t) if way.above || may_turn => t,
            _ => f64::MAX,
        };
        let wet = |length_m: f64| way.wet_m + if way.above { 0.0 } else { length_m };
        if let Some(found) = self.first_surface(way.ray, until_m, true) {
            all.push(Leg {
                weight: way.weight,
                wet_m: wet(found.distance_m),
                end: Some(self.finish(&found, at, &way.turns)),
            });
            return;
        }
        if !may_turn || meets.is_none() {
            if way.above {
                all.push(Leg {
                    weight: way.weight,
                    wet_m: way.wet_m,
                    end: None,
                });
            }
            return;
        }
        for turn in [Turn::Through, Turn::Mirrored] {
            let turns = [way.turns.as_slice(), &[turn]].concat();
            if let Some((ray, share)) = self.turned(at, &turns)
                && share > 0.0
            {
                let next = Way {
                    turns,
                    ray,
                    above: way.above != (turn == Turn::Through),
                    weight: way.weight * share,
                    wet_m: wet(until_m),
                };
                self.follow(at, &next, bounces, all);
            }
        }
    }

    fn meet_water(&self, ray: Ray, above: bool) -> Option<f64> {
        let side = if above { 1.0 } else { -1.0 };
        self.place.meet_water(ray.from_m, ray.direction, side)
    }

    /// The ray through `at`, in pixels from the upper left corner.
    fn pixel_ray(&self, at: DVec2) -> Ray {
        let picture = self.picture;
        let right = 2.0 * at.x / picture.pixels.x - 1.0 - picture.axis_at.x;
        let up = 1.0 - 2.0 * at.y / picture.pixels.y - picture.axis_at.y;
        let offset = picture.right * right + picture.up * up;
        if picture.parallel {
            Ray {
                from_m: self.eye_m + offset,
                direction: picture.forward,
            }
        } else {
            let direction = (picture.forward + offset).normalize();
            Ray {
                from_m: self.eye_m + direction * picture.start_m,
                direction,
            }
        }
    }

    /// The ray through `at` after these turns at the water, and the factor of the last of them on radiance.
    fn turned(&self, at: DVec2, turns: &[Turn]) -> Option<(Ray, f64)> {
        let mut ray = self.pixel_ray(at);
        let mut above = self.place.over_water_m(ray.from_m) >= 0.0;
        let mut share = 1.0;
        for &turn in turns {
            let t = self.meet_water(ray, above)?;
            let from_m = ray.from_m + ray.direction * t;
            let slope = self.place.surface.at(from_m.x, from_m.z).slope;
            let upward = normal_from_slope(slope.x, slope.y);
            let (normal, ior) = if above {
                (upward, self.place.ior)
            } else {
                (-upward, 1.0 / self.place.ior)
            };
            let reflectance = fresnel_reflectance(-ray.direction.dot(normal), ior);
            // The next part begins on its own side, so that it does not meet the water where it leaves it.
            let (direction, side) = match turn {
                Turn::Through => {
                    above = !above;
                    share = (1.0 - reflectance) / (ior * ior);
                    (refract_direction(ray.direction, normal, ior)?, -1.0)
                }
                Turn::Mirrored => {
                    share = reflectance;
                    (reflect_direction(ray.direction, normal), 1.0)
                }
            };
            ray = Ray {
                from_m: from_m + normal * (side * OFF_M),
                direction,
            };
        }
        Some((ray, share))
    }

    /// The first surface before `until_m`.
    fn first_surface(&mut self, ray: Ray, until_m: f64, with_floor: bool) -> Option<Surfaced> {
        let Ray { from_m, direction } = ray;
        let mut nearest_m = until_m;
        let mut found = None;
        if let Some(floor) = &self.place.floor
            && with_floor
            && direction.y < 0.0
        {
            let t = (floor.y_m - from_m.y) / direction.y;
            let p = from_m + direction * t;
            if t > 0.0 && t < nearest_m && floor.spans(p) {
                nearest_m = t;
                found = Some(Surfaced {
                    distance_m: t,
                    position_m: DVec3::new(p.x, floor.y_m, p.z),
                    normal: DVec3::Y,
                    object: None,
                    albedo: floor.albedo,
                });
            }
        }
        let seen = self
            .place
            .occluders
            .first_seen(from_m, direction, nearest_m, &mut self.stack);
        if let Some(seen) = seen {
            found = Some(Surfaced {
                distance_m: seen.distance_m,
                position_m: from_m + direction * seen.distance_m,
                normal: seen.normal,
                object: Some(seen.object),
                albedo: seen.albedo,
            });
        }
        found
    }

    fn finish(&self, found: &Surfaced, at: DVec2, turns: &[Turn]) -> ViewPoint {
        ViewPoint {
            position_m: found.position_m,
            normal: found.normal,
            object: found.object,
            dry: self.place.over_water_m(found.position_m) > DRY_M,
            side_m: self.side_m(found.position_m, found.normal, at, turns),
            albedo: found.albedo,
        }
    }

    /// The geometric mean of the distances between `p_m` and where the rays of the next pixels along x and y meet its plane.
    fn side_m(&self, p_m: DVec3, normal: DVec3, at: DVec2, turns: &[Turn]) -> f64 {
        let to_next = |step: DVec2| {
            [step, -step].into_iter().find_map(|step| {
                let (Ray { from_m, direction }, _) = self.turned(at + step, turns)?;
                let t = (p_m - from_m).dot(normal) / direction.dot(normal);
                let distance_m = (from_m + direction * t).distance(p_m);
                (t > 0.0 && distance_m.is_finite()).then_some(distance_m)
            })
        };
        let (least_m, most_m) = SIDES_M;
        let side_m = match (to_next(DVec2::X), to_next(DVec2::Y)) {
            (Some(x_m), Some(y_m)) => (x_m * y_m).sqrt(),
            (Some(only_m), None) | (None, Some(only_m)) => only_m,
            (None, None) => least_m,
        };
        side_m.clamp(least_m, most_m)
    }
}

/// A camera ray on its way.
struct Way {
    turns: Vec<Turn>,
    ray: Ray,
    above: bool,
    /// See [`Leg::weight`].
    weight: f64,
    /// See [`Leg::wet_m`].
    wet_m: f64,
}

fn middle_of(pixel: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5)
}
