//! The state of the device, as published to all.

use crate::render::SelfCheck;
use crate::stats::{AdapterStats, CacheStats};

/// The state of the device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum GpuState {
    /// Being opened for the first time.
    #[default]
    Initializing,
    /// Jobs run.
    Ready,
    /// The device is lost (reason) and is being rebuilt; jobs wait for it.
    Lost(String),
    /// The device could not be opened (reason); jobs are refused. Opening is retried every few seconds, but the first failure
    /// ends `caustica serve`.
    Failed(String),
}

/// What is known about the device and its thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuStatus {
    /// The state of the device.
    pub state: GpuState,
    /// The adapter opened last; absent before the first.
    pub adapter: Option<AdapterStats>,
    /// Hash of what determines the chosen dials on that adapter; see
    /// [`RenderBackend::dial_basis`](super::RenderBackend::dial_basis).
    pub dial_basis: String,
    /// Result of the self-check (GPU against float64 physics); absent until it has run on the present device.
    pub self_check: Option<SelfCheck>,
    /// Number of devices lost or given up since the start.
    pub losses: u64,
    /// The level-map cache after the last job: counts since the start, over all devices, and what it holds now.
    pub level_maps: CacheStats,
    /// The kept fields of light, likewise.
    pub fields: CacheStats,
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
