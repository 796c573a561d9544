//! Every setting of the program: command-line flag, environment variable, default.

mod listen;
mod origin;

use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

pub use self::listen::{ListenAddress, ListenHost};
pub use self::origin::CorsOrigin;
use crate::calibration::Calibration;

/// Which adapters may be used.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum AdapterPolicy {
    /// A GPU; without one the program does not start.
    Gpu,
    /// A CPU driver (software Vulkan); without one the program does not start.
    Software,
    /// A GPU if there is one, else a CPU driver. Logs, `/v1/info` and every `stats` name the adapter in use.
    #[default]
    Any,
}

/// Settings of the renderer.
#[derive(Clone, Debug, Args)]
pub struct RenderConfig {
    /// Which adapters may be used.
    #[arg(long, env = "CAUSTICA_ADAPTER", value_enum, default_value_t = AdapterPolicy::Any, global = true)]
    pub adapter: AdapterPolicy,
    /// GPU memory that one frame may hold, MiB. A plan that needs more is refused before anything is allocated.
    #[arg(
        long,
        env = "CAUSTICA_MEMORY_BUDGET_MIB",
        default_value_t = 2048,
        global = true
    )]
    pub memory_budget_mib: u64,
    /// GPU memory for cached level maps, MiB.
    #[arg(
        long,
        env = "CAUSTICA_LEVEL_MAP_BUDGET_MIB",
        default_value_t = 64,
        global = true
    )]
    pub level_map_budget_mib: u64,
    /// GPU memory for kept fields of light, MiB.
    #[arg(
        long,
        env = "CAUSTICA_FIELD_BUDGET_MIB",
        default_value_t = 128,
        global = true
    )]
    pub field_budget_mib: u64,
    /// Folder to which every assembled shader is written.
    #[arg(long, env = "CAUSTICA_SHADER_DUMP", global = true)]
    pub shader_dump: Option<std::path::PathBuf>,
    /// File that `caustica calibrate` wrote on this machine. Without it, predictions are those of software Vulkan on two cores.
    #[arg(long, env = "CAUSTICA_CALIBRATION", value_name = "FILE", value_parser = calibration, global = true)]
    pub calibration: Option<Calibration>,
    /// Folder in which float64 references are kept for studies of accuracy. Without it, `caustica accuracy` uses the user's cache
    /// folder, and a service keeps none.
    #[arg(
        long,
        env = "CAUSTICA_TRUTH_CACHE",
        value_name = "FOLDER",
        global = true
    )]
    pub truth_cache: Option<std::path::PathBuf>,
}

impl RenderConfig {
    /// GPU memory that one frame may hold, bytes.
    pub fn memory_budget_bytes(&self) -> u64 {
        self.memory_budget_mib.saturating_mul(1 << 20)
    }

    /// GPU memory for cached level maps, bytes. A device that cannot bind a buffer of this size gets less.
    pub fn level_map_budget_bytes(&self) -> u64 {
        self.level_map_budget_mib.saturating_mul(1 << 20)
    }

    /// GPU memory for kept fields of light, bytes. A device that cannot bind a buffer of this size gets less.
    pub fn field_budget_bytes(&self) -> u64 {
        self.field_budget_mib.saturating_mul(1 << 20)
    }
}

/// Reads `--calibration`.
fn calibration(text: &str) -> Result<Calibration, String> {
    Calibration::load(std::path::Path::new(text)).map_err(|error| error.to_string())
}

impl Default for RenderConfig {
    fn default() -> Self {
        Self {
            adapter: AdapterPolicy::Any,
            memory_budget_mib: 2048,
            level_map_budget_mib: 64,
            field_budget_mib: 128,
            shader_dump: None,
            calibration: None,
            truth_cache: None,
        }
    }
}

