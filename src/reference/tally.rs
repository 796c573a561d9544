//! Sums over a batch of rays, term by term.

use super::floor::FloorMap;

/// Sums over rays per unit of the sun's irradiance, first in units of the water per ray, after [`Tally::scale`] in m²;
/// `K` different extinction coefficients side by side.
#[derive(Clone, Debug)]
pub(super) struct Tally<const K: usize> {
    /// Landed per texel.
    pub(super) texels: Vec<[f64; K]>,
    /// Blocked by a mesh, per texel where it would have landed; empty when no mesh can block.
    pub(super) shaded: Vec<[f64; K]>,
    /// Landed per object.
    pub(super) objects: Vec<[f64; K]>,
    /// Fell on the water.
    pub(super) emitted: f64,
    /// Reflected at the surface.
    pub(super) reflected: f64,
    /// Absorbed or scattered in the water.
    pub(super) lost: [f64; K],
    /// Reached the floor's plane outside the map.
    pub(super) left: [f64; K],
    /// Reached nothing.
    pub(super) missed: f64,
    /// The number of rays.
    pub(super) rays: u64,
}

impl<const K: usize> Tally<K> {
    pub(super) fn new(map: &FloorMap, objects: usize) -> Self {
        Self {
            texels: vec![[0.0; K]; map.len()],
            shaded: vec![[0.0; K]; if objects > 0 { map.len() } else { 0 }],
            objects: vec![[0.0; K]; objects],
            emitted: 0.0,
            reflected: 0.0,
            lost: [0.0; K],
            left: [0.0; K],
            missed: 0.0,
            rays: 0,
        }
    }

    /// Multiplies every sum.
    pub(super) fn scale(&mut self, factor: f64) {
        let many = self.texels.iter_mut().chain(&mut self.shaded);
        let many = many.chain(&mut self.objects);
        for value in many.chain([&mut self.lost, &mut self.left]).flatten() {
            *value *= factor;
        }
        for value in [&mut self.emitted, &mut self.reflected, &mut self.missed] {
            *value *= factor;
        }
    }

    /// Adds `other`; sums depend on the order of the calls, so keep it fixed.
    pub(super) fn add(&mut self, other: &Self) {
        for (sum, value) in self.texels.iter_mut().zip(&other.texels) {
            add_to(sum, value);
        }
        for (sum, value) in self.shaded.iter_mut().zip(&other.shaded) {
            add_to(sum, value);
        }
        for (sum, value) in self.objects.iter_mut().zip(&other.objects) {
            add_to(sum, value);
        }
        self.emitted += other.emitted;
        self.reflected += other.reflected;
        add_to(&mut self.lost, &other.lost);
        add_to(&mut self.left, &other.left);
        self.missed += other.missed;
        self.rays += other.rays;
    }
}

#[inline]
pub(super) fn add_to<const K: usize>(sum: &mut [f64; K], value: &[f64; K]) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += value;
    }
}

/// Sum in four interleaved parts: four times as fast as one by one, and always in the same order.
pub(super) fn sum(values: &[f64]) -> f64 {
    let mut parts = [0.0; 4];
    let chunks = values.chunks_exact(4);
    let rest: f64 = chunks.remainder().iter().sum();
    for chunk in chunks {
        add_to(&mut parts, &[chunk[0], chunk[1], chunk[2], chunk[3]]);
    }
    (parts[0] + parts[1]) + (parts[2] + parts[3]) + rest
}
