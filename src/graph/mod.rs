//! Passes, the slots that carry data between them, and the planner that picks the passes a frame needs. Generic: nothing here is about
//! water, and nothing calls wgpu.
//!
//! - [`slot`]: what flows between passes: a buffer or textures, with content, unit and size;
//! - [`pass`]: a pass: what it reads and writes, when it is wanted, its steps;
//! - [`scope`]: how often a pass runs in a frame, and the parameters of one run;
//! - [`plan`]: passes + requested slots + available slots → the shortest list of passes, with a reason for each pass that is in or
//!   out, and the memory they take;
//! - [`layout`]: structs that host and shaders share.
//!
//! A program that uses the graph supplies the facts that its passes decide by ([`Program`]).

pub mod layout;
pub mod pass;
pub mod plan;
pub mod scope;
pub mod slot;

pub use layout::Layout;
pub use pass::{Color, Depth, Draw, Groups, PassDesc, Step, View, Work};
pub use plan::{Allocation, PlanError, Planned, PlannedSlot, plan};
pub use scope::{BandRun, BeamSetRun, Program, Run, Scope, Steps, WrongScope};
pub use slot::{Clear, Kind, Origin, SlotDesc, Texture};
