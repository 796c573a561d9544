//! A lattice whose cells are the shadows of a receiver's texels on the water at rest, cast against the light.
//!
//! Under flat water each texel then gets the same count of rays, to the ray, however receiver and light are tilted.

use glam::{DMat2, DVec2, DVec3};

use super::lattice::{Lattice, Row, SECOND_HALF, uniform};
use super::window::LightWindow;

/// Least area of a cell as a share of the texel's: light that only grazes a receiver under flat water may still hit it under
/// waves, and needs no finer cells than elsewhere.
const LEAST_AREA: f64 = 0.25;

/// The cells: water at (x, z) = `origin_m` + `basis_m` (s, t) with whole numbers of s and t on their edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    pub(super) origin_m: DVec2,
    pub(super) basis_m: DMat2,
}

impl Cells {
    /// Cells for a texel with edges `u_m` and `v_m` and a corner at `corner_m`, in light along unit `flat`.
    pub(super) fn of(corner_m: DVec3, u_m: DVec3, v_m: DVec3, flat: DVec3) -> Self {
        let cast = |edge: DVec3| {
            let p = edge - flat * (edge.y / flat.y);
            DVec2::new(p.x, p.z)
        };
        let texel_m2 = u_m.cross(v_m).length();
        let mut basis_m = DMat2::from_cols(cast(u_m), cast(v_m));
        if basis_m.determinant().abs() < LEAST_AREA * texel_m2 {
            basis_m = DMat2::from_diagonal(DVec2::splat((LEAST_AREA * texel_m2).sqrt()));
        }
        Self {
            origin_m: cast(corner_m),
            basis_m,
        }
    }

    /// Area of a cell, m².
    pub(super) fn area_m2(&self) -> f64 {
        self.basis_m.determinant().abs()
    }

    /// Water at `st`, m.
    pub(super) fn water_m(&self, st: DVec2) -> DVec2 {
        self.origin_m + self.basis_m * st
    }

    /// The smallest rectangle of (s, t) that holds `window`.
    pub(super) fn around(&self, window: &LightWindow) -> LightWindow {
        let inverse = self.basis_m.inverse();
        let (low, high) = (window.min_m - self.origin_m, window.max_m - self.origin_m);
        let corners = [
            low,
            high,
            DVec2::new(low.x, high.y),
            DVec2::new(high.x, low.y),
        ]
        .map(|corner| inverse * corner);
        LightWindow {
            min_m: corners.into_iter().fold(DVec2::INFINITY, DVec2::min),
            max_m: corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max),
        }
    }
}

/// Two independent lattices over the same cells: of different sizes, turned in opposite directions, with shifts that follow from `key`.
pub(super) fn halves(points_per_cell: f64, key: u64) -> [Lattice; 2] {
    let mut wanted = points_per_cell;
    [0, 1].map(|half| {
        let key = (key * 2 + half) * 2;
        let shift = DVec2::new(uniform(key), uniform(key + 1));
        let lattice = Lattice::new(wanted, DVec2::ONE, shift, half == 1);
        wanted = SECOND_HALF * lattice.points_per_texel(DVec2::ONE);
        lattice
    })
}

/// All rows of `lattice` in a rectangle of (s, t).
pub(super) fn rows(lattice: &Lattice, part: &LightWindow) -> impl Iterator<Item = Row> {
    let (first, end) = lattice.rows(part);
    let (lattice, part) = (*lattice, *part);
    (first..end).map(move |number| lattice.row(number, &part))
}
