//! Scene + Plan → Frame.

use tokio_util::sync::CancellationToken;

use crate::config::RenderConfig;
use crate::frame::Frame;
use crate::gpu::GpuError;
use crate::plan::Plan;
use crate::scene::{ResolvedScene, SceneError};
use crate::stats::{AdapterStats, CacheStats};

/// Why there is no frame.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The scene cannot be rendered as it is.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The plan needs more memory than allowed.
    #[error(
        "the scene needs {needed_bytes} bytes of GPU memory at its peak, {budget_bytes} are allowed"
    )]
    OverBudget {
        /// Planned peak.
        needed_bytes: u64,
        /// The limit.
        budget_bytes: u64,
    },
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// Nobody waits for the frame any more.
    #[error("cancelled")]
    Cancelled,
}

/// Result of comparing this machine's GPU with float64 physics.
#[derive(
    Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema,
)]
pub struct SelfCheck {
    /// Whether every check passed.
    pub passed: bool,
    /// One line per check.
    pub checks: Vec<SelfCheckItem>,
}

/// One check.
#[derive(
    Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema,
)]
pub struct SelfCheckItem {
    /// What was compared.
    pub name: String,
    /// Largest error found.
    pub error: f64,
    /// Largest error allowed.
    pub tolerance: f64,
    /// Whether it passed.
    pub passed: bool,
}

/// Owns the GPU context and the caches; lives on the GPU thread.
#[derive(Debug)]
pub struct Renderer {}

impl Renderer {
    /// Opens an adapter by the policy.
    pub fn new(config: &RenderConfig) -> Result<Self, GpuError> {
        let _ = config;
        Err(GpuError::NoAdapter("not built yet".to_owned()))
    }

    /// Where it runs.
    pub fn adapter(&self) -> AdapterStats {
        AdapterStats::default()
    }

    /// What would run, given what is cached now.
    pub fn plan(&self, resolved: &ResolvedScene) -> Result<Plan, RenderError> {
        let _ = resolved;
        Err(RenderError::Cancelled)
    }

    /// Renders; `cancel` is looked at between submissions.
    pub fn render(
        &mut self,
        resolved: &ResolvedScene,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        let _ = (resolved, cancel);
        Err(RenderError::Cancelled)
    }

    /// Compares this machine with float64 physics.
    pub fn self_check(&mut self) -> Result<SelfCheck, GpuError> {
        Ok(SelfCheck::default())
    }

    /// Frees what is cached for a mesh.
    pub fn forget_mesh(&mut self, id: &str) {
        let _ = id;
    }

    /// The level-map cache since the start (hits, misses, evictions) and now (entries, bytes).
    pub fn level_map_cache(&self) -> CacheStats {
        CacheStats::default()
    }
}
