//! A hard case and its outcome.

use serde::{Deserialize, Serialize};

use super::bench::Bench;
use crate::frame::Frame;
use crate::render::RenderError;
use crate::scene::SceneError;

/// What a case is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Suns at and below the horizon, along slopes, dim and bright.
    Light,
    /// Flat, tiny and steep waves, depths, indices, times, absorption.
    Water,
    /// Seas, basins and given heights at the ends of their ranges.
    Sea,
    /// The same scene in another place, smaller and larger.
    Place,
    /// Broken, thin, tiny, huge and awkwardly placed meshes.
    Mesh,
    /// Footprints that fold, collapse and spread.
    Fold,
    /// Kept fields of light.
    Field,
    /// Awkward cameras and sizes of pictures.
    Camera,
    /// A device that is lost, runs out of memory, is cancelled, or is used for days.
    Machine,
}

impl Family {
    /// All families, in the order of the suite.
    pub const ALL: [Self; 9] = [
        Self::Light,
        Self::Water,
        Self::Sea,
        Self::Place,
        Self::Mesh,
        Self::Fold,
        Self::Field,
        Self::Camera,
        Self::Machine,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Water => "water",
            Self::Sea => "sea",
            Self::Place => "place",
            Self::Mesh => "mesh",
            Self::Fold => "fold",
            Self::Field => "field",
            Self::Camera => "camera",
            Self::Machine => "machine",
        }
    }

    /// A case of this family.
    pub(super) const fn case(
        self,
        name: &'static str,
        breaks: &'static str,
        check: &'static str,
        bound: f64,
        run: fn(&mut Bench<'_>) -> Result<f64, Failure>,
    ) -> Case {
        Case {
            name,
            family: self,
            breaks,
            check,
            bound,
            run,
            known_failure: None,
        }
    }
}

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name: words joined by `_`.
    pub name: &'static str,
    /// What it is about.
    pub family: Family,
    /// What could break.
    pub breaks: &'static str,
    /// How it would show: what the figure measures.
    pub check: &'static str,
    /// Largest allowed figure.
    pub bound: f64,
    /// Renders, and returns the figure.
    pub run: fn(&mut Bench<'_>) -> Result<f64, Failure>,
    /// Why it is known to fail, if it is. Then it must fail.
    pub known_failure: Option<&'static str>,
}

impl Case {
    /// This case, marked as known to fail.
    pub(super) const fn known_to_fail(mut self, why: &'static str) -> Self {
        self.known_failure = Some(why);
        self
    }
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The scene was refused.
    #[error("refused: {0}")]
    Scene(#[from] SceneError),
    /// There is no frame.
    #[error("not rendered: {0}")]
    Render(#[from] RenderError),
    /// A check that holds for every picture failed.
    #[error("{0}")]
    Check(String),
}

/// The result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds.
    Holds,
    /// It fails.
    Fails,
    /// It fails, as known.
    FailsAsKnown,
    /// It is marked as known to fail but holds: the mark is out of date.
    HoldsAfterAll,
}

impl Verdict {
    /// Whether this result is as expected.
    pub fn is_expected(self) -> bool {
        matches!(self, Self::Holds | Self::FailsAsKnown)
    }
}

/// The outcome of a case.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: &'static Case,
    /// Its result.
    pub verdict: Verdict,
    /// Its figure.
    pub figure: Option<f64>,
    /// What went wrong, in a sentence.
    pub failure: Option<String>,
    /// Largest closure of the energy accounts of its pictures.
    pub closure: f64,
    /// Codes of the warnings of its pictures, and the affected flux where it was measured, W.
    pub warnings: Vec<(String, Option<f64>)>,
    /// The last picture, for the page.
    pub picture: Option<Frame>,
}
