//! Sub-volumes as a plain program in float64, written from Iwasaki, Dobashi & Nishita 2002 (§4): every point is tested against every
//! illumination volume near it. Flux is integrated in steps, and front faces are found by walking towards the eye, so it shares no formula with
//! the shader. It shares with the renderer where the rays start, and with the plain program of caustic volumes the list of volumes.

use caustica::methods;
use caustica::scene::ResolvedScene;
use caustica::stages::points::Point;
use glam::{DVec2, DVec3};

use super::plain_volumes::{Light, Lit, Ray, each_near, light_of, position};

/// Steps of the integral of a sub-volume's flux, and of the walk through it.
const INTEGRAL_STEPS: usize = 1000;
const WALK_STEPS: usize = 200;
const HALVINGS: usize = 40;

/// The dials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dials {
    pub(crate) planes: u32,
    pub(crate) has_faces: bool,
    pub(crate) is_scaled: bool,
}

/// Where the points are seen from.
enum Eye {
    At(DVec3),
    Along(DVec3),
}

/// A point's place in a sub-volume: weights of its rays, and the share of the way from the upper plane to the lower.
#[derive(Clone, Copy)]
struct Place {
    weights: [f64; 3],
    share: f64,
}

/// The part of a volume between two heights.
struct SubVolume {
    rays: [Ray; 3],
    upper_m: f64,
    lower_m: f64,
}

/// The irradiance of points from all lights, without shadows.
pub(crate) fn irradiance(resolved: &ResolvedScene, points: &[Point], dials: Dials) -> Vec<Lit> {
    let facts = methods::facts(resolved).unwrap();
    let eye = match &facts.output.camera {
        None => Eye::Along(DVec3::Y),
        Some(camera) if camera.orthographic => Eye::Along(-camera.forward),
        Some(camera) => Eye::At(camera.eye),
    };
    // Planes lie evenly between the crests and what lies deepest, with a thousandth of room.
    let crest_m = facts.water.surface.max_height_m();
    let floor_m = facts.receivers.floor.iter().map(|floor| floor.y_m);
    let objects_m = facts
        .wet_objects()
        .map(|k| facts.receivers.objects[k].min.y);
    let deepest_m = floor_m.chain(objects_m).fold(-crest_m, f64::min);
    let room_m = (crest_m - deepest_m) * 1e-3 + 1e-6;
    let top_m = crest_m + room_m;
    let gap_m = (top_m - deepest_m + room_m) / f64::from(dials.planes);
    let mut all = vec![Lit::default(); points.len()];
    for set in &facts.lights.beam_sets {
        let light = light_of(&facts, set);
        each_near(&light, points, |number, k| {
            let p = position(&points[k]);
            let above = ((top_m - p.y) / gap_m)
                .floor()
                .clamp(0.0, f64::from(dials.planes) - 1.0);
            let sub = SubVolume {
                rays: light.volumes[number].rays.map(|ray| light.rays[ray]),
                upper_m: top_m - above * gap_m,
                lower_m: top_m - (above + 1.0) * gap_m,
            };
            add(
                &light,
                (&sub, number),
                (&points[k], &eye),
                dials,
                &mut all[k],
            );
        });
    }
    all
}

fn double_area(rays: &[Ray; 3], y: f64) -> f64 {
    let [a, b, c] = rays.map(|ray| ray.at_height(y));
    (b - a).perp_dot(c - a)
}

/// Weights of the rays at a place, if it lies between them.
fn weights_at(rays: &[Ray; 3], p: DVec3) -> Option<[f64; 3]> {
    let place = DVec2::new(p.x, p.z);
    let [a, b, c] = rays.map(|ray| ray.at_height(p.y) - place);
    let parts = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let whole: f64 = parts.iter().sum();
    let is_in = parts.iter().all(|&part| part > 0.0) || parts.iter().all(|&part| part < 0.0);
    is_in.then(|| parts.map(|part| part / whole))
}

impl SubVolume {
    fn height_m(&self) -> f64 {
        self.upper_m - self.lower_m
    }

    fn place(&self, p: DVec3) -> Option<Place> {
        let share = (self.upper_m - p.y) / self.height_m();
        let weights = weights_at(&self.rays, p)?;
        (-1e-12..=1.0 + 1e-12)
            .contains(&share)
            .then_some(Place { weights, share })
    }

