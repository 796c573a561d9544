//! Runs a frame in order: level maps, then one beam set after another, then one band after another. Each pass is executed from its
//! description.

use std::collections::BTreeMap;
use std::time::Instant;

use tokio_util::sync::CancellationToken;

use super::buffers::FrameSlots;
use super::collect::{ACCOUNT_BYTES, has_wrapped};
use super::commands::{Recording, steps_of};
use super::comparison::{Comparison, ComparisonPasses};
use super::geometry::Geometry;
use super::{RenderError, Renderer, RunResult, check_cancelled, collect, ms_since, timed};
use crate::facts::placement::{LevelBox, LevelMapKey};
use crate::facts::{FieldKey, SceneFacts};
use crate::gpu::{GpuError, readback};
use crate::graph::plan::Phase;
use crate::graph::{BandRun, BeamSetRun, Scope};
use crate::plan::{self, FramePlan, Wanted};
use crate::scene::{LayerName, ResolvedScene};
use crate::stages::irradiance::IRRADIANCE;
use crate::stages::level_map::LevelMapRun;
use crate::stages::light_field::SLICE_ENERGY;
use crate::stages::points::{POINTS, Point, band_rows, size};
use crate::stages::reference_planes::PLANE_COUNTS;
use crate::stages::shade::RADIANCE;
use crate::stages::sums::{ENERGY, ENERGY_TERMS, FLUX};
use crate::stages::{Pass, Run, light};
use crate::stats::{AccuracyStats, TimeStats};

/// A frame to be run: its scene's facts, its plan, the level maps and fields to build, and its cancellation.
#[derive(Clone, Copy)]
pub(super) struct Job<'a> {
    pub(super) facts: &'a SceneFacts,
    pub(super) plan: &'a FramePlan,
    pub(super) missing: &'a [LevelMapKey],
    pub(super) missing_fields: &'a [FieldKey],
    pub(super) cancel: &'a CancellationToken,
}

impl Renderer {
    pub(super) fn execute(
        &mut self,
        resolved: &ResolvedScene,
        job: Job<'_>,
    ) -> Result<RunResult, RenderError> {
        let mut slots = self.prepare(resolved, job.facts, job.plan)?;
        let result = self.run_passes(job, &mut slots);
        let peak_bytes = self.pool.peak_bytes()
            + slots.texture_peak_bytes()
            + self.gpu.take_readback_peak()
            + plan::differences_beside(job.facts)
            + self.arena.as_ref().map_or(0, wgpu::Buffer::size)
            + self.field_bytes_of(job.plan)
            + self.geometry.in_use().map_or(0, Geometry::bytes);
        let report = self
            .watches_allocator
            .then(|| self.gpu.device.generate_allocator_report())
            .flatten();
        self.give_back(slots);
        result.map(|mut run| {
            run.peak_bytes = peak_bytes;
            run.allocated_bytes = report.map(|report| report.total_allocated_bytes);
            run
        })
    }

    fn run_passes(
        &mut self,
        job: Job<'_>,
        slots: &mut FrameSlots,
    ) -> Result<RunResult, RenderError> {
        let Job { facts, plan, .. } = job;
        let mut time_ms = TimeStats::default();
        self.run_once(job, slots, &mut time_ms)?;
        self.build_level_maps(job, slots, &mut time_ms)?;
        self.next_phase(slots, facts, plan, Phase::Light);
        let comparing = [Scope::BeamSet, Scope::CoarseBeamSet, Scope::Estimate]
            .map(|scope| plan.graph.of(scope));
        let mut comparison = (!comparing[2].is_empty()).then(|| Comparison::new(facts));
        let sums = self.run_beam_sets(job, &mut comparison, &comparing, slots, &mut time_ms)?;
        let (energy, mut warnings) = collect::energy(facts, &sums.accounts);
        warnings.extend(sums.widened);
        if let Some(comparison) = comparison.as_mut().filter(|c| c.sent.is_none()) {
            self.send_comparison(comparison, job, &comparing, slots, &mut time_ms)?;
        }
        let mut result = RunResult {
            width: 0,
            height: 0,
            layers: BTreeMap::new(),
            energy,
            planes: collect::planes(facts, &sums.plane_counts),
            fields: collect::fields(facts, &sums.slice_accounts, job.missing_fields),
            points: Vec::new(),
            accuracy: None,
            warnings,
            time_ms,
            peak_bytes: 0,
            level_maps_built: u32::try_from(job.missing.len()).unwrap_or(u32::MAX),
            allocated_bytes: None,
        };
        self.next_phase(slots, facts, plan, Phase::Picture);
        if plan.wanted == Wanted::Points {
            self.run_points(job, slots, &mut result)?;
        } else if plan.wanted == Wanted::Frame {
            if plan::is_made_in_bands(facts) {
                let mut wide = sums.wide;
                // Sets that no pass traced have no sums.
                wide.resize(facts.lights.beam_sets.len(), false);
                let traced = Traced {
                    wide: &wide,
                    is_current: wide.len() == 1 && comparison.is_none(),
                };
                self.run_bands(job, traced, slots, &mut result)?;
            } else {
                self.collect_map(facts, slots, &mut result)?;
            }
        }
        if let Some(comparison) = comparison {
            let time_ms = &mut result.time_ms;
            let differences = self.read_comparison(comparison, job, &comparing, slots, time_ms)?;
            result.accuracy = Some(AccuracyStats {
                estimated_error: collect::estimated_error(facts, &differences),
                chosen: None,
            });
        }
        Ok(result)
    }

