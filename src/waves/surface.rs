//! The water surface at one time, for all kinds of water.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::grid::Heights;
use super::height_field::{self, FieldNotes, Moment};
use super::row::Rows;
use super::sines::Sines;
use super::spline::Spline;
use super::trochoids::Trochoids;
use super::{ripples, sea};
use crate::kept::Key;
use crate::physics::refraction;
use crate::scene::{HeightField, ResolvedScene, Scene, Wave};

/// Height and slope of the water at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// y − level, m.
    pub height_m: f64,
    /// (∂h/∂x, ∂h/∂z).
    pub slope: DVec2,
}

impl SurfacePoint {
    /// Water at rest.
    pub(super) const FLAT: Self = Self {
        height_m: 0.0,
        slope: DVec2::ZERO,
    };
}

/// Second derivatives of the height at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// ∂²h/∂x², 1/m.
    pub xx_per_m: f64,
    /// ∂²h/∂x∂z, 1/m.
    pub xz_per_m: f64,
    /// ∂²h/∂z², 1/m.
    pub zz_per_m: f64,
}

impl Curvature {
    /// Water at rest.
    pub(super) const FLAT: Self = Self {
        xx_per_m: 0.0,
        xz_per_m: 0.0,
        zz_per_m: 0.0,
    };

    /// Largest magnitude of the second derivative along any horizontal direction, 1/m: the larger eigenvalue of the symmetric
    /// matrix, by magnitude.
    pub fn largest_per_m(&self) -> f64 {
        let Self {
            xx_per_m: xx,
            xz_per_m: xz,
            zz_per_m: zz,
        } = *self;
        (0.5 * (xx + zz)).abs() + (0.5 * (xx - zz)).hypot(xz)
    }
}

/// The water surface at one time. Heights are relative to the water at rest, (x, z) to an origin on it.
///
/// The bounds hold for every height and slope that [`Self::at`] and [`Self::rows`] return, for this surface and for any recentred
/// copy.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    sines: Sines,
    trochoids: Trochoids,
    grids: Vec<Grid>,
}

/// Water that is computed on a grid.
#[derive(Clone, Debug, PartialEq)]
struct Grid {
    spline: Spline,
    shortest_wave_m: f64,
    description: String,
    /// Index into the scene's waves, and the share of its mean square slope that the spline misses.
    slope_lost: (usize, f64),
    /// Of a height field.
    notes: Option<FieldNotes>,
}

/// What is kept of water on a grid.
#[derive(Debug)]
struct KeptGrid {
    spline: Spline,
    shortest_wave_m: f64,
    slope_lost: f64,
    description: String,
    notes: Option<FieldNotes>,
}

impl KeptGrid {
    /// With the number of its bytes.
    fn of(heights: Heights, notes: Option<FieldNotes>) -> (Self, u64) {
        let grid = Self {
            shortest_wave_m: heights.shortest_wave_m,
            slope_lost: heights.slope_lost,
            description: heights.description.clone(),
            spline: heights.spline(),
            notes,
        };
        let bytes = size_of_val(grid.spline.coefficients()) as u64;
        (grid, bytes)
    }
}

impl Grid {
    /// The grid of the scene's wave `index`; `heights` computes it if it is not kept.
    fn of(
        resolved: &ResolvedScene,
        index: usize,
        refinement: u32,
        heights: impl FnOnce(u32) -> Heights,
    ) -> Self {
        let kept = resolved
            .kept
            .get_or(key(&resolved.scene, index, refinement), || {
                KeptGrid::of(heights(refinement), None)
            });
        Self::kept(index, &kept)
    }

    /// The grid of the scene's wave `index`, a height field.
    fn of_field(resolved: &ResolvedScene, index: usize, waves: &HeightField) -> Self {
        let scene = &resolved.scene;
        let frames = resolved
            .fields
            .get(&index)
            .expect("a resolved scene has the files of its height fields");
        let moment = Moment::at(waves, frames.count(), scene.time_s);
        // The ids of the files are among the fields. Only the moment depends on time.
        let sources = ("height field", waves, moment.bits());
        let kept = resolved.kept.get_or(hash(&sources), || {
            let (heights, notes) = height_field::heights(waves, frames, &moment);
            KeptGrid::of(heights, Some(notes))
        });
        Self::kept(index, &kept)
    }

