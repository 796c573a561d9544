//! The sunlight through the water that falls on a small square, searched from the square.
//!
//! The water that can light it is quartered over and over; a piece from which no ray can reach the square is left out. How far
//! apart the rays of a piece can land follows from the steepest slope and the strongest curvature of the waves, so nothing is
//! lost. In what remains plain rays are counted.

use std::f64::consts::SQRT_2;

use glam::{DVec2, DVec3};

use super::place::{Place, PlacedSun};
use super::slanted::{Cells, halves, rows};
use super::tally::add_to;
use super::window::{LightWindow, Target, window_of};
use crate::physics::attenuation::transmission;
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::refraction::normal_from_slope;
use crate::waves::SurfacePoint;

/// A piece of water is not quartered any more once its rays land this close together, in half sides of the square …
const CLOSE: f64 = 0.5;
/// … or once it holds so few rays that counting them is cheaper.
const FEW_RAYS: f64 = 4.0;
/// Sides of the square within which its own object does not shade it: the square leaves the curved surface a little.
const OWN_REACH: f64 = 2.0;

/// A square that receives light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    center_m: DVec3,
    normal: DVec3,
    across: [DVec3; 2],
    half_m: f64,
    object: Option<usize>,
}

/// Light on a square, W/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sunlight {
    /// What arrives.
    pub(super) lit: [f64; 3],
    /// What would arrive, had no mesh stood in the way.
    pub(super) stopped: [f64; 3],
}

impl Sunlight {
    pub(super) fn add(&mut self, other: &Self) {
        add_to(&mut self.lit, &other.lit);
        add_to(&mut self.stopped, &other.stopped);
    }
}

/// A ray just under the water.
struct Bent {
    from_m: DVec3,
    /// Unit direction.
    direction: DVec3,
    /// (n·l)/n_y: water facing the sun per horizontal area.
    facing: f64,
    /// Cosine of the incidence.
    cos_i: f64,
}

/// What is known of all rays of a piece of water.
enum Reach {
    /// None lands on the square.
    Nothing,
    /// All land within this distance of the one from the middle, m.
    Within(f64),
    /// Some may run along the square's plane.
    Unknown,
}

impl Patch {
    /// A square of `side_m` around a point with unit `normal`, on `object` or the floor.
    pub(super) fn new(center_m: DVec3, normal: DVec3, side_m: f64, object: Option<usize>) -> Self {
        let (u, v) = normal.any_orthonormal_pair();
        Self {
            center_m,
            normal,
            across: [u, v],
            half_m: 0.5 * side_m,
            object,
        }
    }

    fn bounds(&self) -> Target {
        let reach_m = (self.across[0].abs() + self.across[1].abs()) * self.half_m;
        Target {
            min_m: self.center_m - reach_m,
            max_m: self.center_m + reach_m,
        }
    }

    /// Where rays land that start within `moved_m` of `from_m` and run within `turned` of unit `direction`.
    ///
    /// A ray from S lands at S + t D/μ with D = (S − P)·n and μ = −t·n: moving S by δS moves that by at most δS/μ, and since
    /// t′/μ′ − t/μ = n × (t × t′)/(μμ′), turning t by δt moves it by at most |D| δt/(μμ′).
    fn reach(&self, from_m: DVec3, moved_m: f64, direction: DVec3, turned: f64) -> Reach {
        let above_m = (from_m - self.center_m).dot(self.normal);
        let against = -direction.dot(self.normal);
        if above_m + moved_m < 0.0 || against + turned <= 0.0 {
            return Reach::Nothing;
        }
        if against - turned < 0.01 {
            return Reach::Unknown;
        }
        let reach_m =
            moved_m / against + (above_m.abs() + moved_m) * turned / (against * (against - turned));
        let landed_m = from_m + direction * (above_m / against) - self.center_m;
        let limit_m = self.half_m + reach_m;
        let misses = |axis: &DVec3| axis.dot(landed_m).abs() > limit_m;
        if self.across.iter().any(misses) {
            return Reach::Nothing;
        }
        Reach::Within(reach_m)
    }

    fn cells(&self, flat: DVec3) -> Cells {
        let [u_m, v_m] = self.across.map(|edge| edge * (2.0 * self.half_m));
        Cells::of(self.center_m - (u_m + v_m) * 0.5, u_m, v_m, flat)
    }
}

/// The search for one sun's light on one square.
pub(super) struct Search<'a> {
    place: &'a Place,
    sun: &'a PlacedSun,
    patch: &'a Patch,
    cells: Cells,
    /// Half diagonal of a cell that is a unit square of (s, t), m.
    half_diagonal_m: f64,
    /// Whether a mesh may stand between the water and the square.
    may_be_shaded: bool,
    window: LightWindow,
}

