//! The order of a frame: level maps, then light by light, then band by band. What a pass does is all in its description.

use std::collections::BTreeMap;
use std::time::Instant;

use tokio_util::sync::CancellationToken;

use super::buffers::{EMPTY_LIST, FrameBuffers, INDIRECT, QUEUE_HEADS, clear_for_light};
use super::collect::{ACCOUNT_BYTES, has_wrapped};
use super::commands::Recording;
use super::comparison::{Comparison, ComparisonPasses};
use super::geometry::Geometry;
use super::{
    RenderError, Renderer, RunResult, check_cancelled, collect, ms_since, slot_name, timed,
};
use crate::facts::placement::{LevelBox, LevelMapKey};
use crate::facts::{SceneFacts, Wanted};
use crate::gpu::{GpuError, readback};
use crate::passes::desc::{PassDesc, Repeat, Run};
use crate::passes::slot::{self, Lifetime, Slot, band_rows};
use crate::passes::{self, light};
use crate::plan::{self, Plan};
use crate::scene::{LayerName, ResolvedScene};
use crate::stats::{AccuracyStats, TimeStats};

impl Renderer {
    pub(super) fn execute(
        &mut self,
        resolved: &ResolvedScene,
        facts: &SceneFacts,
        plan: &Plan,
        missing: &[LevelMapKey],
        cancel: &CancellationToken,
    ) -> Result<RunResult, RenderError> {
        let buffers = self.prepare(resolved, facts, plan)?;
        let result = self.run_passes(facts, plan, missing, &buffers, cancel);
        let targets = missing.iter().map(slot::draw_target_bytes).max();
        let slices = plan
            .slots
            .iter()
            .find(|s| s.name == slot_name(Slot::Slices));
        let peak_bytes = self.pool.peak_bytes()
            + slices.map_or(0, |planned| planned.bytes)
            + targets.unwrap_or(0)
            + self.gpu.take_readback_peak()
            + slot::differences_beside(facts)
            + self.arena.as_ref().map_or(0, wgpu::Buffer::size)
            + self.geometry.in_use().map_or(0, Geometry::bytes);
        let report = self
            .watches_allocator
            .then(|| self.gpu.device.generate_allocator_report())
            .flatten();
        let FrameBuffers {
            by_name,
            empty,
            queue_heads,
            indirect,
            slices: _,
        } = buffers;
        for (name, buffer) in by_name {
            if name != slot_name(Slot::Geometry) && name != slot_name(Slot::LevelMaps) {
                self.pool.give_back(name, buffer);
            }
        }
        for (label, buffer) in [
            (EMPTY_LIST, empty),
            (QUEUE_HEADS, queue_heads),
            (INDIRECT, indirect),
        ] {
            self.pool.give_back(label, buffer);
        }
        result.map(|mut run| {
            run.peak_bytes = peak_bytes;
            run.allocated_bytes = report.map(|report| report.total_allocated_bytes);
            run
        })
    }

    fn run_passes(
        &mut self,
        facts: &SceneFacts,
        plan: &Plan,
        missing: &[LevelMapKey],
        buffers: &FrameBuffers,
        cancel: &CancellationToken,
    ) -> Result<RunResult, RenderError> {
        let mut time_ms = TimeStats::default();
        let kept: Vec<&'static PassDesc> = passes::ALL
            .into_iter()
            .filter(|pass| plan.passes.iter().any(|p| p.name == pass.name))
            .collect();
        let of = |repeat: Repeat| {
            kept.iter()
                .copied()
                .filter(move |pass| pass.repeat == repeat)
                .collect::<Vec<_>>()
        };
        if !of(Repeat::LevelMap).is_empty() {
            let passes = of(Repeat::LevelMap);
            self.build_level_maps(facts, &passes, missing, buffers, cancel, &mut time_ms)?;
        }
        let mut accounts = Vec::new();
        let mut widened = Vec::new();
        let mut plane_counts: Vec<Vec<[u32; 4]>> = Vec::new();
        let of_lights: Vec<&'static PassDesc> = kept
            .iter()
            .copied()
            .filter(|pass| matches!(pass.repeat, Repeat::Light | Repeat::FineLight))
            .collect();
        let comparing = [
            of(Repeat::Light),
            of(Repeat::CoarseLight),
            of(Repeat::Frame),
        ];
        let mut comparison = (!comparing[2].is_empty()).then(|| Comparison::new(facts));
        let lights = if of_lights.is_empty() {
            0
        } else {
            facts.lights.len()
        };
        for light in 0..lights {
            check_cancelled(cancel)?;
            let reruns = self.wide_sum_reruns;
            // After the last light it is known what comes.
            let next = comparison.as_mut().filter(|_| light + 1 == lights);
            let next = next.map(|comparison| (comparison, &comparing));
            let found = self.run_light(facts, light, &of_lights, next, buffers, &mut time_ms)?;
            if let Some((account, counts)) = found {
                accounts.extend(account);
                plane_counts.extend(counts);
            }
            if self.wide_sum_reruns > reruns {
                widened.push(collect::widened(facts.lights[light].index));
            }
        }
        let (energy, mut warnings) = collect::energy(facts, &accounts);
        warnings.extend(widened);
        if let Some(comparison) = comparison.as_mut().filter(|c| c.sent.is_none()) {
            self.send_comparison(comparison, facts, &comparing, buffers, cancel, &mut time_ms)?;
        }
        let mut result = RunResult {
            width: 0,
            height: 0,
            layers: BTreeMap::new(),
            energy,
            planes: collect::planes(facts, &plane_counts),
            accuracy: None,
            warnings,
            time_ms,
            peak_bytes: 0,
            level_maps_built: u32::try_from(missing.len()).unwrap_or(u32::MAX),
            allocated_bytes: None,
        };
        if facts.wanted != Wanted::Frame {
            // Nothing but what has been sent already.
        } else if let Some(camera) = facts.camera {
            self.run_bands(
                facts,
                camera.width,
                camera.height,
                &of(Repeat::Band),
                buffers,
                cancel,
                &mut result,
            )?;
        } else {
            self.collect_map(facts, buffers, &mut result)?;
        }
        if let Some(comparison) = comparison {
            let time_ms = &mut result.time_ms;
            let differences =
                self.read_comparison(comparison, facts, &comparing, buffers, cancel, time_ms)?;
            result.accuracy = Some(AccuracyStats {
                estimated_error: collect::estimated_error(facts, &differences),
                chosen: None,
            });
        }
        Ok(result)
    }

