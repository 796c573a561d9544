//! Scene + Plan → Frame: owns the GPU context and the caches, and runs the planned passes.

mod buffers;
mod collect;
mod commands;
mod comparison;
mod executor;
mod fields;
mod geometry;
mod pieces;
mod prepared;
mod self_check;
mod tune;
mod warm;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::time::Instant;

use tokio_util::sync::CancellationToken;

use crate::cache::{ArenaError, FieldCache, LevelMapCache};
use crate::calibration::Calibration;
use crate::calibration::frontiers::Frontiers;
use crate::config::RenderConfig;
use crate::facts::placement::LevelMapKey;
use crate::facts::{FieldKey, Product, SceneFacts};
use crate::frame::{Frame, FrameKind};
use crate::gpu::shader::ShaderSources;
use crate::gpu::timing::Timing;
use crate::gpu::uniforms::Uniforms;
use crate::gpu::{BindGroups, BufferPool, GpuContext, GpuError, KernelCache};
use crate::graph::{PlanError, Scope};
use crate::methods;
use crate::plan::{self, Cached, FramePlan, Plan, Wanted};
use crate::scene::projection::{Lens, Projection, rows};
use crate::scene::{Output, ResolvedScene, SceneError};
use crate::stages::Pass;
use crate::stages::objects::GEOMETRY;
use crate::stages::points::Point;
use crate::stats::{
    AccuracyStats, AdapterStats, CacheStats, CameraStats, ExposureStats, MemoryStats, MethodStats,
    PassStats, Stats, TimeStats, Warning,
};
use crate::tuning::method::{self, Question};

pub use prepared::Prepared;
pub use self_check::{SelfCheck, SelfCheckItem, TwinError, twin_error};

/// Why there is no frame.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The scene cannot be rendered as it is.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The plan needs more memory than allowed.
    #[error("{what} needs {needed_bytes} bytes of GPU memory, {budget_bytes} are allowed")]
    OverBudget {
        /// The frame, or the one buffer that is too large for the device.
        what: String,
        /// Planned bytes.
        needed_bytes: u64,
        /// The limit.
        budget_bytes: u64,
    },
    /// A result is not a number.
    #[error("layer {layer} is not finite at ({x}, {y})")]
    NotFinite {
        /// The layer.
        layer: String,
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The frame is no longer needed.
    #[error("cancelled")]
    Cancelled,
}

impl From<PlanError> for RenderError {
    fn from(error: PlanError) -> Self {
        Self::Gpu(GpuError::Validation(error.to_string()))
    }
}

/// Idle polls (one a second) after which buffers kept for the next frame are freed.
const IDLE_POLLS: u32 = 5;

/// Owns the GPU context and the caches; lives on the GPU thread.
#[derive(Debug)]
pub struct Renderer {
    gpu: GpuContext,
    sources: ShaderSources,
    pool: BufferPool,
    uniforms: Uniforms,
    bind_groups: BindGroups,
    timing: Timing,
    kernels: KernelCache,
    level_maps: LevelMapCache,
    arena: Option<wgpu::Buffer>,
    fields: FieldCache,
    field_arena: Option<wgpu::Buffer>,
    geometry: geometry::GeometryCache,
    memory_budget_bytes: u64,
    calibration: Calibration,
    /// Polls since the last frame.
    idle_polls: u32,
    wide_sum_reruns: u64,
    recorded_ahead: u64,
    watches_allocator: bool,
    cutting: pieces::Cutting,
}

impl Renderer {
    /// Opens an adapter by the policy.
    ///
    /// # Errors
    /// When no adapter fits, or the device cannot be opened.
    pub fn new(config: &RenderConfig) -> Result<Self, GpuError> {
        Self::with_shaders(config, methods::embedded())
    }