impl<'a> Search<'a> {
    pub(super) fn new(place: &'a Place, sun: &'a PlacedSun, patch: &'a Patch) -> Self {
        let facts = &place.facts;
        let bounds = patch.bounds();
        let window = window_of(&facts.surface, sun.to_light, facts.ior, &[bounds]);
        let cells = patch.cells(sun.flat);
        let (a, b) = (cells.basis_m.x_axis, cells.basis_m.y_axis);
        let crest_m = facts.surface.max_height_m();
        let low = bounds
            .min_m
            .min(DVec3::new(window.min_m.x, bounds.min_m.y, window.min_m.y));
        let high = bounds
            .max_m
            .max(DVec3::new(window.max_m.x, crest_m, window.max_m.y));
        let may_be_shaded = place
            .occluders
            .bounds
            .iter()
            .any(|b| b.min_m.cmple(high).all() && b.max_m.cmpge(low).all());
        Self {
            place,
            sun,
            patch,
            half_diagonal_m: 0.5 * (a + b).length().max((a - b).length()),
            cells,
            may_be_shaded,
            window,
        }
    }

    /// Two independent estimates from about `points` rays per square of evenly lit water each, and how many rays were counted.
    pub(super) fn light(
        &self,
        points: f64,
        key: u64,
        stack: &mut Vec<usize>,
    ) -> ([Sunlight; 2], u64) {
        if !self.window.min_m.is_finite() || !self.window.max_m.is_finite() {
            return Default::default(); // above the crests
        }
        let pieces = self.pieces(points);
        let mut rays = 0;
        let lattices = halves(points, key);
        let both = lattices.map(|lattice| {
            let mut sum = Sunlight::default();
            let step = lattice.step_m();
            for piece in &pieces {
                for row in rows(&lattice, piece) {
                    rays += row.count;
                    for i in 0..row.count {
                        let st = row.start_m + step * i as f64;
                        self.count(self.cells.water_m(st), &mut sum, stack);
                    }
                }
            }
            let water_m2 = self.cells.area_m2() * lattice.area_per_point_m2();
            let per_m2 = water_m2 / (2.0 * self.patch.half_m).powi(2);
            for c in 0..3 {
                let scale = self.sun.irradiance_w_m2[c] * per_m2;
                sum.lit[c] *= scale;
                sum.stopped[c] *= scale;
            }
            sum
        });
        (both, rays)
    }

    /// Rectangles of (s, t) without overlap that hold all water whose light can reach the square.
    fn pieces(&self, points: f64) -> Vec<LightWindow> {
        let whole = self.cells.around(&self.window);
        let middle = (whole.min_m + whole.max_m) * 0.5;
        let half = 0.5 * (whole.max_m - whole.min_m).max_element();
        let corner = DVec2::splat(half);
        let mut pieces = Vec::new();
        let mut open = vec![LightWindow {
            min_m: middle - corner,
            max_m: middle + corner,
        }];
        while let Some(piece) = open.pop() {
            let size = piece.max_m - piece.min_m;
            let middle = (piece.min_m + piece.max_m) * 0.5;
            let close = match self.reach(middle, size.max_element() * self.half_diagonal_m) {
                Reach::Nothing => continue,
                Reach::Within(reach_m) => reach_m < CLOSE * self.patch.half_m,
                Reach::Unknown => false,
            };
            if close || size.element_product() * points < FEW_RAYS {
                pieces.push(piece);
                continue;
            }
            let (low, high) = (piece.min_m, piece.max_m);
            for [min_m, max_m] in [
                [low, middle],
                [DVec2::new(middle.x, low.y), DVec2::new(high.x, middle.y)],
                [DVec2::new(low.x, middle.y), DVec2::new(middle.x, high.y)],
                [middle, high],
            ] {
                open.push(LightWindow { min_m, max_m });
            }
        }
        pieces
    }

    /// The ray that enters at `water_m`; `None` where the water faces away from the sun.
    fn bend(&self, water_m: DVec2) -> Option<Bent> {
        let SurfacePoint { height_m, slope } = self.place.facts.surface.at(water_m.x, water_m.y);
        let l = self.sun.to_light;
        let facing = l.y - slope.x * l.x - slope.y * l.z;
        if facing <= 0.0 {
            return None;
        }
        let normal = normal_from_slope(slope.x, slope.y);
        let cos_i = normal.dot(l).clamp(0.0, 1.0);
        let ior = self.place.facts.ior;
        Some(Bent {
            from_m: DVec3::new(water_m.x, height_m, water_m.y),
            direction: -l / ior + normal * self.turn(cos_i),
            facing,
            cos_i,
        })
    }

    /// g(c) = c/η − cos θ_t, the factor of the normal in the refracted direction −l/η + g n, for c = cos θ_i.
    fn turn(&self, cos_i: f64) -> f64 {
        let ior = self.place.facts.ior;
        cos_i / ior - (1.0 - (1.0 - cos_i * cos_i) / (ior * ior)).max(0.0).sqrt()
    }

