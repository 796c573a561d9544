//! Level of detail: the size of an object in the picture, and the number of texels that its maps get for it.

use glam::DVec3;

use super::{CameraFacts, SceneFacts};
use crate::scene::ranges::{Integer, LevelMapTexels};

/// Largest sideways displacement of an object's image by waves, per depth and per unit of their steepest slope: a surface tilted by α turns
/// a refracted ray by less than α, and the ray goes down at a slant.
const SWAY: f64 = 2.0;

impl SceneFacts {
    /// Texels along a side of an object's maps as a share of `quality.level_map_texels`, above 0 … 1; 1 without level of detail.
    pub fn detail_of(&self, object: usize) -> f64 {
        f64::from(self.receivers.objects[object].map_texels)
            / f64::from(self.quality.level_map_texels)
    }

    /// Number of reference planes of an object, from 2 to the method's number. It falls in proportion to the texels of its maps, so that the
    /// distance between planes grows with the texel size (Tipprasert 2006, §6.1). 0 where the method has none.
    pub fn planes_of(&self, object: usize) -> u32 {
        if self.method.reference_planes == 0 {
            return 0;
        }
        let slices = f64::from(self.method.reference_planes - 1);
        1 + (slices * self.detail_of(object)).round().max(1.0) as u32
    }

    /// Text of a plan about wet objects with smaller maps; empty where there are none.
    pub fn reduced_maps(&self) -> String {
        let reduced = self.wet_objects().filter(|&o| self.detail_of(o) < 1.0);
        match reduced.count() {
            0 => String::new(),
            count => format!(", {count} with smaller maps by quality.level_of_detail"),
        }
    }

    /// Sizes each object's maps for its size in the picture, if the scene requests that.
    pub(super) fn size_maps(&mut self) {
        let per_pixel = self.quality.level_of_detail;
        let Some(camera) = self.output.camera.filter(|_| per_pixel > 0.0) else {
            return;
        };
        let most = self.quality.level_map_texels;
        for object in 0..self.receivers.objects.len() {
            let texels = (self.size_in_pixels(object, &camera) * per_pixel).ceil();
            let texels = texels.min(f64::from(most)) as u32;
            self.receivers.objects[object].map_texels =
                texels.next_power_of_two().clamp(LevelMapTexels::MIN, most);
        }
    }

    /// Longest diagonal of an object's bounds in the picture, pixels; 0 if it is certainly outside, infinite if it is around the eye.
    ///
    /// Flat water in between makes an object look nearer: a path length d under water looks like d / n.
    fn size_in_pixels(&self, object: usize, camera: &CameraFacts) -> f64 {
        let object = &self.receivers.objects[object];
        let highest_m = self.water.surface.max_height_m();
        // From below the surface, total reflection may show any object.
        let in_air = camera.eye.y > highest_m;
        if in_air && self.is_outside(object.min, object.max, camera) {
            return 0.0;
        }
        let diagonal_m = (object.max - object.min).length();
        let per_unit = f64::from(camera.height) / (2.0 * camera.up.length());
        if camera.orthographic {
            return diagonal_m * per_unit;
        }
        let nearest = camera.eye.clamp(object.min, object.max);
        let from_eye = nearest - camera.eye;
        let below = if in_air && nearest.y < 0.0 {
            nearest.y / (nearest.y - camera.eye.y)
        } else {
            0.0
        };
        let apparent_m = from_eye.length() * (1.0 - below + below / self.water.ior);
        // Perspective stretches the image away from the picture's middle, at most as much as in its corners.
        let corner = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]
            .map(|[x, y]| (camera.middle + camera.right * x + camera.up * y).length())
            .into_iter()
            .fold(1.0, f64::max);
        let cosine = from_eye
            .normalize_or_zero()
            .dot(camera.forward)
            .max(1.0 / corner);
        diagonal_m * per_unit / (apparent_m * cosine * cosine)
    }

    /// Whether a box is certainly outside the picture of a camera in the air: the box and all places where refraction may show it lie beyond
    /// one edge of the picture.
    fn is_outside(&self, min: DVec3, max: DVec3, camera: &CameraFacts) -> bool {
        // Flat water shows a point between its true place and the water above it; waves move this image to and fro.
        let sway_m = SWAY * self.water.surface.max_slope() * (-min.y).max(0.0);
        let top_m = max.y.max(self.water.surface.max_height_m());
        let low = DVec3::new(min.x - sway_m, min.y, min.z - sway_m);
        let high = DVec3::new(max.x + sway_m, top_m, max.z + sway_m);
        let corners: [DVec3; 8] = std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { low } else { high }[axis];
            DVec3::new(pick(0), pick(1), pick(2)) - camera.eye
        });
        let half = [camera.right.length(), camera.up.length()];
        let across = [camera.right / half[0], camera.up / half[1]];
        // Distance beyond an edge: positive outside.
        let beyond = |p: DVec3, axis: usize, sign: f64| {
            let reach = if camera.orthographic {
                1.0
            } else {
                p.dot(camera.forward)
            };
            sign * (p.dot(across[axis]) - camera.middle.dot(across[axis]) * reach)
                - half[axis] * reach
        };
        let all = |outside: &dyn Fn(DVec3) -> bool| corners.iter().all(|&p| outside(p));
        all(&|p| p.dot(camera.forward) < 0.0)
            || (0..2).any(|axis| {
                [-1.0, 1.0]
                    .iter()
                    .any(|&sign| all(&|p| beyond(p, axis, sign) > 0.0))
            })
    }
}
