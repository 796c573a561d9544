//! What the GPU thread owns.

use std::sync::Arc;

use tokio_util::sync::CancellationToken;

use crate::cache::{WarmUp, WarmedMap};
use crate::frame::Frame;
use crate::gpu::GpuError;
use crate::mesh::Mesh;
use crate::plan::Plan;
use crate::render::{Prepared, RenderError, Renderer, SelfCheck};
use crate::stats::{AdapterStats, CacheStats};

/// The renderer as the queue sees it. It is built on the GPU thread and never leaves it, so it need not be `Send`.
pub trait RenderBackend {
    /// Where it runs.
    fn adapter(&self) -> AdapterStats;

    /// Hash of all that decides, besides the scene and the adapter, which dials are chosen where `quality` asks for an error or a time.
    fn dial_basis(&self) -> String;

    /// What would run, given what is cached now; looks at the scene where dials are to be chosen.
    fn plan(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError>;

    /// Renders; `cancel` is looked at between submissions.
    fn render(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError>;

    /// Builds level maps of a mesh for frames to come, and says of each sun what is ready.
    fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError>;

    /// Compares this machine with float64 physics.
    fn self_check(&mut self) -> Result<SelfCheck, GpuError>;

    /// Frees what is cached for a mesh.
    fn forget_mesh(&mut self, id: &str);

    /// The level-map cache since the start (hits, misses, evictions) and now (entries, bytes).
    fn level_map_cache(&self) -> CacheStats;

    /// Called about once a second while there is nothing to do. An error of a lost device makes the queue rebuild the backend
    /// before the next request pays for it.
    fn idle(&mut self) -> Result<(), GpuError> {
        Ok(())
    }
}

impl RenderBackend for Renderer {
    fn adapter(&self) -> AdapterStats {
        Renderer::adapter(self)
    }

    fn dial_basis(&self) -> String {
        Renderer::dial_basis(self)
    }

    fn plan(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError> {
        self.plan_prepared(prepared, cancel)
    }

    fn render(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        self.render_prepared(prepared, cancel)
    }

    fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError> {
        Renderer::warm(self, mesh, wanted, cancel)
    }

    fn self_check(&mut self) -> Result<SelfCheck, GpuError> {
        Renderer::self_check(self)
    }

    fn forget_mesh(&mut self, id: &str) {
        Renderer::forget_mesh(self, id);
    }

    fn level_map_cache(&self) -> CacheStats {
        Renderer::level_map_cache(self)
    }

    fn idle(&mut self) -> Result<(), GpuError> {
        Renderer::idle(self)
    }
}
