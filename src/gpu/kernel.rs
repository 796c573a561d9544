//! Pipelines whose bindings are matched by name: the WGSL variable's name is the only place where a binding is named.

use std::collections::BTreeMap;

use super::pool::KEEP_FRAMES;
use super::shader::{Access, Module, Reflected, ShaderSources};
use super::uniforms::Placed;
use super::{GpuContext, GpuError};

/// Something to bind.
#[derive(Clone, Copy, Debug)]
pub enum Binding<'a> {
    /// A whole buffer.
    Buffer(&'a wgpu::Buffer),
    /// Constants, for a `var<uniform>`.
    Uniform(&'a Placed),
    /// A texture.
    Texture(&'a wgpu::TextureView),
}

/// What an entry point reads and writes, ready to be set at group 0.
#[derive(Clone, Debug)]
pub struct Bound {
    /// The group.
    pub group: wgpu::BindGroup,
    /// Where its uniforms begin, in the order of their bindings.
    pub offsets: Vec<u32>,
}

/// Bind groups by what they bind, kept from frame to frame as long as the [pool](super::BufferPool) keeps buffers: making one takes a
/// frame's host as long as all the rest of a dispatch. They keep their buffers alive, so whoever drops buffers earlier
/// [clears](Self::clear) them.
#[derive(Debug, Default)]
pub struct BindGroups {
    kept: BTreeMap<(wgpu::BindGroupLayout, Vec<wgpu::Buffer>), KeptGroup>,
    frame: u64,
    made: u64,
}

#[derive(Debug)]
struct KeptGroup {
    group: wgpu::BindGroup,
    last_used: u64,
}

impl BindGroups {
    /// Starts a frame: what was not used for some frames is dropped, no later than the buffers it binds.
    pub fn begin_frame(&mut self) {
        self.frame += 1;
        let frame = self.frame;
        self.kept
            .retain(|_, kept| kept.last_used + KEEP_FRAMES >= frame);
    }

    /// Drops all of them.
    pub fn clear(&mut self) {
        self.kept.clear();
    }

    /// How many were made since the start.
    pub fn made(&self) -> u64 {
        self.made
    }

    fn get(
        &mut self,
        layout: &wgpu::BindGroupLayout,
        buffers: Vec<wgpu::Buffer>,
        make: impl FnOnce() -> wgpu::BindGroup,
    ) -> wgpu::BindGroup {
        let made = &mut self.made;
        let kept = self
            .kept
            .entry((layout.clone(), buffers))
            .or_insert_with(|| {
                *made += 1;
                KeptGroup {
                    group: make(),
                    last_used: 0,
                }
            });
        kept.last_used = self.frame;
        kept.group.clone()
    }
}

/// A compute entry point, ready to run.
#[derive(Debug)]
pub struct Kernel {
    name: String,
    layout: BoundLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// Builds entry point `entry` of shader file `path` with values for `override` constants (those it does not have are skipped).
    pub fn new(
        gpu: &GpuContext,
        sources: &ShaderSources,
        path: &str,
        entry: &str,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, GpuError> {
        Self::from_text(gpu, path, sources.assemble(path)?, entry, constants)
    }

    /// The same for an entry point that runs in pieces and is told which: see [`super::pieces`].
    ///
    /// # Errors
    /// As [`Self::new`], and when the entry point cannot be cut.
    pub fn in_pieces(
        gpu: &GpuContext,
        sources: &ShaderSources,
        path: &str,
        entry: &str,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, GpuError> {
        let module = Module::parse(path, sources.assemble(path)?)?;
        let text = super::pieces::told_its_piece(&module, path, entry)?;
        Self::from_text(gpu, path, text, entry, constants)
    }

    /// The same from assembled WGSL; `path` is for messages.
    ///
    /// # Errors
    /// When the shader is not valid.
    pub fn from_text(
        gpu: &GpuContext,
        path: &str,
        text: String,
        entry: &str,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, GpuError> {
        let uniforms = uniforms_of(&text);
        let module = Module::parse(path, gpu.adapt(text))?;
        let layout = BoundLayout::new(
            gpu,
            path,
            (module.bindings(path, entry)?, &uniforms),
            wgpu::ShaderStages::COMPUTE,
        );
        let shader = shader_module(gpu, path, &module);
        let constants: Vec<(&str, f64)> = constants
            .iter()
            .copied()
            .filter(|(name, _)| module.has_override(name))
            .collect();
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout.pipeline_layout(gpu, entry)),
                module: &shader,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                cache: None,
            });
        gpu.check()?;
        Ok(Self {
            name: entry.to_owned(),
            layout,
            pipeline,
        })
    }

    /// What the kernel binds.
    pub fn bindings(&self) -> &[Reflected] {
        &self.layout.bindings
    }

    /// What `find` returns for each variable's name, bound; with a group of `groups` where that holds no textures.
    ///
    /// # Errors
    /// Where `find` has nothing for a variable, or a uniform for what is none, or none for one.
    pub fn bind<'a>(
        &self,
        gpu: &GpuContext,
        groups: &mut BindGroups,
        find: impl Fn(&str) -> Option<Binding<'a>>,
    ) -> Result<Bound, GpuError> {
        self.layout.bind(gpu, groups, &self.name, find)
    }

    /// The pipeline.
    pub fn pipeline(&self) -> &wgpu::ComputePipeline {
        &self.pipeline
    }
}

/// What a raster kernel draws into.
#[derive(Clone, Copy, Debug)]
pub struct RasterTargets<'a> {
    /// Colour formats in the order of the fragment's outputs.
    pub colors: &'a [wgpu::TextureFormat],
    /// Depth format.
    pub depth: wgpu::TextureFormat,
    /// Which fragment stays.
    pub depth_compare: wgpu::CompareFunction,
}

