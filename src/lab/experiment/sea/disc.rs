//! The sun's disc. Scenes have suns without a size; a sun's disc lights a horizontal floor like the mean of many such suns, and since waves
//! are flat and the disc is small, that is the map of one of them, blurred by the disc's image under flat water.

use super::fluctuation::Grid;
use super::scene::{SEA_IOR, SUN_ELEVATION_DEG};

/// The sun's angular radius, rad: 16 minutes of arc.
const SUN_RADIUS_RAD: f64 = 16.0 / 60.0 * std::f64::consts::PI / 180.0;
/// Points along the side of a texel, to find how much of the disc lies in it.
const POINTS: i32 = 32;

/// The image of a disc on texels: the share of its light in each texel around its middle. The disc has the same radiance all over.
#[derive(Clone, Debug, PartialEq)]
pub struct Disc {
    reach: usize,
    weights: Vec<f64>,
}

impl Disc {
    /// Half axes along x and z of the image of the sun's disc under `depth_m` of flat water, m, for a sun at azimuth 0: it moves as the
    /// refracted ray does when the sun moves along and across its azimuth.
    pub fn half_axes_m(depth_m: f64) -> [f64; 2] {
        let zenith = (90.0 - SUN_ELEVATION_DEG).to_radians();
        let sin_t = zenith.sin() / SEA_IOR;
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        let along = zenith.cos() / (SEA_IOR * cos_t) / (cos_t * cos_t);
        let across = 1.0 / (SEA_IOR * cos_t);
        [along, across].map(|rate| depth_m * SUN_RADIUS_RAD * rate)
    }

    /// The image of the sun's disc at a depth, on texels of `texel_m`.
    pub fn of_sun(depth_m: f64, texel_m: f64) -> Self {
        Self::ellipse(Self::half_axes_m(depth_m).map(|half_m| half_m / texel_m))
    }

    /// An ellipse with these half axes, in texels.
    pub fn ellipse(half: [f64; 2]) -> Self {
        let reach = (half[0].max(half[1]) + 0.5).ceil() as i32 - 1;
        let reach = reach.max(0);
        let inside = |x: f64, z: f64| (x / half[0]).hypot(z / half[1]) <= 1.0;
        let count = |i: i32, j: i32| {
            let place = |cell: i32, k: i32| {
                f64::from(cell) + (f64::from(k) + 0.5) / f64::from(POINTS) - 0.5
            };
            let points = (0..POINTS).flat_map(|b| (0..POINTS).map(move |a| (a, b)));
            let inside = points.filter(|&(a, b)| inside(place(i, a), place(j, b)));
            inside.count() as f64
        };
        let cells = (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j)));
        let counts: Vec<f64> = cells.map(|(i, j)| count(i, j)).collect();
        let all: f64 = counts.iter().sum();
        if all == 0.0 {
            // Smaller than the distance of the points.
            return Self {
                reach: 0,
                weights: vec![1.0],
            };
        }
        Self {
            reach: reach as usize,
            weights: counts.iter().map(|count| count / all).collect(),
        }
    }

    /// Texels that a blurred map loses at each edge.
    pub fn reach(&self) -> usize {
        self.reach
    }

    /// The blurred map, without the texels near its edges whose light is not all known.
    pub fn blurred(&self, map: &Grid) -> Grid {
        let size = 2 * self.reach + 1;
        let [width, height] = [map.width, map.height].map(|side| (side + 1).saturating_sub(size));
        let mut values = Vec::with_capacity(width * height);
        for z in 0..height {
            for x in 0..width {
                let rows = self.weights.chunks_exact(size).enumerate();
                let sum: f64 = rows
                    .map(|(j, weights)| {
                        let row = &map.values[(z + j) * map.width + x..][..size];
                        let products = row.iter().zip(weights);
                        products.map(|(value, weight)| value * weight).sum::<f64>()
                    })
                    .sum();
                values.push(sum);
            }
        }
        Grid {
            width,
            height,
            values,
        }
    }
}
