//! The state machine of the device, as everybody sees it.

use crate::render::SelfCheck;
use crate::stats::{AdapterStats, CacheStats};

/// Where the device stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum GpuState {
    /// Being opened for the first time.
    #[default]
    Initializing,
    /// Jobs run.
    Ready,
    /// The device is gone (reason) and is being rebuilt; jobs wait for it.
    Lost(String),
    /// It could not be opened (reason); jobs are refused. Tried again every few seconds, except that the first failure ends
    /// `caustica serve`.
    Failed(String),
}

/// What is known about the device and its thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuStatus {
    /// Where the device stands.
    pub state: GpuState,
    /// The adapter last opened; absent until the first one is.
    pub adapter: Option<AdapterStats>,
    /// What dials are chosen by on that adapter, as a hash; see [`RenderBackend::dial_basis`](super::RenderBackend::dial_basis).
    pub dial_basis: String,
    /// Result of comparing it with float64 physics; absent until it has run on the present device.
    pub self_check: Option<SelfCheck>,
    /// How often a device was lost or given up since the start.
    pub losses: u64,
    /// The level-map cache after the last job: counts since the start, whatever devices were lost, and what is held now.
    pub level_maps: CacheStats,
    /// Typical wall time of a job, s; 0 before the first.
    pub job_s: f64,
}

impl GpuStatus {
    /// Why work should not be sent here now, one sentence each; empty when it may.
    pub fn obstacles(&self) -> Vec<String> {
        let mut obstacles = match &self.state {
            GpuState::Ready => Vec::new(),
            GpuState::Initializing => vec!["the GPU device is being opened".to_owned()],
            GpuState::Lost(why) => vec![format!("the GPU device is being rebuilt: {why}")],
            GpuState::Failed(why) => vec![format!("there is no GPU device: {why}")],
        };
        if let Some(check) = &self.self_check
            && !check.passed
        {
            obstacles.extend(check.checks.iter().filter(|item| !item.passed).map(|item| {
                format!(
                    "the self-check `{}` has error {:e}, at most {:e} is allowed",
                    item.name, item.error, item.tolerance
                )
            }));
            if obstacles.is_empty() {
                obstacles.push("the self-check failed".to_owned());
            }
        }
        obstacles
    }
}
