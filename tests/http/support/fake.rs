//! A scripted backend that records its calls.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use caustica::cache::{WarmSun, WarmUp, WarmedMap};
use caustica::frame::{Frame, FrameKind, Layer};
use caustica::gpu::GpuError;
use caustica::gpu_queue::RenderBackend;
use caustica::mesh::Mesh;
use caustica::plan::{Plan, PlannedPass};
use caustica::render::{Prepared, RenderError, SelfCheck, SelfCheckItem};
use caustica::scene::{LayerName, Output, ResolvedScene};
use caustica::stats::{AdapterStats, CacheStats, PassStats, Stats};
use tokio_util::sync::CancellationToken;

/// What the next render or warm-up does.
pub(crate) enum Behaviour {
    /// A small gradient.
    Draw,
    /// A frame that no file can hold.
    DrawNan,
    /// Waits until `Control::open_gate` or until it is cancelled.
    Block,
    /// Waits until `Control::open_gate`, whatever the caller does.
    BlockDeaf,
    /// Returns an error.
    Fail(RenderError),
    /// Panics.
    Panic,
}

/// The strings of the puppet, and its diary.
#[derive(Clone, Default)]
pub(crate) struct Control {
    inner: Arc<Mutex<Inner>>,
}

#[derive(Default)]
struct Inner {
    renders: VecDeque<Behaviour>,
    builds: VecDeque<GpuError>,
    idle_errors: VecDeque<GpuError>,
    failing_check: Option<String>,
    dial_basis: String,
    gate_open: bool,
    builds_held: bool,
    diary: Vec<String>,
    warmed: Vec<(String, WarmUp)>,
    cache: CacheStats,
}

impl Control {
    /// Appends to what the coming renders and warm-ups do; afterwards they draw.
    pub(crate) fn script(&self, behaviours: impl IntoIterator<Item = Behaviour>) {
        self.inner.lock().unwrap().renders.extend(behaviours);
    }

    /// Lets the coming builds fail.
    pub(crate) fn fail_builds(&self, errors: impl IntoIterator<Item = GpuError>) {
        self.inner.lock().unwrap().builds.extend(errors);
    }

    /// Lets the next idle poll fail.
    pub(crate) fn fail_idle(&self, error: GpuError) {
        self.inner.lock().unwrap().idle_errors.push_back(error);
    }

    /// Lets the self-check fail by this name.
    pub(crate) fn fail_self_check(&self, name: &str) {
        self.inner.lock().unwrap().failing_check = Some(name.to_owned());
    }

    /// Sets what dials are chosen by, for the coming builds.
    pub(crate) fn choose_dials_by(&self, basis: &str) {
        self.inner.lock().unwrap().dial_basis = basis.to_owned();
    }

    /// Holds builds up until `release_builds`.
    pub(crate) fn hold_builds(&self) {
        self.inner.lock().unwrap().builds_held = true;
    }

    /// Lets builds go on.
    pub(crate) fn release_builds(&self) {
        self.inner.lock().unwrap().builds_held = false;
    }

    /// Sets what the level-map cache reports.
    pub(crate) fn set_cache(&self, cache: CacheStats) {
        self.inner.lock().unwrap().cache = cache;
    }

    /// Ends blocked renders, now and later.
    pub(crate) fn open_gate(&self) {
        self.inner.lock().unwrap().gate_open = true;
    }

    /// What has happened, in order.
    pub(crate) fn diary(&self) -> Vec<String> {
        self.inner.lock().unwrap().diary.clone()
    }

    /// The warm-ups that were done: mesh and what was wanted.
    pub(crate) fn warmed(&self) -> Vec<(String, WarmUp)> {
        self.inner.lock().unwrap().warmed.clone()
    }

    /// How often something has happened.
    pub(crate) fn count(&self, event: &str) -> usize {
        self.diary().iter().filter(|entry| *entry == event).count()
    }

