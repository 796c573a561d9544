//! The light through the water on a small square, found by a search that starts at the square.
//!
//! The water that can light it is quartered recursively, and pieces from which no ray can reach the square are dropped. How far
//! apart the rays of a piece can land is bounded by the steepest slope and the strongest curvature of the waves, and for a point light
//! also by its distance, so no light is lost. In the remaining pieces plain rays are counted.

use std::f64::consts::SQRT_2;

use glam::{DVec2, DVec3};

use super::light::{PlacedLight, turn};
use super::place::Place;
use super::slanted::{halves, rows};
use super::strata::Strata;
use super::tally::add_to;
use super::window::{LightWindow, Target};
use crate::physics::attenuation::transmission;
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::refraction::normal_from_slope;

/// A piece of water is not quartered further once its rays land this close together, in half sides of the square …
const CLOSE: f64 = 0.5;
/// … or once it has so few rays that counting them is cheaper.
const FEW_RAYS: f64 = 4.0;
/// Distance, in sides of the square, within which its own object does not shade it: the flat square does not lie exactly on the
/// curved surface.
const OWN_REACH: f64 = 2.0;

/// A square that receives light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) center_m: DVec3,
    pub(super) normal: DVec3,
    /// Unit directions of its sides.
    pub(super) across: [DVec3; 2],
    pub(super) half_m: f64,
    object: Option<usize>,
}

/// Light on a square, W/m² after scaling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Landed {
    /// Light that arrives.
    pub(super) lit: [f64; 3],
    /// Light that meshes block: it would arrive without them.
    pub(super) blocked: [f64; 3],
}

impl Landed {
    pub(super) fn add(&mut self, other: &Self) {
        add_to(&mut self.lit, &other.lit);
        add_to(&mut self.blocked, &other.blocked);
    }

    /// Multiplies each channel.
    pub(super) fn scale(&mut self, factor: [f64; 3]) {
        for (c, factor) in factor.into_iter().enumerate() {
            self.lit[c] *= factor;
            self.blocked[c] *= factor;
        }
    }

    /// Adds a ray of flux `entered` that passes `path_m` of water.
    pub(super) fn book(&mut self, entered: f64, [r, g, b]: [f64; 3], path_m: f64, blocked: bool) {
        let target = if blocked {
            &mut self.blocked
        } else {
            &mut self.lit
        };
        if r == g && g == b {
            let arrived = entered * transmission(r, path_m);
            target.iter_mut().for_each(|sum| *sum += arrived);
        } else {
            for (sum, c) in target.iter_mut().zip([r, g, b]) {
                *sum += entered * transmission(c, path_m);
            }
        }
    }
}

/// A bound for all rays of a piece of water.
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

    /// A corner, and the sides from there.
    fn sides_m(&self) -> (DVec3, [DVec3; 2]) {
        let sides_m = self.across.map(|side| side * (2.0 * self.half_m));
        (self.center_m - (sides_m[0] + sides_m[1]) * 0.5, sides_m)
    }

    /// Whether something is between `from_m` and `to_m`, a point of the square.
    pub(super) fn blocked(
        &self,
        place: &Place,
        from_m: DVec3,
        to_m: DVec3,
        may_be_shaded: bool,
        stack: &mut Vec<usize>,
    ) -> bool {
        if let Some(floor) = &place.floor
            && self.object.is_some()
            && to_m.y < floor.y_m
        {
            let through_m = from_m.lerp(to_m, (floor.y_m - from_m.y) / (to_m.y - from_m.y));
            if floor.spans(through_m) {
                return true;
            }
        }
        let path_m = from_m.distance(to_m);
        if !may_be_shaded || path_m <= 0.0 {
            return false;
        }
        let own_until = 1.0 - OWN_REACH * 2.0 * self.half_m / path_m;
        place
            .occluders
            .blocks(from_m, to_m, self.object, own_until, stack)
    }

    /// Whether a mesh may be between the square and the box `others`.
    pub(super) fn may_be_shaded(&self, place: &Place, others: Target) -> bool {
        let own = self.bounds();
        let (low, high) = (own.min_m.min(others.min_m), own.max_m.max(others.max_m));
        let mut bounds = place.occluders.bounds.iter();
        bounds.any(|b| b.min_m.cmple(high).all() && b.max_m.cmpge(low).all())
    }
}

/// The search for the rays of one light that pass through the water to one square.
pub(super) struct Search<'a> {
    place: &'a Place,
    light: &'a PlacedLight,
    patch: &'a Patch,
    strata: Strata,
    /// Whether a mesh may be between the water and the square.
    may_be_shaded: bool,
    window: LightWindow,
}

