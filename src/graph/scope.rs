//! How often a pass runs in a frame, and the parameters of one run.
//!
//! The type of a pass's steps fixes its scope, so a pass cannot have steps for another scope; requesting such steps is an error.

use std::fmt;

use super::pass::Step;

/// The types that a program supplies.
pub trait Program: Sized + 'static {
    /// The facts that passes decide by.
    type Facts;
    /// Parameters of a run that builds a level map.
    type LevelMap;
}

/// How often a pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// Once, before any light and any level map.
    Frame,
    /// Once per level map that is not cached.
    LevelMap,
    /// Once per beam set, and once more for each beam set that the error estimate traces with fewer cells.
    BeamSet,
    /// Once per beam set, but not for the coarse ones: passes that make the frame's maps, or that only count.
    FineBeamSet,
    /// Once per beam set, but not for the coarse ones, after it is known that the sums of the set did not wrap: passes that add sums to the
    /// frame's maps.
    BeamSetMaps,
    /// Once per coarse beam set. A list with such a pass needs one of scope `Estimate`.
    CoarseBeamSet,
    /// Once, after all fine and coarse beam sets.
    Estimate,
    /// Once per band of the picture (or of a map's texels) and sample of its pixels.
    Band,
    /// Once per band, sample and beam set.
    BandBeamSet,
}

impl Scope {
    /// Scopes run in this order; passes of scopes with the same number run in the order of the list.
    pub(super) fn order(self) -> u32 {
        match self {
            Self::Frame => 0,
            Self::LevelMap => 1,
            Self::BeamSet | Self::FineBeamSet => 2,
            Self::BeamSetMaps => 3,
            Self::CoarseBeamSet => 4,
            Self::Estimate => 5,
            Self::Band | Self::BandBeamSet => 6,
        }
    }
}

/// Which beam set a run traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BeamSetRun {
    /// Its number.
    pub index: usize,
    /// Whether flux is summed in 64 bits; used where 32-bit sums would be too coarse or have wrapped.
    pub wide_sums: bool,
}

/// Which rows of the picture a run renders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandRun {
    /// First row.
    pub first_row: u32,
    /// Number of rows.
    pub rows: u32,
    /// Offset of the rays from the pixel's centre, pixels.
    pub offset: [f64; 2],
    /// Number of samples and legs that the picture already holds.
    pub sample_index: u32,
    /// The way that rays take where they split: a bit for each time.
    pub leg: u32,
}

/// One run of a pass.
#[derive(Debug)]
pub enum Run<'a, P: Program> {
    /// See [`Scope::Frame`].
    Frame,
    /// See [`Scope::LevelMap`].
    LevelMap(&'a P::LevelMap),
    /// See [`Scope::BeamSet`], [`Scope::FineBeamSet`] and [`Scope::BeamSetMaps`].
    BeamSet(BeamSetRun),
    /// See [`Scope::CoarseBeamSet`]: the coarse set, and the facts whose maps it is compared with.
    CoarseBeamSet(BeamSetRun, &'a P::Facts),
    /// See [`Scope::Estimate`].
    Estimate,
    /// See [`Scope::Band`].
    Band(BandRun),
    /// See [`Scope::BandBeamSet`].
    BandBeamSet(BandRun, BeamSetRun),
}

impl<P: Program> Clone for Run<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Program> Copy for Run<'_, P> {}

impl<P: Program> Run<'_, P> {
    /// Whether the run traces a beam set with 64-bit flux sums.
    pub fn has_wide_sums(&self) -> bool {
        match self {
            Self::BeamSet(set) | Self::CoarseBeamSet(set, _) | Self::BandBeamSet(_, set) => {
                set.wide_sums
            }
            Self::Frame | Self::LevelMap(_) | Self::Estimate | Self::Band(_) => false,
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Frame => "a frame",
            Self::LevelMap(_) => "a level map",
            Self::BeamSet(_) => "a beam set",
            Self::CoarseBeamSet(..) => "a coarse beam set",
            Self::Estimate => "the estimate",
            Self::Band(_) => "a band",
            Self::BandBeamSet(..) => "a band and beam set",
        }
    }
}

