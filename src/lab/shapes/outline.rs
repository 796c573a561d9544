//! A surface under construction: positions, and triangles over them.

use glam::DVec3;

/// Positions and triangles of a surface, before normals and text. Corners that are one point share an index.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Positions, m.
    pub positions_m: Vec<DVec3>,
    /// Indices of the corners, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl Outline {
    /// Adds a position; returns its index.
    pub(super) fn point(&mut self, p_m: DVec3) -> u32 {
        self.positions_m.push(p_m);
        self.positions_m.len() as u32 - 1
    }

    /// Adds a quadrilateral as two triangles, cut from its first corner to its third.
    pub(super) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.faces.extend([[a, b, c], [a, c, d]]);
    }

    /// Puts another surface beside this one; they share no point.
    pub(super) fn add(&mut self, other: &Self) {
        let first = self.positions_m.len() as u32;
        self.positions_m.extend(&other.positions_m);
        self.faces
            .extend(other.faces.iter().map(|face| face.map(|i| first + i)));
    }

    /// All of these, side by side.
    pub(super) fn all(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut whole = Self::default();
        for part in parts {
            whole.add(&part);
        }
        whole
    }

    /// Moves every point; a map that mirrors turns the surface inside out.
    pub(super) fn map(mut self, change: impl Fn(DVec3) -> DVec3) -> Self {
        for p in &mut self.positions_m {
            *p = change(*p);
        }
        self
    }

    /// Moved by an offset.
    pub(super) fn moved(self, x_m: f64, y_m: f64, z_m: f64) -> Self {
        self.map(|p| p + DVec3::new(x_m, y_m, z_m))
    }

    /// Mirrored at the plane through the origin across `axis` (0 = x, 1 = y, 2 = z), the outside still outside.
    pub(super) fn mirrored(self, axis: usize) -> Self {
        let mut mirrored = self.map(|mut p| {
            p[axis] = -p[axis];
            p
        });
        for face in &mut mirrored.faces {
            face.swap(1, 2);
        }
        mirrored
    }

    /// The middle of the bounds at the origin, their longest side 1 m.
    pub(super) fn fitted(self) -> Self {
        let (min, max) = self
            .positions_m
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &p| {
                (min.min(p), max.max(p))
            });
        let (middle, longest_m) = (0.5 * (min + max), (max - min).max_element());
        self.map(|p| (p - middle) / longest_m)
    }
}