    fn kept(index: usize, kept: &KeptGrid) -> Self {
        Self {
            spline: kept.spline.clone(),
            shortest_wave_m: kept.shortest_wave_m,
            description: kept.description.clone(),
            slope_lost: (index, kept.slope_lost),
            notes: kept.notes,
        }
    }
}

/// Hash of all that the grid of the scene's wave `index` depends on.
fn key(scene: &Scene, index: usize, refinement: u32) -> Key {
    let sources = (
        "water on a grid",
        &scene.water.waves[index],
        scene.water.dispersion,
        scene.floor.as_ref().map(|floor| floor.depth_m.to_bits()),
        scene.time_s.to_bits(),
        refinement,
    );
    hash(&sources)
}

fn hash(sources: &impl serde::Serialize) -> Key {
    let text = serde_json::to_vec(sources).expect("waves always serialise");
    *blake3::hash(&text).as_bytes()
}

/// Most samples along a side of a refined grid.
const MAX_REFINED: u32 = 4096;

/// The refinement, or less, so that `samples` times it is at most `most`.
fn within(most: u32, refinement: u32, samples: u32) -> u32 {
    refinement.min(most / samples).max(1)
}

impl Surface {
    /// The surface of a scene at its `time_s`; the origin is that of the scene. Water on a grid that was computed before is taken from
    /// [`ResolvedScene::kept`].
    pub fn of(resolved: &ResolvedScene) -> Self {
        Self::refined(resolved, 1)
    }

    /// The same with `refinement` times as many samples along the sides of grids, so that their splines miss less of what they stand for;
    /// for references. The spline of a height field is its surface, which is not refined. Of a grid that would have more than 4096 samples
    /// along a side, the refinement is smaller.
    pub fn refined(resolved: &ResolvedScene, refinement: u32) -> Self {
        let scene = &resolved.scene;
        let waves = scene.water.waves.iter().enumerate();
        let grids = waves.filter_map(|(index, wave)| match wave {
            Wave::Sine(_) | Wave::Gerstner(_) => None,
            Wave::Spectrum(waves) => {
                let refinement = within(MAX_REFINED, refinement, waves.samples);
                Some(Grid::of(resolved, index, refinement, |refinement| {
                    sea::heights(waves, scene, refinement)
                }))
            }
            Wave::Ripples(waves) => {
                // Mirror images double the sides.
                let refinement = within(MAX_REFINED, refinement, 2 * waves.samples);
                Some(Grid::of(resolved, index, refinement, |refinement| {
                    ripples::heights(waves, scene, refinement)
                }))
            }
            Wave::HeightField(waves) => Some(Grid::of_field(resolved, index, waves)),
        });
        Self {
            sines: Sines::of(scene),
            trochoids: Trochoids::of(scene),
            grids: grids.collect(),
        }
    }

    /// The same surface with (x, z) = (0, 0) moved to `origin_m`.
    pub fn recentred(&self, origin_m: DVec2) -> Self {
        let recentred = |grid: &Grid| Grid {
            spline: grid.spline.recentred(origin_m),
            notes: grid.notes.map(|notes| notes.recentred(origin_m)),
            ..grid.clone()
        };
        Self {
            sines: self.sines.recentred(origin_m),
            trochoids: self.trochoids.recentred(origin_m),
            grids: self.grids.iter().map(recentred).collect(),
        }
    }

    fn splines(&self) -> impl Iterator<Item = &Spline> {
        self.grids.iter().map(|grid| &grid.spline)
    }

    /// Height and slope at (x, z), m.
    pub fn at(&self, x_m: f64, z_m: f64) -> SurfacePoint {
        let mut point = self.sines.at(x_m, z_m);
        let others = self.splines().map(|spline| spline.at(x_m, z_m));
        for other in others.chain([self.trochoids.at(x_m, z_m)]) {
            point.height_m += other.height_m;
            point.slope += other.slope;
        }
        point
    }