    /// Like [`Self::new`], with the given shader sources: for tests that break a formula on purpose.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_shaders(config: &RenderConfig, sources: ShaderSources) -> Result<Self, GpuError> {
        let gpu = GpuContext::open(config.adapter)?;
        if let Some(folder) = &config.shader_dump {
            dump_shaders(&sources, folder)?;
        }
        let arena_bytes = config.level_map_budget_bytes().min(bindable_bytes(&gpu));
        if arena_bytes < config.level_map_budget_bytes() {
            tracing::warn!(
                wanted_bytes = config.level_map_budget_bytes(),
                arena_bytes,
                "the device binds no more level maps at once"
            );
        }
        let field_arena_bytes = config.field_budget_bytes().min(bindable_bytes(&gpu));
        if field_arena_bytes < config.field_budget_bytes() {
            tracing::debug!(
                wanted_bytes = config.field_budget_bytes(),
                field_arena_bytes,
                "the device binds no more fields of light at once"
            );
        }
        Ok(Self {
            timing: Timing::new(&gpu),
            gpu,
            sources,
            pool: BufferPool::default(),
            uniforms: Uniforms::default(),
            bind_groups: BindGroups::default(),
            kernels: KernelCache::default(),
            level_maps: LevelMapCache::new(arena_bytes),
            arena: None,
            fields: FieldCache::new(field_arena_bytes),
            field_arena: None,
            geometry: geometry::GeometryCache::default(),
            memory_budget_bytes: config.memory_budget_bytes(),
            calibration: config.calibration.clone().unwrap_or_default(),
            idle_polls: 0,
            wide_sum_reruns: 0,
            recorded_ahead: 0,
            watches_allocator: false,
            cutting: pieces::Cutting::default(),
        })
    }

    /// Where it runs.
    pub fn adapter(&self) -> AdapterStats {
        self.gpu.adapter().clone()
    }

    /// The device context, for tests.
    pub fn gpu(&self) -> &GpuContext {
        &self.gpu
    }

    /// The shaders this renderer runs.
    pub fn sources(&self) -> &ShaderSources {
        &self.sources
    }

    /// Prepares a scene and plans it, as [`plan_prepared`](Self::plan_prepared) does.
    ///
    /// # Errors
    /// When the scene cannot be rendered.
    pub fn plan(
        &mut self,
        resolved: &ResolvedScene,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError> {
        self.plan_prepared(&Prepared::new(resolved.clone())?, cancel)
    }

    /// Plans a frame, given what is cached now. Nothing is rendered, except the trial renders that choose the dials if `quality` requests
    /// an error or a time.
    ///
    /// # Errors
    /// When the scene cannot be rendered.
    pub fn plan_prepared(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError> {
        let tuned = self.tuned(prepared, cancel)?;
        let rendered = tuned.as_ref().map_or(prepared, |tuned| &tuned.rung);
        let facts = self.facts_here(rendered.facts());
        let mut plan = plan::plan(rendered.passes(), &facts, Wanted::Frame, self)?.report;
        let target = prepared.resolved().scene.quality.target_error;
        plan.method_choice = tuned.as_ref().zip(target).map(|(tuned, target)| {
            let question = Question {
                resolved: tuned.rung.resolved(),
                facts: &facts,
                target,
                chosen: &tuned.chosen,
            };
            method::advise(&question, Frontiers::built_in())
        });
        plan.chosen = tuned.map(|tuned| tuned.chosen);
        Ok(plan)
    }

    /// Prepares a scene and renders it, as [`render_prepared`](Self::render_prepared) does.
    ///
    /// # Errors
    /// When the scene cannot be rendered within the budget, the GPU fails, or the job is cancelled.
    pub fn render(
        &mut self,
        resolved: &ResolvedScene,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        self.render_prepared(&Prepared::new(resolved.clone())?, cancel)
    }

    /// Renders a frame; `cancel` is checked between submissions. If the GPU runs out of memory, the caches are emptied and the frame is
    /// tried once more.
    ///
    /// # Errors
    /// When the scene cannot be rendered within the budget, the GPU fails, or the job is cancelled.
    pub fn render_prepared(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        match self.render_once(prepared, cancel) {
            Err(RenderError::Gpu(GpuError::OutOfMemory(first))) => {
                tracing::warn!(
                    error = first,
                    "the caches are emptied, and the frame is tried again"
                );
                match self.render_once(prepared, cancel) {
                    Err(RenderError::Gpu(GpuError::OutOfMemory(again))) => {
                        Err(RenderError::Gpu(GpuError::OutOfMemory(format!(
                            "{again} (with empty caches, at the second try)"
                        ))))
                    }
                    other => other,
                }
            }
            other => other,
        }
    }

    fn render_once(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        let started = Instant::now();
        self.gpu.check()?;
        let tuned = self.tuned(prepared, cancel)?;
        let rendered = tuned.as_ref().map_or(prepared, |tuned| &tuned.rung);
        let resolved = rendered.resolved();
        let facts = &*self.facts_here(rendered.facts());
        let plan = self.plan_in_budget(rendered.passes(), facts, Wanted::Frame)?;
        let plan_ms = prepared.took_ms() + ms_since(started);
        let cache_before = self.level_maps.stats();
        let fields_before = self.fields.stats();
        let ran = Instant::now();
        let run = self.run(resolved, facts, &plan, cancel)?;
        let builds_level_maps: Vec<&str> = (plan.graph.of(Scope::LevelMap).iter())
            .map(|pass| pass.name)
            .collect();
        let plan = plan.report;
        // Some GPU work overlaps with recording, so a pass may take longer than the host waits: the limit is the whole run.
        let gpu_times = self.timing.collect(&self.gpu, ms_since(ran))?;
        let projection = projection(resolved);
        let kind = match &resolved.scene.output {
            Output::View(_) => FrameKind::View,
            Output::IrradianceMap(_) => FrameKind::IrradianceMap,
            Output::WaterMap(_) => FrameKind::WaterMap,
        };
        let is_embedded = resolved.scene.output.encoding().embed_scene;
        // As requested, like the hash: `resolved` may have chosen dials.
        let scene = is_embedded.then(|| prepared.resolved().canonical_json());
        let mut stats = Stats {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene_hash: prepared.scene_hash().to_owned(),
            adapter: self.adapter(),
            method: method_stats(facts),
            passes: plan
                .passes
                .iter()
                .map(|p| PassStats {
                    name: p.name.clone(),
                    reason: p.reason.clone(),
                    runs: if builds_level_maps.contains(&p.name.as_str()) {
                        run.level_maps_built
                    } else {
                        p.runs
                    },
                    gpu_ms: gpu_times
                        .iter()
                        .find(|(name, _)| *name == p.name)
                        .map(|&(_, ms)| ms),
                })
                .collect(),
            absent: plan.absent,
            time_ms: TimeStats {
                plan: plan_ms,
                ..run.time_ms
            },
            memory: MemoryStats {
                planned_peak_bytes: plan.peak_bytes,
                peak_bytes: run.peak_bytes,
                allocated_bytes: run.allocated_bytes,
                budget_bytes: self.memory_budget_bytes,
                level_maps: cache_change(&cache_before, &self.level_maps.stats()),
                fields: cache_change(&fields_before, &self.fields.stats()),
            },
            energy: run.energy,
            planes: run.planes,
            fields: run.fields,
            accuracy: run.accuracy,
            exposure: exposure(facts, resolved),
            camera: projection.as_ref().map(camera_stats),
            warnings: plan.warnings,
        };
        // The slices of a field count no light on paths that are not followed.
        let was_measured = !stats.energy.is_empty() && facts.method.product != Product::Field;
        collect::join_warnings(&mut stats.warnings, run.warnings, was_measured);
        collect::add_flux_to_warnings(&mut stats.warnings, facts, &stats.energy);
        if let Some(tune::Tuned { chosen, .. }) = tuned {
            let unmet = tune::unmet(prepared.resolved(), &chosen);
            stats.warnings.extend(unmet);
            let adapter = format!("{}, {}", stats.adapter.name, stats.adapter.driver);
            let calibrated = &self.calibration.adapter;
            stats.warnings.extend(tune::foreign(calibrated, &adapter));
            stats.accuracy.get_or_insert_default().chosen = Some(chosen);
        }
        stats.time_ms.total = prepared.took_ms() + ms_since(started);
        Ok(Frame {
            kind,
            width: run.width,
            height: run.height,
            layers: run.layers,
            projection,
            stats,
            scene,
        })
    }

    /// The points that the pixels of a view see, or where the texels of a map lie, row by row, in local coordinates around
    /// [`SceneFacts::origin_m`].
    ///
    /// # Errors
    /// As [`Self::render`].
    pub fn points(
        &mut self,
        resolved: &ResolvedScene,
        cancel: &CancellationToken,
    ) -> Result<Vec<Point>, RenderError> {
        self.gpu.check()?;
        let facts = methods::facts(resolved)?;
        let plan = plan::plan_scene(&facts, Wanted::Points, self)?;
        Ok(self.run(resolved, &facts, &plan, cancel)?.points)
    }

    /// The facts with what only the renderer knows of the adapter.
    fn facts_here<'a>(&self, facts: &'a SceneFacts) -> Cow<'a, SceneFacts> {
        if !facts.blends_float32 || self.gpu.blends_float32 {
            return Cow::Borrowed(facts);
        }
        Cow::Owned(SceneFacts {
            blends_float32: false,
            ..facts.clone()
        })
    }

    /// The plan of a frame. Level maps and fields of other scenes are dropped if they do not fit beside it, so whether a frame can be rendered does
    /// not depend on the cache.
    fn plan_in_budget(
        &mut self,
        passes: &[&'static Pass],
        facts: &SceneFacts,
        wanted: Wanted,
    ) -> Result<FramePlan, RenderError> {
        let plan = plan::plan(passes, facts, wanted, self)?;
        self.drop_idle_fields(&plan);
        let is_over = plan.report.peak_bytes > self.memory_budget_bytes;
        if !is_over || self.arena.is_none() || !plan::level_maps(facts).is_empty() {
            return Ok(plan);
        }
        self.level_maps.clear();
        self.arena = None;
        self.bind_groups.clear();
        Ok(plan::plan(passes, facts, wanted, self)?)
    }

    /// Runs a plan, within the budgets of memory and level maps.
    fn run(
        &mut self,
        resolved: &ResolvedScene,
        facts: &SceneFacts,
        plan: &FramePlan,
        cancel: &CancellationToken,
    ) -> Result<RunResult, RenderError> {
        self.check_budget(plan)?;
        let missing = self
            .level_maps
            .reserve(&plan::level_maps(facts))
            .map_err(|error| self.level_maps_over_budget(error))?;
        let missing_fields = self.reserve_fields(facts, plan).inspect_err(|_| {
            self.level_maps.forget_unbuilt();
        })?;
        let peak_bytes = plan.report.peak_bytes + self.idle_field_bytes(plan);
        let free_budget_bytes = self.memory_budget_bytes.saturating_sub(peak_bytes);
        self.bind_groups.begin_frame();
        let needs_geometry = plan.graph.slot(&GEOMETRY).is_some();
        let meshes = needs_geometry.then_some(resolved.meshes.as_slice());
        let (kept_bytes, dropped) = self.geometry.begin_frame(meshes, free_budget_bytes);
        if self.pool.begin_frame(free_budget_bytes - kept_bytes) || dropped {
            self.bind_groups.clear();
        }
        self.idle_polls = 0;
        self.uniforms.begin_frame();
        self.timing.begin_frame();
        self.cutting.begin_frame(cancel);
        let job = executor::Job {
            facts,
            plan,
            missing: &missing,
            missing_fields: &missing_fields,
            cancel,
        };
        let result = self.execute(resolved, job);
        // Finished maps stay, even if the frame was cancelled later.
        self.level_maps.forget_unbuilt();
        self.fields.forget_unbuilt();
        if let Err(RenderError::Gpu(_)) = &result {
            // It is unknown which buffers the device failed on, so nothing that would outlive the frame is kept.
            self.level_maps.clear();
            self.arena = None;
            self.fields.clear();
            self.field_arena = None;
            self.geometry.clear();
            self.drop_buffers();
            self.gpu.forget_errors();
        }
        result
    }

    fn level_maps_over_budget(&self, error: ArenaError) -> RenderError {
        let limit = if error.budget_bytes < bindable_bytes(&self.gpu) {
            "CAUSTICA_LEVEL_MAP_BUDGET_MIB"
        } else {
            "the device's limit for one binding"
        };
        RenderError::OverBudget {
            what: format!("holding the scene's level maps at once ({limit})"),
            needed_bytes: error.needed_bytes,
            budget_bytes: error.budget_bytes,
        }
    }

    /// Frees what is cached for a mesh.
    pub fn forget_mesh(&mut self, id: &str) {
        self.level_maps.forget_mesh(id);
        self.geometry.forget_mesh(id);
        self.bind_groups.clear();
    }

    /// Drops all buffers that are kept for later frames, except level maps, fields and geometry.
    fn drop_buffers(&mut self) {
        self.pool.clear();
        self.uniforms = Uniforms::default();
        self.bind_groups.clear();
    }

    /// Statistics of the level-map cache: hits, misses and evictions since the start; entries and bytes now.
    pub fn level_map_cache(&self) -> CacheStats {
        self.level_maps.stats()
    }

    /// Kernels that were compiled since the start.
    pub fn kernels_compiled(&self) -> usize {
        self.kernels.compiled()
    }

    /// Bytes of meshes that were uploaded since the start.
    pub fn geometry_uploaded_bytes(&self) -> u64 {
        self.geometry.uploaded_bytes()
    }

    /// Number of times since the start that a beam set was traced again because its narrow flux sums had wrapped.
    pub fn wide_sum_reruns(&self) -> u64 {
        self.wide_sum_reruns
    }

    /// Number of times since the start that the commands after a beam set were recorded while the GPU worked on it.
    pub fn recorded_ahead(&self) -> u64 {
        self.recorded_ahead
    }

    /// Number of reusable bind groups made since the start.
    pub fn bind_groups_made(&self) -> u64 {
        self.bind_groups.made()
    }

    /// Whether frames report the bytes of the GPU's allocator (`stats.memory.allocated_bytes`).
    pub fn watch_allocator(&mut self, on: bool) {
        self.watches_allocator = on;
    }

    /// Whether passes are timed on adapters without usable timestamps. There each pass is submitted alone and timed on the CPU. On by
    /// default; if off, such frames report no pass times, and are submitted as on other adapters.
    pub fn time_by_host(&mut self, on: bool) {
        self.timing.allow_host(&self.gpu, on);
    }

    /// Largest number of workgroups of a piece, whatever its time; `None`: only long dispatches are cut, by time.
    pub fn cut_into(&mut self, most_groups: Option<u64>) {
        self.cutting.most_groups = most_groups;
    }

    /// Resets the count of pieces.
    pub fn forget_pieces(&mut self) {
        self.cutting.forget();
    }

    /// Number of pieces that dispatches were cut into since the start or [`forget_pieces`](Self::forget_pieces), and the time of the
    /// longest piece, ms.
    pub fn pieces(&self) -> (u64, f64) {
        (self.cutting.pieces, self.cutting.longest_ms)
    }

    /// Bytes held on the GPU between frames: free pooled buffers, level maps, fields, geometry.
    pub fn resident_bytes(&self) -> u64 {
        self.pool.free_bytes()
            + self.arena.as_ref().map_or(0, wgpu::Buffer::size)
            + self.resident_field_bytes()
            + self.geometry.bytes()
    }

    /// To be called regularly when idle: lets the driver free unused memory.
    ///
    /// # Errors
    /// An error that the device reported in the meantime, such as its loss.
    pub fn idle(&mut self) -> Result<(), GpuError> {
        self.idle_polls = self.idle_polls.saturating_add(1);
        if self.idle_polls == IDLE_POLLS {
            self.drop_buffers();
        }
        self.gpu.tidy();
        self.gpu.check()
    }

    fn check_budget(&self, plan: &FramePlan) -> Result<(), RenderError> {
        let peak_bytes = plan.report.peak_bytes;
        if peak_bytes > self.memory_budget_bytes {
            return Err(RenderError::OverBudget {
                what: "the frame at its peak (CAUSTICA_MEMORY_BUDGET_MIB)".to_owned(),
                needed_bytes: peak_bytes,
                budget_bytes: self.memory_budget_bytes,
            });
        }
        let limit = bindable_bytes(&self.gpu);
        let buffers = plan.graph.slots.iter().filter(|s| s.slot.is_buffer());
        for planned in buffers {
            if planned.bytes > limit {
                let name = planned.slot.name;
                return Err(RenderError::OverBudget {
                    what: format!(
                        "buffer `{name}` (the device's limit for one binding{})",
                        size_advice(plan, name)
                    ),
                    needed_bytes: planned.bytes,
                    budget_bytes: limit,
                });
            }
        }
        Ok(())
    }
}