    /// Follows one light and returns its raw account, and the counts of its planes where there are any; with narrow flux sums where
    /// those are fine enough, and once more with wide ones if they wrapped. Sends `next` too if that can be recorded while the GPU is at work on the light.
    fn run_light(
        &mut self,
        facts: &SceneFacts,
        index: usize,
        passes: &[&'static PassDesc],
        mut next: Option<(&mut Comparison, &ComparisonPasses)>,
        buffers: &FrameBuffers,
        time_ms: &mut TimeStats,
    ) -> Result<Option<LightSums>, RenderError> {
        let Some(energy) = buffers.by_name.get(slot_name(Slot::Energy)) else {
            return Ok(None);
        };
        let planes = buffers.by_name.get(slot_name(Slot::PlaneCounts));
        let (sums, maps): (Vec<&'static PassDesc>, Vec<&'static PassDesc>) = passes
            .iter()
            .copied()
            .partition(|pass| pass.writes.iter().all(|slot| !slot.is_map()));
        let mut wide_sums = light::needs_wide_sums(facts, index);
        loop {
            let run = Run::Light { index, wide_sums };
            let started = Recording::start(time_ms);
            self.set_receivers(facts, index, buffers);
            let mut encoder = self.begin_light(facts, wide_sums, buffers);
            self.record_all(&mut encoder, &sums, facts, run, buffers, time_ms)?;
            let staged = readback::stage(&self.gpu, &mut encoder, energy, ACCOUNT_BYTES);
            let staged_counts = planes.map(|buffer| {
                let bytes = Slot::PlaneCounts.bytes(facts);
                readback::stage(&self.gpu, &mut encoder, buffer, bytes)
            });
            let submitted = self.send(encoder, started, time_ms);
            let timed_so_far = self.timing.mark();
            let mut ahead = Vec::new();
            if self.runs_in_one_go(&maps, facts, run, buffers) {
                let mut encoder = self.encoder("light's maps");
                self.record_all(&mut encoder, &maps, facts, run, buffers, time_ms)?;
                ahead.push(encoder.finish());
                if let Some((comparison, passes)) = &mut next {
                    ahead.extend(self.record_comparison(comparison, facts, passes, buffers)?);
                }
            }
            self.gpu.wait()?;
            time_ms.gpu += ms_since(submitted);
            let started = Instant::now();
            let account: Vec<u64> = staged.read(&self.gpu)?;
            let counts = staged_counts.map(|staged| staged.read(&self.gpu));
            let counts: Option<Vec<[u32; 4]>> = counts.transpose()?;
            time_ms.readback += ms_since(started);
            if !wide_sums && has_wrapped(facts, index, &account) {
                self.wide_sum_reruns += 1;
                wide_sums = true;
                self.timing.forget_since(timed_so_far);
                if let Some((comparison, _)) = &mut next {
                    comparison.sent = None;
                }
                continue;
            }
            // Only sums that are known to be whole join the maps.
            if ahead.is_empty() {
                let started = Recording::start(time_ms);
                let mut encoder = self.encoder("light's maps");
                self.record_all(&mut encoder, &maps, facts, run, buffers, time_ms)?;
                self.send(encoder, started, time_ms);
                return Ok(Some((account, counts)));
            }
            self.recorded_ahead += 1;
            timed(&mut time_ms.upload, || {
                let mut ahead = ahead.into_iter();
                self.gpu.queue.submit(ahead.next());
                for (coarse_light, commands) in ahead.enumerate() {
                    if let Some((comparison, _)) = &next {
                        self.set_receivers(&comparison.coarse, coarse_light, buffers);
                    }
                    self.gpu.queue.submit([commands]);
                }
            });
            return Ok(Some((account, counts)));
        }
    }

    /// Whether passes can be recorded before their turn: none of them is cut into pieces, or timed by the host, for which it would have
    /// to run when it is recorded.
    pub(super) fn runs_in_one_go(
        &self,
        passes: &[&'static PassDesc],
        facts: &SceneFacts,
        run: Run<'_>,
        buffers: &FrameBuffers,
    ) -> bool {
        let mut steps = passes.iter().flat_map(|pass| (pass.steps)(facts, run));
        !self.timing.times_by_host() && steps.all(|step| !self.may_be_cut(&step, buffers))
    }

    /// Sets the receivers of a light, for what is submitted from now on.
    pub(super) fn set_receivers(&self, facts: &SceneFacts, index: usize, buffers: &FrameBuffers) {
        if let Some(buffer) = buffers.by_name.get(slot_name(Slot::Receivers)) {
            let receivers = self.receivers(facts, index);
            let bytes = bytemuck::cast_slice(&receivers);
            self.gpu.queue.write_buffer(buffer, 0, bytes);
        }
    }

    /// Begins a light's commands, with empty queues and its flux sums at zero.
    pub(super) fn begin_light(
        &self,
        facts: &SceneFacts,
        wide_sums: bool,
        buffers: &FrameBuffers,
    ) -> wgpu::CommandEncoder {
        let mut encoder = self.encoder("light");
        clear_for_light(&mut encoder, buffers, slot::flux_bytes(facts, wide_sums));
        encoder
    }

    /// Records passes one after the other; where the host times them, submits each.
    pub(super) fn record_all(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        passes: &[&'static PassDesc],
        facts: &SceneFacts,
        run: Run<'_>,
        buffers: &FrameBuffers,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        for pass in passes {
            self.record(encoder, pass, facts, run, buffers, None)?;
            self.submit_if_timed(pass, encoder, time_ms)?;
        }
        Ok(())
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one call site; a struct would only rename them"
    )]
    fn run_bands(
        &mut self,
        facts: &SceneFacts,
        width: u32,
        height: u32,
        passes: &[&'static PassDesc],
        buffers: &FrameBuffers,
        cancel: &CancellationToken,
        result: &mut RunResult,
    ) -> Result<(), RenderError> {
        (result.width, result.height) = (width, height);
        let mut view = collect::ViewLayers::new(facts, width, height);
        let step = band_rows(width, height);
        for first_row in (0..height).step_by(step as usize) {
            let rows = step.min(height - first_row);
            let pixels = u64::from(width) * u64::from(rows);
            for sample in samples(facts) {
                check_cancelled(cancel)?;
                let started = Recording::start(&result.time_ms);
                let run = Run::Band {
                    first_row,
                    rows,
                    offset: sample.offset,
                    sample_index: sample.index,
                };
                let mut encoder = self.encoder("band");
                let time_ms = &mut result.time_ms;
                self.record_all(&mut encoder, passes, facts, run, buffers, time_ms)?;
                self.submit(encoder, started, &mut result.time_ms)?;
                let started = Instant::now();
                let layers = plan::awaited(facts);
                for slot in layers
                    .into_iter()
                    .filter(|s| s.info().lifetime == Lifetime::Band)
                {
                    let wanted = if slot == Slot::Radiance {
                        sample.ends_radiance
                    } else {
                        sample.is_middle
                    };
                    if wanted {
                        let band: Vec<[f32; 4]> =
                            readback::read(&self.gpu, buffers.get(slot_name(slot)), 16 * pixels)?;
                        view.add_band(slot, first_row, &band);
                    }
                }
                result.time_ms.readback += ms_since(started);
            }
        }
        let (layers, warnings) = view.finish()?;
        result.layers = layers;
        result.warnings.extend(warnings);
        Ok(())
    }

    fn collect_map(
        &mut self,
        facts: &SceneFacts,
        buffers: &FrameBuffers,
        result: &mut RunResult,
    ) -> Result<(), RenderError> {
        let map = collect::map_of(facts);
        (result.width, result.height) = (map.width, map.height);
        let texels = map.width as usize * map.height as usize;
        let mut values = vec![0.0_f32; 3 * texels];
        if let Some(buffer) = buffers.by_name.get(slot_name(Slot::Irradiance)) {
            let started = Recording::start(&result.time_ms);
            let mut encoder = self.encoder("map");
            let bytes = 12 * (map.first_texel + texels as u64);
            let staged = readback::stage(&self.gpu, &mut encoder, buffer, bytes);
            self.submit(encoder, started, &mut result.time_ms)?;
            let all: Vec<f32> = timed(&mut result.time_ms.readback, || staged.read(&self.gpu))?;
            values.copy_from_slice(&all[3 * map.first_texel as usize..][..3 * texels]);
        }
        let mut cosines = None;
        let started = Instant::now();
        if let (Some(key), true) = (&map.level_map, !facts.lights.is_empty()) {
            let arena = self.arena.as_ref().zip(self.level_maps.offset(key));
            if let Some((arena, offset)) = arena {
                cosines = Some(self.read_normals(arena, offset, key, facts.map_layer)?);
            }
        }
        let layer = collect::finish_map(facts, &map, values, cosines.as_deref())?;
        result.time_ms.readback += ms_since(started);
        result.layers.insert(LayerName::Irradiance, layer);
        Ok(())
    }

    /// Packed normals of a layer of a level map.
    fn read_normals(
        &self,
        arena: &wgpu::Buffer,
        offset: u64,
        key: &LevelMapKey,
        layer: u32,
    ) -> Result<Vec<u32>, GpuError> {
        let bytes = 4 * u64::from(key.texels) * u64::from(key.texels);
        let first = offset + key.pyramid_bytes() + 4 * u64::from(key.normals_after(layer));
        let staging = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("normals"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.encoder("normals");
        encoder.copy_buffer_to_buffer(arena, first, &staging, 0, bytes);
        self.gpu.queue.submit([encoder.finish()]);
        readback::read(&self.gpu, &staging, bytes)
    }

    fn build_level_maps(
        &mut self,
        facts: &SceneFacts,
        passes: &[&'static PassDesc],
        missing: &[LevelMapKey],
        buffers: &FrameBuffers,
        cancel: &CancellationToken,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        let boxes: BTreeMap<&LevelMapKey, &LevelBox> = facts
            .lights
            .iter()
            .flat_map(|light| light.boxes.iter().flatten())
            .map(|level_box| (&level_box.key, level_box))
            .collect();
        for key in missing {
            check_cancelled(cancel)?;
            let started = Recording::start(time_ms);
            let (Some(level_box), Some(offset), Some(geometry)) = (
                boxes.get(key),
                self.level_maps.offset(key),
                self.geometry.in_use(),
            ) else {
                continue;
            };
            let place = geometry.place(&key.mesh);
            let run = Run::LevelMap {
                level_box,
                arena_offset: u32::try_from(offset / 4).unwrap_or(u32::MAX),
                first_triangle: place.first_triangle,
                triangles: place.triangles,
            };
            let targets = self.draw_targets(key);
            let mut encoder = self.encoder("level map");
            for pass in passes {
                self.record(&mut encoder, pass, facts, run, buffers, Some(&targets))?;
                self.submit_if_timed(pass, &mut encoder, time_ms)?;
            }
            self.submit(encoder, started, time_ms)?;
            self.level_maps.built(key);
        }
        Ok(())
    }
}

/// What a light's sums came to: its raw account, and the counts of its planes.
type LightSums = (Vec<u64>, Option<Vec<[u32; 4]>>);

/// One round of rays through the pixels of a band.
struct Sample {
    offset: [f64; 2],
    index: u32,
    /// Goes through the pixels' middles: the layers that are not averaged come from it.
    is_middle: bool,
    /// The radiance sum is complete after it.
    ends_radiance: bool,
}

/// The rounds of a view: an even grid in the pixel, and before it one through the middle where layers need it.
fn samples(facts: &SceneFacts) -> Vec<Sample> {
    let side = if facts.wants(LayerName::Radiance) {
        facts.quality.pixel_samples
    } else {
        1
    };
    let count = side * side;
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
    let mut all: Vec<Sample> = (0..count)
        .map(|index| Sample {
            offset: [place(index % side), place(index / side)],
            index,
            is_middle: side == 1,
            ends_radiance: index + 1 == count,
        })
        .collect();
    let other_layers = facts
        .layers
        .iter()
        .any(|&layer| layer != LayerName::Radiance);
    if side > 1 && other_layers {
        all.insert(
            0,
            Sample {
                offset: [0.0; 2],
                index: 0,
                is_middle: true,
                ends_radiance: false,
            },
        );
    }
    all
}
