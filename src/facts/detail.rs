//! Level of detail: how large an object looks on the picture, and how many texels its maps get for that.

use glam::DVec3;

use super::{CameraFacts, SceneFacts};
use crate::scene::ranges::{Integer, LevelMapTexels};

/// The share of the way from an object's depth that waves may move its image sideways, per unit of their steepest slope: a surface
/// tilted by α turns a refracted ray by less than α, and the ray goes down at a slant.
const SWAY: f64 = 2.0;

impl SceneFacts {
    /// Texels along a side of an object's maps as a share of `quality.level_map_texels`, above 0 … 1; 1 without level of detail.
    pub fn detail_of(&self, object: usize) -> f64 {
        f64::from(self.receivers.objects[object].map_texels)
            / f64::from(self.quality.level_map_texels)
    }

    /// Reference planes of an object, 2 … all of the method: as many fewer as its maps are smaller, so that a plane stays as far from
    /// the next as texels do (Tipprasert 2006, §6.1). 0 where the method has none.
    pub fn planes_of(&self, object: usize) -> u32 {
        if self.method.reference_planes == 0 {
            return 0;
        }
        let slices = f64::from(self.method.reference_planes - 1);
        1 + (slices * self.detail_of(object)).round().max(1.0) as u32
    }

    /// What a plan says about wet objects with smaller maps; empty where there are none.
    pub fn reduced_maps(&self) -> String {
        let reduced = self.wet_objects().filter(|&o| self.detail_of(o) < 1.0);
        match reduced.count() {
            0 => String::new(),
            count => format!(", {count} with smaller maps by quality.level_of_detail"),
        }
    }

    /// Gives each object maps for its size on the picture, where the scene asks for that.
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

    /// Longest diagonal of an object's bounds on the picture, pixels; 0 where it is certainly outside, infinite around the eye.
    ///
    /// Flat water in between brings an object nearer, by what it takes from the way below (d / n).
    fn size_in_pixels(&self, object: usize, camera: &CameraFacts) -> f64 {
        let object = &self.receivers.objects[object];
        let highest_m = self.water.surface.max_height_m();
        // From below, total reflection may show anything.
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
        let way = nearest - camera.eye;
        let below = if in_air && nearest.y < 0.0 {
            nearest.y / (nearest.y - camera.eye.y)
        } else {
            0.0
        };
        let looks_m = way.length() * (1.0 - below + below / self.water.ior);
        // Away from the picture's middle a plane image is stretched, at most by what it is in the corner.
        let corner = (1.0 + camera.right.length_squared() + camera.up.length_squared()).sqrt();
        let cosine = way
            .normalize_or_zero()
            .dot(camera.forward)
            .max(1.0 / corner);
        diagonal_m * per_unit / (looks_m * cosine * cosine)
    }

    /// Whether a box cannot be on the picture of a camera in the air: it lies, with all places where the water may show it, on the
    /// outer side of one of the picture's edges.
    fn is_outside(&self, min: DVec3, max: DVec3, camera: &CameraFacts) -> bool {
        // Flat water shows a point between where it is and the water above it; waves move that to and fro.
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
            sign * p.dot(across[axis]) - half[axis] * reach
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