/// Advice on how to make a buffer smaller, if it holds maps of objects.
fn size_advice(plan: &FramePlan, slot: &str) -> &'static str {
    let holds_maps = ["flux", "irradiance"].contains(&slot);
    let has_objects = plan.graph.slot(&GEOMETRY).is_some();
    if holds_maps && has_objects {
        "; quality.level_of_detail gives small and far objects smaller maps, fewer quality.level_map_texels or quality.layers all of them"
    } else {
        ""
    }
}

impl Cached for Renderer {
    fn has_level_map(&self, key: &LevelMapKey) -> bool {
        self.level_maps.contains(key)
    }

    fn arena_bytes(&self, wanted_bytes: u64) -> u64 {
        if wanted_bytes == 0 && self.arena.is_none() {
            0
        } else {
            self.level_maps.stats().budget_bytes
        }
    }

    fn has_field(&self, key: &FieldKey) -> bool {
        self.fields.contains(key)
    }

    fn field_arena_bytes(&self, wanted_bytes: u64) -> u64 {
        if wanted_bytes == 0 && self.field_arena.is_none() {
            0
        } else {
            self.fields.stats().budget_bytes
        }
    }
}

/// Result of running a plan.
#[derive(Debug)]
struct RunResult {
    width: u32,
    height: u32,
    layers: BTreeMap<crate::scene::LayerName, crate::frame::Layer>,
    energy: Vec<crate::stats::EnergyAccount>,
    planes: Vec<crate::stats::PlaneStats>,
    fields: Vec<crate::stats::FieldStats>,
    points: Vec<Point>,
    accuracy: Option<AccuracyStats>,
    warnings: Vec<Warning>,
    time_ms: TimeStats,
    peak_bytes: u64,
    /// More than planned if cached maps had to be evicted and built again.
    level_maps_built: u32,
    allocated_bytes: Option<u64>,
}

