//! Plan.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::stats::{AbsentPass, Warning};

/// The shortest list of passes that makes what a scene asks for, and why.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Plan {
    /// Passes in the order they run.
    pub passes: Vec<PlannedPass>,
    /// Passes that are not needed, and why.
    pub absent: Vec<AbsentPass>,
    /// What flows between the passes.
    pub slots: Vec<PlannedSlot>,
    /// Most bytes held on the GPU at once, level maps included.
    pub peak_bytes: u64,
    /// What the plan leaves out or sub-samples.
    pub warnings: Vec<Warning>,
}

/// A pass that will run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlannedPass {
    /// Pass name.
    pub name: String,
    /// Why it is in.
    pub reason: String,
    /// How often it runs.
    pub runs: u32,
}

/// A slot that will be held.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlannedSlot {
    /// Slot name.
    pub name: String,
    /// Size, bytes.
    pub bytes: u64,
    /// What one element holds, with its unit.
    pub holds: String,
}
