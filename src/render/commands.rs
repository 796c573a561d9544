//! Dispatches, draws and submissions.

use std::collections::BTreeMap;
use std::time::Instant;

use super::buffers::{DrawTargets, FrameBuffers};
use super::{RenderError, Renderer, ms_since, slot_name};
use crate::facts::SceneFacts;
use crate::gpu::kernel::RasterTargets;
use crate::gpu::kernels::KernelId;
use crate::gpu::pieces::PIECE;
use crate::gpu::shader::Access;
use crate::gpu::{Binding, GpuError};
use crate::passes::desc::{Groups, PassDesc, Run, Step, Surface, Work};
use crate::passes::level_map::EMPTY_DEPTH;
use crate::passes::slot::Slot;
use crate::stats::TimeStats;

/// When the recording of a submission began.
#[derive(Clone, Copy)]
pub(super) struct Recording {
    pub(super) at: Instant,
    pub(super) gpu_ms: f64,
}

impl Recording {
    pub(super) fn start(time_ms: &TimeStats) -> Self {
        Self {
            at: Instant::now(),
            gpu_ms: time_ms.gpu,
        }
    }
}

/// How many workgroups a dispatch runs.
#[derive(Clone, Copy)]
enum Launch {
    /// These.
    Groups([u32; 3]),
    /// As many as the queue has said.
    Counted,
}

