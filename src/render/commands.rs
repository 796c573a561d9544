//! Dispatches, draws and submissions.

use std::time::Instant;

use super::buffers::FrameSlots;
use super::pieces::Batch;
use super::{RenderError, Renderer, ms_since};
use crate::facts::SceneFacts;
use crate::gpu::kernel::RasterTargets;
use crate::gpu::pieces::PIECE;
use crate::gpu::{Binding, GpuError};
use crate::graph::{Draw, View};
use crate::stages::light_field;
use crate::stages::sums::FLUX;
use crate::stages::{Caustica, Groups, Pass, Run, Step, Work};
use crate::stats::TimeStats;

/// Start of the recording of a submission.
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

/// The number of workgroups of a dispatch.
#[derive(Clone, Copy)]
enum Launch {
    /// A fixed number along each axis.
    Groups([u32; 3]),
    /// Read from the queue's head: an indirect dispatch.
    Counted,
}

impl Renderer {
    pub(super) fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }

    /// Submits and waits. Returns the time from the submission until all submitted work is done, ms, and adds it to `time_ms`, together
    /// with the time of earlier pieces.
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

    /// Submits without waiting, and returns the time of the submission. The next wait includes this work.
    pub(super) fn send(
        &mut self,
        encoder: wgpu::CommandEncoder,
        started: Recording,
        time_ms: &mut TimeStats,
    ) -> Instant {
        let commands = encoder.finish();
        // Passes timed by the host meanwhile, and pieces, count as GPU time, not as recording.
        time_ms.gpu += std::mem::take(&mut self.cutting.unaccounted_ms);
        time_ms.upload += ms_since(started.at) - (time_ms.gpu - started.gpu_ms);
        let submitted = Instant::now();
        self.gpu.queue.submit([commands]);
        submitted
    }

    /// If the host times passes: submits the recorded commands, waits, and starts a new encoder.
    pub(super) fn submit_if_timed(
        &mut self,
        pass: &Pass,
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

    /// Records passes one after the other; submits each if the host times them.
    pub(super) fn record_all(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        passes: &[&'static Pass],
        facts: &SceneFacts,
        run: Run<'_>,
        slots: &FrameSlots,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        for pass in passes {
            self.record(encoder, pass, facts, run, slots)?;
            self.submit_if_timed(pass, encoder, time_ms)?;
        }
        Ok(())
    }

    /// Records one run of a pass.
    pub(super) fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static Pass,
        facts: &SceneFacts,
        run: Run<'_>,
        slots: &FrameSlots,
    ) -> Result<(), RenderError> {
        // Passes that do not touch the sums use one kernel for both widths.
        let wide_sums = run.has_wide_sums() && pass.touches(&FLUX);
        let mut batch = light_field::is_made_by(pass).then(Batch::default);
        for step in steps_of(pass, facts, run)? {
            match &step.work {
                Work::Compute(groups) => {
                    self.dispatch(encoder, pass, facts, &step, (*groups, wide_sums), slots)?;
                }
                Work::Draw(draw) => self.draw(encoder, pass, &step, draw, slots)?,
            }
            if let Some(batch) = &mut batch {
                self.end_step(encoder, pass.name, batch)?;
            }
        }
        Ok(())
    }

    fn dispatch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static Pass,
        facts: &SceneFacts,
        step: &Step,
        (groups, wide_sums): (Groups, bool),
        slots: &FrameSlots,
    ) -> Result<(), RenderError> {
        if let Groups::Queue(queue, word) = groups {
            encoder.copy_buffer_to_buffer(
                slots.buffer(queue).0,
                4 * u64::from(word),
                &slots.indirect,
                0,
                12,
            );
        }
        let cut = self.cut_of(encoder, pass.name, groups, slots)?;
        let switch = |on: bool| f64::from(u8::from(on));
        let constants = [
            ("ATTENUATES", switch(facts.attenuates())),
            ("TROCHOIDS", switch(facts.water.surface.has_trochoids())),
            ("WAVE_GRIDS", switch(facts.water.surface.has_grids())),
            ("WIDE_SUMS", switch(wide_sums)),
            ("PLANES", switch(!facts.method.lights_meshes_by_hits)),
        ];
        let kernel = self.kernels.compute(
            &self.gpu,
            &self.sources,
            (pass.shader, step.entry),
            &constants,
            cut.is_some(),
        )?;
        let Some((all, first)) = cut else {
            let launch = match groups {
                Groups::Direct(all) => Launch::Groups(all),
                Groups::Queue(..) => Launch::Counted,
            };
            return Ok(self.launch(encoder, (pass, kernel), step, &[], launch, slots)?);
        };
        self.run_pieces(
            encoder,
            pass.name,
            (all, first),
            &mut |this, encoder, piece| {
                let uniform = bytemuck::bytes_of(&piece.uniform(all)).to_vec();
                let launch = Launch::Groups(piece.groups);
                let own = [(PIECE, uniform)];
                Ok(this.launch(encoder, (pass, kernel), step, &own, launch, slots)?)
            },
        )
    }

    /// Records a dispatch of a kernel; `more_uniforms` are added to those of the step.
    fn launch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        (pass, kernel): (&'static Pass, crate::gpu::kernels::KernelId),
        step: &Step,
        more_uniforms: &[(&'static str, Vec<u8>)],
        launch: Launch,
        slots: &FrameSlots,
    ) -> Result<(), GpuError> {
        let uniforms = self.place_uniforms(step.uniforms.iter().chain(more_uniforms));
        let views = views_of(step, slots);
        let kernel = self.kernels.kernel(kernel);
        let bound = kernel.bind(&self.gpu, &mut self.bind_groups, |name| {
            uniforms
                .find(name)
                .or_else(|| view(&views, name))
                .or_else(|| slots.binding(pass, name))
        })?;
        let timestamp_writes = self.timing.span(pass.name).map(|(query_set, begin, end)| {
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
            Launch::Counted => compute.dispatch_workgroups_indirect(&slots.indirect, 0),
        }
        Ok(())
    }

    /// Records a draw.
    fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static Pass,
        step: &Step,
        draw: &Draw<Caustica>,
        slots: &FrameSlots,
    ) -> Result<(), GpuError> {
        let kernel = self.kernels.raster(
            &self.gpu,
            &self.sources,
            (pass.shader, [step.entry, draw.fragment]),
            targets_of(draw, slots)?,
        )?;
        let uniforms = self.place_uniforms(step.uniforms.iter());
        let views = views_of(step, slots);
        let kernel = self.kernels.raster_kernel(kernel);
        let bound = kernel.bind(&self.gpu, &mut self.bind_groups, |name| {
            uniforms
                .find(name)
                .or_else(|| view(&views, name))
                .or_else(|| slots.binding(pass, name))
        })?;
        let timestamp_writes = self.timing.span(pass.name).map(|(query_set, begin, end)| {
            wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }
        });
        let mut colors = Vec::with_capacity(draw.colors.len());
        for color in &draw.colors {
            let view = slots.layer(color.slot, color.layer)?;
            colors.push((view, color.clear));
        }
        let colors: Vec<Option<wgpu::RenderPassColorAttachment<'_>>> = colors
            .iter()
            .map(|(view, clear)| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: clear.map_or(wgpu::LoadOp::Load, |[r, g, b, a]| {
                            wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a })
                        }),
                        store: wgpu::StoreOp::Store,
                    },
                })
            })
            .collect();
        let depth_view = match &draw.depth {
            Some(depth) => Some(slots.layer(depth.slot, 0)?),
            None => None,
        };
        let depth = draw.depth.as_ref().zip(depth_view.as_ref());
        let depth_stencil_attachment = depth.map(|(depth, view)| {
            let has_stencil = slots
                .format(depth.slot)
                .is_some_and(|format| format.has_stencil_aspect());
            wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: depth.clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: has_stencil.then_some(wgpu::Operations {
                    load: depth
                        .stencil_clear
                        .map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                    store: wgpu::StoreOp::Store,
                }),
            }
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(step.entry),
            color_attachments: &colors,
            depth_stencil_attachment,
            timestamp_writes,
            ..Default::default()
        });
        pass.set_pipeline(kernel.pipeline());
        pass.set_bind_group(0, &bound.group, &bound.offsets);
        if let Some([width, height]) = draw.viewport {
            pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        }
        pass.draw(0..draw.vertices, 0..draw.instances);
        Ok(())
    }
}

