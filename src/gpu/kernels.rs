//! Cache of compiled kernels, keyed by shader, entry point, and values of the overrides that the entry point uses.

use std::collections::BTreeMap;

use super::kernel::{Kernel, RasterKernel, RasterTargets};
use super::shader::{Module, ShaderSources};
use super::{GpuContext, GpuError, pieces};

/// A compute kernel of a [`KernelCache`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelId(usize);

/// A raster kernel of a [`KernelCache`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RasterKernelId(usize);

/// Key of a compute kernel.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    path: String,
    entry: String,
    /// Bits of the values, in the order of the names of the overrides that the entry point uses.
    values: Vec<u64>,
    in_pieces: bool,
}

/// Key of a raster kernel.
#[derive(Clone, Debug, PartialEq)]
struct RasterKey {
    path: String,
    entries: [String; 2],
    targets: RasterTargets,
}

/// A parsed shader file, and the overrides of those entry points that were requested.
#[derive(Debug)]
struct Parsed {
    module: Module,
    overrides: BTreeMap<String, Vec<String>>,
}

/// Kernels and the modules they are made of, kept for as long as the device.
#[derive(Debug, Default)]
pub struct KernelCache {
    modules: BTreeMap<String, Parsed>,
    kernels: Vec<Kernel>,
    ids: BTreeMap<Key, KernelId>,
    raster: Vec<(RasterKey, RasterKernel)>,
}

impl KernelCache {
    /// The kernel of entry point `entry` of shader file `path`. Only those of `constants` count that the entry point uses. With `in_pieces`
    /// it reads the offset of its piece from a uniform, see [`pieces`].
    ///
    /// # Errors
    /// When the shader is not valid, or the entry point cannot be cut.
    pub fn compute(
        &mut self,
        gpu: &GpuContext,
        sources: &ShaderSources,
        (path, entry): (&str, &str),
        constants: &[(&'static str, f64)],
        in_pieces: bool,
    ) -> Result<KernelId, GpuError> {
        let parsed = parsed(&mut self.modules, sources, path)?;
        let used = match parsed.overrides.get(entry) {
            Some(used) => used,
            None => {
                let used = parsed.module.overrides_of(path, entry)?;
                parsed.overrides.entry(entry.to_owned()).or_insert(used)
            }
        };
        let value = |name: &String| constants.iter().find(|(constant, _)| constant == name);
        if let Some(name) = used.iter().find(|name| value(name).is_none()) {
            return Err(GpuError::Validation(format!(
                "`{entry}` of `{path}` has the override `{name}`, which nothing sets"
            )));
        }
        let constants: Vec<(&str, f64)> = used.iter().filter_map(value).copied().collect();
        let key = Key {
            path: path.to_owned(),
            entry: entry.to_owned(),
            values: constants.iter().map(|(_, value)| value.to_bits()).collect(),
            in_pieces,
        };
        if let Some(&id) = self.ids.get(&key) {
            return Ok(id);
        }
        let kernel = if in_pieces {
            let text = pieces::with_piece_offset(&parsed.module, path, entry)?;
            Kernel::from_text(gpu, path, text, entry, &constants)?
        } else {
            Kernel::new(gpu, path, &parsed.module, entry, &constants)?
        };
        let id = KernelId(self.kernels.len());
        self.kernels.push(kernel);
        self.ids.insert(key, id);
        Ok(id)
    }

    /// The raster kernel of the vertex and the fragment entry point of shader file `path`.
    ///
    /// # Errors
    /// When the shader is not valid.
    pub fn raster(
        &mut self,
        gpu: &GpuContext,
        sources: &ShaderSources,
        (path, entries): (&str, [&str; 2]),
        targets: RasterTargets,
    ) -> Result<RasterKernelId, GpuError> {
        let key = RasterKey {
            path: path.to_owned(),
            entries: entries.map(str::to_owned),
            targets,
        };
        if let Some(index) = self.raster.iter().position(|(known, _)| *known == key) {
            return Ok(RasterKernelId(index));
        }
        let parsed = parsed(&mut self.modules, sources, path)?;
        let kernel = RasterKernel::new(gpu, path, &parsed.module, entries, &key.targets)?;
        self.raster.push((key, kernel));
        Ok(RasterKernelId(self.raster.len() - 1))
    }

    /// A compute kernel by its id.
    pub fn kernel(&self, id: KernelId) -> &Kernel {
        &self.kernels[id.0]
    }

    /// A raster kernel by its id.
    pub fn raster_kernel(&self, id: RasterKernelId) -> &RasterKernel {
        &self.raster[id.0].1
    }

    /// Number of compiled kernels, compute and raster.
    pub fn compiled(&self) -> usize {
        self.kernels.len() + self.raster.len()
    }

    /// Number of parsed shader files.
    pub fn parsed(&self) -> usize {
        self.modules.len()
    }
}

/// The module of a shader file, parsed when it is first requested.
fn parsed<'a>(
    modules: &'a mut BTreeMap<String, Parsed>,
    sources: &ShaderSources,
    path: &str,
) -> Result<&'a mut Parsed, GpuError> {
    if !modules.contains_key(path) {
        let parsed = Parsed {
            module: Module::parse(path, sources.assemble(path)?)?,
            overrides: BTreeMap::new(),
        };
        modules.insert(path.to_owned(), parsed);
    }
    modules.get_mut(path).ok_or_else(|| GpuError::Shader {
        shader: path.to_owned(),
        message: "is not kept".to_owned(),
    })
}