    /// What the rays of the piece around `st` can reach whose corners lie `radius_m` away.
    ///
    /// Within the piece the slope changes by at most the curvature times the radius, the unit normal by no more than that, and
    /// the direction t = −l/η + g(c) n by at most (|g| + g′) of it; both g′ and |g| are largest at the smallest c.
    fn reach(&self, st: DVec2, radius_m: f64) -> Reach {
        let water_m = self.cells.water_m(st);
        let (at, bend_per_m) = self.place.curved(water_m, radius_m);
        let from_m = DVec3::new(water_m.x, at.height_m, water_m.y);
        let bend = (bend_per_m * radius_m).min(2.0 * self.place.steepest);
        let steepest = self.place.steepest.min(at.slope.length() + bend);
        let moved_m = radius_m * steepest.hypot(1.0);
        let normal = normal_from_slope(at.slope.x, at.slope.y);
        let cosine = normal.dot(self.sun.to_light);
        if cosine + bend <= 0.0 {
            return Reach::Nothing;
        }
        if cosine <= 0.0 {
            return Reach::Unknown;
        }
        let ior = self.place.facts.ior;
        let least = (cosine - bend).max(0.0);
        let cos_t = (1.0 - (1.0 - least * least) / (ior * ior))
            .max(1e-12)
            .sqrt();
        let turned =
            bend * (self.turn(least).abs() + (1.0 / ior - least / (ior * ior * cos_t)).max(0.0));
        let direction = -self.sun.to_light / ior + normal * self.turn(cosine);
        if self.misses_ball(from_m, moved_m, direction, turned) {
            return Reach::Nothing;
        }
        self.patch.reach(from_m, moved_m, direction, turned)
    }

    /// Whether all rays that start within `moved_m` of `from_m` and run within `turned` of unit `direction` miss the ball around
    /// the square: the unit vectors from one start to its middle and from another to any point of it differ by less than
    /// 2ε/(2d − ε), with d the distance and ε the radius of the ball plus that of the starts.
    fn misses_ball(&self, from_m: DVec3, moved_m: f64, direction: DVec3, turned: f64) -> bool {
        let to_center_m = self.patch.center_m - from_m;
        let distance_m = to_center_m.length();
        let blur_m = moved_m + self.patch.half_m * SQRT_2;
        if distance_m <= blur_m {
            return false;
        }
        let apart = (to_center_m / distance_m - direction).length();
        apart > turned + 2.0 * blur_m / (2.0 * distance_m - blur_m)
    }

    /// Books the ray that enters at `water_m` if it crosses the square against its normal.
    fn count(&self, water_m: DVec2, sum: &mut Sunlight, stack: &mut Vec<usize>) {
        let Some(ray) = self.bend(water_m) else {
            return;
        };
        let patch = self.patch;
        let against = -ray.direction.dot(patch.normal);
        let above_m = (ray.from_m - patch.center_m).dot(patch.normal);
        if against <= 0.0 || above_m < 0.0 {
            return;
        }
        let path_m = above_m / against;
        let to_m = ray.from_m + ray.direction * path_m;
        let off_m = to_m - patch.center_m;
        if patch
            .across
            .iter()
            .any(|axis| axis.dot(off_m).abs() > patch.half_m)
        {
            return;
        }
        let facts = &self.place.facts;
        let entered = ray.facing * fresnel_transmittance(ray.cos_i, facts.ior);
        let blocked = self.blocked(&ray, to_m, path_m, stack);
        let target = if blocked {
            &mut sum.stopped
        } else {
            &mut sum.lit
        };
        let [r, g, b] = facts.extinction_per_m;
        if r == g && g == b {
            let arrived = entered * transmission(r, path_m);
            target.iter_mut().for_each(|sum| *sum += arrived);
        } else {
            for (sum, c) in target.iter_mut().zip([r, g, b]) {
                *sum += entered * transmission(c, path_m);
            }
        }
    }

    fn blocked(&self, ray: &Bent, to_m: DVec3, path_m: f64, stack: &mut Vec<usize>) -> bool {
        let patch = self.patch;
        if let Some(floor) = &self.place.facts.floor
            && patch.object.is_some()
            && to_m.y < floor.y_m
        {
            let p = ray.from_m + ray.direction * ((floor.y_m - ray.from_m.y) / ray.direction.y);
            let p = DVec2::new(p.x, p.z);
            if p.cmpge(floor.rect.min).all() && p.cmple(floor.rect.max).all() {
                return true;
            }
        }
        if !self.may_be_shaded || path_m <= 0.0 {
            return false;
        }
        let own_until = 1.0 - OWN_REACH * 2.0 * patch.half_m / path_m;
        self.place
            .occluders
            .blocks(ray.from_m, to_m, patch.object, own_until, stack)
    }
}