    /// The place where a walk from a point to the eye leaves it.
    fn front(&self, p: DVec3, eye: &Eye) -> Place {
        let (to_eye, length_m) = match eye {
            Eye::Along(direction) => (*direction, f64::INFINITY),
            Eye::At(eye_m) => ((*eye_m - p).normalize(), (*eye_m - p).length()),
        };
        let mut inside_m = 0.0;
        // No straight line in it is longer than its extent.
        let corners = self.rays.iter().flat_map(|ray| {
            let at = |y: f64| (ray.at_height(y) - DVec2::new(p.x, p.z)).length();
            [at(self.upper_m), at(self.lower_m)]
        });
        let reach_m = corners.fold(0.0, f64::max) + self.height_m();
        let mut outside_m = reach_m.min(length_m);
        let end = self.place(p + to_eye * outside_m);
        if let (Some(place), true) = (end, length_m <= reach_m) {
            return place;
        }
        for k in 1..=WALK_STEPS {
            let at_m = outside_m * k as f64 / WALK_STEPS as f64;
            if self.place(p + to_eye * at_m).is_none() {
                outside_m = at_m;
                break;
            }
            inside_m = at_m;
        }
        for _ in 0..HALVINGS {
            let middle_m = 0.5 * (inside_m + outside_m);
            match self.place(p + to_eye * middle_m) {
                Some(_) => inside_m = middle_m,
                None => outside_m = middle_m,
            }
        }
        self.place(p + to_eye * inside_m).unwrap()
    }

    /// Flux over area at the two planes.
    fn densities(&self, flux: f64, is_scaled: bool) -> [f64; 2] {
        let areas = [self.upper_m, self.lower_m].map(|y| 0.5 * double_area(&self.rays, y).abs());
        let ratios = areas.map(|area| flux / area);
        if !is_scaled {
            return ratios;
        }
        let through: f64 = (0..INTEGRAL_STEPS)
            .map(|k| {
                let share = (k as f64 + 0.5) / INTEGRAL_STEPS as f64;
                let y = self.upper_m - share * self.height_m();
                let density = ratios[0] + share * (ratios[1] - ratios[0]);
                0.5 * double_area(&self.rays, y).abs() * density / INTEGRAL_STEPS as f64
            })
            .sum();
        ratios.map(|ratio| ratio * flux / through)
    }
}

fn add(
    light: &Light,
    (sub, number): (&SubVolume, usize),
    (point, eye): (&Point, &Eye),
    dials: Dials,
    lit: &mut Lit,
) {
    let p = position(point);
    let Some(weights) = weights_at(&sub.rays, p) else {
        return;
    };
    let mean = |of: &dyn Fn(&Ray) -> f64| -> f64 {
        let each = sub.rays.iter().zip(weights);
        each.map(|(ray, weight)| weight * of(ray)).sum()
    };
    let is_floor = point.receiver == 0.0;
    if mean(&|ray| ray.length_to(p.y)) < 0.0 && !is_floor {
        return;
    }
    let flux = light.volumes[number].flux;
    // The intensity of the two triangles: on the floor there is one, at the point.
    let (place, heights_m, densities) = if is_floor {
        let own = Place {
            weights,
            share: 0.0,
        };
        let density = flux / (0.5 * double_area(&sub.rays, p.y).abs());
        (own, [p.y; 2], [density; 2])
    } else {
        let own = Place {
            weights,
            share: (sub.upper_m - p.y) / sub.height_m(),
        };
        let place = if dials.has_faces {
            sub.front(p, eye)
        } else {
            own
        };
        let densities = sub.densities(flux, dials.is_scaled);
        (place, [sub.upper_m, sub.lower_m], densities)
    };
    let direction = DVec3::new(
        mean(&|ray| ray.direction.x),
        mean(&|ray| ray.direction.y),
        mean(&|ray| ray.direction.z),
    );
    let normal = DVec3::from(point.normal.map(f64::from));
    let turned = (normal.dot(-direction) / -direction.y).max(0.0);
    let entering = sub.rays.iter().map(|ray| ray.transmittance).sum::<f64>() / 3.0;
    for ch in 0..3 {
        let mut intensity = 0.0;
        for (ray, weight) in sub.rays.iter().zip(place.weights) {
            for (plane, share) in [1.0 - place.share, place.share].into_iter().enumerate() {
                let path_m = ray.length_to(heights_m[plane]).max(0.0);
                let left = (-light.extinction_per_m[ch] * path_m).exp();
                intensity +=
                    weight * share * densities[plane] * left * ray.transmittance / entering;
            }
        }
        lit.irradiance[ch] += light.power[ch] * intensity * turned;
    }
    lit.volumes += 1;
}
