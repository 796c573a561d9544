//! The GPU: one context, assembled and reflected shaders, pooled buffers, timing, readback. Nothing here is about water.

pub mod bind_groups;
pub mod context;
pub mod kernel;
pub mod kernels;
pub mod pieces;
pub mod pool;
pub mod readback;
pub mod shader;
pub mod timing;
pub mod uniforms;

pub use bind_groups::{BindGroups, Binding};
pub use context::GpuContext;
pub use kernel::{Kernel, RasterKernel};
pub use kernels::KernelCache;
pub use pool::BufferPool;

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
    /// A shader does not assemble or does not match its pass: a defect of ours.
    #[error("shader `{shader}`: {message}")]
    Shader {
        /// File name below `shaders/`.
        shader: String,
        /// What is wrong with it.
        message: String,
    },
    /// The GPU did not answer in time.
    #[error("the GPU did not answer within {0} s")]
    Timeout(u64),
}