/// The largest buffer that shaders can bind whole, a multiple of 16 bytes.
fn bindable_bytes(gpu: &GpuContext) -> u64 {
    let limits = &gpu.limits;
    let bytes = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    bytes - bytes % 16
}

fn check_cancelled(cancel: &CancellationToken) -> Result<(), RenderError> {
    if cancel.is_cancelled() {
        Err(RenderError::Cancelled)
    } else {
        Ok(())
    }
}

/// Runs `work` and adds its time to `ms`.
fn timed<T>(ms: &mut f64, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    *ms += ms_since(started);
    result
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn method_stats(facts: &SceneFacts) -> MethodStats {
    MethodStats {
        name: facts.method.name.to_owned(),
        paper: methods::of(&facts.quality).paper.to_owned(),
        conserves_energy: facts.method.conserves_energy,
    }
}

fn cache_change(before: &CacheStats, after: &CacheStats) -> CacheStats {
    CacheStats {
        hits: after.hits - before.hits,
        misses: after.misses - before.misses,
        evictions: after.evictions - before.evictions,
        ..after.clone()
    }
}

/// The camera of a view.
fn projection(resolved: &ResolvedScene) -> Option<Projection> {
    match (&resolved.scene.output, &resolved.scene.camera) {
        (Output::View(view), Some(camera)) => Some(camera.projection([view.width, view.height])),
        _ => None,
    }
}

fn camera_stats(projection: &Projection) -> CameraStats {
    CameraStats {
        k_px: projection.k_px(),
        pixels_per_m: match projection.lens {
            Lens::Orthographic { pixels_per_m } => Some(pixels_per_m),
            Lens::Perspective { .. } => None,
        },
        world_to_camera_opencv: rows(projection.world_to_camera_opencv()),
        world_to_camera_opengl: rows(projection.world_to_camera_opengl()),
    }
}

fn exposure(facts: &SceneFacts, resolved: &ResolvedScene) -> ExposureStats {
    let ev = resolved.scene.output.encoding().exposure_ev;
    let scale = if facts.lights.white_radiance > 0.0 {
        ev.exp2() / facts.lights.white_radiance
    } else {
        0.0
    };
    ExposureStats {
        white_radiance: facts.lights.white_radiance,
        ev,
        scale,
    }
}

fn dump_shaders(sources: &ShaderSources, folder: &std::path::Path) -> Result<(), GpuError> {
    let is_pass = |path: &&str| path.starts_with("stages/") || path.starts_with("methods/");
    for path in sources.paths().filter(is_pass) {
        let target = folder.join(path.rsplit('/').next().unwrap_or(path));
        std::fs::create_dir_all(folder)
            .and_then(|()| std::fs::write(&target, sources.assemble(path).unwrap_or_default()))
            .map_err(|error| GpuError::Shader {
                shader: path.to_owned(),
                message: format!("cannot be dumped to {}: {error}", target.display()),
            })?;
    }
    Ok(())
}
