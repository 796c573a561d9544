//! When the reference stops tracing, and why a scene cannot be traced.

use std::path::PathBuf;

use crate::scene::SceneError;

/// When tracing stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceSettings {
    /// Relative L1 error at which tracing stops, above 0; `None`: spend all of `max_rays` at once.
    pub target_error: Option<f64>,
    /// Most rays of a round, both halves and all lights together, 1 …
    pub max_rays: u64,
    /// Rays of the first round, 1 …
    pub initial_rays: u64,
}

impl Default for ReferenceSettings {
    fn default() -> Self {
        Self {
            target_error: Some(2e-3),
            max_rays: 4_000_000_000,
            initial_rays: 1 << 23,
        }
    }
}

impl ReferenceSettings {
    pub(super) fn check(&self) -> Result<(), ReferenceError> {
        if self.max_rays == 0 || self.initial_rays == 0 {
            return Err(ReferenceError::Settings(format!(
                "max_rays is {} and initial_rays is {}; both must be 1 or more",
                self.max_rays, self.initial_rays
            )));
        }
        match self.target_error {
            Some(target) if target.is_nan() || target <= 0.0 => Err(ReferenceError::Settings(
                format!("target_error is {target}; it must be above 0, or absent"),
            )),
            _ => Ok(()),
        }
    }
}

/// When the search for a [`super::Truth`] stops, and where it is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthSettings {
    /// Relative L1 error at which the search stops, above 0; `None`: spend `max_rays`.
    pub target_error: Option<f64>,
    /// Most rays of a round, both halves and all lights together, 1 …
    pub max_rays: u64,
    /// Most pixels of a view that are traced, 1 …; maps are always complete.
    pub most_points: u32,
    /// Folder that keeps truths from one run to the next; created if it does not exist. `None`: nothing is kept.
    pub disk: Option<PathBuf>,
}

impl Default for TruthSettings {
    fn default() -> Self {
        Self {
            target_error: Some(5e-3),
            max_rays: 4_000_000_000,
            most_points: 6000,
            disk: None,
        }
    }
}

impl TruthSettings {
    /// The settings of the tracing functions.
    pub(super) fn counting(&self) -> ReferenceSettings {
        ReferenceSettings {
            target_error: self.target_error,
            max_rays: self.max_rays,
            initial_rays: 1 << 20,
        }
    }

    pub(super) fn check(&self) -> Result<(), ReferenceError> {
        self.counting().check()?;
        if self.most_points == 0 {
            return Err(ReferenceError::Settings(
                "most_points is 0; it must be 1 or more".to_owned(),
            ));
        }
        Ok(())
    }
}

/// Why there is no reference map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// The output is a view, or a map on a mesh.
    #[error(
        "the reference counts light on the floor only: output.kind must be \"irradiance_map\" and output.receiver \"floor\""
    )]
    NotAFloorMap,
    /// The output is a map of the water.
    #[error(
        "the output is a map of the water, which has no light that could be compared; output.kind \"view\" or \"irradiance_map\" is accepted"
    )]
    WaterMap,
    /// There is no receiver.
    #[error("the scene has no floor; the reference needs one")]
    NoFloor,
    /// The map has no area, no texels, or corners that are not finite.
    #[error(
        "the map from {min_m:?} to {max_m:?} m with {width} × {height} texels is empty; max must be above min and there must be a texel"
    )]
    EmptyMap {
        /// Lower corner (x, z), m.
        min_m: [f64; 2],
        /// Upper corner (x, z), m.
        max_m: [f64; 2],
        /// Texels along x.
        width: u32,
        /// Texels along z.
        height: u32,
    },
    /// `output.light` names neither a sun nor a point light.
    #[error(
        "output.light is {index}, which is no sun and no point light; the scene has {lights} lights, counted from 0"
    )]
    NotASun {
        /// What was asked for.
        index: u32,
        /// Length of `lights`.
        lights: usize,
    },
    /// Skies are not traced.
    #[error("the reference counts suns and point lights only; output.include_sky must be false")]
    IncludesSky,
    /// The list of meshes does not fit the list of objects.
    #[error("the scene has {objects} objects but {meshes} meshes were given")]
    Meshes {
        /// Length of `objects`.
        objects: usize,
        /// Length of the mesh list.
        meshes: usize,
    },
    /// A value of the scene is not finite or out of range.
    #[error("{what} is {value}; {accepted}")]
    Figure {
        /// Which one.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What would be accepted.
        accepted: &'static str,
    },
    /// A view without a camera.
    #[error("the output is a view and the scene has no camera; the reference needs one")]
    NoCamera,
    /// A map on an object that is not there.
    #[error("output.receiver is object {index}; the scene has {objects} objects, counted from 0")]
    NoObject {
        /// What was asked for.
        index: u32,
        /// Length of `objects`.
        objects: usize,
    },
    /// The water of the scene cannot be computed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The caller cancelled.
    #[error("cancelled before the reference was good enough")]
    Cancelled,
    /// The settings make no sense.
    #[error("reference settings: {0}")]
    Settings(String),
}
