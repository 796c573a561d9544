//! Is the picture right on this machine?

/// Result of comparing this machine's GPU with float64 physics.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema)]
pub struct SelfCheck {
    /// Whether every check passed.
    pub passed: bool,
    /// One line per check.
    pub checks: Vec<SelfCheckItem>,
}

/// One check.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema)]
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

impl super::Renderer {
    /// Compares this machine with float64 physics.
    pub fn self_check(&mut self) -> Result<SelfCheck, crate::gpu::GpuError> {
        Ok(SelfCheck::default())
    }
}
