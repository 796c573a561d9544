//! Caustic volumes as a plain program in float64, written from Sandberg & Falemo 2005 (§3.2–§3.4): every point is tested against every volume
//! whose bounds it lies in. It shares with the renderer only where the rays start: the vertices and triangles of the water grid.

use caustica::facts::source::Source;
use caustica::facts::{BeamSet, SceneFacts};
use caustica::methods;
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::physics::refraction::{normal_from_slope, refract_direction};
use caustica::physics::solid_angle::solid_angle;
use caustica::scene::ResolvedScene;
use caustica::stages::points::Point;
use glam::{DVec2, DVec3};

/// Rays that fall less than this per metre bound no volume.
const LEAST_FALL: f64 = 1e-3;
/// Bins along a side in which volumes are searched.
const BINS: usize = 128;

/// A refracted ray.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) transmittance: f64,
}

impl Ray {
    /// Where it crosses the height `y`, forwards or backwards.
    pub(crate) fn at_height(&self, y: f64) -> DVec2 {
        let p = self.origin + self.direction * self.length_to(y);
        DVec2::new(p.x, p.z)
    }

    pub(crate) fn length_to(&self, y: f64) -> f64 {
        (y - self.origin.y) / self.direction.y
    }
}

pub(crate) struct Volume {
    pub(crate) rays: [usize; 3],
    /// Flux below the surface from a light of unit power.
    pub(crate) flux: f64,
}

/// The volumes of a light.
pub(crate) struct Light {
    pub(crate) rays: Vec<Ray>,
    pub(crate) volumes: Vec<Volume>,
    /// Volumes around each ray.
    around: Vec<Vec<usize>>,
    pub(crate) power: [f64; 3],
    pub(crate) extinction_per_m: [f64; 3],
}

/// What a point gets.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Lit {
    /// W/m².
    pub(crate) irradiance: [f64; 3],
    /// Volumes that it lies in.
    pub(crate) volumes: u32,
}

/// How the light varies in a volume's cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Density {
    Constant,
    Linear,
}

/// The irradiance of points from all lights, without shadows.
pub(crate) fn irradiance(resolved: &ResolvedScene, points: &[Point], density: Density) -> Vec<Lit> {
    let facts = methods::facts(resolved).unwrap();
    let mut all = vec![Lit::default(); points.len()];
    for set in &facts.lights.beam_sets {
        let light = light_of(&facts, set);
        each_near(&light, points, |number, k| {
            light.add_volume(number, &points[k], density, &mut all[k]);
        });
    }
    all
}

pub(crate) fn light_of(facts: &SceneFacts, set: &BeamSet) -> Light {
    let cells = facts.quality.water_cells as usize;
    let side = cells + 1;
    let step = set.grid.places.size() / cells as f64;
    let mut rays: Vec<Ray> = Vec::with_capacity(side * side);
    for j in 0..side {
        for i in 0..side {
            let s = set.grid.places.min + step * DVec2::new(i as f64, j as f64);
            let at = set.grid.foot_m + s * (1.0 + set.grid.bend_per_m2 * s * s);
            let water = facts.water.surface.at(at.x, at.y);
            let origin = DVec3::new(at.x, water.height_m, at.y);
            let to_light = match set.source {
                Source::Sun { to_light } => to_light,
                Source::Point { position_m } => (position_m - origin).normalize(),
                Source::Submerged { .. } => panic!("no volumes begin under water"),
            };
            let normal = normal_from_slope(water.slope.x, water.slope.y);
            let direction = refract_direction(-to_light, normal, set.band.ior).unwrap();
            rays.push(Ray {
                origin,
                direction,
                transmittance: fresnel_transmittance(normal.dot(to_light), set.band.ior),
            });
        }
    }
    let mut volumes = Vec::new();
    let mut around = vec![Vec::new(); rays.len()];
    for j in 0..cells {
        for i in 0..cells {
            let [low, right, far, far_right] =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(di, dj)| (j + dj) * side + i + di);
            // The diagonal alternates like a chessboard.
            let halves = if (i + j) % 2 == 0 {
                [[low, right, far_right], [low, far_right, far]]
            } else {
                [[low, right, far], [right, far_right, far]]
            };
            for corners in halves {
                let [a, b, c] = corners.map(|k| rays[k].origin);
                let onto = match set.source {
                    Source::Sun { to_light } => 0.5 * (c - a).cross(b - a).dot(to_light),
                    Source::Point { position_m } => solid_angle(a - position_m, b - a, c - a),
                    Source::Submerged { .. } => 0.0,
                };
                let enters = corners.map(|k| rays[k].transmittance).iter().sum::<f64>() / 3.0;
                let falls = corners.iter().all(|&k| rays[k].direction.y < -LEAST_FALL);
                if onto * enters <= 0.0 || !falls {
                    continue;
                }
                for k in corners {
                    around[k].push(volumes.len());
                }
                volumes.push(Volume {
                    rays: corners,
                    flux: onto * enters,
                });
            }
        }
    }
    Light {
        rays,
        volumes,
        around,
        power: set.power,
        extinction_per_m: set.band.extinction_per_m,
    }
}

