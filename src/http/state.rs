//! What the routes share.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use tokio::sync::Semaphore;

use super::error::ApiError;
use super::metrics::Metrics;
use crate::assets::{FieldStore, MeshStore};
use crate::config::{CorsOrigin, Limits, RenderConfig};
use crate::fields::Field;
use crate::gpu_queue::GpuQueue;
use crate::kept::Kept;
use crate::mesh::Mesh;
use crate::scene::Assets;

/// What the routes share; clones refer to the same state.
#[derive(Clone, Debug)]
pub struct AppState {
    inner: Arc<Inner>,
    origins: Arc<[CorsOrigin]>,
}

#[derive(Debug)]
struct Inner {
    queue: GpuQueue,
    meshes: MeshStore,
    fields: FieldStore,
    kept: Kept,
    limits: Limits,
    render: RenderConfig,
    metrics: Metrics,
    studies: Arc<Semaphore>,
    draining: AtomicBool,
}

impl AppState {
    /// A service on a running queue, with empty stores.
    pub fn new(queue: GpuQueue, limits: Limits, render: RenderConfig) -> Self {
        Self {
            inner: Arc::new(Inner {
                queue,
                meshes: MeshStore::new(&limits),
                fields: FieldStore::new(&limits),
                kept: Kept::default(),
                limits,
                render,
                metrics: Metrics::new(),
                studies: Arc::new(Semaphore::new(1)),
                draining: AtomicBool::new(false),
            }),
            origins: Arc::default(),
        }
    }

    /// The same service, also for web pages of these origins.
    #[must_use]
    pub fn allowing_origins(self, origins: Vec<CorsOrigin>) -> Self {
        Self {
            origins: origins.into(),
            ..self
        }
    }

    /// Origins whose web pages may use the service.
    pub fn origins(&self) -> &[CorsOrigin] {
        &self.origins
    }

    /// The queue in front of the GPU.
    pub fn queue(&self) -> &GpuQueue {
        &self.inner.queue
    }

    /// Uploaded meshes.
    pub fn meshes(&self) -> &MeshStore {
        &self.inner.meshes
    }

    /// Uploaded files of numbers.
    pub fn fields(&self) -> &FieldStore {
        &self.inner.fields
    }

    /// Limits of a request.
    pub fn limits(&self) -> &Limits {
        &self.inner.limits
    }

    /// Settings of the renderer.
    pub fn render_config(&self) -> &RenderConfig {
        &self.inner.render
    }

    /// Counters and gauges.
    pub fn metrics(&self) -> Metrics {
        self.inner.metrics
    }

    /// The permit to run a study of accuracy: one at a time, since a study uses one or all CPU cores.
    pub fn studies(&self) -> &Arc<Semaphore> {
        &self.inner.studies
    }

    /// Folder in which references are kept, if any.
    pub fn truth_cache(&self) -> Option<&PathBuf> {
        self.inner.render.truth_cache.as_ref()
    }

    /// Makes `/readyz` answer 503 from now on, so that no more work is sent. Requests are still served.
    pub fn start_draining(&self) {
        self.inner.draining.store(true, Ordering::Release);
    }

    /// Why work should not be sent here, one sentence each; empty when the service is ready.
    pub fn obstacles(&self) -> Vec<String> {
        let mut obstacles = self.inner.queue.status().obstacles();
        if self.inner.draining.load(Ordering::Acquire) {
            obstacles.push("the service is shutting down".to_owned());
        }
        obstacles
    }

    /// Refuses work if the device has failed its self-check, because its pictures are not trustworthy.
    ///
    /// # Errors
    /// [`ApiError::NotReady`].
    pub fn require_trusted_device(&self) -> Result<(), ApiError> {
        let status = self.inner.queue.status();
        match &status.self_check {
            Some(check) if !check.passed => Err(ApiError::NotReady {
                reasons: status.obstacles(),
            }),
            _ => Ok(()),
        }
    }
}

impl Assets for &AppState {
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>> {
        self.meshes().get(id)
    }

    fn field(&self, id: &str) -> Option<Arc<Field>> {
        self.fields().get(id)
    }

    fn kept(&self) -> Kept {
        self.inner.kept.clone()
    }
}
