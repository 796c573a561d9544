//! Dispatches that may run long, piece by piece: each piece is submitted, waited for and timed, and sizes the next.

use std::time::Instant;

use tokio_util::sync::CancellationToken;

use super::buffers::FrameSlots;
use super::{RenderError, Renderer, ms_since};
use crate::gpu::pieces::{Piece, next_size};
use crate::gpu::readback;
use crate::stages::sums::FLUX;
use crate::stages::{Groups, Slot, Step, Work};

/// Workgroups that run in one go, and first piece of a larger dispatch: about what the largest GPUs hold at once (132 multiprocessors with 32
/// each), and as many as the vertices of 512 water cells need.
const FIRST_GROUPS: u64 = 4224;
/// The same of a dispatch that empties a queue: there a workgroup may have all texels of the maps to itself.
const FIRST_QUEUE_GROUPS: u64 = 256;
/// Words of a queue or of the flux sums up to which queues are emptied in one go: how many workgroups that takes only the GPU
/// knows, and asking costs a small frame more than it could save.
const SHORT_WORDS: u64 = 1 << 22;

fn words(slot: &Slot, slots: &FrameSlots) -> u64 {
    slots.buffer(slot).1 / 4
}

/// Whether a queue is emptied in one go.
fn is_short(queue: &Slot, slots: &FrameSlots) -> bool {
    words(queue, slots).max(words(&FLUX, slots)) <= SHORT_WORDS
}

/// How dispatches are cut, and what came of it.
#[derive(Debug, Default)]
pub(super) struct Cutting {
    /// Most workgroups of a piece, where that is asked for.
    pub(super) most_groups: Option<u64>,
    /// Pieces since the start.
    pub(super) pieces: u64,
    /// Time of the longest, ms.
    pub(super) longest_ms: f64,
    /// Time of pieces that no account has yet, ms.
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

impl Renderer {
    /// Whether a step's dispatch may be cut, so that it runs when it is recorded.
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

    /// The workgroups of a dispatch that is to be cut and the most of its first piece; `None` where it runs in one go. What is in
    /// `encoder` is submitted where the GPU has to be asked how many there are.
    pub(super) fn cut_of(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static str,
        groups: Groups,
        slots: &FrameSlots,
    ) -> Result<Option<([u32; 3], u64)>, RenderError> {
        let asked = self.cutting.most_groups;
        let (all, first) = match groups {
            Groups::Direct(all) => (all, FIRST_GROUPS),
            Groups::Queue(slot, _) => {
                if asked.is_none() && is_short(slot, slots) {
                    return Ok(None);
                }
                self.submit_now(encoder, pass)?;
                let read: Vec<u32> = readback::read(&self.gpu, &slots.indirect, 12)?;
                let all = <[u32; 3]>::try_from(read.as_slice()).unwrap_or_default();
                // As much to do as the full number has on the largest maps that are emptied in one go.
                let larger = words(&FLUX, slots).div_ceil(SHORT_WORDS).max(1);
                (all, (FIRST_QUEUE_GROUPS / larger).max(1))
            }
        };
        let first = asked.unwrap_or(first);
        let count: u64 = all.map(u64::from).iter().product();
        Ok((count > first).then_some((all, first)))
    }

    /// Runs a dispatch of `all` workgroups piece by piece, the first of `first` at most; `record` puts a piece into an encoder.
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
                Some(asked) => asked,
                None => next_size(piece.count(), ms),
            };
        }
        Ok(())
    }

    /// Submits what is recorded of a pass, waits for it, and starts over with an empty encoder; ms.
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
