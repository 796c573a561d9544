//! What a camera sees, exactly: through the waves to the first surface, as the camera pass of the renderer is documented to.

use glam::{DVec2, DVec3};

use super::ReferenceError;
use super::place::Place;
use crate::physics::refraction::{normal_from_slope, reflect_direction, refract_direction};
use crate::scene::{Camera, DEFAULT_FIELD_OF_VIEW_DEG, Output, ResolvedScene};

/// Above the water by more than this counts as dry, m: rounding of a floor that lies in the water's plane.
const DRY_M: f64 = 1e-9;
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
}

/// How the camera ray of a pixel reaches its point.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Route {
    /// Without crossing the surface.
    Direct,
    /// From the air down into the water.
    Refracted,
    /// From the water up into the air.
    Left,
    /// Reflected at the surface from below.
    Mirrored,
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
    pub(super) fn point(&mut self, pixel: [u32; 2]) -> Option<ViewPoint> {
        let at = DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
        let ray = self.pixel_ray(at);
        let above = self.place.over_water_m(ray.from_m) >= 0.0;
        let until_m = self
            .place
            .meet_water(ray.from_m, ray.direction, if above { 1.0 } else { -1.0 })
            .unwrap_or(f64::MAX);
        if let Some(point) = self.first_surface(ray, until_m, true) {
            return Some(self.finish(point, at, Route::Direct));
        }
        if until_m == f64::MAX {
            return None;
        }
        let routes: &[Route] = if above {
            &[Route::Refracted]
        } else {
            // An object in the air has precedence over the mirror image of one in the water.
            &[Route::Left, Route::Mirrored]
        };
        for &route in routes {
            if let Some(ray) = self.last_leg(at, route)
                && let Some(point) = self.first_surface(ray, f64::MAX, route != Route::Left)
            {
                return Some(self.finish(point, at, route));
            }
        }
        None
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
            Ray {
                from_m: self.eye_m,
                direction: (picture.forward + offset).normalize(),
            }
        }
    }

    /// The last leg of the camera ray through `at`.
    fn last_leg(&self, at: DVec2, route: Route) -> Option<Ray> {
        let ray = self.pixel_ray(at);
        if route == Route::Direct {
            return Some(ray);
        }
        let side = if route == Route::Refracted { 1.0 } else { -1.0 };
        let t = self.place.meet_water(ray.from_m, ray.direction, side)?;
        let from_m = ray.from_m + ray.direction * t;
        let slope = self.place.surface.at(from_m.x, from_m.z).slope;
        let normal = normal_from_slope(slope.x, slope.y) * side;
        let ior = self.place.ior;
        let direction = match route {
            Route::Refracted => refract_direction(ray.direction, normal, ior)?,
            Route::Left => refract_direction(ray.direction, normal, 1.0 / ior)?,
            Route::Mirrored | Route::Direct => reflect_direction(ray.direction, normal),
        };
        Some(Ray { from_m, direction })
    }

    /// Position, normal and object of the first surface before `until_m`.
    fn first_surface(
        &mut self,
        ray: Ray,
        until_m: f64,
        with_floor: bool,
    ) -> Option<(DVec3, DVec3, Option<usize>)> {
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
                let on_floor = DVec3::new(p.x, floor.y_m, p.z);
                found = Some((on_floor, DVec3::Y, None));
            }
        }
        let seen = self
            .place
            .occluders
            .first_seen(from_m, direction, nearest_m, &mut self.stack);
        if let Some(seen) = seen {
            let p = from_m + direction * seen.distance_m;
            found = Some((p, seen.normal, Some(seen.object)));
        }
        found
    }

    fn finish(
        &self,
        (position_m, normal, object): (DVec3, DVec3, Option<usize>),
        at: DVec2,
        route: Route,
    ) -> ViewPoint {
        ViewPoint {
            position_m,
            normal,
            object,
            dry: self.place.over_water_m(position_m) > DRY_M,
            side_m: self.side_m(position_m, normal, at, route),
        }
    }

    /// The geometric mean of the distances between `p_m` and where the rays of the next pixels along x and y meet its plane.
    fn side_m(&self, p_m: DVec3, normal: DVec3, at: DVec2, route: Route) -> f64 {
        let to_next = |step: DVec2| {
            [step, -step].into_iter().find_map(|step| {
                let Ray { from_m, direction } = self.last_leg(at + step, route)?;
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
