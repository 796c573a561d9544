//! How often a pass runs in a frame, and what one of its runs is told.
//!
//! The type of a pass's steps says its scope, so that steps for another scope cannot be written; asking for them is an error.

use std::fmt;

use super::pass::Step;

/// What a program brings along.
pub trait Program: Sized + 'static {
    /// The figures that passes decide by.
    type Facts;
    /// What a run of a pass that builds a level map is told.
    type LevelMap;
}

/// How often a pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// Once, before any light.
    Frame,
    /// Once per level map that is not kept from before.
    LevelMap,
    /// Once per beam set, and once more for each that the estimate of the error follows coarsely.
    BeamSet,
    /// Once per beam set, but not for those that are followed coarsely: what makes the frame's maps, or only counts.
    FineBeamSet,
    /// Once per beam set that is followed coarsely.
    CoarseBeamSet,
    /// Once, when all beam sets are done, finely and coarsely.
    Estimate,
    /// Once per band of the picture (or of a map's texels) and round of its rays.
    Band,
    /// Once per band, round and beam set.
    BandBeamSet,
}

/// Which beam set a run follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BeamSetRun {
    /// Its number.
    pub index: usize,
    /// With 64-bit flux sums, after narrow ones have wrapped.
    pub wide_sums: bool,
}

/// Which rows of the picture a run makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandRun {
    /// First row.
    pub first_row: u32,
    /// Number of rows.
    pub rows: u32,
    /// Where in the pixel the rays go: away from its middle, in pixels.
    pub offset: [f64; 2],
    /// Samples that the picture already holds.
    pub sample_index: u32,
}

/// One run of a pass.
#[derive(Debug)]
pub enum Run<'a, P: Program> {
    /// See [`Scope::Frame`].
    Frame,
    /// See [`Scope::LevelMap`].
    LevelMap(&'a P::LevelMap),
    /// See [`Scope::BeamSet`] and [`Scope::FineBeamSet`].
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
    /// Whether a beam set with 64-bit flux sums is followed.
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
            Self::CoarseBeamSet(..) => "a beam set that is followed coarsely",
            Self::Estimate => "the estimate",
            Self::Band(_) => "a band",
            Self::BandBeamSet(..) => "a band and beam set",
        }
    }
}

/// The steps of a beam set that is followed coarsely.
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
    /// See [`Scope::CoarseBeamSet`]: the coarse facts, the set, and the facts whose maps it is compared with.
    CoarseBeamSet(CoarseSteps<P>),
    /// See [`Scope::Estimate`].
    Estimate(fn(&P::Facts) -> Vec<Step<P>>),
    /// See [`Scope::Band`].
    Band(fn(&P::Facts, BandRun) -> Vec<Step<P>>),
    /// See [`Scope::BandBeamSet`].
    BandBeamSet(fn(&P::Facts, BandRun, BeamSetRun) -> Vec<Step<P>>),
}

/// A pass was asked for steps of another scope than its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongScope {
    /// The pass's scope.
    pub scope: Scope,
    /// What was to be run.
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
            (Self::BeamSet(steps) | Self::FineBeamSet(steps), Run::BeamSet(set)) => {
                Ok(steps(facts, set))
            }
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