/// The steps of a run.
pub(super) fn steps_of(
    pass: &Pass,
    facts: &SceneFacts,
    run: Run<'_>,
) -> Result<Vec<Step>, RenderError> {
    pass.steps.of(facts, run).map_err(|wrong| {
        RenderError::Gpu(GpuError::Validation(format!(
            "pass `{}`: {wrong}",
            pass.name
        )))
    })
}

/// The texture views of a step's variables that are not named like their slots.
fn views_of(step: &Step, slots: &FrameSlots) -> Vec<(&'static str, wgpu::TextureView)> {
    let views = step.views.iter();
    views
        .filter_map(|view: &View<Caustica>| {
            Some((view.variable, slots.layer(view.slot, view.layer).ok()?))
        })
        .collect()
}

fn view<'a>(views: &'a [(&'static str, wgpu::TextureView)], name: &str) -> Option<Binding<'a>> {
    let found = views.iter().find(|(variable, _)| *variable == name);
    found.map(|(_, view)| Binding::Texture(view))
}

/// The pipeline state of a draw.
fn targets_of(draw: &Draw<Caustica>, slots: &FrameSlots) -> Result<RasterTargets, GpuError> {
    let format = |slot| {
        slots.format(slot).ok_or_else(|| {
            GpuError::Validation(format!("{slot:?} is a render target but not a texture"))
        })
    };
    let mut colors = Vec::with_capacity(draw.colors.len());
    for color in &draw.colors {
        colors.push(wgpu::ColorTargetState {
            format: format(color.slot)?,
            blend: color.blend,
            write_mask: wgpu::ColorWrites::ALL,
        });
    }
    let depth = match &draw.depth {
        Some(depth) => Some(wgpu::DepthStencilState {
            format: format(depth.slot)?,
            depth_write_enabled: Some(depth.writes),
            depth_compare: Some(depth.compare),
            stencil: depth.stencil.clone(),
            bias: wgpu::DepthBiasState::default(),
        }),
        None => None,
    };
    Ok(RasterTargets {
        colors,
        depth,
        primitive: wgpu::PrimitiveState {
            topology: draw.topology,
            cull_mode: draw.cull,
            ..wgpu::PrimitiveState::default()
        },
    })
}
