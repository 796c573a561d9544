//! A frame's estimate of its own error: its beam sets are traced again with fewer cells, and their maps compared with the frame's maps. If
//! possible all of it is recorded while the GPU works on the last beam set, otherwise one beam set at a time.

use std::time::Instant;

use super::buffers::FrameSlots;
use super::collect::{ACCOUNT_BYTES, has_wrapped};
use super::commands::Recording;
use super::executor::Job;
use super::{RenderError, Renderer, check_cancelled, ms_since, timed};
use crate::facts::SceneFacts;
use crate::gpu::readback::{self, Staged};
use crate::graph::BeamSetRun;
use crate::stages::estimate::DIFFERENCES;
use crate::stages::sums::ENERGY;
use crate::stages::{Pass, Run, coarse_irradiance, estimate, light};
use crate::stats::TimeStats;

/// Passes of the comparison: those that make a coarse beam set's sums, those that read the sums, and those that compare.
pub(super) type ComparisonPasses = [Vec<&'static Pass>; 3];

/// The coarse beam sets that are compared with the frame's maps.
pub(super) struct Comparison {
    pub(super) coarse: SceneFacts,
    /// Whether each beam set's sums are wide.
    wide_sums: Vec<bool>,
    /// The submitted readbacks: the differences, and the account of each coarse beam set.
    pub(super) sent: Option<(Staged, Vec<Staged>)>,
}

impl Comparison {
    pub(super) fn new(facts: &SceneFacts) -> Self {
        let coarse = facts.coarse();
        let lights = 0..coarse.lights.beam_sets.len();
        Self {
            wide_sums: lights
                .map(|index| light::needs_wide_sums(&coarse, index))
                .collect(),
            coarse,
            sent: None,
        }
    }
}

impl Renderer {
    /// Records the coarse beam sets and their comparison with the maps, if that can be done ahead; else returns nothing. One command buffer
    /// per beam set: the caller must set its receivers before submitting it. The last one also compares.
    pub(super) fn record_comparison(
        &mut self,
        comparison: &mut Comparison,
        facts: &SceneFacts,
        [light, coarse_light, estimate]: &ComparisonPasses,
        slots: &FrameSlots,
    ) -> Result<Vec<wgpu::CommandBuffer>, RenderError> {
        let coarse = &comparison.coarse;
        let sets: Vec<(usize, bool)> = comparison.wide_sums.iter().copied().enumerate().collect();
        for &(index, wide_sums) in &sets {
            let set = BeamSetRun { index, wide_sums };
            let of_set = Run::BeamSet(set);
            let of_coarse = Run::CoarseBeamSet(set, facts);
            if !self.runs_in_one_submission(light, coarse, of_set, slots)?
                || !self.runs_in_one_submission(coarse_light, coarse, of_coarse, slots)?
            {
                return Ok(Vec::new());
            }
        }
        if !self.runs_in_one_submission(estimate, facts, Run::Estimate, slots)? {
            return Ok(Vec::new());
        }
        let passes = (light.as_slice(), coarse_light.as_slice());
        let mut nothing = TimeStats::default();
        let (mut recorded, mut accounts) = (Vec::new(), Vec::new());
        for &(index, wide_sums) in &sets {
            let mut encoder = self.encoder("light");
            slots.clear_for_beam_set(&mut encoder, coarse, wide_sums);
            accounts.push(self.record_coarse_light(
                &mut encoder,
                (coarse, facts),
                (index, wide_sums),
                passes,
                slots,
                &mut nothing,
            )?);
            if index + 1 == sets.len() {
                let differences = self.record_estimate(&mut encoder, estimate, facts, slots)?;
                comparison.sent = Some((differences, std::mem::take(&mut accounts)));
            }
            recorded.push(encoder.finish());
        }
        Ok(recorded)
    }

    /// Submits the coarse beam sets and the comparison with the maps without waiting; the frame's next readback waits for them.
    pub(super) fn send_comparison(
        &mut self,
        comparison: &mut Comparison,
        job: Job<'_>,
        [light, coarse_light, estimate]: &ComparisonPasses,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        let facts = job.facts;
        let coarse = &comparison.coarse;
        let mut started = Recording::start(time_ms);
        let (mut encoder, accounts) = self.coarse_lights(
            (coarse, facts),
            &comparison.wide_sums,
            (light, coarse_light),
            slots,
            job,
            time_ms,
        )?;
        let by_host = self.timing.times_by_host();
        if by_host {
            let lights = std::mem::replace(&mut encoder, self.encoder("estimate"));
            let began = started.at;
            self.submit(lights, started, time_ms)?;
            let name = coarse_irradiance::PASS.name;
            self.timing.note(name, ms_since(began));
            started = Recording::start(time_ms);
        }
        let differences = self.record_estimate(&mut encoder, estimate, facts, slots)?;
        if by_host {
            let ms = self.submit(encoder, started, time_ms)?;
            // If it ran in pieces, their time is noted already.
            self.timing.note(estimate::PASS.name, ms);
        } else {
            self.send(encoder, started, time_ms);
        }
        comparison.sent = Some((differences, accounts));
        Ok(())
    }

    /// Records the comparison of the maps with those of the coarse beam sets, and the readback of its result.
    fn record_estimate(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        passes: &[&'static Pass],
        facts: &SceneFacts,
        slots: &FrameSlots,
    ) -> Result<Staged, RenderError> {
        for pass in passes {
            self.record(encoder, pass, facts, Run::Estimate, slots)?;
        }
        let (differences, _) = slots.buffer(&DIFFERENCES);
        let bytes = DIFFERENCES.bytes(facts);
        Ok(readback::stage(&self.gpu, encoder, differences, bytes))
    }

    /// Reads the sums of the differences, one per workgroup. If an account shows that a coarse beam set's narrow sums wrapped, everything
    /// is submitted again with wide sums for that beam set.
    pub(super) fn read_comparison(
        &mut self,
        mut comparison: Comparison,
        job: Job<'_>,
        passes: &ComparisonPasses,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<Vec<[f32; 4]>, RenderError> {
        loop {
            let Some((differences, accounts)) = comparison.sent.take() else {
                let again = &mut comparison;
                self.send_comparison(again, job, passes, slots, time_ms)?;
                continue;
            };
            timed(&mut time_ms.gpu, || self.gpu.wait())?;
            let started = Instant::now();
            let differences = differences.read(&self.gpu)?;
            let mut have_wrapped = false;
            for (index, account) in accounts.into_iter().enumerate() {
                let account = account.read(&self.gpu)?;
                let wide_sums = &mut comparison.wide_sums[index];
                if !*wide_sums && has_wrapped(&comparison.coarse, index, &account) {
                    self.wide_sum_reruns += 1;
                    *wide_sums = true;
                    have_wrapped = true;
                }
            }
            time_ms.readback += ms_since(started);
            if !have_wrapped {
                return Ok(differences);
            }
        }
    }

    /// Records all coarse beam sets; each is submitted when the next one begins. Returns the encoder with the last one, and the accounts,
    /// which can be read once that encoder has run.
    fn coarse_lights(
        &mut self,
        (coarse, fine): (&SceneFacts, &SceneFacts),
        wide_sums: &[bool],
        (sums, maps): (&[&'static Pass], &[&'static Pass]),
        slots: &FrameSlots,
        job: Job<'_>,
        time_ms: &mut TimeStats,
    ) -> Result<(wgpu::CommandEncoder, Vec<Staged>), RenderError> {
        let mut recorded: Option<wgpu::CommandEncoder> = None;
        let mut accounts = Vec::new();
        for (index, &wide_sums) in wide_sums.iter().enumerate() {
            check_cancelled(job.cancel)?;
            // The next beam set's receivers overwrite the current ones, so the commands that read these must be submitted first.
            if let Some(light) = recorded.take() {
                self.gpu.queue.submit([light.finish()]);
            }
            self.set_receivers(coarse, index, slots);
            let mut encoder = self.encoder("light");
            slots.clear_for_beam_set(&mut encoder, coarse, wide_sums);
            accounts.push(self.record_coarse_light(
                &mut encoder,
                (coarse, fine),
                (index, wide_sums),
                (sums, maps),
                slots,
                time_ms,
            )?);
            recorded = Some(encoder);
        }
        let encoder = recorded.unwrap_or_else(|| self.encoder("estimate"));
        Ok((encoder, accounts))
    }

    /// Records a coarse beam set, timed as one pass, and the readback of its account.
    fn record_coarse_light(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (coarse, fine): (&SceneFacts, &SceneFacts),
        (index, wide_sums): (usize, bool),
        (sums, maps): (&[&'static Pass], &[&'static Pass]),
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<Staged, RenderError> {
        self.timing.group(Some(coarse_irradiance::PASS.name));
        let set = BeamSetRun { index, wide_sums };
        self.record_all(encoder, sums, coarse, Run::BeamSet(set), slots, time_ms)?;
        let run = Run::CoarseBeamSet(set, fine);
        self.record_all(encoder, maps, coarse, run, slots, time_ms)?;
        self.timing.group(None);
        let (energy, _) = slots.buffer(&ENERGY);
        Ok(readback::stage(&self.gpu, encoder, energy, ACCOUNT_BYTES))
    }
}
