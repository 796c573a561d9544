//! Runs a plan: buffers, uploads, dispatches, draws. What a pass does is all in its description.

use std::collections::BTreeMap;
use std::time::Instant;

use tokio_util::sync::CancellationToken;

use super::{RenderError, Renderer, RunResult, collect, geometry, ms_since, slot_name};
use crate::gpu::kernel::RasterTargets;
use crate::gpu::{Binding, GpuError, Kernel, RasterKernel, readback};
use crate::passes::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use crate::passes::gpu_data::{Receiver, Wave};
use crate::passes::level_map::EMPTY_DEPTH;
use crate::passes::slot::{ENERGY_TERMS, Lifetime, Slot, WIDE_GROUPS, band_rows};
use crate::passes::{self, light};
use crate::plan::{self, Plan};
use crate::scene::facts::SceneFacts;
use crate::scene::placement::LevelMapKey;
use crate::scene::{LayerName, ResolvedScene};
use crate::stats::TimeStats;

/// Bytes of one sun's energy account.
const ACCOUNT_BYTES: u64 = 8 * ENERGY_TERMS;

/// The buffers of one frame, by slot name.
pub(super) struct FrameBuffers {
    by_name: BTreeMap<&'static str, wgpu::Buffer>,
    empty: wgpu::Buffer,
    queue_heads: wgpu::Buffer,
    indirect: wgpu::Buffer,
}

impl FrameBuffers {
    /// The buffer of a slot; lists that hold nothing in this scene are one zero element.
    fn get(&self, name: &str) -> &wgpu::Buffer {
        self.by_name.get(name).unwrap_or(&self.empty)
    }
}

/// When the recording of a submission began.
#[derive(Clone, Copy)]
struct Recording {
    at: Instant,
    gpu_ms: f64,
}

impl Recording {
    fn start(time_ms: &TimeStats) -> Self {
        Self {
            at: Instant::now(),
            gpu_ms: time_ms.gpu,
        }
    }
}

