//! Sample places around the foot of a point light, denser where it is brightest.
//!
//! A lamp at height h lights a plane with I h/(ρ² + h²)^(3/2) at distance ρ from its foot: for a lamp a millimetre above the water, half
//! the light goes through a spot of two millimetres, which an even lattice hardly samples. Here the lattice lies over (w, φ) with
//! w = q + κ (1 − e^(−q)), q = ½ ln(1 + ρ²/h²). The second term distributes places like the light on a level plane. The first gives
//! every ring of twice the width the same number; the flanks of waves at grazing light need this. Each place represents
//! (ρ² + h²)/(1 + κ e^(−q)) dw dφ of the plane.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::window::LightWindow;

/// κ: the weight of the places distributed like the light on a level plane, relative to those of the rings. For a light a millimetre
/// above metres of water they are about half of all places.
const CORE: f64 = 8.0;
/// Steps of Newton's method, far more than it needs.
const MOST_STEPS: u32 = 64;

/// The places, on any plane; coordinates (s, t) are (w, φ) in units that the caller chooses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rings {
    foot_m: DVec2,
    height_m: f64,
    unit: DVec2,
}

impl Rings {
    /// Around a lamp `height_m`, above 0, over `foot_m`.
    pub(super) fn around(foot_m: DVec2, height_m: f64) -> Self {
        Self {
            foot_m,
            height_m,
            unit: DVec2::ONE,
        }
    }

    /// The same places in other units of w and φ.
    pub(super) fn in_units_of(self, unit: DVec2) -> Self {
        Self { unit, ..self }
    }

    /// Area per unit of w and φ at distance `rho_m` from the foot, m².
    pub(super) fn area_m2(&self, rho_m: f64) -> f64 {
        let square_m2 = rho_m * rho_m + self.height_m * self.height_m;
        square_m2 / (1.0 + CORE * self.height_m / square_m2.sqrt())
    }

    /// The place at `st`, m, and the area that a unit of (s, t) is there, m².
    pub(super) fn place(&self, st: DVec2) -> (DVec2, f64) {
        let w_phi = st * self.unit;
        let rho_m = self.distance_m(w_phi.x);
        let place_m = self.foot_m + DVec2::from_angle(w_phi.y) * rho_m;
        (place_m, self.area_m2(rho_m) * self.unit.element_product())
    }

    fn w(&self, rho_m: f64) -> f64 {
        let q = 0.5 * (rho_m / self.height_m).powi(2).ln_1p();
        q - CORE * (-q).exp_m1()
    }

    /// The distance from the foot at `w`, m: w(q) is concave, so that Newton's method runs up to q from below.
    fn distance_m(&self, w: f64) -> f64 {
        let mut q = (w / (1.0 + CORE)).max(w - CORE).max(0.0);
        for _ in 0..MOST_STEPS {
            let below = (-q).exp_m1();
            let step = (w - q + CORE * below) / (1.0 + CORE * (1.0 + below));
            q += step;
            if step <= 1e-16 * q {
                break;
            }
        }
        self.height_m * (2.0 * q).exp_m1().max(0.0).sqrt()
    }

    /// The smallest rectangle of (s, t) that holds `window`; empty when that is.
    pub(super) fn around_window(&self, window: &LightWindow) -> LightWindow {
        let (low, high) = (window.min_m - self.foot_m, window.max_m - self.foot_m);
        if !low.is_finite() || !high.is_finite() || low.cmpgt(high).any() {
            return LightWindow::empty();
        }
        let nearest_m = low.max(-high).max(DVec2::ZERO).length();
        let farthest_m = low.abs().max(high.abs()).length();
        let (from, to) = if nearest_m > 0.0 {
            let middle = (low + high) * 0.5;
            let turn = [
                low,
                high,
                DVec2::new(low.x, high.y),
                DVec2::new(high.x, low.y),
            ]
            .map(|corner| middle.angle_to(corner));
            let ahead = middle.to_angle();
            (
                ahead + turn.into_iter().fold(0.0, f64::min),
                ahead + turn.into_iter().fold(0.0, f64::max),
            )
        } else {
            (-PI, PI)
        };
        LightWindow {
            min_m: DVec2::new(self.w(nearest_m), from) / self.unit,
            max_m: DVec2::new(self.w(farthest_m), to.min(from + TAU)) / self.unit,
        }
    }

    /// A place of `piece`, m, and how far from it the piece reaches, m.
    pub(super) fn middle(&self, piece: &LightWindow) -> (DVec2, f64) {
        let (low, high) = (piece.min_m * self.unit, piece.max_m * self.unit);
        let (inner_m, outer_m) = (self.distance_m(low.x), self.distance_m(high.x));
        let rho_m = 0.5 * (inner_m + outer_m);
        let place_m = self.foot_m + DVec2::from_angle(0.5 * (low.y + high.y)) * rho_m;
        // Along the ray from the foot, then along the ring.
        let reach_m = 0.5 * (outer_m - inner_m) + outer_m * 0.5 * (high.y - low.y);
        (place_m, reach_m)
    }
}
