//! Refracts many rays at once: plain arrays and no branches, so that the compiler uses vector instructions.
//!
//! The same formulas as [`crate::physics::refraction`] and [`crate::physics::fresnel`], without a unit normal where its
//! length drops out; tests compare the map with the closed forms, which use those.

use glam::{DVec2, DVec3};

use crate::waves::{ROW_POINTS, RowPoints, Rows, Surface};

/// Rays per block.
pub(super) const BLOCK: usize = ROW_POINTS;

type Lanes = [f64; BLOCK];

/// Rays of one block, by property.
pub(super) struct Block {
    /// The water where the rays enter.
    pub(super) water: RowPoints,
    /// (n·l)/n_y: water surface facing the sun per horizontal area.
    pub(super) facing: Lanes,
    /// `facing` times the reflectance.
    pub(super) reflected: Lanes,
    /// `facing` times the transmittance.
    pub(super) entered: Lanes,
    /// Where the ray meets the floor's plane, local, m; NaN when it does not.
    pub(super) x_m: Lanes,
    /// Where the ray meets the floor's plane, local, m.
    pub(super) z_m: Lanes,
    /// Length of the ray, m.
    pub(super) path_m: Lanes,
}

impl Block {
    pub(super) fn new() -> Self {
        const ZERO: Lanes = [0.0; BLOCK];
        Self {
            water: RowPoints::FLAT,
            facing: ZERO,
            reflected: ZERO,
            entered: ZERO,
            x_m: ZERO,
            z_m: ZERO,
            path_m: ZERO,
        }
    }
}

/// The surface along rows with a fixed step, and one sun.
pub(super) struct RowRefractor {
    rows: Rows,
    step_m: DVec2,
    to_light: DVec3,
    ior: f64,
    depth_m: f64,
}

impl RowRefractor {
    /// For local coordinates of `surface`, rows with `step_m` between the rays and a floor `depth_m` below.
    pub(super) fn new(
        surface: &Surface,
        step_m: DVec2,
        to_light: DVec3,
        ior: f64,
        depth_m: f64,
    ) -> Self {
        Self {
            rows: surface.rows(step_m),
            step_m,
            to_light,
            ior,
            depth_m,
        }
    }

    /// Traces [`BLOCK`] rays from `start_m` on.
    pub(super) fn send(&self, start_m: DVec2, block: &mut Block) {
        self.rows.evaluate(start_m, &mut block.water);
        self.refract(block);
        self.drop(start_m, block);
    }

    /// The Fresnel reflectance, and the refracted direction as (sideways per metre of path, down per metre of path).
    fn refract(&self, block: &mut Block) {
        let Block {
            water: RowPoints {
                slope_x, slope_z, ..
            },
            facing,
            reflected,
            entered,
            x_m,
            z_m,
            path_m,
            ..
        } = block;
        let l = self.to_light;
        let eta = self.ior;
        let per_eta = 1.0 / eta;
        let per_eta2 = per_eta * per_eta;
        for i in 0..BLOCK {
            let (a, b) = (slope_x[i], slope_z[i]);
            let per_length = 1.0 / (1.0 + a * a + b * b).sqrt();
            let toward = l.y - a * l.x - b * l.z;
            let lit = toward.max(0.0);
            let cos_i = lit * per_length;
            let cos_t = (1.0 - (1.0 - cos_i * cos_i).max(0.0) * per_eta2)
                .max(0.0)
                .sqrt();
            let s_sum = cos_i + eta * cos_t;
            let p_sum = eta * cos_i + cos_t;
            let per_both = 1.0 / (s_sum * p_sum);
            let r_s = (cos_i - eta * cos_t) * p_sum * per_both;
            let r_p = (eta * cos_i - cos_t) * s_sum * per_both;
            let reflectance = 0.5 * (r_s * r_s + r_p * r_p);
            let transmittance =
                2.0 * eta * cos_i * cos_t * (s_sum * s_sum + p_sum * p_sum) * (per_both * per_both);
            facing[i] = lit;
            // A surface that faces away has no flux; the quotients above may be 0/0 there.
            reflected[i] = if toward > 0.0 { lit * reflectance } else { 0.0 };
            entered[i] = if toward > 0.0 {
                lit * transmittance
            } else {
                0.0
            };
            let along_normal = (cos_i * per_eta - cos_t) * per_length;
            x_m[i] = -l.x * per_eta - along_normal * a;
            z_m[i] = -l.z * per_eta - along_normal * b;
            path_m[i] = l.y * per_eta - along_normal;
        }
    }

    /// Computes the landing point from the direction.
    fn drop(&self, start_m: DVec2, block: &mut Block) {
        let Block {
            water: RowPoints { height_m, .. },
            x_m,
            z_m,
            path_m,
            ..
        } = block;
        for i in 0..BLOCK {
            let above_floor_m = height_m[i] + self.depth_m;
            let path = above_floor_m / path_m[i];
            // Light that runs flat or upwards, or starts under the floor, meets nothing.
            let path = if path_m[i] > 1e-9 && above_floor_m >= 0.0 {
                path
            } else {
                f64::NAN
            };
            let steps = i as f64;
            x_m[i] = start_m.x + self.step_m.x * steps + x_m[i] * path;
            z_m[i] = start_m.y + self.step_m.y * steps + z_m[i] * path;
            path_m[i] = path;
        }
    }
}