/// Textures a level map is drawn into before it goes to the arena.
struct DrawTargets {
    front: wgpu::TextureView,
    back: wgpu::TextureView,
    normal: wgpu::TextureView,
    scratch_normal: wgpu::TextureView,
    depth: wgpu::TextureView,
}

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
        let peak_bytes = self.pool.peak_bytes()
            + self.arena.as_ref().map_or(0, wgpu::Buffer::size)
            + self.geometry.as_ref().map_or(0, geometry::Geometry::bytes);
        let FrameBuffers {
            by_name,
            empty,
            queue_heads,
            indirect,
        } = buffers;
        for (name, buffer) in by_name {
            if name != slot_name(Slot::Geometry) && name != slot_name(Slot::LevelMaps) {
                self.pool.give_back(buffer);
            }
        }
        for buffer in [empty, queue_heads, indirect] {
            self.pool.give_back(buffer);
        }
        result.map(|mut run| {
            run.peak_bytes = peak_bytes;
            run
        })
    }

    /// Lends the plan's buffers and uploads what the host provides.
    fn prepare(
        &mut self,
        resolved: &ResolvedScene,
        facts: &SceneFacts,
        plan: &Plan,
    ) -> Result<FrameBuffers, RenderError> {
        use wgpu::BufferUsages as U;
        let device = self.gpu.device.clone();
        let mut by_name = BTreeMap::new();
        for planned in &plan.slots {
            let Some(slot) = Slot::by_name(&planned.name) else {
                continue;
            };
            match slot {
                Slot::Geometry => {
                    if let Some(buffer) = self.geometry_buffer(resolved) {
                        by_name.insert(slot_name(slot), buffer);
                    }
                }
                Slot::LevelMaps => {
                    if facts.wet_objects().next().is_some() {
                        by_name.insert(slot_name(slot), self.arena_buffer());
                    }
                }
                _ => {
                    let usage = U::STORAGE | U::COPY_DST | U::COPY_SRC;
                    let buffer = self
                        .pool
                        .lend(&device, slot_name(slot), planned.bytes, usage);
                    by_name.insert(slot_name(slot), buffer);
                }
            }
        }
        let queue_heads = self
            .pool
            .lend(&device, "queue heads", 32, U::COPY_SRC | U::COPY_DST);
        let heads: [[u32; 4]; 2] = [[0, 1, 1, 0], [0, WIDE_GROUPS, 1, 0]];
        self.gpu
            .queue
            .write_buffer(&queue_heads, 0, bytemuck::cast_slice(&heads));
        let empty = self
            .pool
            .lend(&device, "empty list", 256, U::STORAGE | U::COPY_DST);
        self.gpu.queue.write_buffer(&empty, 0, &[0; 256]);
        let buffers = FrameBuffers {
            by_name,
            empty,
            queue_heads,
            indirect: self
                .pool
                .lend(&device, "indirect", 12, U::INDIRECT | U::COPY_DST),
        };
        self.upload(facts, &buffers);
        self.gpu.check()?;
        Ok(buffers)
    }

    fn upload(&self, facts: &SceneFacts, buffers: &FrameBuffers) {
        let write = |slot: Slot, bytes: &[u8]| {
            if let Some(buffer) = buffers.by_name.get(slot_name(slot)) {
                if !bytes.is_empty() {
                    self.gpu.queue.write_buffer(buffer, 0, bytes);
                }
            }
        };
        let waves: Vec<Wave> = facts
            .surface
            .components
            .iter()
            .map(|c| Wave {
                amplitude_m: c.amplitude_m as f32,
                frequency_x_per_m: c.frequency_per_m.x as f32,
                frequency_z_per_m: c.frequency_per_m.y as f32,
                phase_turns: c.phase_turns as f32,
            })
            .collect();
        write(Slot::Waves, bytemuck::cast_slice(&waves));
        if let Some(geometry) = &self.geometry {
            if buffers.by_name.contains_key(slot_name(Slot::Instances)) {
                write(
                    Slot::Instances,
                    bytemuck::cast_slice(&geometry.instances(facts)),
                );
            }
        }
        let all: Vec<Receiver> = (0..facts.suns.len())
            .flat_map(|sun| self.receivers(facts, sun))
            .collect();
        write(Slot::AllReceivers, bytemuck::cast_slice(&all));
    }

    fn receivers(&self, facts: &SceneFacts, sun: usize) -> Vec<Receiver> {
        light::receivers(facts, sun, |object| {
            let key = facts.suns[sun].boxes[object].as_ref().map(|b| &b.key);
            let offset = key
                .and_then(|key| self.level_maps.offset(key))
                .unwrap_or_default();
            u32::try_from(offset / 4).unwrap_or(u32::MAX)
        })
    }

    fn geometry_buffer(&mut self, resolved: &ResolvedScene) -> Option<wgpu::Buffer> {
        if resolved.meshes.is_empty() {
            return None;
        }
        if !self
            .geometry
            .as_ref()
            .is_some_and(|g| g.holds(&resolved.meshes))
        {
            self.geometry = Some(geometry::Geometry::upload(&self.gpu, &resolved.meshes));
        }
        self.geometry.as_ref().map(|g| g.buffer.clone())
    }

    fn arena_buffer(&mut self) -> wgpu::Buffer {
        let size = self.level_maps.stats().budget_bytes;
        self.arena
            .get_or_insert_with(|| {
                self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("level maps"),
                    size,
                    usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                })
            })
            .clone()
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
            self.build_level_maps(facts, &of(Repeat::LevelMap), missing, buffers, &mut time_ms)?;
        }
        let mut accounts = Vec::new();
        for sun in 0..if of(Repeat::Sun).is_empty() {
            0
        } else {
            facts.suns.len()
        } {
            check_cancelled(cancel)?;
            accounts.extend(self.run_sun(facts, sun, &of(Repeat::Sun), buffers, &mut time_ms)?);
        }
        let (energy, warnings) = collect::energy(facts, &accounts);
        let mut result = RunResult {
            width: 0,
            height: 0,
            layers: BTreeMap::new(),
            energy,
            warnings,
            time_ms,
            peak_bytes: 0,
        };
        if let Some(camera) = facts.camera {
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
            let started = Instant::now();
            self.collect_map(facts, buffers, &mut result)?;
            result.time_ms.readback += ms_since(started);
        }
        Ok(result)
    }

    /// Follows one sun and returns its raw account; with narrow flux sums where those are fine enough, and once more with wide
    /// ones if they wrapped.
    fn run_sun(
        &mut self,
        facts: &SceneFacts,
        index: usize,
        passes: &[&'static PassDesc],
        buffers: &FrameBuffers,
        time_ms: &mut TimeStats,
    ) -> Result<Vec<u64>, RenderError> {
        let Some(energy) = buffers.by_name.get(slot_name(Slot::Energy)) else {
            return Ok(Vec::new());
        };
        let mut account = Vec::new();
        let too_coarse = light::needs_wide_sums(facts, index);
        for wide_sums in [false, true].into_iter().skip(usize::from(too_coarse)) {
            let started = Recording::start(time_ms);
            if let Some(buffer) = buffers.by_name.get(slot_name(Slot::Receivers)) {
                self.gpu.queue.write_buffer(
                    buffer,
                    0,
                    bytemuck::cast_slice(&self.receivers(facts, index)),
                );
            }
            let mut encoder = self.encoder("sun's flux");
            clear_for_sun(&mut encoder, buffers);
            let (sums, rest): (Vec<&'static PassDesc>, Vec<&'static PassDesc>) = passes
                .iter()
                .copied()
                .partition(|pass| !pass.writes.contains(&Slot::Irradiance));
            for pass in sums {
                self.record(
                    &mut encoder,
                    pass,
                    facts,
                    Run::Sun { index, wide_sums },
                    buffers,
                    None,
                )?;
                self.submit_if_timed(pass, &mut encoder, time_ms)?;
            }
            self.submit(encoder, started, time_ms)?;
            let started = Instant::now();
            account = readback::read(&self.gpu, energy, ACCOUNT_BYTES)?;
            time_ms.readback += ms_since(started);
            if !wide_sums
                && light::has_wrapped(facts, index, collect::missing_m2(facts, index, &account))
            {
                self.wide_sum_reruns += 1;
                continue;
            }
            // Only sums that are known to be whole join the maps.
            let started = Recording::start(time_ms);
            let mut encoder = self.encoder("sun's maps");
            for pass in rest {
                self.record(
                    &mut encoder,
                    pass,
                    facts,
                    Run::Sun { index, wide_sums },
                    buffers,
                    None,
                )?;
                self.submit_if_timed(pass, &mut encoder, time_ms)?;
            }
            self.submit(encoder, started, time_ms)?;
            break;
        }
        Ok(account)
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
                for pass in passes {
                    self.record(&mut encoder, pass, facts, run, buffers, None)?;
                    self.submit_if_timed(pass, &mut encoder, &mut result.time_ms)?;
                }
                self.submit(encoder, started, &mut result.time_ms)?;
                let started = Instant::now();
                for slot in plan::awaited(facts) {
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
        &self,
        facts: &SceneFacts,
        buffers: &FrameBuffers,
        result: &mut RunResult,
    ) -> Result<(), RenderError> {
        let map = collect::map_of(facts);
        (result.width, result.height) = (map.width, map.height);
        let texels = map.width as usize * map.height as usize;
        let mut values = vec![0.0_f32; 3 * texels];
        if let Some(buffer) = buffers.by_name.get(slot_name(Slot::Irradiance)) {
            let all: Vec<f32> =
                readback::read(&self.gpu, buffer, 12 * (map.first_texel + texels as u64))?;
            values.copy_from_slice(&all[3 * map.first_texel as usize..][..3 * texels]);
        }
        let mut cosines = None;
        if let (Some(key), true) = (&map.level_map, !facts.suns.is_empty()) {
            let arena = self.arena.as_ref().zip(self.level_maps.offset(key));
            if let Some((arena, offset)) = arena {
                cosines = Some(self.read_normals(arena, offset, key)?);
            }
        }
        let layer = collect::finish_map(facts, &map, values, cosines.as_deref())?;
        result
            .layers
            .insert(LayerName::Irradiance, layer);
        Ok(())
    }

    /// Packed normals of a level map.
    fn read_normals(
        &self,
        arena: &wgpu::Buffer,
        offset: u64,
        key: &LevelMapKey,
    ) -> Result<Vec<u32>, GpuError> {
        let bytes = 4 * u64::from(key.texels) * u64::from(key.texels);
        let staging = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("normals"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.encoder("normals");
        encoder.copy_buffer_to_buffer(arena, offset + key.bytes() - bytes, &staging, 0, bytes);
        self.gpu.queue.submit([encoder.finish()]);
        readback::read(&self.gpu, &staging, bytes)
    }

    fn build_level_maps(
        &mut self,
        facts: &SceneFacts,
        passes: &[&'static PassDesc],
        missing: &[LevelMapKey],
        buffers: &FrameBuffers,
        time_ms: &mut TimeStats,
    ) -> Result<(), RenderError> {
        for key in missing {
            let started = Recording::start(time_ms);
            let found = facts
                .suns
                .iter()
                .flat_map(|sun| sun.boxes.iter().flatten())
                .find(|b| &b.key == key);
            let (Some(level_box), Some(offset), Some(geometry)) =
                (found, self.level_maps.offset(key), self.geometry.as_ref())
            else {
                continue;
            };
            let place = geometry.place(&key.mesh);
            let run = Run::LevelMap {
                level_box,
                arena_offset: u32::try_from(offset / 4).unwrap_or(u32::MAX),
                first_triangle: place.first_triangle,
                triangles: place.triangles,
            };
            let targets = self.draw_targets(key.texels);
            let mut encoder = self.encoder("level map");
            for pass in passes {
                self.record(&mut encoder, pass, facts, run, buffers, Some(&targets))?;
                self.submit_if_timed(pass, &mut encoder, time_ms)?;
            }
            self.submit(encoder, started, time_ms)?;
        }
        Ok(())
    }

    fn draw_targets(&self, texels: u32) -> DrawTargets {
        let texture = |label, format| {
            self.gpu
                .device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some(label),
                    size: wgpu::Extent3d {
                        width: texels,
                        height: texels,
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                        | wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                })
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        DrawTargets {
            front: texture("front depth", wgpu::TextureFormat::R32Float),
            back: texture("back depth", wgpu::TextureFormat::R32Float),
            normal: texture("front normal", wgpu::TextureFormat::R32Uint),
            scratch_normal: texture("back normal", wgpu::TextureFormat::R32Uint),
            depth: texture("depth", wgpu::TextureFormat::Depth32Float),
        }
    }

    fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }

    fn submit(
        &self,
        encoder: wgpu::CommandEncoder,
        started: Recording,
        time_ms: &mut TimeStats,
    ) -> Result<(), GpuError> {
        let commands = encoder.finish();
        // Passes that the host timed on the way are GPU time, not recording.
        time_ms.upload += ms_since(started.at) - (time_ms.gpu - started.gpu_ms);
        let submitted = Instant::now();
        self.gpu.queue.submit([commands]);
        self.gpu.wait()?;
        time_ms.gpu += ms_since(submitted);
        Ok(())
    }

    /// Where the host times passes: submits what is recorded, waits, and starts over with an empty encoder.
    fn submit_if_timed(
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

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        facts: &SceneFacts,
        run: Run<'_>,
        buffers: &FrameBuffers,
        targets: Option<&DrawTargets>,
    ) -> Result<(), GpuError> {
        let wide_sums = matches!(
            run,
            Run::Sun {
                wide_sums: true,
                ..
            }
        );
        for step in (pass.steps)(facts, run) {
            match step.work {
                Work::Compute(groups) => self.dispatch(
                    encoder,
                    pass,
                    facts,
                    &step,
                    (groups, wide_sums),
                    buffers,
                    targets,
                )?,
                Work::DrawLevelMap { back, vertices } => {
                    if let Some(targets) = targets {
                        self.draw(encoder, pass, &step, (back, vertices), buffers, targets)?;
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
    fn dispatch(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        facts: &SceneFacts,
        step: &Step,
        (groups, wide_sums): (Groups, bool),
        buffers: &FrameBuffers,
        targets: Option<&DrawTargets>,
    ) -> Result<(), GpuError> {
        let key = (pass.name, step.entry, facts.attenuates(), wide_sums);
        if !self.kernels.contains_key(&key) {
            let path = format!("passes/{}.wgsl", pass.name);
            let switch = |on: bool| f64::from(u8::from(on));
            let constants = [
                ("ATTENUATES", switch(facts.attenuates())),
                ("WIDE_SUMS", switch(wide_sums)),
            ];
            let kernel = Kernel::new(&self.gpu, &self.sources, &path, step.entry, &constants)?;
            self.kernels.insert(key, kernel);
        }
        let kernel = &self.kernels[&key];
        let uniforms = self.uniform_buffers(step);
        let group = kernel.bind(&self.gpu, |name| match name {
            "front_depth" => targets.map(|t| Binding::Texture(&t.front)),
            "back_depth" => targets.map(|t| Binding::Texture(&t.back)),
            "front_normal" => targets.map(|t| Binding::Texture(&t.normal)),
            _ => Some(Binding::Buffer(
                uniforms.get(name).unwrap_or_else(|| buffers.get(name)),
            )),
        })?;
        if let Groups::Queue(slot) = groups {
            encoder.copy_buffer_to_buffer(
                buffers.get(slot_name(slot)),
                0,
                &buffers.indirect,
                0,
                12,
            );
        }
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
        compute.set_bind_group(0, &group, &[]);
        match groups {
            Groups::Direct([x, y, z]) => compute.dispatch_workgroups(x, y, z),
            Groups::Queue(_) => compute.dispatch_workgroups_indirect(&buffers.indirect, 0),
        }
        Ok(())
    }

    fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        step: &Step,
        (back, vertices): (bool, u32),
        buffers: &FrameBuffers,
        targets: &DrawTargets,
    ) -> Result<(), GpuError> {
        if !self.raster_kernels.contains_key(&back) {
            let kernel = RasterKernel::new(
                &self.gpu,
                &self.sources,
                &format!("passes/{}.wgsl", pass.name),
                (step.entry, "level_map_fragment"),
                &RasterTargets {
                    colors: &[wgpu::TextureFormat::R32Float, wgpu::TextureFormat::R32Uint],
                    depth: wgpu::TextureFormat::Depth32Float,
                    depth_compare: if back {
                        wgpu::CompareFunction::Greater
                    } else {
                        wgpu::CompareFunction::Less
                    },
                },
            )?;
            self.raster_kernels.insert(back, kernel);
        }
        let kernel = &self.raster_kernels[&back];
        let uniforms = self.uniform_buffers(step);
        let group = kernel.bind(&self.gpu, |name| {
            Some(Binding::Buffer(
                uniforms.get(name).unwrap_or_else(|| buffers.get(name)),
            ))
        })?;
        let (color, normal) = if back {
            (&targets.back, &targets.scratch_normal)
        } else {
            (&targets.front, &targets.normal)
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
        draw.set_bind_group(0, &group, &[]);
        draw.draw(0..vertices, 0..1);
        Ok(())
    }

    fn uniform_buffers(&self, step: &Step) -> BTreeMap<&'static str, wgpu::Buffer> {
        step.uniforms
            .iter()
            .map(|(name, bytes)| {
                let buffer = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(name),
                    size: bytes.len() as u64,
                    usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                });
                self.gpu.queue.write_buffer(&buffer, 0, bytes);
                (*name, buffer)
            })
            .collect()
    }
}

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

fn check_cancelled(cancel: &CancellationToken) -> Result<(), RenderError> {
    if cancel.is_cancelled() {
        Err(RenderError::Cancelled)
    } else {
        Ok(())
    }
}

/// Empties sums and queues before a sun's turn.
fn clear_for_sun(encoder: &mut wgpu::CommandEncoder, buffers: &FrameBuffers) {
    for (name, buffer) in &buffers.by_name {
        let Some(info) = Slot::by_name(name).map(Slot::info) else {
            continue;
        };
        if info.is_queue {
            let head = if *name == slot_name(Slot::WideQueue) {
                16
            } else {
                0
            };
            encoder.copy_buffer_to_buffer(&buffers.queue_heads, head, buffer, 0, 16);
        } else if info.lifetime == Lifetime::Sun
            && (*name == slot_name(Slot::Flux) || *name == slot_name(Slot::Energy))
        {
            encoder.clear_buffer(buffer, 0, None);
        }
    }
}