    /// Waits until something has happened `times` times.
    pub(crate) async fn wait_for(&self, event: &str, times: usize) {
        for _ in 0..1000 {
            if self.count(event) >= times {
                return;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        panic!("`{event}` did not happen {times} times: {:?}", self.diary());
    }

    /// The factory of a queue.
    pub(crate) fn build(&self) -> Result<Box<dyn RenderBackend>, GpuError> {
        while self.inner.lock().unwrap().builds_held {
            std::thread::sleep(Duration::from_millis(1));
        }
        let mut inner = self.inner.lock().unwrap();
        if let Some(error) = inner.builds.pop_front() {
            inner.diary.push("build failed".to_owned());
            return Err(error);
        }
        inner.diary.push("built".to_owned());
        Ok(Box::new(Fake {
            control: self.clone(),
        }))
    }

    fn note(&self, event: impl Into<String>) {
        self.inner.lock().unwrap().diary.push(event.into());
    }
}

struct Fake {
    control: Control,
}

impl Fake {
    /// Does what the script says, and whether the result is to be no number.
    fn act(&self, event: &str, cancel: &CancellationToken) -> Result<bool, RenderError> {
        self.control.note(event);
        let behaviour = self.control.inner.lock().unwrap().renders.pop_front();
        match behaviour.unwrap_or(Behaviour::Draw) {
            Behaviour::Draw => {}
            Behaviour::DrawNan => return Ok(true),
            Behaviour::Fail(error) => return Err(error),
            Behaviour::Panic => panic!("the strings are tangled"),
            Behaviour::BlockDeaf => {
                while !self.control.inner.lock().unwrap().gate_open {
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
            Behaviour::Block => {
                while !self.control.inner.lock().unwrap().gate_open {
                    if cancel.is_cancelled() {
                        self.control.note(format!("{event} cancelled"));
                        return Err(RenderError::Cancelled);
                    }
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
        }
        Ok(false)
    }
}

impl Drop for Fake {
    fn drop(&mut self) {
        self.control.note("dropped");
    }
}

/// The adapter of the fake.
pub(crate) fn adapter() -> AdapterStats {
    AdapterStats {
        name: "Puppet 3000".to_owned(),
        backend: "vulkan".to_owned(),
        driver: "strings 1.0".to_owned(),
        software: true,
    }
}

impl RenderBackend for Fake {
    fn adapter(&self) -> AdapterStats {
        adapter()
    }

    fn dial_basis(&self) -> String {
        self.control.inner.lock().unwrap().dial_basis.clone()
    }

    fn plan(
        &mut self,
        prepared: &Prepared,
        _cancel: &CancellationToken,
    ) -> Result<Plan, RenderError> {
        self.control.note("plan");
        Ok(Plan {
            passes: vec![PlannedPass {
                name: "surface".to_owned(),
                reason: format!("{} waves", prepared.resolved().scene.water.waves.len()),
                runs: 1,
            }],
            peak_bytes: 4096,
            ..Plan::default()
        })
    }

    fn render(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        let is_nan = self.act("render", cancel)?;
        let mut frame = draw(prepared.resolved());
        if is_nan {
            for layer in frame.layers.values_mut() {
                layer.data.fill(f32::NAN);
            }
        } else {
            self.control.note("drawn");
        }
        Ok(frame)
    }

    fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError> {
        self.act("warm", cancel)?;
        let mut inner = self.control.inner.lock().unwrap();
        inner.warmed.push((mesh.id.clone(), wanted.clone()));
        let map = |sun: &WarmSun| WarmedMap {
            elevation_deg: sun.elevation_deg,
            azimuth_deg: sun.azimuth_deg,
            texels: wanted.texels,
            layers: wanted.layers,
            bytes: 4096,
            cached: false,
        };
        Ok(wanted.suns.iter().map(map).collect())
    }

    fn self_check(&mut self) -> Result<SelfCheck, GpuError> {
        let failing = self.control.inner.lock().unwrap().failing_check.clone();
        Ok(SelfCheck {
            passed: failing.is_none(),
            checks: vec![SelfCheckItem {
                passed: failing.is_none(),
                name: failing.unwrap_or_else(|| "snell".to_owned()),
                error: 0.5,
                tolerance: 0.001,
            }],
        })
    }

    fn forget_mesh(&mut self, id: &str) {
        self.control.note(format!("forget {id}"));
    }

    fn level_map_cache(&self) -> CacheStats {
        self.control.inner.lock().unwrap().cache.clone()
    }

    /// The same counts, in half the bytes.
    fn field_cache(&self) -> CacheStats {
        let cache = self.level_map_cache();
        CacheStats {
            bytes: cache.bytes / 2,
            ..cache
        }
    }

    fn idle(&mut self) -> Result<(), GpuError> {
        match self.control.inner.lock().unwrap().idle_errors.pop_front() {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }
}

/// A gradient of the size asked for.
fn draw(resolved: &ResolvedScene) -> Frame {
    let (name, channels, width, height) = match &resolved.scene.output {
        Output::View(view) => (LayerName::Radiance, 4, view.width, view.height),
        Output::IrradianceMap(map) => (
            LayerName::Irradiance,
            3,
            map.width.unwrap_or(8),
            map.height.unwrap_or(8),
        ),
        Output::WaterMap(map) => (
            LayerName::Water,
            3,
            map.width.unwrap_or(8),
            map.height.unwrap_or(8),
        ),
    };
    let values = width as usize * height as usize * channels;
    let data = (0..values).map(|i| i as f32 / values as f32).collect();
    let mut stats = Stats {
        adapter: adapter(),
        passes: vec![PassStats {
            name: "surface".to_owned(),
            reason: "there is water".to_owned(),
            runs: 1,
            gpu_ms: Some(1.25),
        }],
        ..Stats::default()
    };
    stats.exposure.scale = 1.0;
    stats.time_ms.gpu = 2.5;
    Frame {
        kind: match resolved.scene.output {
            Output::View(_) => FrameKind::View,
            Output::IrradianceMap(_) => FrameKind::IrradianceMap,
            Output::WaterMap(_) => FrameKind::WaterMap,
        },
        width,
        height,
        layers: BTreeMap::from([(name, Layer { channels, data })]),
        projection: None,
        stats,
        scene: None,
    }
}
