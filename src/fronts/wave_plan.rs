//! Settings of a wave simulation, and what it needs, known before anything is allocated.

use super::{FrontError, Grid, Start};

/// Layers of cells around the simulated box that hold its edge conditions.
pub(super) const GHOSTS: usize = 1;

/// What starts at the water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pulse {
    /// 1 in every cell that the water passes through, as the paper.
    Cells,
    /// cos² of the distance to the water, 0 from this number of cells on (1 … 6). Aslant through the grid, waves as short as a cell are
    /// slower than light should be and trail behind; a wider pulse has fewer of them.
    Smooth(f64),
}

/// What happens at the four upright sides of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The damping band, as the paper. Less light than from endless water comes in.
    Absorb,
    /// Mirrors: no band, and flat water stays even up to the sides.
    Mirror,
}

/// What is added up in every cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sum {
    /// φ, as the paper.
    Values,
    /// φ², the density of energy.
    Squares,
}

/// Settings of a wave simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveSettings {
    /// Step of time as a share of the time in which light crosses the shortest side of a cell, above 0, at most 1. Longer
    /// steps are unstable; at 1 the shortest waves stay where a segment was cleared; in shorter steps short waves fall behind.
    pub courant: f64,
    /// Cells of the damping band, 4 … 64.
    pub band: usize,
    /// What starts at the water.
    pub pulse: Pulse,
    /// The upright sides.
    pub sides: Sides,
    /// Whether φ below 0 is set to 0 in every step. Keeps the wave together, and is wrong: a remedy of the paper.
    pub clamped: bool,
    /// What is added up.
    pub sum: Sum,
    /// Waves below this height are taken as 0, 10⁻⁷ … 0.1.
    pub silent: f64,
}

impl Default for WaveSettings {
    fn default() -> Self {
        Self {
            courant: 0.99,
            band: 16,
            pulse: Pulse::Smooth(2.0),
            sides: Sides::Absorb,
            clamped: false,
            sum: Sum::Values,
            silent: 0.01,
        }
    }
}

/// What a simulation may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveLimits {
    /// Bytes.
    pub bytes: u64,
    /// Cells × steps.
    pub cell_steps: f64,
}

impl Default for WaveLimits {
    /// 1 GiB, and 5 · 10¹⁰ updates of cells: some minutes of a few cores. 256³ is allowed, 512³ is not.
    fn default() -> Self {
        Self {
            bytes: 1 << 30,
            cell_steps: 5e10,
        }
    }
}

/// What a simulation needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WavePlan {
    /// Cells along x, z and depth with the damping band.
    pub size: [usize; 3],
    /// Cells of the band before the grid's first cell along x, z and depth; as many follow its last.
    pub band: [usize; 3],
    /// Step of time as a path in water, m.
    pub step_m: f64,
    /// The most steps.
    pub steps: usize,
    /// Bytes of the arrays; water that is steep needs a little more while it starts.
    pub bytes: u64,
    /// Cells of the box with the band.
    pub cells: u64,
}

impl WavePlan {
    /// The plan of a simulation that fills `grid`. Nothing is allocated.
    ///
    /// # Errors
    /// Settings out of range; more bytes or work than `limits`.
    pub fn of(
        grid: &Grid,
        settings: &WaveSettings,
        limits: &WaveLimits,
    ) -> Result<Self, FrontError> {
        let refuse = |setting, value, accepted| {
            Err(FrontError::Setting {
                setting,
                value,
                accepted,
            })
        };
        let WaveSettings {
            courant,
            band,
            silent,
            ..
        } = *settings;
        if !(courant > 0.0 && courant <= 1.0) {
            return refuse(
                "courant",
                courant,
                "above 0, at most 1: longer steps are unstable",
            );
        }
        if !(4..=64).contains(&band) {
            return refuse("band", band as f64, "4 to 64 cells");
        }
        if !(1e-7..=0.1).contains(&silent) {
            return refuse("silent", silent, "1e-7 to 0.1");
        }
        let width = match settings.pulse {
            Pulse::Cells => 1.0,
            Pulse::Smooth(cells) if (1.0..=6.0).contains(&cells) => cells,
            Pulse::Smooth(cells) => return refuse("pulse", cells, "1 to 6 cells"),
        };
        let bands = match settings.sides {
            Sides::Absorb => [band; 3],
            Sides::Mirror => [0, 0, band],
        };
        let size: [usize; 3] = std::array::from_fn(|axis| grid.size[axis] + 2 * bands[axis]);
        let cells: u64 = size.iter().map(|n| *n as u64).product();
        let padded: u64 = size.iter().map(|n| (n + 2 * GHOSTS) as u64).product();
        // Two states and the sums, f32; and the cells next to the water, which are found first.
        let columns = (size[0] * size[1]) as u64;
        let starts = columns * (2.0 * width + 2.0) as u64 * size_of::<Start>() as u64;
        let bytes = 4 * (2 * padded + grid.cells() as u64) + 2 * starts;
        let step_m = courant * grid.step_m.min_element();
        // Down to the bottom, aslant, and out of the band.
        let path_m = grid.step_m.z * (1.5 * grid.size[2] as f64 + 2.0 * width + band as f64);
        let steps = (path_m / step_m).ceil() as usize;
        let cell_steps = cells as f64 * steps as f64;
        if bytes > limits.bytes || cell_steps > limits.cell_steps {
            return Err(FrontError::TooLarge {
                bytes,
                cells,
                steps: steps as u64,
                cell_steps,
                most_bytes: limits.bytes,
                most_cell_steps: limits.cell_steps,
            });
        }
        Ok(Self {
            size,
            band: bands,
            step_m,
            steps,
            bytes,
            cells,
        })
    }
}