    /// Height, slope and curvature at (x, z), m. Height and slope equal those of [`Self::at`] except for rounding.
    pub fn curved_at(&self, x_m: f64, z_m: f64) -> (SurfacePoint, Curvature) {
        let (mut point, mut curvature) = self.sines.curved_at(x_m, z_m);
        let others = self.splines().map(|spline| spline.curved_at(x_m, z_m));
        for (other, curved) in others.chain([self.trochoids.curved_at(x_m, z_m)]) {
            point.height_m += other.height_m;
            point.slope += other.slope;
            curvature.xx_per_m += curved.xx_per_m;
            curvature.xz_per_m += curved.xz_per_m;
            curvature.zz_per_m += curved.zz_per_m;
        }
        (point, curvature)
    }

    /// Height and slope along rows of points that are `step_m`, (x, z), apart. Much faster than [`Self::at`] for many points, and
    /// equal except for rounding.
    pub fn rows(&self, step_m: DVec2) -> Rows {
        Rows {
            step_m,
            sines: self.sines.rows(step_m),
            trochoids: self.trochoids.clone(),
            splines: self.splines().cloned().collect(),
        }
    }

    /// Whether the following bounds and the shortest wave depend on time. If not, they are equal to the bit at all times.
    pub fn bounds_change_with_time(&self) -> bool {
        // Of waves with a formula only phases change with time, not amplitudes and wavelengths.
        !self.grids.is_empty()
    }

    /// Upper bound of |height|, m.
    pub fn max_height_m(&self) -> f64 {
        let of_grids: f64 = self.splines().map(Spline::max_height_m).sum();
        self.sines.max_height_m() + self.trochoids.max_height_m() + of_grids
    }

    /// Upper bound of the slope along the horizontal unit vector `u`.
    pub fn max_slope_along(&self, u: DVec2) -> f64 {
        let of_grids: f64 = self.splines().map(|spline| spline.max_slope_along(u)).sum();
        self.sines.max_slope_along(u) + self.trochoids.max_slope_along(u) + of_grids
    }

    /// Upper bound of the slope in any direction; 0 for flat water only.
    pub fn max_slope(&self) -> f64 {
        let of_grids: f64 = self.splines().map(Spline::max_slope).sum();
        self.sines.max_slope() + self.trochoids.max_slope() + of_grids
    }

    /// Upper bound of the magnitude of the second derivative along any direction, 1/m.
    pub fn max_second_derivative_per_m(&self) -> f64 {
        let of_grids: f64 = self
            .splines()
            .map(Spline::max_second_derivative_per_m)
            .sum();
        self.sines.max_derivative(2) + self.trochoids.max_second_derivative_per_m() + of_grids
    }

    /// Upper bound of the magnitude of the third derivative along any direction, 1/m².
    pub fn max_third_derivative_per_m2(&self) -> f64 {
        let of_grids: f64 = self
            .splines()
            .map(Spline::max_third_derivative_per_m2)
            .sum();
        self.sines.max_derivative(3) + self.trochoids.max_third_derivative_per_m2() + of_grids
    }

    /// The extreme slopes: for each of `directions` evenly spaced directions, from x towards z, a slope that no slope of the
    /// surface exceeds along that direction. Empty for flat water.
    pub fn rim_slopes(&self, directions: u32) -> Vec<DVec2> {
        if self.max_slope() == 0.0 {
            return Vec::new();
        }
        (0..directions)
            .map(|i| {
                let u = DVec2::from_angle(TAU * f64::from(i) / f64::from(directions));
                let of_grids: DVec2 = self.splines().map(|spline| spline.rim_slope(u)).sum();
                self.sines.rim_slope(u) + self.trochoids.rim_slope(u) + of_grids
            })
            .collect()
    }

