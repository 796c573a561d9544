//! Continues the heights of a basin to where there is no water: into obstacles, and beyond reflecting walls.

use super::cells::Cells;

/// Samples at the rim of an obstacle that repeat the water next to them.
const RIM: u32 = 2;

/// Rounds in which the heights deeper inside are smoothed.
const ROUNDS: usize = 32;

/// Heights inside obstacles. At the rim they repeat the water next to them, so that the slope across the rim stays 0, as it is for waves at
/// a wall. Deeper inside they go on so and are smoothed. Obstacles without water beside them stay flat.
pub(super) fn inside(heights_m: &mut [f64], inside: &[bool], cells: &Cells) {
    // By distance from the water in samples: 0 is water.
    let mut depths: Vec<u32> = inside
        .iter()
        .map(|is| if *is { u32::MAX } else { 0 })
        .collect();
    let mut front: Vec<usize> = (0..inside.len()).filter(|at| inside[*at]).collect();
    let mut depth = 0;
    while !front.is_empty() {
        let reached: Vec<(usize, f64)> = front
            .iter()
            .filter_map(|at| {
                let known = neighbours(*at, cells).filter(|(at, _)| depths[*at] <= depth);
                let sums = known.fold([0.0; 2], |[sum, weights], (at, weight)| {
                    [sum + weight * heights_m[at], weights + weight]
                });
                (sums[1] > 0.0).then(|| (*at, sums[0] / sums[1]))
            })
            .collect();
        if reached.is_empty() {
            break;
        }
        depth += 1;
        for (at, height_m) in reached {
            heights_m[at] = height_m;
            depths[at] = depth;
        }
        front.retain(|at| depths[*at] == u32::MAX);
    }
    let deep: Vec<usize> = (0..inside.len())
        .filter(|at| depths[*at] > RIM && depths[*at] != u32::MAX)
        .collect();
    for _ in 0..ROUNDS {
        let smoothed: Vec<f64> = deep
            .iter()
            .map(|at| {
                let sums = neighbours(*at, cells).fold([0.0; 2], |[sum, weights], (at, weight)| {
                    [sum + weight * heights_m[at], weights + weight]
                });
                sums[0] / sums[1]
            })
            .collect();
        for (at, height_m) in deep.iter().zip(smoothed) {
            heights_m[*at] = height_m;
        }
    }
}

/// The samples around one, with weights: 2 for those beside it, 1 for those at its corners.
fn neighbours(at: usize, cells: &Cells) -> impl Iterator<Item = (usize, f64)> {
    let [width, height] = cells.size.map(|count| count as i64);
    let (column, row) = (at as i64 % width, at as i64 / width);
    let wraps = cells.wraps;
    let around = (-1..=1).flat_map(|dz: i64| (-1..=1).map(move |dx: i64| [dx, dz]));
    around.filter_map(move |[dx, dz]| {
        let (x, z) = (column + dx, row + dz);
        let is_on_grid = (0..width).contains(&x) && (0..height).contains(&z);
        if [dx, dz] == [0, 0] || !(wraps || is_on_grid) {
            return None;
        }
        let (x, z) = (x.rem_euclid(width), z.rem_euclid(height));
        let weight = if dx == 0 || dz == 0 { 2.0 } else { 1.0 };
        Some(((z * width + x) as usize, weight))
    })
}

/// The heights with their mirror images: twice as many along x and z.
pub(super) fn mirrored(heights_m: &[f64], [width, height]: [usize; 2]) -> Vec<f64> {
    let mut mirrored = Vec::with_capacity(4 * heights_m.len());
    for row in (0..height).chain((0..height).rev()) {
        let line = &heights_m[row * width..][..width];
        mirrored.extend(line.iter().chain(line.iter().rev()));
    }
    mirrored
}
