//! The service: HTTP in front of the GPU queue.
//!
//! * [`router`]: every route and layer;
//! * [`routes`]: one resource per file;
//! * [`state`]: what the routes share;
//! * [`error`]: all errors with their status codes; [`problem`]: the problem documents they are answered with;
//! * [`extract`]: request bodies; [`decode`]: their encodings; [`warm`]: the query of an upload; [`accept`]: content negotiation;
//! * [`cors`]: pages of other origins;
//! * [`observe`]: arrival, deadline, request log and request metrics, around every route; [`metrics`]: the Prometheus side;
//! * [`openapi`]: the contract, generated from the routes;
//! * [`server`]: the listening process, from start to graceful shutdown; [`connections`]: their number, and how long one may do
//!   nothing; [`log`]: what turns events into lines of the log.
//!
//! To add a route: a handler with `#[utoipa::path]` in a file under `routes`, a line in [`router`], its problems in
//! [`problem`], and `BLESS=1 cargo test --test http contract` to write `openapi.yaml`.

pub mod accept;
pub mod connections;
pub mod cors;
pub mod decode;
pub mod error;
pub mod extract;
mod listen;
pub mod log;
pub mod metrics;
pub mod observe;
mod open_files;
pub mod openapi;
pub mod problem;
pub mod router;
pub mod routes;
pub mod server;
pub mod state;
pub mod warm;

pub use connections::ConnectionLimits;
pub use error::{ApiError, ProblemKind};
pub use openapi::openapi;
pub use problem::Problem;
pub use router::{app, layered};
pub use server::{ServeError, serve, serve_on, serve_with};
pub use state::AppState;
