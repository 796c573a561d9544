//! Photon mapping in image space as a plain float64 program, written from Mihálik 2008 (ch. 7.1 and 8) with points and lines, for a floor
//! and upright boxes. It shares with the method only the facts of the scene: where the water's window lies, and its waves.

use caustica::facts::SceneFacts;
use caustica::facts::source::Source;
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::physics::refraction::{normal_from_slope, refract_direction};
use glam::{DVec2, DVec3};

/// A rectangle of places on the water at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
}

impl Window {
    fn side_m(&self, count: u32) -> DVec2 {
        (self.max - self.min) / f64::from(count)
    }
}

/// The program's scene: one sun.
pub(crate) struct Plain<'a> {
    facts: &'a SceneFacts,
    to_light: DVec3,
    floor_y_m: f64,
    boxes: Vec<[DVec3; 2]>,
    water: Window,
    view: Window,
    pub(crate) map: Window,
    photons: u32,
    texels: u32,
    /// What the view shows per texel: heights, m.
    heights: Vec<f64>,
}

/// Where a photon ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ended {
    pub(crate) at: DVec3,
    pub(crate) path_m: f64,
    /// Flux that enters the water, m² under 1 W/m².
    pub(crate) flux: f64,
}

impl<'a> Plain<'a> {
    pub(crate) fn new(
        facts: &'a SceneFacts,
        boxes: &[[DVec3; 2]],
        photons: u32,
        texels: u32,
    ) -> Self {
        let set = &facts.lights.beam_sets[0];
        let Source::Sun { to_light } = set.source else {
            panic!("a sun");
        };
        let floor = facts.receivers.floor.as_ref().unwrap();
        let rect = facts.receivers.floor_map.unwrap().rect;
        let water = Window {
            min: set.window.min,
            max: set.window.max,
        };
        let mut plain = Self {
            facts,
            to_light,
            floor_y_m: floor.y_m,
            boxes: boxes.to_vec(),
            water,
            view: water,
            map: water,
            photons,
            texels,
            heights: Vec::new(),
        };
        let on_floor = |p: DVec2| plain.place(DVec3::new(p.x, floor.y_m, p.y));
        let map = Window {
            min: on_floor(rect.min),
            max: on_floor(rect.max),
        };
        // The water's surface in the view: its window, moved by the height of the waves along the light.
        let high_m = facts.water.surface.max_height_m();
        let corners = [
            (water.min, high_m),
            (water.max, high_m),
            (water.min, -high_m),
            (water.max, -high_m),
        ]
        .map(|(p, y)| plain.place(DVec3::new(p.x, y, p.y)));
        let view = Window {
            min: corners.iter().fold(map.min, |low, p| low.min(*p)),
            max: corners.iter().fold(map.max, |high, p| high.max(*p)),
        };
        plain.map = map;
        plain.view = view;
        let side_m = view.side_m(texels);
        plain.heights = (0..texels * texels)
            .map(|i| {
                let texel = DVec2::new(f64::from(i % texels), f64::from(i / texels));
                plain.shown_through(view.min + (texel + 0.5) * side_m)
            })
            .collect();
        plain
    }

    /// Where the sun's ray through a point crosses the water at rest.
    fn place(&self, p: DVec3) -> DVec2 {
        let on_water = p - self.to_light * (p.y / self.to_light.y);
        DVec2::new(on_water.x, on_water.z)
    }

    /// Height of the first surface under the water along the sun's ray through a place: the floor, or where the ray enters a box.
    fn shown_through(&self, place: DVec2) -> f64 {
        let start = DVec3::new(place.x, 0.0, place.y);
        let mut reach = -self.floor_y_m / self.to_light.y;
        for [min, max] in &self.boxes {
            let ends = [*min, *max].map(|corner| (start - corner) / self.to_light);
            let enters = ends[0].min(ends[1]).max_element();
            let leaves = ends[0].max(ends[1]).min_element();
            if enters <= leaves && enters >= 0.0 {
                reach = reach.min(enters);
            }
        }
        -reach * self.to_light.y
    }

    /// A of a point W: on the light's ray through W, at the height that the depth texture has there.
    fn shown_at(&self, w: DVec3) -> DVec3 {
        let texel = (self.place(w) - self.view.min) / self.view.side_m(self.texels);
        let last = f64::from(self.texels);
        let is_within = texel.cmpge(DVec2::ZERO).all() && texel.cmplt(DVec2::splat(last)).all();
        let y = if is_within {
            self.heights[(texel.y as u32 * self.texels + texel.x as u32) as usize]
        } else {
            self.floor_y_m
        };
        w + self.to_light * ((y - w.y) / self.to_light.y)
    }

