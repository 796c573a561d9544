//! Draws what lies nearest to a plane into its slice image.

use super::Renderer;
use super::buffers::FrameBuffers;
use crate::gpu::GpuError;
use crate::gpu::kernel::RasterTargets;
use crate::passes::desc::{PassDesc, Step};

impl Renderer {
    pub(super) fn draw_slice(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &'static PassDesc,
        step: &Step,
        (plane, texels, vertices): (u32, u32, u32),
        buffers: &FrameBuffers,
    ) -> Result<(), GpuError> {
        let Some(slices) = &buffers.slices else {
            return Ok(());
        };
        let kernel = self.kernels.raster(
            &self.gpu,
            &self.sources,
            (
                &format!("passes/{}.wgsl", pass.name),
                [step.entry, "slice_fragment"],
            ),
            RasterTargets {
                colors: &[wgpu::TextureFormat::Rgba8Unorm],
                depth: wgpu::TextureFormat::Depth32Float,
                depth_compare: wgpu::CompareFunction::Less,
            },
        )?;
        let uniforms = self.place_uniforms(step);
        let kernel = self.kernels.raster_kernel(kernel);
        let bound = kernel.bind(&self.gpu, &mut self.bind_groups, |name| {
            Some(uniforms.or_buffer(name, buffers))
        })?;
        let timestamp_writes = self.timing.span(pass.name).map(|(query_set, begin, end)| {
            wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(begin),
                end_of_pass_write_index: Some(end),
            }
        });
        let mut draw = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(step.entry),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &slices.colors[plane as usize],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &slices.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        });
        draw.set_pipeline(kernel.pipeline());
        draw.set_bind_group(0, &bound.group, &bound.offsets);
        // The images are as large as the largest object's.
        let side = texels as f32;
        draw.set_viewport(0.0, 0.0, side, side, 0.0, 1.0);
        draw.draw(0..vertices, 0..1);
        Ok(())
    }
}
