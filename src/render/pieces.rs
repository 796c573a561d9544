//! Runs long dispatches piece by piece: each piece is submitted alone and timed, and its time sizes the next one.

use std::time::Instant;

use tokio_util::sync::CancellationToken;

use super::buffers::FrameSlots;
use super::{RenderError, Renderer, ms_since};
use crate::gpu::pieces::{Piece, next_size};
use crate::gpu::readback;
use crate::stages::sums::FLUX;
use crate::stages::{Groups, Slot, Step, Work};

/// Largest number of workgroups that run in one dispatch, and size of the first piece of a larger dispatch. About the number that the
/// largest GPUs hold at once (132 multiprocessors with 32 each), and as many as the vertices of 512 water cells need.
const FIRST_GROUPS: u64 = 4224;
/// The same for a dispatch that empties a queue: there one workgroup may have to write all texels of the maps.
const FIRST_QUEUE_GROUPS: u64 = 256;
/// Largest size of a queue or of the flux sums, in words, at which queues are emptied in one dispatch. Only the GPU knows the number of
/// workgroups of a queue, and reading it back costs a small frame more than it could save.
const SHORT_WORDS: u64 = 1 << 22;

fn words(slot: &Slot, slots: &FrameSlots) -> u64 {
    slots.buffer(slot).1 / 4
}

/// Whether a queue is emptied in one dispatch.
fn is_short(queue: &Slot, slots: &FrameSlots) -> bool {
    words(queue, slots).max(words(&FLUX, slots)) <= SHORT_WORDS
}

/// How dispatches are cut, and statistics of the pieces.
#[derive(Debug, Default)]
pub(super) struct Cutting {
    /// Largest number of workgroups of a piece, if it is fixed.
    pub(super) most_groups: Option<u64>,
    /// Number of pieces since the start.
    pub(super) pieces: u64,
    /// Time of the longest piece, ms.
    pub(super) longest_ms: f64,
    /// Time of pieces that is not yet in the frame's statistics, ms.
    pub(super) unaccounted_ms: f64,
    cancel: CancellationToken,
}

impl Cutting {
    pub(super) fn begin_frame(&mut self, cancel: &CancellationToken) {
        self.cancel = cancel.clone();
        self.unaccounted_ms = 0.0;
    }

    pub(super) fn forget(&mut self) {
        (self.pieces, self.longest_ms) = (0, 0.0);
    }
}

/// Steps of a long pass that are submitted together. Like pieces, they are timed, and their time sizes the next batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch {
    most: u64,
    recorded: u64,
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            most: 1,
            recorded: 0,
        }
    }
}

impl Renderer {
    /// Counts a recorded step of a long pass, and submits its batch if that is full.
    pub(super) fn end_step(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static str,
        batch: &mut Batch,
    ) -> Result<(), RenderError> {
        batch.recorded += 1;
        if batch.recorded < batch.most {
            return Ok(());
        }
        if self.cutting.cancel.is_cancelled() {
            return Err(RenderError::Cancelled);
        }
        let ms = self.submit_now(encoder, pass)?;
        *batch = Batch {
            most: next_size(batch.recorded, ms),
            recorded: 0,
        };
        Ok(())
    }

    /// Whether a step's dispatch may be cut into pieces, which run while they are recorded.
    pub(super) fn may_be_cut(&self, step: &Step, slots: &FrameSlots) -> bool {
        let Work::Compute(groups) = step.work else {
            return false;
        };
        match groups {
            Groups::Direct(all) => {
                let most = self.cutting.most_groups.unwrap_or(FIRST_GROUPS);
                all.map(u64::from).iter().product::<u64>() > most
            }
            Groups::Queue(slot, _) => self.cutting.most_groups.is_some() || !is_short(slot, slots),
        }
    }

    /// The number of workgroups of a dispatch that must be cut, and the largest number of its first piece; `None` if it runs in one
    /// dispatch. Submits the commands in `encoder` if the number has to be read back from the GPU.
    pub(super) fn cut_of(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static str,
        groups: Groups,
        slots: &FrameSlots,
    ) -> Result<Option<([u32; 3], u64)>, RenderError> {
        let fixed = self.cutting.most_groups;
        let (all, first) = match groups {
            Groups::Direct(all) => (all, FIRST_GROUPS),
            Groups::Queue(slot, _) => {
                if fixed.is_none() && is_short(slot, slots) {
                    return Ok(None);
                }
                self.submit_now(encoder, pass)?;
                let read: Vec<u32> = readback::read(&self.gpu, &slots.indirect, 12)?;
                let all = <[u32; 3]>::try_from(read.as_slice()).unwrap_or_default();
                // As much work as the full number has on the largest maps whose queues are emptied in one dispatch.
                let larger = words(&FLUX, slots).div_ceil(SHORT_WORDS).max(1);
                (all, (FIRST_QUEUE_GROUPS / larger).max(1))
            }
        };
        let first = fixed.unwrap_or(first);
        let count: u64 = all.map(u64::from).iter().product();
        Ok((count > first).then_some((all, first)))
    }

    /// Runs a dispatch of `all` workgroups piece by piece; the first piece has at most `first` of them. `record` records a piece.
    pub(super) fn run_pieces(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static str,
        (all, first): ([u32; 3], u64),
        record: &mut dyn FnMut(
            &mut Self,
            &mut wgpu::CommandEncoder,
            Piece,
        ) -> Result<(), RenderError>,
    ) -> Result<(), RenderError> {
        self.submit_now(encoder, pass)?;
        let mut most = first;
        let mut done = 0;
        while let Some(piece) = Piece::after(all, done, most) {
            if self.cutting.cancel.is_cancelled() {
                return Err(RenderError::Cancelled);
            }
            record(self, encoder, piece)?;
            let ms = self.submit_now(encoder, pass)?;
            self.cutting.pieces += 1;
            self.cutting.longest_ms = self.cutting.longest_ms.max(ms);
            done += piece.count();
            most = match self.cutting.most_groups {
                Some(fixed) => fixed,
                None => next_size(piece.count(), ms),
            };
        }
        Ok(())
    }

    /// Submits the recorded commands of a pass, waits for them, and starts a new encoder. Returns the time, ms.
    fn submit_now(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static str,
    ) -> Result<f64, RenderError> {
        let recorded = std::mem::replace(encoder, self.encoder("piece"));
        let submitted = Instant::now();
        self.gpu.queue.submit([recorded.finish()]);
        self.gpu.wait()?;
        let ms = ms_since(submitted);
        self.cutting.unaccounted_ms += ms;
        if self.timing.by_host() {
            self.timing.note(pass, ms);
        }
        Ok(ms)
    }
}
