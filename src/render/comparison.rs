//! A frame's estimate of its own error: its lights done again coarsely, and compared with its maps; recorded while the GPU is at work on
//! the last light where that can be, else light by light.

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

/// Passes of a light that is done again coarsely: those that make its sums, those that take them, and those that compare.
pub(super) type ComparisonPasses = [Vec<&'static Pass>; 3];

/// The light done again coarsely, to be compared with the frame's maps.
pub(super) struct Comparison {
    pub(super) coarse: SceneFacts,
    /// Of each light, whether its sums are wide.
    wide_sums: Vec<bool>,
    /// The differences and the lights' accounts, on their way.
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
    /// Records the lights done again coarsely, and their comparison with the maps, if that can be done ahead: the commands of each light,
    /// whose receivers have to be set when they are submitted. The last ones also compare.
    pub(super) fn record_comparison(
        &mut self,
        comparison: &mut Comparison,
        facts: &SceneFacts,
        [light, coarse_light, estimate]: &ComparisonPasses,
        slots: &FrameSlots,
    ) -> Result<Vec<wgpu::CommandBuffer>, RenderError> {
        let coarse = &comparison.coarse;
        let in_turn: Vec<(usize, bool)> =
            comparison.wide_sums.iter().copied().enumerate().collect();
        for &(index, wide_sums) in &in_turn {
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
        for &(index, wide_sums) in &in_turn {
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
            if index + 1 == in_turn.len() {
                let differences = self.record_estimate(&mut encoder, estimate, facts, slots)?;
                comparison.sent = Some((differences, std::mem::take(&mut accounts)));
            }
            recorded.push(encoder.finish());
        }
        Ok(recorded)
    }

    /// Sends the lights done again coarsely, and the comparison with the maps, to the GPU. Nobody waits: what the frame reads next is
    /// what is waited for.
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
            // Where it ran in pieces, those are noted already.
            self.timing.note(estimate::PASS.name, ms);
        } else {
            self.send(encoder, started, time_ms);
        }
        comparison.sent = Some((differences, accounts));
        Ok(())
    }

    /// Records the comparison of the maps with those of the lights done coarsely, and the copy of what it gives.
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

    /// The sums of the differences, workgroup by workgroup. Where an account says that narrow sums of the coarse light wrapped, all of
    /// it goes once more, with wide ones there.
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

    /// Records all coarse lights, each of them submitted when the next begins: an encoder that ends with the last, and their accounts,
    /// which are there once that has run.
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
            // The next light's receivers take the place of this one's, so what reads those has to be on its way.
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

    /// Records a light done coarsely, all of it timed as one, and the copy of its account.
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
