//! Continues the heights of a basin to where there is no water: into obstacles, and beyond reflecting walls.

use super::cells::Cells;

/// Samples at the rim of an obstacle that mirror the water beside it.
const RIM: i64 = 4;

/// Rounds in which the heights deeper inside are smoothed.
const ROUNDS: usize = 32;

/// What is known of a sample.
#[derive(Clone, Copy, PartialEq)]
enum Known {
    /// Water, or mirrored from it.
    Fixed,
    /// From the samples around it.
    Spread,
    /// Nothing yet.
    Nothing,
}

/// Heights inside obstacles. Near the rim they mirror the water, so that the slope across the rim stays 0, as it is for waves at a wall.
/// Deeper inside they spread from there and are smoothed. Obstacles without water beside them stay flat.
pub(super) fn inside(heights_m: &mut [f64], inside: &[bool], cells: &Cells) {
    let mut known: Vec<Known> = inside
        .iter()
        .map(|is| if *is { Known::Nothing } else { Known::Fixed })
        .collect();
    let mut front: Vec<usize> = (0..inside.len()).filter(|at| inside[*at]).collect();
    let mirrored: Vec<(usize, f64)> = front
        .iter()
        .filter_map(|at| Some((*at, mirrored_at(*at, heights_m, inside, cells)?)))
        .collect();
    for (at, height_m) in mirrored {
        heights_m[at] = height_m;
        known[at] = Known::Fixed;
    }
    front.retain(|at| known[*at] == Known::Nothing);
    let deep = front.clone();
    while !front.is_empty() {
        let reached: Vec<(usize, f64)> = front
            .iter()
            .filter_map(|at| Some((*at, mean_around(*at, heights_m, &known, cells)?)))
            .collect();
        if reached.is_empty() {
            break;
        }
        for (at, height_m) in reached {
            heights_m[at] = height_m;
            known[at] = Known::Spread;
        }
        front.retain(|at| known[*at] == Known::Nothing);
    }
    for _ in 0..ROUNDS {
        let smoothed: Vec<(usize, f64)> = deep
            .iter()
            .filter(|at| known[**at] == Known::Spread)
            .filter_map(|at| Some((*at, mean_around(*at, heights_m, &known, cells)?)))
            .collect();
        for (at, height_m) in smoothed {
            heights_m[at] = height_m;
        }
    }
}

/// The height of the water at the mirror image of a sample inside an obstacle; none if water is further away than the rim reaches. The
/// rim is half a sample beyond the nearest water, whose height serves if there is no water at the image. Equally near ones are averaged.
fn mirrored_at(at: usize, heights_m: &[f64], inside: &[bool], cells: &Cells) -> Option<f64> {
    let around = || (-RIM..=RIM).flat_map(|dz| (-RIM..=RIM).map(move |dx| [dx, dz]));
    let water = |shift: [i64; 2]| shifted(at, shift, cells).filter(|at| !inside[*at]);
    let square = |[dx, dz]: [i64; 2]| dx * dx + dz * dz;
    let reachable = around().filter(|shift| square(*shift) <= RIM * RIM);
    let nearest = reachable
        .filter(|shift| water(*shift).is_some())
        .map(square)
        .min()?;
    // The image is as far beyond the rim as the sample is before it: one step less than twice as far as the nearest water.
    let share = 2.0 - (nearest as f64).sqrt().recip();
    let images = around()
        .filter(|shift| square(*shift) == nearest)
        .filter_map(|shift| {
            let image = shift.map(|steps| (steps as f64 * share).round() as i64);
            Some(heights_m[water(image).or(water(shift))?])
        });
    let (sum_m, count) = images.fold((0.0, 0), |(sum_m, count), height_m| {
        (sum_m + height_m, count + 1)
    });
    Some(sum_m / f64::from(count))
}

/// The weighted mean of what is known around a sample; none if that is nothing.
fn mean_around(at: usize, heights_m: &[f64], known: &[Known], cells: &Cells) -> Option<f64> {
    let (mut sum_m, mut weights) = (0.0, 0.0);
    for (at, weight) in neighbours(at, cells) {
        if known[at] != Known::Nothing {
            sum_m += weight * heights_m[at];
            weights += weight;
        }
    }
    (weights > 0.0).then(|| sum_m / weights)
}

/// The sample that is some samples away along x and z; none beyond the grid.
fn shifted(at: usize, [dx, dz]: [i64; 2], cells: &Cells) -> Option<usize> {
    let [width, height] = cells.size.map(|count| count as i64);
    let (x, z) = (at as i64 % width + dx, at as i64 / width + dz);
    if cells.wraps {
        return Some((z.rem_euclid(height) * width + x.rem_euclid(width)) as usize);
    }
    let is_on_grid = (0..width).contains(&x) && (0..height).contains(&z);
    is_on_grid.then(|| (z * width + x) as usize)
}

/// The samples around one, with weights: 2 for those beside it, 1 for those at its corners.
fn neighbours(at: usize, cells: &Cells) -> impl Iterator<Item = (usize, f64)> {
    let around = (-1..=1).flat_map(|dz: i64| (-1..=1).map(move |dx: i64| [dx, dz]));
    around
        .filter(|shift| *shift != [0, 0])
        .filter_map(move |shift| {
            let weight = if shift.contains(&0) { 2.0 } else { 1.0 };
            Some((shifted(at, shift, cells)?, weight))
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
