//! Traces all rays of one lattice: rows in bands, the receivers under the water, and the rays of a sun.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::floor::FloorMap;
use super::lattice::{Lattice, Row};
use super::occluders::Occluders;
use super::refract::{BLOCK, Block, RowRefractor};
use super::tally::{Tally, add_to, sum};
use super::window::LightWindow;
use crate::physics::attenuation::transmission;
use crate::waves::Surface;

/// The largest number of bands of rows. Each has its own map, and the maps are summed in order.
const MOST_BANDS: usize = 64;
/// Memory for the bands' maps, bytes.
const BAND_BYTES: usize = 256 << 20;

/// Floor and meshes under the water, in local coordinates.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a, const K: usize> {
    pub(super) map: &'a FloorMap,
    pub(super) occluders: &'a Occluders,
    /// The different extinction coefficients, 1/m.
    pub(super) extinction_per_m: [f64; K],
}

impl<const K: usize> Ground<'_, K> {
    /// Calls `count_row` for each row of `lattice` in `window`; `counted` gets the number of rays of each band. Once `cancelled` returns
    /// true, the remaining rows are skipped. The number of bands and the order of their sum depend on the map only, so the bits do not
    /// depend on the threads.
    pub(super) fn count_rows(
        &self,
        lattice: &Lattice,
        window: &LightWindow,
        counted: &(dyn Fn(u64) + Sync),
        cancelled: &(dyn Fn() -> bool + Sync),
        count_row: &(dyn Fn(Row, &mut Tally<K>) + Sync),
    ) -> Tally<K> {
        let (first, end) = lattice.rows(window);
        let rows = usize::try_from(end - first).unwrap_or(0);
        let maps = if self.occluders.is_empty() { 1 } else { 2 };
        let map_bytes = maps * self.map.len() * size_of::<[f64; K]>();
        let bands = (BAND_BYTES / map_bytes.max(1))
            .clamp(2, MOST_BANDS)
            .min(rows.max(1));
        let tallies: Vec<Tally<K>> = (0..bands)
            .into_par_iter()
            .map(|band| {
                let mut tally = Tally::new(self.map, self.occluders.bounds.len());
                for row in rows * band / bands..rows * (band + 1) / bands {
                    if cancelled() {
                        break;
                    }
                    let row = lattice.row(first + row as i64, window);
                    count_row(row, &mut tally);
                    tally.rays += row.count;
                }
                counted(tally.rays);
                tally
            })
            .collect();
        let mut total = Tally::new(self.map, self.occluders.bounds.len());
        for tally in &tallies {
            total.add(tally);
        }
        total.scale(lattice.area_per_point_m2());
        total
    }

    /// Counts a ray with flux `entered` that goes from `from_m` to the floor's plane at `to_m`, `path_m` away.
    #[inline]
    pub(super) fn land(
        &self,
        entered: f64,
        from_m: DVec3,
        to_m: DVec3,
        path_m: f64,
        stack: &mut Vec<usize>,
        tally: &mut Tally<K>,
    ) {
        let hit = if self.occluders.is_empty() {
            None
        } else {
            self.occluders.first_hit(from_m, to_m, stack)
        };
        let length_m = path_m * hit.map_or(1.0, |hit| hit.fraction);
        let mut arrived = [entered; K];
        for (k, arrived) in arrived.iter_mut().enumerate() {
            if self.extinction_per_m[k] > 0.0 {
                *arrived = entered * transmission(self.extinction_per_m[k], length_m);
                tally.lost[k] += entered - *arrived;
            }
        }
        if let Some(hit) = hit {
            add_to(&mut tally.objects[hit.object], &arrived);
            if let Some(texel) = self.map.texel_at(to_m.x, to_m.z) {
                let blocked = self
                    .extinction_per_m
                    .map(|c| entered * transmission(c, path_m));
                add_to(&mut tally.shaded[texel], &blocked);
            }
        } else if let Some(texel) = self.map.texel_at(to_m.x, to_m.z) {
            add_to(&mut tally.texels[texel], &arrived);
        } else {
            add_to(&mut tally.left, &arrived);
        }
    }
}

/// Values that all rays of a sun share, in local coordinates.
pub(super) struct Beam<'a, const K: usize> {
    pub(super) ground: Ground<'a, K>,
    pub(super) surface: &'a Surface,
    pub(super) to_light: DVec3,
    pub(super) ior: f64,
    pub(super) window: LightWindow,
}

impl<const K: usize> Beam<'_, K> {
    /// Counts every ray of `lattice` in the window; `counted` gets the number of rays since its last call. Once
    /// `cancelled` returns true, the rest is skipped and the tally is unusable.
    pub(super) fn trace(
        &self,
        lattice: &Lattice,
        counted: &(dyn Fn(u64) + Sync),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Tally<K> {
        let refractor = RowRefractor::new(
            self.surface,
            lattice.step_m(),
            self.to_light,
            self.ior,
            self.ground.map.depth_m,
        );
        let count_row = |row: Row, tally: &mut Tally<K>| {
            let mut block = Block::new();
            let mut stack = Vec::new();
            let mut done = 0;
            while done < row.count {
                let start_m = row.start_m + lattice.step_m() * done as f64;
                let count = (row.count - done).min(BLOCK as u64) as usize;
                refractor.send(start_m, &mut block);
                self.count(start_m, lattice, &block, count, &mut stack, tally);
                done += count as u64;
            }
        };
        self.ground
            .count_rows(lattice, &self.window, counted, cancelled, &count_row)
    }

    /// Counts the first `count` rays of `block`.
    fn count(
        &self,
        start_m: DVec2,
        lattice: &Lattice,
        block: &Block,
        count: usize,
        stack: &mut Vec<usize>,
        tally: &mut Tally<K>,
    ) {
        tally.emitted += sum(&block.facing[..count]);
        tally.reflected += sum(&block.reflected[..count]);
        for i in 0..count {
            let (x_m, z_m) = (block.x_m[i], block.z_m[i]);
            let entered = block.entered[i];
            if x_m.is_nan() {
                tally.missed += entered;
                continue;
            }
            let top_m = start_m + lattice.step_m() * i as f64;
            let from_m = DVec3::new(top_m.x, block.water.height_m[i], top_m.y);
            let to_m = DVec3::new(x_m, -self.ground.map.depth_m, z_m);
            self.ground
                .land(entered, from_m, to_m, block.path_m[i], stack, tally);
        }
    }
}
