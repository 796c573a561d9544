//! From water to irradiance by the eikonal equation: band, sides, times, curvature, dissipation, power law.
//!
//! Source: Mercier, §3.

use glam::DVec2;

use super::{
    Arrivals, Concentration, Curvature, Dissipation, Frame, Front, FrontError, Grid, Height, Order,
    PowerLaw, Problem, concentration, lost_shares, march, polish, sweep, with_sides,
};

/// Cells of the narrow band on each side of the water. Second order needs two.
const BAND_CELLS: f64 = 2.0;

/// How the times are found. Both give the same times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Fast marching with a heap, as the paper: one thread.
    Heap,
    /// Rounds over slices, on all threads.
    Sweep,
}

/// Settings of an eikonal field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EikonalSettings {
    /// Order of the differences; the paper's is the first.
    pub order: Order,
    /// How the times are found.
    pub solver: Solver,
    /// Whether times of second order are polished; the paper's are not.
    pub polished: bool,
    /// Curvature that makes the brightness; the paper's is the Laplacian.
    pub curvature: Curvature,
    /// Spreading below a threshold depth.
    pub dissipation: Option<Dissipation>,
    /// Power law from concentration to irradiance. Its factor has no effect, since flux is kept.
    pub law: PowerLaw,
}

impl Default for EikonalSettings {
    fn default() -> Self {
        Self {
            order: Order::Second,
            solver: Solver::Sweep,
            polished: true,
            curvature: Curvature::Principal,
            dissipation: None,
            law: PowerLaw::NONE,
        }
    }
}

/// An eikonal field, with what it lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct EikonalField {
    /// Irradiance relative to its mean over a slice: x fastest, then z, then depth; 0 in slices that lie in the air.
    pub relative: Vec<f32>,
    /// By slice: share of the light that other fronts have overtaken, so that the field does not show it.
    pub lost: Vec<f64>,
    /// Share of the cells with a negative concentration, set to 0.
    pub raised: f64,
    /// Of the light below the threshold: how much the dissipation added because waves went below 0.
    pub raised_by_dissipation: f64,
    /// Cells of the narrow band whose time is not exact to rounding.
    pub unsettled: usize,
    /// Whether the times came to rest. Polished times may not where fronts meet at large angles; then they still change by small shares
    /// of a cell.
    pub settled: bool,
}

impl EikonalSettings {
    /// Bytes of the largest arrays that [`EikonalSettings::run`] holds at the same time.
    pub fn bytes(&self, grid: &Grid) -> u64 {
        let cells = grid.cells() as u64;
        let slice = grid.slice() as u64;
        let times = Arrivals::bytes(grid);
        let work = match self.solver {
            // Trial times; the heap holds a few entries per cell of the front.
            Solver::Heap => times + 64 * slice,
            Solver::Sweep => times / 8 + 8 * slice,
        };
        let column = size_of::<super::Column>() as u64;
        let start = size_of::<super::Start>() as u64;
        let band = slice * (column + 2 * start * (4.0 * BAND_CELLS) as u64);
        times + work.max(4 * cells) + band
    }

    /// The field of `water` in a grid of model coordinates.
    ///
    /// # Errors
    /// Water that is not finite or stands above the grid; a dissipation out of range.
    pub fn run<F>(&self, grid: &Grid, frame: &Frame, water: &F) -> Result<EikonalField, FrontError>
    where
        F: Fn(DVec2) -> Height + Sync,
    {
        let front = Front::of(grid, frame, water, BAND_CELLS)?;
        let starts = with_sides(grid, &front, self.order);
        let problem = Problem::below(grid, &front, &starts, self.order);
        let (mut arrivals, mut settled) = match self.solver {
            Solver::Heap => (march(&problem), true),
            Solver::Sweep => {
                let (arrivals, report) = sweep(&problem);
                (arrivals, report.settled)
            }
        };
        if self.polished && self.order == Order::Second {
            settled &= polish(&problem, &mut arrivals).settled;
        }
        let lost = lost_shares(&arrivals, &front);
        let Concentration {
            values: mut relative,
            raised,
            ..
        } = concentration(&arrivals, frame, self.curvature);
        drop(arrivals);
        let mut raised_by_dissipation = 0.0;
        if let Some(dissipation) = &self.dissipation {
            raised_by_dissipation = dissipation.apply(grid, &mut relative)?.raised;
        }
        self.law.keep_flux(&mut relative, grid.slice(), 1.0);
        Ok(EikonalField {
            relative,
            lost,
            raised,
            raised_by_dissipation,
            unsettled: front.unsettled,
            settled,
        })
    }
}
