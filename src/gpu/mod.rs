//! GPU.

/// What can go wrong on the GPU.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No adapter matches the policy.
    #[error("no adapter: {0}")]
    NoAdapter(String),
    /// The device was lost.
    #[error("the GPU device was lost: {0}")]
    DeviceLost(String),
    /// An allocation failed.
    #[error("out of GPU memory: {0}")]
    OutOfMemory(String),
    /// The driver or wgpu refused a call: a defect of ours.
    #[error("GPU validation error: {0}")]
    Validation(String),
    /// The GPU did not answer in time.
    #[error("the GPU did not answer within {0} s")]
    Timeout(u64),
}
