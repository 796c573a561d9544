//! How water is divided into pieces for counting rays. It is parametrised by (s, t); every unit gets the same number of rays.

use glam::{DVec2, DVec3};

use super::light::{PlacedLight, Source};
use super::place::Place;
use super::rings::Rings;
use super::slanted::Cells;
use super::window::LightWindow;

/// The parametrisation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Strata {
    /// For a sun: shadows of the receiver's texels.
    Cells(Cells),
    /// For a point light above the water: rings around its foot.
    Rings(Rings),
}

impl Strata {
    /// For light on a square with edges `u_m` and `v_m` and a corner at `corner_m`, which a unit of (s, t) lights under flat water;
    /// `None` for light that does not pass through the surface.
    pub(super) fn of(
        place: &Place,
        light: &PlacedLight,
        corner_m: DVec3,
        [u_m, v_m]: [DVec3; 2],
    ) -> Option<Self> {
        let middle_m = corner_m + (u_m + v_m) * 0.5;
        match light.source {
            Source::Sun { .. } => {
                let flat = light.source.flat_direction(middle_m, place.ior)?;
                Some(Self::Cells(Cells::of(corner_m, u_m, v_m, flat)))
            }
            Source::Lamp {
                position_m,
                submerged: false,
            } => {
                let across = u_m.cross(v_m);
                let square = (middle_m, across.normalize_or_zero(), across.length());
                Some(Self::Rings(light.rings(place, position_m, square)))
            }
            Source::Lamp {
                submerged: true, ..
            } => None,
        }
    }

    /// The water at `st`, m, and the area of a unit of (s, t) there, m².
    pub(super) fn water_m(&self, st: DVec2) -> (DVec2, f64) {
        match self {
            Self::Cells(cells) => (cells.water_m(st), cells.area_m2()),
            Self::Rings(rings) => rings.place(st),
        }
    }

    /// The smallest rectangle of (s, t) that holds `window`.
    pub(super) fn around(&self, window: &LightWindow) -> LightWindow {
        match self {
            Self::Cells(cells) => cells.around(window),
            Self::Rings(rings) => rings.around_window(window),
        }
    }

    /// A rectangle of (s, t) that holds `window` and suits quartering: for cells a square.
    pub(super) fn start_of_quartering(&self, window: &LightWindow) -> LightWindow {
        let whole = self.around(window);
        match self {
            Self::Cells(_) => {
                let middle = (whole.min_m + whole.max_m) * 0.5;
                let corner = DVec2::splat(0.5 * (whole.max_m - whole.min_m).max_element());
                LightWindow {
                    min_m: middle - corner,
                    max_m: middle + corner,
                }
            }
            // Beyond a full turn they would be counted twice.
            Self::Rings(_) => whole,
        }
    }

    /// A place of the water in the piece `part`, m, and how far from it the piece reaches, m.
    pub(super) fn middle(&self, part: &LightWindow) -> (DVec2, f64) {
        match self {
            Self::Cells(cells) => {
                let (a, b) = (cells.basis_m.x_axis, cells.basis_m.y_axis);
                let half_diagonal_m = 0.5 * (a + b).length().max((a - b).length());
                let size = part.max_m - part.min_m;
                let middle_m = cells.water_m((part.min_m + part.max_m) * 0.5);
                (middle_m, size.max_element() * half_diagonal_m)
            }
            Self::Rings(rings) => rings.middle(part),
        }
    }
}
