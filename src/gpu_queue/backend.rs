//! The renderer that the GPU thread owns, as a trait.

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
    /// The adapter it runs on.
    fn adapter(&self) -> AdapterStats;

    /// Hash of everything except scene and adapter that determines which dials are chosen for a target error or a time budget.
    fn dial_basis(&self) -> String;

    /// Plans with what is cached now; makes trial renders if dials have to be chosen.
    fn plan(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError>;

    /// Renders; `cancel` is checked between submissions.
    fn render(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError>;

    /// Builds level maps of a mesh for later frames, and reports for each sun which maps are ready.
    fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError>;

    /// Runs the self-check: compares the GPU with float64 physics.
    fn self_check(&mut self) -> Result<SelfCheck, GpuError>;

    /// Frees what is cached for a mesh.
    fn forget_mesh(&mut self, id: &str);

    /// The level-map cache since the start (hits, misses, evictions) and now (entries, bytes).
    fn level_map_cache(&self) -> CacheStats;

    /// The kept fields of light, likewise.
    fn field_cache(&self) -> CacheStats {
        CacheStats::default()
    }

    /// Called about once a second while there is nothing to do. If it reports a lost device, the queue rebuilds the backend
    /// before the next request arrives.
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

    fn field_cache(&self) -> CacheStats {
        Renderer::field_cache(self)
    }

    fn idle(&mut self) -> Result<(), GpuError> {
        Renderer::idle(self)
    }
}
