//! Renders a shape with each technique and measures time, memory and error.

use super::scene::{Technique, scene};
use super::study::{Experiment, HitPoint, MemoryExample, MeshResult, PlanePoint, TechniqueFigures};
use crate::accuracy::LinearImage;
use crate::accuracy::display::display_linear;
use crate::accuracy::luv::luv_distance;
use crate::accuracy::metrics::{MetricError, relative_l1};
use crate::frame::Frame;
use crate::lab::study::study::SpreadMs;
use crate::methods::volumetric::slice_deposit::{SLICE_DEPTH, SLICES};
use crate::methods::{level_map, planes, volumetric};
use crate::reference::{ReferenceError, Truth};
use crate::scene::{LayerName, ResolvedScene};
use crate::stats::Stats;

/// The number of techniques with planes: slices, uniform planes, smart planes.
const PLANE_TECHNIQUES: usize = 3;
/// Water cells that placement by hits is measured with.
const HIT_CELLS: [u32; 8] = [24, 32, 48, 64, 96, 128, 192, 256];
/// Split levels that each number of cells is measured with: none, as for planes, and the default.
const HIT_SPLIT_LEVELS: [u32; 2] = [0, 2];

/// Whether a pass belongs to slices or planes only, and not to hits.
fn is_own(pass: &str) -> bool {
    let mut of_hits = level_map::METHOD.passes.iter();
    let of_planes = planes::METHOD.passes.iter();
    let mut of_techniques = of_planes.chain(volumetric::METHOD.passes);
    of_techniques.any(|own| own.name == pass) && !of_hits.any(|shared| shared.name == pass)
}

