//! A device that is lost, runs out of memory, must not be blocked for long, and is used for days.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::bench::Bench;
use super::case::Family::Machine;
use super::case::{Case, Failure};
use super::mesh::with_planes;
use super::sabotage::{Saboteur, after_submissions, differing_values, exhaust};
use super::truths::{pool, waves, with};
use crate::config::{AdapterPolicy, RenderConfig};
use crate::frame::Frame;
use crate::gpu::GpuError;
use crate::gpu_queue::{GpuQueue, GpuState, GpuStatus, QueueSettings, RenderBackend};
use crate::methods;
use crate::render::{Prepared, RenderError, Renderer};
use crate::scene::ResolvedScene;

const SAME: &str = "values that differ from those of the undisturbed frame";

/// MiB of growth that is attributed to the allocator of the process, not to us.
const NOISE_MIB: f64 = 16.0;

/// MiB by which the memory of the driver's allocator may grow. Where it was measured, it did not grow by a byte; a GPU may keep a staging
/// buffer a little longer.
const ALLOCATOR_MIB: f64 = 0.25;

pub(super) const CASES: &[Case] = &[
    Machine.case(
        "a_device_lost_in_mid_frame",
        "a lost frame, a service that stays unready, caches of a device that no longer exists",
        SAME,
        0.0,
        lost_in_mid_frame,
    ),
    Machine.case(
        "out_of_memory_once",
        "a frame that is refused although caches could have been dropped",
        SAME,
        0.0,
        |b| {
            let scene = b.scene(with_box())?;
            let expected = b.render_resolved(&scene)?;
            let renderer = b.renderer()?;
            let before = renderer.level_map_cache().misses;
            let device = renderer.gpu().device.clone();
            after_submissions(&renderer.gpu().queue, 2, move || exhaust(&device));
            let found = renderer.render(&scene, &CancellationToken::new())?;
            if renderer.level_map_cache().misses == before {
                let message = "the level maps were not given up: nothing ran out";
                return Err(Failure::Check(message.to_owned()));
            }
            Ok(differing_values(&found, &expected))
        },
    ),
    Machine.case(
        "out_of_memory_for_good",
        "a crash, an unclear error, a device that is unusable afterwards",
        "values that differ in the small scene after the refusal",
        0.0,
        |b| {
            let scene = b.scene(with_box())?;
            let small = b.scene(with(pool(), &[("/quality/water_cells", json!(32))]))?;
            let expected = b.render_resolved(&small)?;
            let renderer = b.renderer()?;
            let starved = Arc::new(AtomicBool::new(true));
            keep_exhausted(renderer, &starved);
            let refused = renderer.render(&scene, &CancellationToken::new());
            starved.store(false, Ordering::Relaxed);
            match refused {
                Err(RenderError::Gpu(GpuError::OutOfMemory(_))) => {}
                other => {
                    let found = other.map(|_| "a frame");
                    return Err(Failure::Check(format!("{found:?} instead of a refusal")));
                }
            }
            if renderer.resident_bytes() > 0 {
                let message = "buffers are kept that others could need";
                return Err(Failure::Check(message.to_owned()));
            }
            let found = renderer.render(&small, &CancellationToken::new())?;
            Ok(differing_values(&found, &expected))
        },
    ),
    Machine.case(
        "every_dispatch_in_pieces",
        "workgroups that are skipped, run twice, or run at the wrong place",
        SAME,
        0.0,
        |b| {
            let mut differing = 0.0;
            let by_method = methods::variants().into_iter().map(|choice| {
                // Few planes, as each has dispatches of its own.
                let choice = with_planes(choice.clone(), 4).unwrap_or(choice);
                with(with_box(), &[("/quality/method", json!(choice))])
            });
            for scene in by_method.chain([view()]) {
                let few = [
                    ("/quality/water_cells", json!(32)),
                    ("/quality/level_map_texels", json!(32)),
                ];
                let scene = b.scene(with(scene, &few))?;
                let expected = b.render_resolved(&scene)?;
                let renderer = b.renderer()?;
                let (before, _) = renderer.pieces();
                renderer.cut_into(Some(3));
                let found = renderer.render(&scene, &CancellationToken::new());
                renderer.cut_into(None);
                if renderer.pieces().0 < before + 20 {
                    return Err(Failure::Check("nothing was cut".to_owned()));
                }
                differing += differing_values(&found?, &expected);
            }
            Ok(differing)
        },
    ),
    Machine.case(
        "cancelled_between_pieces",
        "a GPU that works on after its caller has cancelled",
        SAME,
        0.0,
        |b| {
            let scene = b.scene(with(pool(), &[("/water/waves", waves())]))?;
            let expected = b.render_resolved(&scene)?;
            let renderer = b.renderer()?;
            let cancel = CancellationToken::new();
            let cancelled = cancel.clone();
            after_submissions(&renderer.gpu().queue, 3, move || cancelled.cancel());
            // A map of one sun checks the token before the sun and then only between pieces.
            renderer.cut_into(Some(1));
            let cancelled = renderer.render(&scene, &cancel);
            renderer.cut_into(None);
            if !matches!(cancelled, Err(RenderError::Cancelled)) {
                return Err(Failure::Check("it was rendered to its end".to_owned()));
            }
            let found = renderer.render(&scene, &CancellationToken::new())?;
            Ok(differing_values(&found, &expected))
        },
    ),
    Machine.case(
        "thousands_of_small_renders",
        "memory that grows with every frame",
        "growth in MiB after the first fifth of the frames, of the process or of the driver's allocator, which may not grow by a quarter; our own account may not grow by a byte",
        NOISE_MIB,
        many_renders,
    ),
];