    /// Runs the passes that run once, before any light.
    fn run_once(
        &mut self,
        job: Job<'_>,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        let passes = job.plan.graph.of(Scope::Frame);
        if passes.is_empty() {
            return Ok(());
        }
        let started = Recording::start(time_ms);
        let mut encoder = self.encoder("frame");
        self.record_all(&mut encoder, &passes, job.facts, Run::Frame, slots, time_ms)?;
        self.submit(encoder, started, time_ms)?;
        Ok(())
    }

    /// Traces all beam sets.
    fn run_beam_sets(
        &mut self,
        job: Job<'_>,
        comparison: &mut Option<Comparison>,
        comparing: &ComparisonPasses,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<BeamSetSums, RenderError> {
        let facts = job.facts;
        let mut all = BeamSetSums::default();
        // In the order of the list: passes that also run for coarse sets, and passes that do not.
        let passes: Vec<&'static Pass> = (job.plan.graph.passes.iter())
            .map(|(pass, _)| *pass)
            .filter(|pass| matches!(pass.steps.scope(), Scope::BeamSet | Scope::FineBeamSet))
            .collect();
        let maps = job.plan.graph.of(Scope::BeamSetMaps);
        let sets = if passes.is_empty() {
            0
        } else {
            facts.lights.beam_sets.len()
        };
        for index in 0..sets {
            check_cancelled(job.cancel)?;
            let field = facts.lights.beam_sets[index].field.as_ref();
            if field.is_some_and(|key| self.fields.contains(key)) {
                continue;
            }
            let reruns = self.wide_sum_reruns;
            // Only the comparison follows the last beam set.
            let next = comparison.as_mut().filter(|_| index + 1 == sets);
            let next = next.map(|comparison| (comparison, comparing));
            let passes = (passes.as_slice(), maps.as_slice());
            let sums = self.run_beam_set(facts, index, passes, next, slots, time_ms)?;
            if let (Some(key), Some(accounts)) = (field, sums.slice_accounts) {
                self.fields.built(key, accounts);
            }
            all.accounts.extend(sums.account);
            all.plane_counts.extend(sums.plane_counts);
            all.wide.push(sums.wide);
            if self.wide_sum_reruns > reruns {
                let light = facts.lights.beam_sets[index].light_index;
                all.widened.push(collect::widened(light));
            }
        }
        // The account of a kept field is kept with it. What falls through its lowest slice has landed.
        for set in &facts.lights.beam_sets {
            let accounts = set.field.as_ref().and_then(|key| self.fields.note(key));
            if let Some(accounts) = accounts {
                all.accounts
                    .extend(accounts.iter().take(ENERGY_TERMS as usize));
                all.slice_accounts.push(accounts.clone());
            }
        }
        Ok(all)
    }

    /// Traces one beam set and returns its raw account, and the counts of its planes if there are any. Flux sums are narrow where that is
    /// fine enough; if they wrap, the set is traced again with wide ones. Also submits `next` if it can be recorded while the GPU works on
    /// the set.
    fn run_beam_set(
        &mut self,
        facts: &SceneFacts,
        index: usize,
        (tracing, maps): (&[&'static Pass], &[&'static Pass]),
        mut next: Option<(&mut Comparison, &ComparisonPasses)>,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<RawSums, RenderError> {
        let energy = slots.held_buffer(&ENERGY);
        let planes = slots.held_buffer(&PLANE_COUNTS);
        let slices = slots.held_buffer(&SLICE_ENERGY);
        let mut wide_sums = light::needs_wide_sums(facts, index);
        loop {
            let run = Run::BeamSet(BeamSetRun { index, wide_sums });
            let started = Recording::start(time_ms);
            self.set_receivers(facts, index, slots);
            let mut encoder = self.encoder("light");
            slots.clear_for_beam_set(&mut encoder, facts, wide_sums);
            self.record_all(&mut encoder, tracing, facts, run, slots, time_ms)?;
            let staged = energy
                .map(|(buffer, _)| readback::stage(&self.gpu, &mut encoder, buffer, ACCOUNT_BYTES));
            let staged_counts = planes.map(|(buffer, _)| {
                let bytes = PLANE_COUNTS.bytes(facts);
                readback::stage(&self.gpu, &mut encoder, buffer, bytes)
            });
            let staged_slices = slices.map(|(buffer, _)| {
                let bytes = SLICE_ENERGY.bytes(facts);
                readback::stage(&self.gpu, &mut encoder, buffer, bytes)
            });
            let submitted = self.send(encoder, started, time_ms);
            let timed_so_far = self.timing.mark();
            let mut ahead = Vec::new();
            if self.runs_in_one_submission(maps, facts, run, slots)? {
                let mut encoder = self.encoder("light's maps");
                self.record_all(&mut encoder, maps, facts, run, slots, time_ms)?;
                ahead.push(encoder.finish());
                if let Some((comparison, passes)) = &mut next {
                    ahead.extend(self.record_comparison(comparison, facts, passes, slots)?);
                }
            }
            self.gpu.wait()?;
            time_ms.gpu += ms_since(submitted);
            let started = Instant::now();
            let account: Option<Vec<u64>> =
                staged.map(|staged| staged.read(&self.gpu)).transpose()?;
            let counts = staged_counts.map(|staged| staged.read(&self.gpu));
            let counts: Option<Vec<[u32; 4]>> = counts.transpose()?;
            let slice_accounts = staged_slices.map(|staged| staged.read(&self.gpu));
            let slice_accounts: Option<Vec<u64>> = slice_accounts.transpose()?;
            time_ms.readback += ms_since(started);
            // Without flux sums, what is missing in the account is the method's own.
            let has_sums = slots.held_buffer(&FLUX).is_some();
            let wrapped = |account: &Vec<u64>| has_sums && has_wrapped(facts, index, account);
            if !wide_sums && account.as_ref().is_some_and(wrapped) {
                self.wide_sum_reruns += 1;
                wide_sums = true;
                self.timing.forget_since(timed_so_far);
                if let Some((comparison, _)) = &mut next {
                    comparison.sent = None;
                }
                continue;
            }
            let sums = RawSums {
                account: account.unwrap_or_default(),
                plane_counts: counts,
                slice_accounts,
                wide: wide_sums,
            };
            // Sums are added to the maps only after it is known that they did not wrap.
            if ahead.is_empty() {
                let started = Recording::start(time_ms);
                let mut encoder = self.encoder("light's maps");
                self.record_all(&mut encoder, maps, facts, run, slots, time_ms)?;
                self.send(encoder, started, time_ms);
                return Ok(sums);
            }
            self.recorded_ahead += 1;
            timed(&mut time_ms.upload, || {
                let mut ahead = ahead.into_iter();
                self.gpu.queue.submit(ahead.next());
                for (coarse_set, commands) in ahead.enumerate() {
                    if let Some((comparison, _)) = &next {
                        self.set_receivers(&comparison.coarse, coarse_set, slots);
                    }
                    self.gpu.queue.submit([commands]);
                }
            });
            return Ok(sums);
        }
    }

    /// Whether passes can be recorded now and submitted later. That is impossible if one is cut into pieces or timed by the host, because
    /// then it runs while it is recorded.
    pub(super) fn runs_in_one_submission(
        &self,
        passes: &[&'static Pass],
        facts: &SceneFacts,
        run: Run<'_>,
        slots: &FrameSlots,
    ) -> Result<bool, RenderError> {
        if self.timing.times_by_host() {
            return Ok(false);
        }
        for pass in passes {
            let steps = steps_of(pass, facts, run)?;
            if steps.iter().any(|step| self.may_be_cut(step, slots)) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Renders the picture band by band (or the map, if the method computes irradiance at points).
    fn run_bands(
        &mut self,
        job: Job<'_>,
        traced: Traced<'_>,
        slots: &FrameSlots,
        result: &mut RunResult,
    ) -> Result<(), RenderError> {
        let facts = job.facts;
        let Some([width, height]) = size(facts) else {
            return Ok(());
        };
        (result.width, result.height) = (width, height);
        let mut view = collect::PointLayers::new(facts, width, height);
        let awaited = plan::awaited_layers(facts);
        let step = band_rows(width, height);
        for first_row in (0..height).step_by(step as usize) {
            let rows = step.min(height - first_row);
            let pixels = u64::from(width) * u64::from(rows);
            for sample in samples(facts) {
                check_cancelled(job.cancel)?;
                let started = Recording::start(&result.time_ms);
                let band = BandRun {
                    first_row,
                    rows,
                    offset: sample.offset,
                    sample_index: sample.index,
                    leg: sample.leg,
                };
                let mut encoder = self.encoder("band");
                let time_ms = &mut result.time_ms;
                self.record_band(&mut encoder, job, (band, traced), slots, time_ms)?;
                self.submit(encoder, started, &mut result.time_ms)?;
                let started = Instant::now();
                for &slot in &awaited {
                    let wanted = if *slot == RADIANCE {
                        sample.ends_radiance
                    } else {
                        sample.is_middle
                    };
                    if wanted {
                        let bytes = plan::bytes_per_point(slot) * pixels;
                        let band = readback::read(&self.gpu, slots.buffer(slot).0, bytes)?;
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

    /// Fills the points band by band, and reads them.
    fn run_points(
        &mut self,
        job: Job<'_>,
        slots: &FrameSlots,
        result: &mut RunResult,
    ) -> Result<(), RenderError> {
        let Some([width, height]) = size(job.facts) else {
            return Ok(());
        };
        (result.width, result.height) = (width, height);
        let step = band_rows(width, height);
        for first_row in (0..height).step_by(step as usize) {
            let band = BandRun {
                first_row,
                rows: step.min(height - first_row),
                offset: [0.0; 2],
                sample_index: 0,
                leg: 0,
            };
            let started = Recording::start(&result.time_ms);
            let mut encoder = self.encoder("points");
            let time_ms = &mut result.time_ms;
            let no_light = Traced {
                wide: &[],
                is_current: true,
            };
            self.record_band(&mut encoder, job, (band, no_light), slots, time_ms)?;
            self.submit(encoder, started, &mut result.time_ms)?;
            let bytes = size_of::<Point>() as u64 * u64::from(width) * u64::from(band.rows);
            let read: Vec<Point> = readback::read(&self.gpu, slots.buffer(&POINTS).0, bytes)?;
            result.points.extend(read);
        }
        Ok(())
    }

    /// Records the passes of a band. Passes per band and beam set run for each set; unless the slots still hold the only set, each is traced
    /// again for the band.
    fn record_band(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        job: Job<'_>,
        (band, traced): (BandRun, Traced<'_>),
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        let Job { facts, plan, .. } = job;
        let picture: Vec<&'static Pass> = (plan.graph.passes.iter())
            .map(|(pass, _)| *pass)
            .filter(|pass| Phase::of(pass.steps.scope()) == Phase::Picture)
            .collect();
        let per_set = plan.graph.of(Scope::BandBeamSet);
        for pass in picture {
            if pass.steps.scope() == Scope::Band {
                self.record_all(encoder, &[pass], facts, Run::Band(band), slots, time_ms)?;
                continue;
            }
            if pass.name != per_set[0].name {
                // The passes of a set are recorded together, with the first of them.
                continue;
            }
            for (index, &wide_sums) in traced.wide.iter().enumerate() {
                let set = BeamSetRun { index, wide_sums };
                if !traced.is_current {
                    // The recorded commands read the receivers of the previous set, so they are submitted first.
                    let recorded = std::mem::replace(encoder, self.encoder("band"));
                    self.gpu.queue.submit([recorded.finish()]);
                    self.set_receivers(facts, index, slots);
                    slots.clear_for_beam_set(encoder, facts, set.wide_sums);
                    let again = plan.graph.of(Scope::BeamSet);
                    self.record_all(encoder, &again, facts, Run::BeamSet(set), slots, time_ms)?;
                }
                let run = Run::BandBeamSet(band, set);
                self.record_all(encoder, &per_set, facts, run, slots, time_ms)?;
            }
        }
        Ok(())
    }

    fn collect_map(
        &mut self,
        facts: &SceneFacts,
        slots: &FrameSlots,
        result: &mut RunResult,
    ) -> Result<(), RenderError> {
        let map = collect::map_of(facts);
        (result.width, result.height) = (map.width, map.height);
        let texels = map.width as usize * map.height as usize;
        let mut values = vec![0.0_f32; 3 * texels];
        if let Some((buffer, _)) = slots.held_buffer(&IRRADIANCE) {
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
        if let (Some(key), true) = (&map.level_map, !facts.lights.beam_sets.is_empty()) {
            let arena = self.arena.as_ref().zip(self.level_maps.offset(key));
            if let Some((arena, offset)) = arena {
                let layer = facts.output.receiver_layer;
                cosines = Some(self.read_normals(arena, offset, key, layer)?);
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
        job: Job<'_>,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        let passes = job.plan.graph.of(Scope::LevelMap);
        if passes.is_empty() {
            return Ok(());
        }
        let lit = job.facts.lights.lit.iter();
        let boxes: BTreeMap<&LevelMapKey, &LevelBox> = lit
            .flat_map(|light| light.boxes.iter().flatten())
            .map(|level_box| (&level_box.key, level_box))
            .collect();
        for key in job.missing {
            check_cancelled(job.cancel)?;
            let started = Recording::start(time_ms);
            let (Some(level_box), Some(offset), Some(geometry)) = (
                boxes.get(key),
                self.level_maps.offset(key),
                self.geometry.in_use(),
            ) else {
                continue;
            };
            let place = geometry.place(&key.mesh);
            let level_map = LevelMapRun {
                level_box: (*level_box).clone(),
                arena_offset: u32::try_from(offset / 4).unwrap_or(u32::MAX),
                first_triangle: place.first_triangle,
                triangles: place.triangles,
            };
            let run = Run::LevelMap(&level_map);
            let mut encoder = self.encoder("level map");
            self.record_all(&mut encoder, &passes, job.facts, run, slots, time_ms)?;
            self.submit(encoder, started, time_ms)?;
            self.level_maps.built(key, ());
        }
        Ok(())
    }
}

/// Sums of a beam set.
struct RawSums {
    /// Its raw account; empty if no pass keeps one.
    account: Vec<u64>,
    plane_counts: Option<Vec<[u32; 4]>>,
    /// The raw account of each slice of its field, if it has one.
    slice_accounts: Option<Vec<u64>>,
    /// Whether its flux was summed in 64 bits.
    wide: bool,
}

/// The sums of all beam sets, one behind the other.
#[derive(Default)]
struct BeamSetSums {
    accounts: Vec<u64>,
    plane_counts: Vec<Vec<[u32; 4]>>,
    /// The raw accounts of the slices of each field.
    slice_accounts: Vec<Vec<u64>>,
    /// Whether the flux of each set was summed in 64 bits.
    wide: Vec<bool>,
    /// Warnings about sets that were traced again with wide sums.
    widened: Vec<crate::stats::Warning>,
}

/// How the beam sets were traced.
#[derive(Clone, Copy)]
struct Traced<'a> {
    /// Whether the flux of each set is summed in 64 bits.
    wide: &'a [bool],
    /// Whether the slots still hold the only set.
    is_current: bool,
}

/// One sample of the pixels of a band: one way of a ray through each pixel.
struct Sample {
    offset: [f64; 2],
    index: u32,
    /// See [`BandRun::leg`].
    leg: u32,
    /// Goes through the pixels' centres; the layers that are not averaged come from it.
    is_middle: bool,
    /// The radiance sum is complete after it.
    ends_radiance: bool,
}

/// The samples of a view: an even grid in the pixel, with all ways of each ray, and before it one through the pixel's centre if layers need
/// it.
fn samples(facts: &SceneFacts) -> Vec<Sample> {
    let side = if facts.output.wants(LayerName::Radiance) {
        facts.quality.pixel_samples
    } else {
        1
    };
    let legs = if facts.output.wants(LayerName::Radiance) {
        facts.legs().count()
    } else {
        1
    };
    let count = side * side * legs;
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
    let mut all: Vec<Sample> = (0..count)
        .map(|index| Sample {
            offset: [place(index / legs % side), place(index / legs / side)],
            index,
            leg: index % legs,
            is_middle: side == 1 && index == 0,
            ends_radiance: index + 1 == count,
        })
        .collect();
    let other_layers = facts
        .output
        .layers
        .iter()
        .any(|&layer| layer != LayerName::Radiance);
    if side > 1 && other_layers {
        all.insert(
            0,
            Sample {
                offset: [0.0; 2],
                index: 0,
                leg: 0,
                is_middle: true,
                ends_radiance: false,
            },
        );
    }
    all
}
