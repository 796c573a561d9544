//! The light of a lamp under water on a small square: straight rays, blocked by meshes.

use glam::{DVec2, DVec3};

use super::light::PlacedLight;
use super::patch::{Landed, Patch};
use super::place::Place;
use super::rings::Rings;
use super::slanted::{halves, rows};
use super::window::{LightWindow, Target};

/// Two independent estimates from about `points` rays each, and the number of rays.
///
/// The sampled places lie on the square, in rings around the lamp's foot on its plane; each brings
/// I h/r³ e^(−c r), with h the lamp's height over the plane.
pub(super) fn shine(
    place: &Place,
    light: &PlacedLight,
    lamp_m: DVec3,
    patch: &Patch,
    (points, key): (f64, u64),
    stack: &mut Vec<usize>,
) -> ([Landed; 2], u64) {
    let way_m = lamp_m - patch.center_m;
    let height_m = way_m.dot(patch.normal);
    if height_m <= 0.0 {
        return Default::default();
    }
    let [u, v] = patch.across;
    let half_m = DVec2::splat(patch.half_m);
    let square = LightWindow {
        min_m: -half_m,
        max_m: half_m,
    };
    let rings = Rings::around(DVec2::new(way_m.dot(u), way_m.dot(v)), height_m);
    let whole = rings.around_window(&square);
    let rings = rings.in_units_of(whole.max_m - whole.min_m);
    let part = rings.around_window(&square);
    let lamp = Target {
        min_m: lamp_m,
        max_m: lamp_m,
    };
    let may_be_shaded = patch.may_be_shaded(place, lamp);
    let mut rays = 0;
    let both = halves(points, key).map(|lattice| {
        let mut sum = Landed::default();
        for row in rows(&lattice, &part) {
            rays += row.count;
            for i in 0..row.count {
                let (at, m2) = rings.place(row.start_m + lattice.step_m() * i as f64);
                // The rings extend beyond the square.
                if !square.contains(at) {
                    continue;
                }
                let to_m = patch.center_m + u * at.x + v * at.y;
                let path_m = lamp_m.distance(to_m);
                let blocked = patch.blocked(place, lamp_m, to_m, may_be_shaded, stack);
                let flux = m2 * height_m / path_m.powi(3);
                sum.book(flux, place.extinction_per_m, path_m, blocked);
            }
        }
        let per_m2 = lattice.area_per_point_m2() / (2.0 * patch.half_m).powi(2);
        sum.scale(light.power.map(|power| power * per_m2));
        sum
    });
    (both, rays)
}
