//! What a pass is, what flows between passes, and which of them a frame needs. Generic: it knows nothing of water, and calls nothing
//! of wgpu.
//!
//! - [`slot`]: what flows between passes: a buffer or textures, with what it holds and how large it is;
//! - [`pass`]: a pass: what it reads and writes, when it is wanted, its steps;
//! - [`scope`]: how often a pass runs in a frame, and what one of its runs is told;
//! - [`plan`]: passes + what is awaited + what is there already → the shortest list of passes, with a reason for each that is in or
//!   out, and the memory they take;
//! - [`layout`]: structs that host and shaders share.
//!
//! A program that uses the graph says what its passes decide by ([`Program`]).

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
