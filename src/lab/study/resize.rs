//! Resizes maps to fit a tile: small ones are enlarged by whole factors, so that each texel stays a square; large ones are averaged by
//! whole factors.

/// How a map becomes a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    /// Each value becomes a square of pixels; the number along a side.
    Grow(usize),
    /// Each square of values becomes a pixel; the number along a side. Squares at the far edges have fewer values.
    Shrink(usize),
}

impl Fit {
    /// For a map of that size and tiles of at most `most` pixels a side.
    pub(super) fn new(width: usize, height: usize, most: usize) -> Self {
        let side = width.max(height).max(1);
        if side <= most {
            Self::Grow(most / side)
        } else {
            Self::Shrink(side.div_ceil(most))
        }
    }

    /// Size of the tile along one side.
    pub(super) fn size(self, side: usize) -> usize {
        match self {
            Self::Grow(factor) => side * factor,
            Self::Shrink(factor) => side.div_ceil(factor),
        }
    }

    /// The values of the tile, row by row.
    pub(super) fn apply<const N: usize>(
        self,
        values: &[[f64; N]],
        width: usize,
        height: usize,
    ) -> Vec<[f64; N]> {
        let mut out = Vec::with_capacity(self.size(width) * self.size(height));
        for y in 0..self.size(height) {
            for x in 0..self.size(width) {
                out.push(match self {
                    Self::Grow(factor) => values[y / factor * width + x / factor],
                    Self::Shrink(factor) => mean(values, width, height, (x, y), factor),
                });
            }
        }
        out
    }
}

fn mean<const N: usize>(
    values: &[[f64; N]],
    width: usize,
    height: usize,
    (x, y): (usize, usize),
    factor: usize,
) -> [f64; N] {
    let (mut sum, mut count) = ([0.0; N], 0.0);
    for row in y * factor..((y + 1) * factor).min(height) {
        for column in x * factor..((x + 1) * factor).min(width) {
            for (sum, value) in sum.iter_mut().zip(values[row * width + column]) {
                *sum += value;
            }
            count += 1.0;
        }
    }
    sum.map(|v| v / count)
}