    /// §7.1: of W_1 … W_n the one that is nearest to its A.
    fn search(&self, u: DVec3, r: DVec3, iterations: u32) -> DVec3 {
        let mut a = self.shown_at(u);
        let mut w = u + r * a.distance(u);
        let mut nearest = (w, f64::INFINITY);
        for _ in 0..iterations {
            let next_a = self.shown_at(w);
            let gap_m = next_a.distance(w);
            if gap_m < nearest.1 {
                nearest = (w, gap_m);
            }
            let q = next_a - a;
            let n = r.cross(q);
            // Formula (3).
            let met = u + r * ((a - u).cross(q).dot(n) / n.length_squared());
            // The program of §9.1 allows a tenth more than the distance of the two.
            let is_between = met.distance(a) + next_a.distance(met) <= 1.1 * q.length();
            w = if is_between {
                met
            } else if w.dot(self.to_light) >= next_a.dot(self.to_light) {
                w + r * gap_m
            } else {
                w - r * gap_m
            };
            a = next_a;
        }
        nearest.0
    }

    /// The photon of a cell of the water.
    pub(crate) fn photon(&self, index: u32, iterations: u32) -> Ended {
        let cell = DVec2::new(
            f64::from(index % self.photons),
            f64::from(index / self.photons),
        );
        let side_m = self.water.side_m(self.photons);
        let at = self.water.min + (cell + 0.5) * side_m;
        let water = self.facts.water.surface.at(at.x, at.y);
        let normal = normal_from_slope(water.slope.x, water.slope.y);
        let u = DVec3::new(at.x, water.height_m, at.y);
        let ior = self.facts.lights.beam_sets[0].band.ior;
        let r = refract_direction(-self.to_light, normal, ior).unwrap();
        // The area of the cell of the sloped surface, as the sun sees it.
        let area_m2 = side_m.x * side_m.y / normal.y * normal.dot(self.to_light);
        let at = self.search(u, r, iterations);
        Ended {
            at,
            path_m: at.distance(u),
            flux: area_m2 * fresnel_transmittance(normal.dot(self.to_light), ior),
        }
    }

    /// A point's place on the map, texels.
    pub(crate) fn map_place(&self, p: DVec3) -> DVec2 {
        (self.place(p) - self.map.min) / self.map.side_m(self.texels)
    }

    /// The caustics map: flux per texel of each channel, in W under the scene's sun.
    pub(crate) fn caustics(&self, iterations: u32) -> Vec<[f64; 3]> {
        let set = &self.facts.lights.beam_sets[0];
        let mut map = vec![[0.0; 3]; (self.texels * self.texels) as usize];
        for index in 0..self.photons * self.photons {
            let ended = self.photon(index, iterations);
            let texel = self.map_place(ended.at);
            let last = DVec2::splat(f64::from(self.texels));
            if texel.cmplt(DVec2::ZERO).any() || texel.cmpge(last).any() {
                continue;
            }
            let sums = &mut map[(texel.y as u32 * self.texels + texel.x as u32) as usize];
            for (c, sum) in sums.iter_mut().enumerate() {
                let left = (-set.band.extinction_per_m[c] * ended.path_m).exp();
                *sum += set.power[c] * ended.flux * left;
            }
        }
        map
    }

    /// Irradiance of the floor's texels, row by row: the map between its texel centres, where the view shows the floor.
    pub(crate) fn floor(&self, map: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let floor = self.facts.receivers.floor_map.unwrap();
        let size = floor.rect.size() / DVec2::new(f64::from(floor.width), f64::from(floor.height));
        let side_m = self.map.side_m(self.texels);
        let last = i64::from(self.texels) - 1;
        (0..floor.width * floor.height)
            .map(|i| {
                let texel = DVec2::new(f64::from(i % floor.width), f64::from(i / floor.width));
                let at = floor.rect.min + (texel + 0.5) * size;
                let p = DVec3::new(at.x, self.floor_y_m, at.y);
                if self.shown_at(p).y > self.floor_y_m + 0.01 {
                    return [0.0; 3];
                }
                let uv = self.map_place(p) - 0.5;
                let low = uv.floor();
                let share = uv - low;
                let mut sum = [0.0; 3];
                for (dx, dy, weight) in [
                    (0, 0, (1.0 - share.x) * (1.0 - share.y)),
                    (1, 0, share.x * (1.0 - share.y)),
                    (0, 1, (1.0 - share.x) * share.y),
                    (1, 1, share.x * share.y),
                ] {
                    let [x, y] = [low.x as i64 + dx, low.y as i64 + dy].map(|k| k.clamp(0, last));
                    let texel = map[(y * i64::from(self.texels) + x) as usize];
                    for c in 0..3 {
                        // A horizontal floor cuts the sun's rays in the area of the texel on the water.
                        sum[c] += weight * texel[c] / (side_m.x * side_m.y);
                    }
                }
                sum
            })
            .collect()
    }
}