/// A vertex and a fragment entry point that draw triangles without vertex buffers.
#[derive(Debug)]
pub struct RasterKernel {
    name: String,
    layout: BoundLayout,
    pipeline: wgpu::RenderPipeline,
}

impl RasterKernel {
    /// Builds the pipeline of `vertex` and `fragment` of shader file `path`; both sides of triangles are drawn.
    pub fn new(
        gpu: &GpuContext,
        sources: &ShaderSources,
        path: &str,
        (vertex, fragment): (&str, &str),
        targets: &RasterTargets<'_>,
    ) -> Result<Self, GpuError> {
        let text = sources.assemble(path)?;
        let uniforms = uniforms_of(&text);
        let module = Module::parse(path, gpu.adapt(text))?;
        let mut bindings = module.bindings(path, vertex)?;
        for found in module.bindings(path, fragment)? {
            if !bindings.contains(&found) {
                bindings.push(found);
            }
        }
        bindings.sort_by_key(|b| b.binding);
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = BoundLayout::new(gpu, path, (bindings, &uniforms), stages);
        let shader = shader_module(gpu, path, &module);
        let colors: Vec<Option<wgpu::ColorTargetState>> = targets
            .colors
            .iter()
            .map(|&format| Some(format.into()))
            .collect();
        let pipeline = gpu
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(vertex),
                layout: Some(&layout.pipeline_layout(gpu, vertex)),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: targets.depth,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(targets.depth_compare),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &colors,
                }),
                multiview_mask: None,
                cache: None,
            });
        gpu.check()?;
        Ok(Self {
            name: vertex.to_owned(),
            layout,
            pipeline,
        })
    }

    /// What `find` returns for each variable's name, bound; with a group of `groups` where that holds no textures.
    ///
    /// # Errors
    /// Where `find` has nothing for a variable, or a uniform for what is none, or none for one.
    pub fn bind<'a>(
        &self,
        gpu: &GpuContext,
        groups: &mut BindGroups,
        find: impl Fn(&str) -> Option<Binding<'a>>,
    ) -> Result<Bound, GpuError> {
        self.layout.bind(gpu, groups, &self.name, find)
    }

    /// The pipeline.
    pub fn pipeline(&self) -> &wgpu::RenderPipeline {
        &self.pipeline
    }
}

fn shader_module(gpu: &GpuContext, path: &str, module: &Module) -> wgpu::ShaderModule {
    gpu.device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(path),
            source: wgpu::ShaderSource::Wgsl(module.text.as_str().into()),
        })
}

/// The names of a shader's uniforms, whatever an adapter [takes them for](GpuContext::adapt).
fn uniforms_of(text: &str) -> Vec<String> {
    let declared = text.split("var<uniform>").skip(1);
    let names = declared.filter_map(|rest| rest.split_once(':'));
    names.map(|(name, _)| name.trim().to_owned()).collect()
}