/// What is measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Names of shapes of the catalogue.
    pub meshes: Vec<String>,
    /// Numbers of planes, each 2 … 1024.
    pub planes: Vec<u32>,
    /// Timed runs of each setting, at least 1.
    pub runs: u32,
    /// Water cells along each side of the light's window.
    pub water_cells: u32,
    /// Texels along each side of the maps, a power of two.
    pub texels: u32,
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// No shape of this name.
    #[error("`{0}` is no shape of the catalogue")]
    Shape(String),
    /// The scene is refused.
    #[error("{0}")]
    Scene(String),
    /// A frame cannot be rendered.
    #[error(transparent)]
    Render(#[from] crate::render::RenderError),
    /// The reference cannot be computed.
    #[error("no float64 truth: {0}")]
    Truth(#[from] ReferenceError),
    /// Images cannot be compared.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// A plot cannot be drawn.
    #[error(transparent)]
    Plot(#[from] crate::lab::study::plot::PlotError),
    /// A file cannot be written.
    #[error("cannot write {}: {reason}", path.display())]
    Write {
        /// Which.
        path: std::path::PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
}

/// Renders a scene.
pub type Render<'a> = dyn FnMut(&ResolvedScene) -> Result<Frame, ExperimentError> + 'a;
/// Computes the truth of a scene; `None` where none is requested.
pub type FindTruth<'a> = dyn FnMut(&ResolvedScene) -> Result<Option<Truth>, ExperimentError> + 'a;

/// Runs the experiment; `progress` gets the number of finished frames, the total, and what is running.
///
/// # Errors
/// [`ExperimentError`]; any failure ends the experiment.
pub fn measure(
    settings: &Settings,
    render: &mut Render<'_>,
    find_truth: &mut FindTruth<'_>,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Result<Experiment, ExperimentError> {
    let settings_of_each =
        PLANE_TECHNIQUES * settings.planes.len() + HIT_CELLS.len() * HIT_SPLIT_LEVELS.len();
    let each = settings_of_each * (settings.runs.max(1) as usize + 1);
    let total = settings.meshes.len() * each;
    let mut experiment = Experiment {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        cores: std::thread::available_parallelism().map_or(1, |n| n.get() as u32),
        water_cells: settings.water_cells,
        texels: settings.texels,
        runs: settings.runs,
        memory: memory_example()?,
        ..Experiment::default()
    };
    for (index, name) in settings.meshes.iter().enumerate() {
        let done = index * each;
        let base = scene(name, settings.water_cells, settings.texels)?;
        progress(done, total, &format!("{name}: the float64 truth"));
        let truth = find_truth(&base)?;
        let truth = truth.as_ref();
        let by_planes = settings.planes.iter().flat_map(|&planes| {
            [
                Technique::Volumetric(planes),
                Technique::Uniform(planes),
                Technique::Smart(planes),
            ]
        });
        let mut scenes: Vec<ResolvedScene> =
            by_planes.map(|technique| technique.of(&base)).collect();
        let hits: Vec<(u32, u32)> = HIT_CELLS
            .into_iter()
            .flat_map(|cells| HIT_SPLIT_LEVELS.map(|levels| (cells, levels)))
            .collect();
        scenes.extend(hits.iter().map(|&(water_cells, split_levels)| {
            let mut hit = Technique::Hit.of(&base);
            hit.scene.quality.water_cells = water_cells;
            hit.scene.quality.split_levels = split_levels;
            hit
        }));
        let measured = timed(&scenes, settings.runs, render, &mut |rendered| {
            progress(
                done + rendered,
                total,
                &format!(
                    "{name}: frame {} of {each}, all settings in turn",
                    rendered + 1
                ),
            );
        })?;
        let (by_planes, by_hits) = measured.split_at(PLANE_TECHNIQUES * settings.planes.len());
        let mut result = MeshResult {
            name: name.clone(),
            triangles: base.meshes[0].triangles.len() as u64,
            truth_error: truth.map(|t| t.relative_error),
            ..MeshResult::default()
        };
        for (&planes, techniques) in settings
            .planes
            .iter()
            .zip(by_planes.chunks_exact(PLANE_TECHNIQUES))
        {
            result
                .planes
                .push(plane_point(&base, planes, techniques, truth)?);
        }
        for ((water_cells, split_levels), hit) in hits.into_iter().zip(by_hits) {
            experiment.adapter = hit.frame.stats.adapter.clone();
            let figures = hit.figures(truth)?;
            result.hits.push(HitPoint {
                water_cells,
                split_levels,
                figures,
            });
        }
        experiment.meshes.push(result);
    }
    Ok(experiment)
}

/// The measurements of a number of planes, from its slices, uniform and smart planes.
fn plane_point(
    base: &ResolvedScene,
    planes: u32,
    techniques: &[Measured],
    truth: Option<&Truth>,
) -> Result<PlanePoint, ExperimentError> {
    let [volumetric, uniform, smart] = techniques else {
        return Err(ExperimentError::Scene(format!(
            "{} techniques instead of {PLANE_TECHNIQUES}",
            techniques.len()
        )));
    };
    let white_w_m2 = std::f64::consts::PI
        * crate::methods::facts(base)
            .map_err(|error| refused(&error))?
            .lights
            .white_radiance;
    let pictures = [volumetric, uniform, smart].map(Measured::image);
    let compared: Vec<bool> = (0..pictures[1].rgb.len())
        .map(|at| pictures.iter().any(|picture| picture.rgb[at] != [0.0; 3]))
        .collect();
    let shown = |picture: &LinearImage| display_linear(picture, white_w_m2);
    let [v, u, s] = [
        shown(&pictures[0])?,
        shown(&pictures[1])?,
        shown(&pictures[2])?,
    ];
    let apart = pictures[0]
        .rgb
        .iter()
        .zip(&pictures[1].rgb)
        .filter(|(a, b)| a != b);
    let planes_of_smart = smart
        .frame
        .stats
        .planes
        .first()
        .cloned()
        .unwrap_or_default();
    Ok(PlanePoint {
        planes,
        used: planes_of_smart.used,
        sub_boxes: planes_of_smart.sub_boxes,
        luv_smart: luv_distance(&s, &u, &compared)?,
        luv_volumetric: luv_distance(&v, &u, &compared)?,
        texels_apart: apart.count() as u32,
        texels: compared.iter().filter(|&&c| c).count() as u32,
        volumetric: volumetric.figures(truth)?,
        uniform: uniform.figures(truth)?,
        smart: smart.figures(truth)?,
    })
}

fn refused(error: &crate::scene::SceneError) -> ExperimentError {
    ExperimentError::Scene(error.to_string())
}

/// A technique's picture and the costs of its runs.
struct Measured {
    frame: Frame,
    runs: Vec<Stats>,
}

/// Renders each scene once to warm up, then all interleaved, so that changes of the machine's speed affect all alike. `progress` gets the
/// number of finished frames.
fn timed(
    scenes: &[ResolvedScene],
    runs: u32,
    render: &mut Render<'_>,
    progress: &mut dyn FnMut(usize),
) -> Result<Vec<Measured>, ExperimentError> {
    let mut all = Vec::with_capacity(scenes.len());
    let mut rendered = 0;
    // Absorbs what the shape before has left in caches.
    if let Some(first) = scenes.first() {
        render(first)?;
    }
    for scene in scenes {
        progress(rendered);
        let frame = render(scene)?;
        rendered += 1;
        all.push(Measured {
            frame,
            runs: Vec::new(),
        });
    }
    for _ in 0..runs.max(1) {
        for (scene, measured) in scenes.iter().zip(&mut all) {
            progress(rendered);
            measured.runs.push(render(scene)?.stats);
            rendered += 1;
        }
    }
    Ok(all)
}

impl Measured {
    fn image(&self) -> LinearImage {
        let layer = &self.frame.layers[&LayerName::Irradiance];
        let pixels = layer.data.chunks_exact(layer.channels);
        LinearImage {
            width: self.frame.width,
            height: self.frame.height,
            rgb: pixels
                .map(|p| std::array::from_fn(|c| f64::from(p[c])))
                .collect(),
        }
    }

    fn figures(&self, truth: Option<&Truth>) -> Result<TechniqueFigures, ExperimentError> {
        let own = |stats: &Stats| -> Option<f64> {
            let passes = stats.passes.iter().filter(|pass| is_own(&pass.name));
            // Hits have no such pass.
            let times: Vec<Option<f64>> = passes.map(|pass| pass.gpu_ms).collect();
            times.first()?;
            times.into_iter().sum()
        };
        let own_ms: Option<Vec<f64>> = self.runs.iter().map(own).collect();
        // From the first round: later, frames with many more cells have left buffers for their successors.
        let memory = &self.frame.stats.memory;
        Ok(TechniqueFigures {
            ms: SpreadMs::of(self.runs.iter().map(|stats| stats.time_ms.gpu).collect())
                .unwrap_or_default(),
            own_ms: own_ms.and_then(SpreadMs::of).map(|spread| spread.median),
            planned_bytes: memory.planned_peak_bytes,
            peak_bytes: memory.peak_bytes,
            allocated_bytes: memory.allocated_bytes,
            error: truth.map(|truth| self.error(truth)).transpose()?,
        })
    }

    /// Relative L1 error over the texels that the truth has a surface in.
    fn error(&self, truth: &Truth) -> Result<f64, ExperimentError> {
        let image = self.image();
        let compared = |values: &[[f64; 3]]| -> Vec<[f64; 3]> {
            let marked = values.iter().zip(&truth.compared);
            marked.filter(|(_, c)| **c).map(|(v, _)| *v).collect()
        };
        let (image, truth) = (compared(&image.rgb), compared(&truth.irradiance));
        Ok(relative_l1(image.as_flattened(), truth.as_flattened())?)
    }
}

/// The thesis's example of memory in this program's formats.
fn memory_example() -> Result<MemoryExample, ExperimentError> {
    const OBJECTS: u64 = 100;
    const PLANES: u32 = 100;
    let scene = Technique::Volumetric(PLANES).of(&scene("box", 2, 512)?);
    let facts = crate::methods::facts(&scene).map_err(|error| refused(&error))?;
    let level_map = crate::plan::level_maps(&facts)
        .first()
        .map_or(0, |key| key.bytes());
    Ok(MemoryExample {
        level_maps_bytes: OBJECTS * level_map,
        slices_bytes: OBJECTS * (SLICES.bytes(&facts) + SLICE_DEPTH.bytes(&facts)),
    })
}