pub(crate) fn position(point: &Point) -> DVec3 {
    DVec3::from(point.position_m.map(f64::from))
}

/// Calls `near` for every volume and every point under water that it may hold: the numbers of both.
pub(crate) fn each_near(light: &Light, points: &[Point], mut near: impl FnMut(usize, usize)) {
    let wet: Vec<usize> = (0..points.len())
        .filter(|&k| points[k].receiver >= 0.0)
        .collect();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &k in &wet {
        low = low.min(position(&points[k]));
        high = high.max(position(&points[k]));
    }
    let size = DVec2::new(high.x - low.x, high.z - low.z).max(DVec2::splat(1e-9));
    let bin_of = |p: DVec2| {
        let share = (p - DVec2::new(low.x, low.z)) / size * BINS as f64;
        share
            .floor()
            .clamp(DVec2::ZERO, DVec2::splat(BINS as f64 - 1.0))
    };
    let mut bins: Vec<Vec<usize>> = vec![Vec::new(); BINS * BINS];
    for (number, volume) in light.volumes.iter().enumerate() {
        let (mut least, mut most) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for k in volume.rays {
            for y in [low.y, high.y] {
                least = least.min(light.rays[k].at_height(y));
                most = most.max(light.rays[k].at_height(y));
            }
        }
        if most.x < low.x || most.y < low.z || least.x > high.x || least.y > high.z {
            continue;
        }
        let (first, last) = (bin_of(least - 1e-6), bin_of(most + 1e-6));
        for y in first.y as usize..=last.y as usize {
            for x in first.x as usize..=last.x as usize {
                bins[y * BINS + x].push(number);
            }
        }
    }
    for &k in &wet {
        let p = position(&points[k]);
        let bin = bin_of(DVec2::new(p.x, p.z));
        for &number in &bins[bin.y as usize * BINS + bin.x as usize] {
            near(number, k);
        }
    }
}

impl Light {
    /// Twice the signed area of a volume's cut at height `y`.
    fn double_area(&self, volume: &Volume, y: f64) -> f64 {
        let [a, b, c] = volume.rays.map(|k| self.rays[k].at_height(y));
        (b - a).perp_dot(c - a)
    }

    /// Flux over area of the volumes around a ray.
    fn density_around(&self, ray: usize, y: f64) -> f64 {
        let (mut flux, mut area) = (0.0, 0.0);
        for &number in &self.around[ray] {
            flux += self.volumes[number].flux;
            area += 0.5 * self.double_area(&self.volumes[number], y).abs();
        }
        flux / area
    }

    fn add_volume(&self, number: usize, point: &Point, density: Density, lit: &mut Lit) {
        let volume = &self.volumes[number];
        let p = position(point);
        let place = DVec2::new(p.x, p.z);
        // The point in the triangle in which the horizontal plane through it cuts the volume (§3.3).
        let [a, b, c] = volume.rays.map(|k| self.rays[k].at_height(p.y) - place);
        let parts = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
        if !parts.iter().all(|&part| part > 0.0) && !parts.iter().all(|&part| part < 0.0) {
            return;
        }
        let whole: f64 = parts.iter().sum();
        let weights = parts.map(|part| part / whole);
        let mean = |of: &dyn Fn(usize) -> f64| -> f64 {
            (0..3).map(|k| weights[k] * of(volume.rays[k])).sum()
        };
        // The distance that the light has travelled, and its direction.
        let path_m = mean(&|k| self.rays[k].length_to(p.y));
        if path_m < 0.0 && point.receiver != 0.0 {
            return;
        }
        let direction = DVec3::new(
            mean(&|k| self.rays[k].direction.x),
            mean(&|k| self.rays[k].direction.y),
            mean(&|k| self.rays[k].direction.z),
        );
        // §3.4: flux over the area of the cut, then from a horizontal plane to the receiver's own.
        let per_m2 = match density {
            Density::Constant => volume.flux / (0.5 * whole.abs()),
            Density::Linear => mean(&|k| self.density_around(k, p.y)),
        };
        let normal = DVec3::from(point.normal.map(f64::from));
        let turned = (normal.dot(-direction) / -direction.y).max(0.0);
        for ch in 0..3 {
            let left = (-self.extinction_per_m[ch] * path_m.max(0.0)).exp();
            lit.irradiance[ch] += self.power[ch] * left * per_m2 * turned;
        }
        lit.volumes += 1;
    }
}
