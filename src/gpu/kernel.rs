//! Pipelines whose bindings are matched by name: a binding is declared only once, by the name of its WGSL variable.

use super::bind_groups::{BindGroups, Binding, Bound};
use super::shader::{Access, Module, Reflected};
use super::{GpuContext, GpuError};

/// A compute entry point, ready to run.
#[derive(Debug)]
pub struct Kernel {
    name: String,
    layout: BoundLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// Builds entry point `entry` of `module`, which was assembled from shader file `path`. `constants` sets values of
    /// `override` constants; each of them must exist in the module.
    ///
    /// # Errors
    /// When there is no such entry point, or the device refuses it.
    pub fn new(
        gpu: &GpuContext,
        path: &str,
        module: &Module,
        entry: &str,
        constants: &[(&str, f64)],
    ) -> Result<Self, GpuError> {
        let layout = BoundLayout::new(
            gpu,
            path,
            module.bindings(path, entry)?,
            wgpu::ShaderStages::COMPUTE,
        );
        let shader = shader_module(gpu, path, module);
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout.pipeline_layout(gpu, entry)),
                module: &shader,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants,
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

    /// Like [`Self::new`], from assembled WGSL; `path` is for messages.
    ///
    /// # Errors
    /// When the shader is not valid.
    pub fn from_text(
        gpu: &GpuContext,
        path: &str,
        text: String,
        entry: &str,
        constants: &[(&str, f64)],
    ) -> Result<Self, GpuError> {
        Self::new(gpu, path, &Module::parse(path, text)?, entry, constants)
    }

    /// The resources that the kernel binds.
    pub fn bindings(&self) -> &[Reflected] {
        &self.layout.bindings
    }

    /// Binds the resource that `find` returns for each variable's name. Uses a cached group of `groups` if there are no textures.
    ///
    /// # Errors
    /// When `find` has no resource for a variable, or one of another kind.
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

/// Targets and fixed-function state of a raster kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterTargets {
    /// Format and blending of each output of the fragment.
    pub colors: Vec<wgpu::ColorTargetState>,
    /// Depth and stencil test.
    pub depth: Option<wgpu::DepthStencilState>,
    /// Topology and culling.
    pub primitive: wgpu::PrimitiveState,
}

/// A vertex and a fragment entry point that draw without vertex buffers.
#[derive(Debug)]
pub struct RasterKernel {
    name: String,
    layout: BoundLayout,
    pipeline: wgpu::RenderPipeline,
}

impl RasterKernel {
    /// Builds the pipeline of a vertex and a fragment entry point of `module`, which was assembled from shader file `path`.
    ///
    /// # Errors
    /// When there are no such entry points, or the device refuses them.
    pub fn new(
        gpu: &GpuContext,
        path: &str,
        module: &Module,
        [vertex, fragment]: [&str; 2],
        targets: &RasterTargets,
    ) -> Result<Self, GpuError> {
        let mut bindings = module.bindings(path, vertex)?;
        for found in module.bindings(path, fragment)? {
            if !bindings.contains(&found) {
                bindings.push(found);
            }
        }
        bindings.sort_by_key(|b| b.binding);
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = BoundLayout::new(gpu, path, bindings, stages);
        let shader = shader_module(gpu, path, module);
        let colors: Vec<Option<wgpu::ColorTargetState>> =
            targets.colors.iter().cloned().map(Some).collect();
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
                primitive: targets.primitive,
                depth_stencil: targets.depth.clone(),
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

    /// Binds the resource that `find` returns for each variable's name. Uses a cached group of `groups` if there are no textures.
    ///
    /// # Errors
    /// When `find` has no resource for a variable, or one of another kind.
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
            source: wgpu::ShaderSource::Wgsl(gpu.adapt(&module.text)),
        })
}

#[derive(Debug)]
struct BoundLayout {
    bindings: Vec<Reflected>,
    layout: wgpu::BindGroupLayout,
}

impl BoundLayout {
    fn new(
        gpu: &GpuContext,
        path: &str,
        bindings: Vec<Reflected>,
        stages: wgpu::ShaderStages,
    ) -> Self {
        let entries: Vec<wgpu::BindGroupLayoutEntry> = bindings
            .iter()
            .map(|b| wgpu::BindGroupLayoutEntry {
                binding: b.binding,
                visibility: stages,
                ty: binding_type(gpu, b.access),
                count: None,
            })
            .collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(path),
                entries: &entries,
            });
        Self { bindings, layout }
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
        let mut entries = Vec::with_capacity(self.bindings.len());
        let (mut buffers, mut offsets) = (Vec::with_capacity(self.bindings.len()), Vec::new());
        for b in &self.bindings {
            let found = find(&b.name)
                .ok_or_else(|| fault(format!("there is no resource to bind to `{}`", b.name)))?;
            let resource = match (found, b.access) {
                (Binding::Buffer { buffer, bytes }, Access::StorageRead | Access::StorageWrite) => {
                    buffers.push((buffer.clone(), bytes));
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer,
                        offset: 0,
                        size: wgpu::BufferSize::new(bytes),
                    })
                }
                (Binding::Uniform(placed), Access::Uniform(bytes)) => {
                    buffers.push((placed.buffer.clone(), u64::from(bytes)));
                    offsets.push(placed.offset);
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                        buffer: &placed.buffer,
                        // The dynamic offset is given when the group is set.
                        offset: 0,
                        size: wgpu::BufferSize::new(u64::from(bytes)),
                    })
                }
                (
                    Binding::Texture(view),
                    Access::Texture { .. } | Access::StorageTexture { .. },
                ) => wgpu::BindingResource::TextureView(view),
                _ => {
                    return Err(fault(format!(
                        "`{}` is bound to a resource of another kind",
                        b.name
                    )));
                }
            };
            entries.push(wgpu::BindGroupEntry {
                binding: b.binding,
                resource,
            });
        }
        let make = || {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(name),
                layout: &self.layout,
                entries: &entries,
            })
        };
        // Views of textures are new for each level map, so a group with one would never be reused.
        let group = if buffers.len() == self.bindings.len() {
            groups.get(&self.layout, buffers, make)
        } else {
            make()
        };
        Ok(Bound { group, offsets })
    }
}

fn binding_type(gpu: &GpuContext, access: Access) -> wgpu::BindingType {
    let buffer = |ty, has_dynamic_offset| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset,
        min_binding_size: None,
    };
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    match access {
        Access::Uniform(_) => buffer(gpu.uniforms_as(), true),
        Access::StorageRead => buffer(storage(true), false),
        Access::StorageWrite => buffer(storage(false), false),
        Access::Texture { sample, dimension } => wgpu::BindingType::Texture {
            sample_type: sample,
            view_dimension: dimension,
            multisampled: false,
        },
        Access::StorageTexture {
            access,
            format,
            dimension,
        } => wgpu::BindingType::StorageTexture {
            access,
            format,
            view_dimension: dimension,
        },
    }
}