/// A pool with waves and a box in it, so that there are level maps and beams to split.
fn with_box() -> Value {
    with(
        pool(),
        &[
            ("/water/waves", waves()),
            (
                "/objects",
                json!([{ "mesh": super::obj::cuboid([1.0, 1.0, 1.0]), "scale": 0.4, "translation_m": [0, -1, 0] }]),
            ),
            ("/quality/level_map_texels", json!(64)),
            ("/quality/estimate_error", json!(true)),
        ],
    )
}

fn view() -> Value {
    with(
        with_box(),
        &[
            (
                "/camera",
                json!({ "position_m": [0, 2.5, 3], "target_m": [0, -1, 0] }),
            ),
            ("/quality/layers", json!(2)),
            (
                "/output",
                json!({ "kind": "view", "width": 64, "height": 48 }),
            ),
        ],
    )
}

/// Lets the device be out of memory at every submission until `starved` is unset.
fn keep_exhausted(renderer: &Renderer, starved: &Arc<AtomicBool>) {
    fn again(device: wgpu::Device, queue: &wgpu::Queue, starved: Arc<AtomicBool>) {
        let next = queue.clone();
        queue.on_submitted_work_done(move || {
            if starved.load(Ordering::Relaxed) {
                exhaust(&device);
                again(device, &next, starved);
            }
        });
    }
    let gpu = renderer.gpu();
    again(gpu.device.clone(), &gpu.queue, Arc::clone(starved));
}

/// A queue like that of the service, whose device is lost in the middle of the second frame.
fn lost_in_mid_frame(bench: &mut Bench<'_>) -> Result<f64, Failure> {
    let scene = bench.scene(with_box())?;
    let expected = bench.render_resolved(&scene)?;
    let config = RenderConfig {
        adapter: if bench.renderer()?.adapter().software {
            AdapterPolicy::Software
        } else {
            AdapterPolicy::Gpu
        },
        ..RenderConfig::default()
    };
    // The caller may already be inside a runtime.
    let done = std::thread::scope(|scope| {
        scope
            .spawn(|| lose_and_recover(config, &scene, &expected))
            .join()
    });
    done.unwrap_or_else(|_| Err(Failure::Check("the queue panicked".to_owned())))
}

fn lose_and_recover(
    config: RenderConfig,
    scene: &ResolvedScene,
    expected: &Frame,
) -> Result<f64, Failure> {
    let failed = |message: String| Failure::Check(message);
    let armed = Arc::new(AtomicBool::new(false));
    let seen: Arc<Mutex<Vec<GpuStatus>>> = Arc::default();
    let watched: Arc<OnceLock<tokio::sync::watch::Receiver<GpuStatus>>> = Arc::default();
    let factory = {
        let (armed, seen, watched) = (armed.clone(), seen.clone(), watched.clone());
        move || {
            // Between the loss and the new device: the published state.
            if let Some(status) = watched.get() {
                let status = status.borrow().clone();
                seen.lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push(status);
            }
            let renderer = Renderer::new(&config)?;
            let backend = Saboteur::new(renderer, armed.clone());
            Ok(Box::new(backend) as Box<dyn RenderBackend>)
        }
    };
    let settings = QueueSettings {
        waiting: 1,
        deadline: Duration::from_secs(600),
    };
    let queue = GpuQueue::start(settings, factory).map_err(|e| failed(e.to_string()))?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build()
        .map_err(|e| failed(e.to_string()))?;
    let prepared = Prepared::new(scene.clone()).map_err(RenderError::from)?;
    let render = || {
        let frame = queue
            .place(Instant::now())
            .and_then(|place| runtime.block_on(queue.render(place, prepared.clone())));
        frame.map_err(|error| failed(format!("no frame from the queue: {error}")))
    };
    let before = render()?;
    // The queue has answered, so that it has published its state.
    watched.get_or_init(|| queue.watch());
    armed.store(true, Ordering::Relaxed);
    let after = render()?;
    let status = queue.status();
    queue.close();
    let seen = std::mem::take(&mut *seen.lock().unwrap_or_else(PoisonError::into_inner));
    let was_red = seen.len() == 1
        && seen.iter().all(|status| {
            matches!(status.state, GpuState::Lost(_))
                && !status.obstacles().is_empty()
                && status.level_maps.entries == 0
        });
    if !was_red || status.losses != 1 {
        return Err(failed(format!(
            "{} losses, seen while rebuilding: {seen:?}",
            status.losses
        )));
    }
    if status.state != GpuState::Ready || !status.obstacles().is_empty() {
        return Err(failed(format!("not ready again: {:?}", status.obstacles())));
    }
    if after.stats.memory.level_maps.misses == 0 {
        return Err(failed("level maps outlived their device".to_owned()));
    }
    Ok(differing_values(&before, expected) + differing_values(&after, expected))
}