#[derive(Debug)]
struct BoundLayout {
    bindings: Vec<Reflected>,
    /// Of each binding, whether it is a uniform.
    are_uniforms: Vec<bool>,
    layout: wgpu::BindGroupLayout,
}

impl BoundLayout {
    fn new(
        gpu: &GpuContext,
        path: &str,
        (bindings, uniforms): (Vec<Reflected>, &[String]),
        stages: wgpu::ShaderStages,
    ) -> Self {
        let are_uniforms: Vec<bool> = bindings
            .iter()
            .map(|b| uniforms.contains(&b.name))
            .collect();
        let entries: Vec<wgpu::BindGroupLayoutEntry> = bindings
            .iter()
            .zip(&are_uniforms)
            .map(|(b, &is_uniform)| wgpu::BindGroupLayoutEntry {
                binding: b.binding,
                visibility: stages,
                ty: binding_type(b.access, is_uniform),
                count: None,
            })
            .collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(path),
                entries: &entries,
            });
        Self {
            bindings,
            are_uniforms,
            layout,
        }
    }

    fn pipeline_layout(&self, gpu: &GpuContext, label: &str) -> wgpu::PipelineLayout {
        gpu.device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &[Some(&self.layout)],
                ..Default::default()
            })
    }

    fn bind<'a>(
        &self,
        gpu: &GpuContext,
        groups: &mut BindGroups,
        name: &str,
        find: impl Fn(&str) -> Option<Binding<'a>>,
    ) -> Result<Bound, GpuError> {
        let fault = |message: String| GpuError::Shader {
            shader: name.to_owned(),
            message,
        };
        let mut found = Vec::with_capacity(self.bindings.len());
        let (mut buffers, mut offsets) = (Vec::with_capacity(self.bindings.len()), Vec::new());
        for (b, &is_uniform) in self.bindings.iter().zip(&self.are_uniforms) {
            let binding = find(&b.name)
                .ok_or_else(|| fault(format!("nothing is there to bind to `{}`", b.name)))?;
            if matches!(binding, Binding::Uniform(_)) != is_uniform {
                return Err(fault(format!("`{}` is bound to what it is not", b.name)));
            }
            match binding {
                Binding::Buffer(buffer) => buffers.push(buffer.clone()),
                Binding::Uniform(placed) => {
                    buffers.push(placed.buffer.clone());
                    offsets.push(placed.offset);
                }
                Binding::Texture(_) => {}
            }
            found.push(binding);
        }
        let make = || {
            let entries: Vec<wgpu::BindGroupEntry> = found
                .iter()
                .zip(&self.bindings)
                .map(|(found, b)| wgpu::BindGroupEntry {
                    binding: b.binding,
                    resource: resource(found),
                })
                .collect();
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(name),
                layout: &self.layout,
                entries: &entries,
            })
        };
        // Textures are made anew for each level map, so that a group with one would not be asked for again.
        let group = if buffers.len() == self.bindings.len() {
            groups.get(&self.layout, buffers, make)
        } else {
            make()
        };
        Ok(Bound { group, offsets })
    }
}

fn resource<'a>(binding: &Binding<'a>) -> wgpu::BindingResource<'a> {
    match *binding {
        Binding::Buffer(buffer) => buffer.as_entire_binding(),
        // Where in the buffer is said when it is set. The size is the variable's, so it is the same whenever the group serves.
        Binding::Uniform(placed) => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &placed.buffer,
            offset: 0,
            size: wgpu::BufferSize::new(placed.bytes),
        }),
        Binding::Texture(view) => wgpu::BindingResource::TextureView(view),
    }
}

fn binding_type(access: Access, is_uniform: bool) -> wgpu::BindingType {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: is_uniform,
        min_binding_size: None,
    };
    match access {
        Access::Uniform(_) => buffer(wgpu::BufferBindingType::Uniform),
        Access::StorageRead => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        Access::StorageWrite => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        Access::Texture(unsigned) => wgpu::BindingType::Texture {
            sample_type: if unsigned {
                wgpu::TextureSampleType::Uint
            } else {
                wgpu::TextureSampleType::Float { filterable: false }
            },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
    }
}