impl<'a> Search<'a> {
    /// `None` for light that does not pass through the water surface.
    pub(super) fn new(place: &'a Place, light: &'a PlacedLight, patch: &'a Patch) -> Option<Self> {
        let bounds = patch.bounds();
        let window = light.window(place, bounds);
        let (corner_m, sides_m) = patch.sides_m();
        let crest_m = place.surface.max_height_m();
        let water = Target {
            min_m: DVec3::new(window.min_m.x, bounds.min_m.y, window.min_m.y),
            max_m: DVec3::new(window.max_m.x, crest_m, window.max_m.y),
        };
        Some(Self {
            place,
            light,
            patch,
            strata: Strata::of(place, light, corner_m, sides_m)?,
            may_be_shaded: patch.may_be_shaded(place, water),
            window,
        })
    }

    /// Two independent estimates from about `points` rays per square of evenly lit water each, and the number of rays.
    pub(super) fn light(
        &self,
        points: f64,
        key: u64,
        stack: &mut Vec<usize>,
    ) -> ([Landed; 2], u64) {
        // Above the crests, or beyond the light's reach.
        if !self.window.min_m.is_finite() || !self.window.max_m.is_finite() {
            return Default::default();
        }
        let pieces = self.pieces(points);
        let mut rays = 0;
        let lattices = halves(points, key);
        let both = lattices.map(|lattice| {
            let mut sum = Landed::default();
            let step = lattice.step_m();
            for piece in &pieces {
                for row in rows(&lattice, piece) {
                    rays += row.count;
                    for i in 0..row.count {
                        let st = row.start_m + step * i as f64;
                        self.count(self.strata.water_m(st), &mut sum, stack);
                    }
                }
            }
            let per_m2 = lattice.area_per_point_m2() / (2.0 * self.patch.half_m).powi(2);
            sum.scale(self.light.power.map(|power| power * per_m2));
            sum
        });
        (both, rays)
    }

    /// Rectangles of (s, t) without overlap that hold all water whose light can reach the square.
    fn pieces(&self, points: f64) -> Vec<LightWindow> {
        let mut pieces = Vec::new();
        let mut open = vec![self.strata.start_of_quartering(&self.window)];
        while let Some(piece) = open.pop() {
            let size = piece.max_m - piece.min_m;
            let middle = (piece.min_m + piece.max_m) * 0.5;
            let (water_m, radius_m) = self.strata.middle(&piece);
            let close = match self.reach(water_m, radius_m) {
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

    /// Where the rays can land of the piece around `water_m` whose corners lie `radius_m` away.
    ///
    /// Within the piece the slope changes by at most the curvature times the radius, the unit normal by no more than that, and the
    /// unit vector to a point light by at most δ/(r − δ) when its start moves by δ. So the cosine changes by at most the sum c′ of
    /// the two, and the direction t = −l/η + g(c) n by at most |δl|/η + |g| |δn| + g′ c′; both g′ and |g| are largest at the smallest c.
    fn reach(&self, water_m: DVec2, radius_m: f64) -> Reach {
        let (at, bend_per_m) = self.place.curved(water_m, radius_m);
        let from_m = DVec3::new(water_m.x, at.height_m, water_m.y);
        let bend = (bend_per_m * radius_m).min(2.0 * self.place.steepest);
        let steepest = self.place.steepest.min(at.slope.length() + bend);
        let moved_m = radius_m * steepest.hypot(1.0);
        let normal = normal_from_slope(at.slope.x, at.slope.y);
        let (to_light, distance_m) = self.light.toward(from_m);
        if distance_m <= moved_m {
            return Reach::Unknown;
        }
        let spread = moved_m / (distance_m - moved_m);
        let cosine = normal.dot(to_light);
        if cosine + bend + spread <= 0.0 {
            return Reach::Nothing;
        }
        if cosine <= 0.0 {
            return Reach::Unknown;
        }
        let ior = self.place.ior;
        let least = (cosine - bend - spread).max(0.0);
        let cos_t = (1.0 - (1.0 - least * least) / (ior * ior))
            .max(1e-12)
            .sqrt();
        let per_cosine = (1.0 / ior - least / (ior * ior * cos_t)).max(0.0);
        let turned = spread / ior + bend * turn(least, ior).abs() + (bend + spread) * per_cosine;
        let direction = -to_light / ior + normal * turn(cosine, ior);
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

    /// Counts the ray that enters at `water_m` and represents `m2` of water, if it crosses the square against its normal.
    fn count(&self, (water_m, m2): (DVec2, f64), sum: &mut Landed, stack: &mut Vec<usize>) {
        let Some(ray) = self.light.bend(self.place, water_m) else {
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
        let place = self.place;
        let entered = m2 * ray.facing * fresnel_transmittance(ray.cos_i, place.ior);
        let blocked = patch.blocked(place, ray.from_m, to_m, self.may_be_shaded, stack);
        sum.book(entered, place.extinction_per_m, path_m, blocked);
    }
}