/// Many frames of a few small scenes. Returns the largest growth, in MiB, after the first fifth of the frames, of the driver's allocator
/// and, where nothing else runs in it, of the process. Our own account may not grow by a byte.
fn many_renders(bench: &mut Bench<'_>) -> Result<f64, Failure> {
    let few = |scene: Value| {
        with(
            scene,
            &[
                ("/quality/water_cells", json!(16)),
                ("/quality/estimate_error", json!(false)),
            ],
        )
    };
    let scenes = [few(pool()), few(with_box()), few(view())];
    let scenes: Vec<ResolvedScene> = scenes
        .into_iter()
        .map(|scene| bench.scene(scene))
        .collect::<Result<_, _>>()?;
    // Both measurements come at the same distance after the same scene, and every scene is rendered at least once before.
    let count = scenes.len() as u32;
    let renders = bench.settings().renders.max(10 * count) / count * count;
    let warm_after = renders / 5 / count * count;
    let is_alone = bench.settings().is_alone;
    let never = CancellationToken::new();
    let renderer = bench.renderer()?;
    let mut warm = None;
    for number in 0..renders {
        if number == warm_after {
            warm = Some(Held::by(renderer, is_alone)?);
        }
        renderer.render(&scenes[(number % count) as usize], &never)?;
    }
    let cold = Held::by(renderer, is_alone)?;
    let warm = warm.ok_or_else(|| Failure::Check("nothing was measured".to_owned()))?;
    if cold.resident > warm.resident {
        return Err(Failure::Check(format!(
            "our own account grew by {} bytes",
            cold.resident - warm.resident
        )));
    }
    let gained = |before: Option<u64>, after: Option<u64>| {
        let (before, after) = (before.unwrap_or(0), after.unwrap_or(0));
        after.saturating_sub(before) as f64 / f64::from(1 << 20)
    };
    let by_allocator = gained(warm.allocated, cold.allocated);
    if by_allocator > ALLOCATOR_MIB {
        return Err(Failure::Check(format!(
            "the driver's allocator gave out {by_allocator} MiB more"
        )));
    }
    Ok(gained(warm.process, cold.process).max(by_allocator))
}

/// Bytes that are held between two frames.
#[derive(Clone, Copy, Debug)]
struct Held {
    /// By our own account.
    resident: u64,
    /// By the driver's allocator; `None` where the backend does not report it.
    allocated: Option<u64>,
    /// By the process; `None` where it is not ours alone, and off Linux.
    process: Option<u64>,
}

impl Held {
    /// The memory that is held now. A source that should report and does not is a failure, because it could hide a leak.
    fn by(renderer: &Renderer, is_alone: bool) -> Result<Self, Failure> {
        let missing = |who: &str| Failure::Check(format!("{who} does not report its memory"));
        let device = &renderer.gpu().device;
        let report = device.generate_allocator_report();
        let backend = device.adapter_info().backend;
        let reports = matches!(backend, wgpu::Backend::Vulkan | wgpu::Backend::Dx12);
        if reports && report.is_none() {
            return Err(missing("the driver's allocator"));
        }
        let process = is_alone.then(process_bytes).flatten();
        if is_alone && cfg!(target_os = "linux") && process.is_none() {
            return Err(missing("the process"));
        }
        Ok(Self {
            resident: renderer.resident_bytes(),
            allocated: report.map(|report| report.total_allocated_bytes),
            process,
        })
    }
}

/// Bytes of this process in memory, where the system says so.
fn process_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib << 10)
}