/// The steps of a coarse beam set.
pub type CoarseSteps<P> =
    fn(&<P as Program>::Facts, BeamSetRun, &<P as Program>::Facts) -> Vec<Step<P>>;

/// The steps of one run, by scope.
pub enum Steps<P: Program> {
    /// See [`Scope::Frame`].
    Frame(fn(&P::Facts) -> Vec<Step<P>>),
    /// See [`Scope::LevelMap`].
    LevelMap(fn(&P::Facts, &P::LevelMap) -> Vec<Step<P>>),
    /// See [`Scope::BeamSet`].
    BeamSet(fn(&P::Facts, BeamSetRun) -> Vec<Step<P>>),
    /// See [`Scope::FineBeamSet`].
    FineBeamSet(fn(&P::Facts, BeamSetRun) -> Vec<Step<P>>),
    /// See [`Scope::BeamSetMaps`].
    BeamSetMaps(fn(&P::Facts, BeamSetRun) -> Vec<Step<P>>),
    /// See [`Scope::CoarseBeamSet`]: the coarse facts, the set, and the facts whose maps it is compared with.
    CoarseBeamSet(CoarseSteps<P>),
    /// See [`Scope::Estimate`].
    Estimate(fn(&P::Facts) -> Vec<Step<P>>),
    /// See [`Scope::Band`].
    Band(fn(&P::Facts, BandRun) -> Vec<Step<P>>),
    /// See [`Scope::BandBeamSet`].
    BandBeamSet(fn(&P::Facts, BandRun, BeamSetRun) -> Vec<Step<P>>),
}

/// Steps of another scope than the pass's own were requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongScope {
    /// The pass's scope.
    pub scope: Scope,
    /// The run that was requested.
    pub run: &'static str,
}

impl fmt::Display for WrongScope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "its scope is {:?}, but it was run for {}",
            self.scope, self.run
        )
    }
}

impl std::error::Error for WrongScope {}

impl<P: Program> Steps<P> {
    /// The scope.
    pub fn scope(&self) -> Scope {
        match self {
            Self::Frame(_) => Scope::Frame,
            Self::LevelMap(_) => Scope::LevelMap,
            Self::BeamSet(_) => Scope::BeamSet,
            Self::FineBeamSet(_) => Scope::FineBeamSet,
            Self::BeamSetMaps(_) => Scope::BeamSetMaps,
            Self::CoarseBeamSet(_) => Scope::CoarseBeamSet,
            Self::Estimate(_) => Scope::Estimate,
            Self::Band(_) => Scope::Band,
            Self::BandBeamSet(_) => Scope::BandBeamSet,
        }
    }

    /// The steps of a run.
    ///
    /// # Errors
    /// When the run is of another scope.
    pub fn of(&self, facts: &P::Facts, run: Run<'_, P>) -> Result<Vec<Step<P>>, WrongScope> {
        match (self, run) {
            (Self::Frame(steps), Run::Frame) | (Self::Estimate(steps), Run::Estimate) => {
                Ok(steps(facts))
            }
            (Self::LevelMap(steps), Run::LevelMap(map)) => Ok(steps(facts, map)),
            (
                Self::BeamSet(steps) | Self::FineBeamSet(steps) | Self::BeamSetMaps(steps),
                Run::BeamSet(set),
            ) => Ok(steps(facts, set)),
            (Self::CoarseBeamSet(steps), Run::CoarseBeamSet(set, fine)) => {
                Ok(steps(facts, set, fine))
            }
            (Self::Band(steps), Run::Band(band)) => Ok(steps(facts, band)),
            (Self::BandBeamSet(steps), Run::BandBeamSet(band, set)) => Ok(steps(facts, band, set)),
            _ => Err(WrongScope {
                scope: self.scope(),
                run: run.name(),
            }),
        }
    }
}
