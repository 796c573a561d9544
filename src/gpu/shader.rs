//! WGSL: `#import`, and reflection of the resources that an entry point binds.
//!
//! `#import "path"` on a separate line pastes a file once per module, at the first import. An unknown path is an error. There are no
//! conditions and no renaming.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use wgpu::naga;

use super::GpuError;

/// All WGSL files by their path below `shaders/`.
#[derive(Clone, Debug, Default)]
pub struct ShaderSources {
    files: BTreeMap<&'static str, Cow<'static, str>>,
}

impl ShaderSources {
    /// Sources from (path, text) pairs.
    pub fn new(files: &[(&'static str, &'static str)]) -> Self {
        Self {
            files: files
                .iter()
                .map(|&(path, text)| (path, Cow::Borrowed(text)))
                .collect(),
        }
    }

    /// Paths of all files, sorted.
    pub fn paths(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.files.keys().copied()
    }

    /// The text of a file.
    pub fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path).map(AsRef::as_ref)
    }

    /// The same sources with one more file.
    #[must_use]
    pub fn with_file(mut self, path: &'static str, text: &'static str) -> Self {
        self.files.insert(path, Cow::Borrowed(text));
        self
    }

    /// The same sources with `from` replaced by `to` in one file: for tests that break a formula on purpose.
    pub fn with_replacement(mut self, path: &str, from: &str, to: &str) -> Option<Self> {
        let text = self.files.get_mut(path)?;
        if !text.contains(from) {
            return None;
        }
        *text = Cow::Owned(text.replace(from, to));
        Some(self)
    }

    /// The module of `root` with all imports pasted.
    pub fn assemble(&self, root: &str) -> Result<String, GpuError> {
        self.assemble_all(&[root])
    }

    /// One module of several files, one behind the other, with all imports pasted once.
    pub fn assemble_all(&self, roots: &[&str]) -> Result<String, GpuError> {
        let mut out = String::new();
        let mut done = BTreeSet::new();
        for root in roots {
            self.paste(root, &mut out, &mut done)?;
        }
        Ok(out)
    }

    fn paste(
        &self,
        path: &str,
        out: &mut String,
        done: &mut BTreeSet<String>,
    ) -> Result<(), GpuError> {
        if !done.insert(path.to_owned()) {
            return Ok(());
        }
        let text = self
            .text(path)
            .ok_or_else(|| shader_error(path, "no such file"))?;
        for line in text.lines() {
            if let Some(rest) = line.trim_start().strip_prefix("#import") {
                let name = rest.trim().trim_matches('"');
                if self.text(name).is_none() {
                    return Err(shader_error(
                        path,
                        &format!("imports `{name}`, which does not exist"),
                    ));
                }
                self.paste(name, out, done)?;
            } else {
                out.push_str(line);
                out.push('\n');
            }
        }
        Ok(())
    }
}

fn shader_error(shader: &str, message: &str) -> GpuError {
    GpuError::Shader {
        shader: shader.to_owned(),
        message: message.to_owned(),
    }
}

/// How an entry point uses a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Uniform buffer of this many bytes.
    Uniform(u32),
    /// Read-only storage buffer.
    StorageRead,
    /// Storage buffer that is written.
    StorageWrite,
    /// Texture that is read; floats are loaded, not filtered.
    Texture {
        /// What its texels are.
        sample: wgpu::TextureSampleType,
        /// 2D, an array, 3D …
        dimension: wgpu::TextureViewDimension,
    },
    /// Texture that is stored to.
    StorageTexture {
        /// Whether it is read too.
        access: wgpu::StorageTextureAccess,
        /// Format of a texel.
        format: wgpu::TextureFormat,
        /// 2D, an array, 3D …
        dimension: wgpu::TextureViewDimension,
    },
}

/// A resource of an entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reflected {
    /// Name of the WGSL variable.
    pub name: String,
    /// Its binding in group 0.
    pub binding: u32,
    /// How it is used.
    pub access: Access,
}

/// A parsed and validated module.
#[derive(Debug)]
pub struct Module {
    /// naga's view of it.
    pub ir: naga::Module,
    info: naga::valid::ModuleInfo,
    /// The assembled text.
    pub text: String,
}