    /// Length of the shortest wave, m; infinite for flat water.
    pub fn shortest_wave_m(&self) -> f64 {
        let of_grids = self.grids.iter().map(|grid| grid.shortest_wave_m);
        of_grids
            .chain([
                self.sines.shortest_wave_m(),
                self.trochoids.shortest_wave_m(),
            ])
            .fold(f64::INFINITY, f64::min)
    }

    /// Of each kind of water that is computed on a grid: its index into the scene's waves, and the share of its mean square slope, 0 … 1,
    /// that the surface through the samples misses.
    pub fn slope_lost(&self) -> impl Iterator<Item = (usize, f64)> {
        self.grids.iter().map(|grid| grid.slope_lost)
    }

    /// Of each height field: its index into the scene's waves, and what is to be said of it.
    pub fn field_notes(&self) -> impl Iterator<Item = (usize, FieldNotes)> {
        let grids = self.grids.iter();
        grids.filter_map(|grid| Some((grid.slope_lost.0, grid.notes?)))
    }

    /// Water that is computed on a grid and is flat: indices into the scene's waves.
    pub fn flat_grids(&self) -> impl Iterator<Item = usize> {
        let flat = self
            .grids
            .iter()
            .filter(|grid| grid.spline.max_height_m() == 0.0);
        flat.map(|grid| grid.slope_lost.0)
    }

    /// The kind of water in words, for sentences such as "the sun shines into …".
    pub fn description(&self) -> String {
        if self.max_slope() == 0.0 {
            return "flat water".to_owned();
        }
        let counted = |count: usize, one: &str, many: &str| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            _ => Some(format!("{count} {many}")),
        };
        // Sines are counted as before there were other kinds.
        let sines =
            (self.sines.count() > 0).then(|| format!("{} wave components", self.sines.count()));
        let trochoids = counted(self.trochoids.count(), "Gerstner wave", "Gerstner waves");
        let grids = self.grids.iter().map(|grid| grid.description.clone());
        let parts: Vec<String> = sines.into_iter().chain(trochoids).chain(grids).collect();
        format!("water with {}", parts.join(", "))
    }

    /// Time to evaluate a point on the GPU, in sines.
    pub fn gpu_work_per_point(&self) -> f64 {
        (self.sines.count() + 6 * self.trochoids.count() + 8 * self.grids.len()) as f64
    }

    /// Whether there are Gerstner waves.
    pub fn has_trochoids(&self) -> bool {
        self.trochoids.count() > 0
    }

    /// Whether there is water that is computed on a grid.
    pub fn has_grids(&self) -> bool {
        !self.grids.is_empty()
    }

    /// Number of [`Self::gpu_elements`].
    pub fn gpu_element_count(&self) -> usize {
        let of_grids: usize = self
            .splines()
            .map(|s| 2 + s.coefficients().len().div_ceil(4))
            .sum();
        1 + self.sines.count() + 2 * self.trochoids.count() + of_grids
    }

    /// The data from which the GPU evaluates the surface: elements of 16 bytes, as `shaders/shared/water_surface.wgsl` describes them.
    pub fn gpu_elements(&self) -> Vec<[f32; 4]> {
        let counts = [self.sines.count(), self.trochoids.count(), self.grids.len()];
        let [sines, trochoids, grids] = counts.map(|count| count as f32);
        let mut elements = Vec::with_capacity(self.gpu_element_count());
        elements.push([sines, trochoids, grids, 0.0]);
        elements.extend(self.sines.gpu_elements());
        elements.extend(self.trochoids.gpu_elements());
        let mut first = elements.len() + 2 * self.grids.len();
        for spline in self.splines() {
            elements.extend(spline.gpu_header(first));
            first += spline.coefficients().len().div_ceil(4);
        }
        for spline in self.splines() {
            let four = spline.coefficients().chunks(4);
            elements
                .extend(four.map(|c| std::array::from_fn(|i| c.get(i).map_or(0.0, |c| *c as f32))));
        }
        elements
    }
}

/// Unit normal (up) at a surface point.
pub fn normal(point: SurfacePoint) -> DVec3 {
    refraction::normal_from_slope(point.slope.x, point.slope.y)
}