/// Limits of a request; published in `/v1/info`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Args, Serialize, Deserialize, ToSchema)]
pub struct Limits {
    /// Largest request body, bytes.
    #[arg(
        long,
        env = "CAUSTICA_MAX_BODY_BYTES",
        default_value_t = 67_108_864,
        global = true
    )]
    pub max_body_bytes: usize,
    /// Largest picture or map, pixels (width × height).
    #[arg(
        long,
        env = "CAUSTICA_MAX_PIXELS",
        default_value_t = 33_554_432,
        global = true
    )]
    pub max_pixels: u64,
    /// Most triangles of one mesh.
    #[arg(
        long,
        env = "CAUSTICA_MAX_TRIANGLES",
        default_value_t = 1_000_000,
        global = true
    )]
    pub max_triangles: usize,
    /// Most objects in a scene.
    #[arg(
        long,
        env = "CAUSTICA_MAX_OBJECTS",
        default_value_t = 256,
        global = true
    )]
    pub max_objects: usize,
    /// Most lights in a scene.
    #[arg(long, env = "CAUSTICA_MAX_LIGHTS", default_value_t = 64, global = true)]
    pub max_lights: usize,
    /// Most wave components in a scene.
    #[arg(long, env = "CAUSTICA_MAX_WAVES", default_value_t = 256, global = true)]
    pub max_waves: usize,
    /// Host memory for uploaded meshes, bytes. An upload that would exceed it is refused.
    #[arg(
        long,
        env = "CAUSTICA_MESH_STORE_BYTES",
        default_value_t = 1_073_741_824,
        global = true
    )]
    pub mesh_store_bytes: u64,
    /// Host memory for uploaded assets (files of heights), bytes. An upload that would exceed it is refused.
    #[arg(
        long,
        env = "CAUSTICA_ASSET_STORE_BYTES",
        default_value_t = 1_073_741_824,
        global = true
    )]
    pub asset_store_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_body_bytes: 67_108_864,
            max_pixels: 33_554_432,
            max_triangles: 1_000_000,
            max_objects: 256,
            max_lights: 64,
            max_waves: 256,
            mesh_store_bytes: 1_073_741_824,
            asset_store_bytes: 1_073_741_824,
        }
    }
}

/// Settings of `caustica serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeConfig {
    /// Address to listen on: `127.0.0.1:8080`, `[::1]:8080`, `localhost:8080` (IPv4 is tried first), or `:8080` for all interfaces.
    #[arg(
        long,
        env = "CAUSTICA_LISTEN",
        value_name = "HOST:PORT",
        default_value = "127.0.0.1:8080"
    )]
    pub listen: ListenAddress,
    /// Requests that may wait for the GPU. One more is answered 429.
    #[arg(long, env = "CAUSTICA_QUEUE", default_value_t = 16)]
    pub queue: usize,
    /// Seconds from arrival after which a request is answered 503.
    #[arg(long, env = "CAUSTICA_DEADLINE_S", default_value_t = 120)]
    pub deadline_s: u64,
    /// Seconds that `/readyz` answers 503 on shutdown before connections are refused.
    #[arg(long, env = "CAUSTICA_DRAIN_S", default_value_t = 0)]
    pub drain_s: u64,
    /// Connections open at a time, at least 1. For one more, the connection that has waited longest for a request is closed; if all
    /// have a request, the new one waits. The limit of open files may lower this number; the log says so.
    #[arg(long, env = "CAUSTICA_MAX_CONNECTIONS", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..))]
    pub max_connections: u32,
    /// Seconds after which a connection without a request is closed, and one whose client does not read its answer. The header of a request
    /// has to be complete within this time, and within 30 seconds. Longer than the 60 seconds of common load balancers, so that they never
    /// send a request on a connection that is just being closed.
    #[arg(long, env = "CAUSTICA_IDLE_TIMEOUT_S", default_value_t = 75, value_parser = clap::value_parser!(u64).range(1..=86_400))]
    pub idle_timeout_s: u64,
    /// Origin whose web pages may use the service (CORS), as `http://localhost:3000`, or `*` for all. Repeat it, or separate several
    /// by commas. Without it, browsers let only the service's own pages read its answers.
    #[arg(
        long,
        env = "CAUSTICA_CORS_ORIGIN",
        value_name = "ORIGIN",
        value_delimiter = ','
    )]
    pub cors_origin: Vec<CorsOrigin>,
    /// Log as JSON lines.
    #[arg(long, env = "CAUSTICA_LOG_JSON")]
    pub log_json: bool,
}