impl Renderer {
    pub(super) fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }

    /// Submits and waits; ms from then until all that was submitted so far is done, which `time_ms` gets besides those of the pieces
    /// before it.
    pub(super) fn submit(
        &mut self,
        encoder: wgpu::CommandEncoder,
        started: Recording,
        time_ms: &mut TimeStats,
    ) -> Result<f64, GpuError> {
        let submitted = self.send(encoder, started, time_ms);
        self.gpu.wait()?;
        let ms = ms_since(submitted);
        time_ms.gpu += ms;
        Ok(ms)
    }

    /// Submits and goes on; when it was sent. What waits next waits for it too.
    pub(super) fn send(
        &mut self,
        encoder: wgpu::CommandEncoder,
        started: Recording,
        time_ms: &mut TimeStats,
    ) -> Instant {
        let commands = encoder.finish();
        // Passes that the host timed on the way, and pieces, are GPU time, not recording.
        time_ms.gpu += std::mem::take(&mut self.cutting.unaccounted_ms);
        time_ms.upload += ms_since(started.at) - (time_ms.gpu - started.gpu_ms);
        let submitted = Instant::now();
        self.gpu.queue.submit([commands]);
        submitted
    }

    /// Where the host times passes: submits what is recorded, waits, and starts over with an empty encoder.
    pub(super) fn submit_if_timed(
        &mut self,
        pass: &'static PassDesc,
        encoder: &mut wgpu::CommandEncoder,
        time_ms: &mut TimeStats,
    ) -> Result<(), GpuError> {
        if !self.timing.by_host() {
            return Ok(());
        }
        let recorded = std::mem::replace(encoder, self.encoder("timed pass"));
        let submitted = Instant::now();
        self.gpu.queue.submit([recorded.finish()]);
        self.gpu.wait()?;
        let ms = ms_since(submitted);
        time_ms.gpu += ms;
        self.timing.note(pass.name, ms);
        Ok(())
    }

    pub(super) fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        facts: &SceneFacts,
        run: Run<'_>,
        buffers: &FrameBuffers,
        targets: Option<&DrawTargets>,
    ) -> Result<(), RenderError> {
        // What has nothing to do with the sums is one kernel for both.
        let sums = pass.reads.iter().chain(pass.writes);
        let wide_sums = matches!(run, Run::Light { wide_sums, .. } | Run::CoarseLight { wide_sums, .. } if wide_sums)
            && sums.into_iter().any(|&slot| slot == Slot::Flux);
        for step in (pass.steps)(facts, run) {
            match step.work {
                Work::Compute(groups) => self.dispatch(
                    encoder,
                    pass,
                    facts,
                    &step,
                    (groups, wide_sums),
                    buffers,
                    &|name| targets.and_then(|t| t.by_name(name, 0)),
                )?,
                Work::StoreLayer { layer, groups } => self.dispatch(
                    encoder,
                    pass,
                    facts,
                    &step,
                    (Groups::Direct(groups), wide_sums),
                    buffers,
                    &|name| targets.and_then(|t| t.by_name(name, layer)),
                )?,
                Work::OverSlice { groups, plane } => self.dispatch(
                    encoder,
                    pass,
                    facts,
                    &step,
                    (Groups::Direct(groups), wide_sums),
                    buffers,
                    &|name| (name == "slice").then(|| buffers.slice(plane)).flatten(),
                )?,
                Work::DrawSlice {
                    plane,
                    texels,
                    vertices,
                } => self.draw_slice(encoder, pass, &step, (plane, texels, vertices), buffers)?,
                Work::DrawLevelMap { surface, vertices } => {
                    if let Some(targets) = targets {
                        let drawn = (surface, vertices);
                        self.draw(encoder, pass, &step, drawn, buffers, targets)?;
                    }
                }
            }
        }
        Ok(())
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one call site; a struct would only rename them"
    )]
    pub(super) fn dispatch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        facts: &SceneFacts,
        step: &Step,
        (groups, wide_sums): (Groups, bool),
        buffers: &FrameBuffers,
        texture: &dyn Fn(&str) -> Option<wgpu::TextureView>,
    ) -> Result<(), RenderError> {
        let queue = match groups {
            Groups::Direct(_) => None,
            Groups::Queue(slot) => Some((slot, 0)),
            Groups::QueueAt(slot, word) => Some((slot, word)),
        };
        if let Some((slot, word)) = queue {
            encoder.copy_buffer_to_buffer(
                buffers.get(slot_name(slot)),
                4 * u64::from(word),
                &buffers.indirect,
                0,
                12,
            );
        }
        let cut = self.cut_of(encoder, pass.name, groups, buffers)?;
        let switch = |on: bool| f64::from(u8::from(on));
        let kernel = self.kernels.compute(
            &self.gpu,
            &self.sources,
            (&format!("passes/{}.wgsl", pass.name), step.entry),
            &[
                ("ATTENUATES", switch(facts.attenuates())),
                ("WIDE_SUMS", switch(wide_sums)),
                ("PLANES", switch(facts.quality.has_planes())),
            ],
            cut.is_some(),
        )?;
        let key = (pass.name, kernel);
        let Some((all, first)) = cut else {
            let launch = match groups {
                Groups::Direct(all) => Launch::Groups(all),
                Groups::Queue(_) | Groups::QueueAt(..) => Launch::Counted,
            };
            return Ok(self.launch(encoder, key, step, launch, buffers, texture)?);
        };
        self.run_pieces(
            encoder,
            pass.name,
            (all, first),
            &mut |this, encoder, piece| {
                let mut told = step.clone();
                let uniform = bytemuck::bytes_of(&piece.uniform(all)).to_vec();
                told.uniforms.push((PIECE, uniform));
                let launch = Launch::Groups(piece.groups);
                Ok(this.launch(encoder, key, &told, launch, buffers, texture)?)
            },
        )
    }

    /// Records a dispatch of a kernel that is there.
    fn launch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (pass, kernel): (&'static str, KernelId),
        step: &Step,
        launch: Launch,
        buffers: &FrameBuffers,
        texture: &dyn Fn(&str) -> Option<wgpu::TextureView>,
    ) -> Result<(), GpuError> {
        let uniforms = self.place_uniforms(step);
        let kernel = self.kernels.kernel(kernel);
        let textures: BTreeMap<&str, wgpu::TextureView> = kernel
            .bindings()
            .iter()
            .filter(|bound| matches!(bound.access, Access::Texture(_)))
            .filter_map(|bound| Some((bound.name.as_str(), texture(&bound.name)?)))
            .collect();
        let bound = kernel.bind(&self.gpu, &mut self.bind_groups, |name| {
            let texture = textures.get(name).map(Binding::Texture);
            texture.or_else(|| Some(uniforms.or_buffer(name, buffers)))
        })?;
        let timestamp_writes = self.timing.span(pass).map(|(query_set, begin, end)| {
            wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }
        });
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(step.entry),
            timestamp_writes,
        });
        compute.set_pipeline(kernel.pipeline());
        compute.set_bind_group(0, &bound.group, &bound.offsets);
        match launch {
            Launch::Groups([x, y, z]) => compute.dispatch_workgroups(x, y, z),
            Launch::Counted => compute.dispatch_workgroups_indirect(&buffers.indirect, 0),
        }
        Ok(())
    }

    pub(super) fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        step: &Step,
        (surface, vertices): (Surface, u32),
        buffers: &FrameBuffers,
        targets: &DrawTargets,
    ) -> Result<(), GpuError> {
        let back = surface == Surface::Back;
        let fragment = match surface {
            Surface::Front | Surface::Back => "level_map_fragment",
            Surface::Layer(_) => "level_map_behind",
        };
        let kernel = self.kernels.raster(
            &self.gpu,
            &self.sources,
            (
                &format!("passes/{}.wgsl", pass.name),
                [step.entry, fragment],
            ),
            RasterTargets {
                colors: &[wgpu::TextureFormat::R32Float, wgpu::TextureFormat::R32Uint],
                depth: wgpu::TextureFormat::Depth32Float,
                depth_compare: if back {
                    wgpu::CompareFunction::Greater
                } else {
                    wgpu::CompareFunction::Less
                },
            },
        )?;
        let uniforms = self.place_uniforms(step);
        let kernel = self.kernels.raster_kernel(kernel);
        let groups = &mut self.bind_groups;
        let bound = kernel.bind(&self.gpu, groups, |name| match (name, surface) {
            ("previous_depth", Surface::Layer(1)) => Some(Binding::Texture(&targets.front)),
            ("previous_depth", Surface::Layer(layer)) => further(targets, layer - 1, 0),
            _ => Some(uniforms.or_buffer(name, buffers)),
        })?;
        let (color, normal) = match surface {
            Surface::Front => (&targets.front, &targets.normal),
            Surface::Back => (&targets.back, &targets.scratch_normal),
            Surface::Layer(layer) => {
                let [depth, normal] = &targets.layers[layer as usize - 1];
                (depth, normal)
            }
        };
        let clear = |value: f64| wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color {
                r: value,
                ..wgpu::Color::default()
            }),
            store: wgpu::StoreOp::Store,
        };
        let attachment = |view, value| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: clear(value),
            })
        };
        let timestamp_writes = self.timing.span(pass.name).map(|(query_set, begin, end)| {
            wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }
        });
        let mut draw = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(step.entry),
            color_attachments: &[
                attachment(color, if back { -EMPTY_DEPTH } else { EMPTY_DEPTH }),
                attachment(normal, 0.0),
            ],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(if back { 0.0 } else { 1.0 }),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        });
        draw.set_pipeline(kernel.pipeline());
        draw.set_bind_group(0, &bound.group, &bound.offsets);
        draw.draw(0..vertices, 0..1);
        Ok(())
    }
}

/// Depth (0) or normal (1) of a further layer.
fn further(targets: &DrawTargets, layer: u32, which: usize) -> Option<Binding<'_>> {
    let layer = targets.layers.get((layer as usize).checked_sub(1)?)?;
    Some(Binding::Texture(&layer[which]))
}