impl Module {
    /// Parses and validates assembled WGSL; `name` is for messages.
    pub fn parse(name: &str, text: String) -> Result<Self, GpuError> {
        let ir = naga::front::wgsl::parse_str(&text)
            .map_err(|error| shader_error(name, &error.emit_to_string(&text)))?;
        let info = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::default(),
        )
        .validate(&ir)
        .map_err(|error| shader_error(name, &error.emit_to_string(&text)))?;
        Ok(Self { ir, info, text })
    }

    /// The resources that `entry` binds, by binding number.
    pub fn bindings(&self, name: &str, entry: &str) -> Result<Vec<Reflected>, GpuError> {
        let used = self.info.get_entry_point(self.index_of(name, entry)?);
        let mut found = Vec::new();
        for (handle, variable) in self.ir.global_variables.iter() {
            let Some(binding) = variable.binding else {
                continue;
            };
            if used[handle].is_empty() {
                continue;
            }
            if binding.group != 0 {
                return Err(shader_error(name, "only bind group 0 is used"));
            }
            let label = variable.name.clone().unwrap_or_default();
            let access = self.access(variable).ok_or_else(|| {
                shader_error(
                    name,
                    &format!("`{label}` is of a kind that is not supported"),
                )
            })?;
            found.push(Reflected {
                name: label,
                binding: binding.binding,
                access,
            });
        }
        found.sort_by_key(|r| r.binding);
        if let Some(pair) = found
            .windows(2)
            .find(|pair| pair[0].binding == pair[1].binding)
        {
            let message = format!(
                "`{}` and `{}` share binding {}",
                pair[0].name, pair[1].name, pair[0].binding
            );
            return Err(shader_error(name, &message));
        }
        Ok(found)
    }

    /// Names of the `override` constants on which entry point `entry` depends, in the order of the text.
    ///
    /// # Errors
    /// When there is no such entry point.
    pub fn overrides_of(&self, name: &str, entry: &str) -> Result<Vec<String>, GpuError> {
        let ir = &self.ir;
        let entry = &ir.entry_points[self.index_of(name, entry)?];
        // Overrides in module-scope expressions count for every entry point.
        let mut used = overrides_in(&ir.global_expressions);
        let mut seen = BTreeSet::new();
        let mut pending = vec![&entry.function];
        while let Some(function) = pending.pop() {
            used.extend(overrides_in(&function.expressions));
            let mut called = Vec::new();
            calls(&function.body, &mut called);
            let new = called.into_iter().filter(|&callee| seen.insert(callee));
            pending.extend(new.map(|callee| &ir.functions[callee]));
        }
        let declared = ir.overrides.iter();
        let used = declared.filter(|(handle, _)| used.contains(handle));
        Ok(used
            .filter_map(|(_, constant)| constant.name.clone())
            .collect())
    }

    fn index_of(&self, name: &str, entry: &str) -> Result<usize, GpuError> {
        let mut entries = self.ir.entry_points.iter();
        entries
            .position(|e| e.name == entry)
            .ok_or_else(|| shader_error(name, &format!("has no entry point `{entry}`")))
    }

    fn access(&self, variable: &naga::GlobalVariable) -> Option<Access> {
        let inner = &self.ir.types[variable.ty].inner;
        match variable.space {
            naga::AddressSpace::Uniform => Some(Access::Uniform(inner.size(self.ir.to_ctx()))),
            naga::AddressSpace::Storage { access }
                if access.contains(naga::StorageAccess::STORE) =>
            {
                Some(Access::StorageWrite)
            }
            naga::AddressSpace::Storage { .. } => Some(Access::StorageRead),
            naga::AddressSpace::Handle => match inner {
                naga::TypeInner::Image {
                    dim,
                    arrayed,
                    class,
                } => texture_access(*class, view_dimension(*dim, *arrayed)?),
                _ => None,
            },
            _ => None,
        }
    }
}

fn overrides_in(
    expressions: &naga::Arena<naga::Expression>,
) -> BTreeSet<naga::Handle<naga::Override>> {
    let overrides = expressions.iter().map(|(_, expression)| expression);
    overrides
        .filter_map(|expression| match expression {
            naga::Expression::Override(handle) => Some(*handle),
            _ => None,
        })
        .collect()
}

/// The functions that a block calls directly.
fn calls(block: &naga::Block, into: &mut Vec<naga::Handle<naga::Function>>) {
    for statement in block {
        match statement {
            naga::Statement::Call { function, .. } => into.push(*function),
            naga::Statement::Block(inner) => calls(inner, into),
            naga::Statement::If { accept, reject, .. } => {
                calls(accept, into);
                calls(reject, into);
            }
            naga::Statement::Switch { cases, .. } => {
                for case in cases {
                    calls(&case.body, into);
                }
            }
            naga::Statement::Loop {
                body, continuing, ..
            } => {
                calls(body, into);
                calls(continuing, into);
            }
            _ => {}
        }
    }
}

fn view_dimension(dim: naga::ImageDimension, arrayed: bool) -> Option<wgpu::TextureViewDimension> {
    use wgpu::TextureViewDimension as View;
    Some(match (dim, arrayed) {
        (naga::ImageDimension::D1, false) => View::D1,
        (naga::ImageDimension::D2, false) => View::D2,
        (naga::ImageDimension::D2, true) => View::D2Array,
        (naga::ImageDimension::D3, false) => View::D3,
        (naga::ImageDimension::Cube, false) => View::Cube,
        (naga::ImageDimension::Cube, true) => View::CubeArray,
        _ => return None,
    })
}

fn texture_access(
    class: naga::ImageClass,
    dimension: wgpu::TextureViewDimension,
) -> Option<Access> {
    use wgpu::{
        StorageTextureAccess as Storage, TextureFormat as Format, TextureSampleType as Type,
    };
    match class {
        naga::ImageClass::Sampled { kind, multi: false } => Some(Access::Texture {
            sample: match kind {
                naga::ScalarKind::Uint => Type::Uint,
                naga::ScalarKind::Sint => Type::Sint,
                _ => Type::Float { filterable: false },
            },
            dimension,
        }),
        naga::ImageClass::Depth { multi: false } => Some(Access::Texture {
            sample: Type::Depth,
            dimension,
        }),
        naga::ImageClass::Storage { format, access } => Some(Access::StorageTexture {
            access: match (
                access.contains(naga::StorageAccess::LOAD),
                access.contains(naga::StorageAccess::STORE),
            ) {
                (true, true) => Storage::ReadWrite,
                (true, false) => Storage::ReadOnly,
                _ => Storage::WriteOnly,
            },
            // Formats that every WebGPU device can store to and that passes use.
            format: match format {
                naga::StorageFormat::R32Float => Format::R32Float,
                naga::StorageFormat::R32Uint => Format::R32Uint,
                naga::StorageFormat::Rg32Float => Format::Rg32Float,
                naga::StorageFormat::Rgba16Float => Format::Rgba16Float,
                naga::StorageFormat::Rgba32Float => Format::Rgba32Float,
                naga::StorageFormat::Rgba8Unorm => Format::Rgba8Unorm,
                _ => return None,
            },
            dimension,
        }),
        _ => None,
    }
}
