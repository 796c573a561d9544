//! The results of the experiment.

use serde::{Deserialize, Serialize};

use super::measure::Settings;
use crate::lab::study::study::SpreadMs;
use crate::stats::AdapterStats;

/// Level maps against slice images, and smart against uniform slicing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Program version.
    pub version: String,
    /// Where it ran.
    pub adapter: AdapterStats,
    /// CPU cores of the machine.
    pub cores: u32,
    /// Water cells along each side of the light's window.
    pub water_cells: u32,
    /// Texels along each side of level map, slices and irradiance map.
    pub texels: u32,
    /// Timed runs of each setting, interleaved.
    pub runs: u32,
    /// Memory for many objects.
    pub memory: MemoryExample,
    /// One entry per shape.
    pub meshes: Vec<MeshResult>,
}

impl Experiment {
    /// Whether this is a result of this version of the program with `settings`, apart from the times.
    pub fn is_of(&self, settings: &Settings) -> bool {
        let names = self.meshes.iter().map(|mesh| &mesh.name);
        let planes_of =
            |mesh: &MeshResult| -> Vec<u32> { mesh.planes.iter().map(|p| p.planes).collect() };
        self.version == env!("CARGO_PKG_VERSION")
            && (self.water_cells, self.texels, self.runs)
                == (settings.water_cells, settings.texels, settings.runs)
            && names.eq(&settings.meshes)
            && self
                .meshes
                .iter()
                .all(|mesh| planes_of(mesh) == settings.planes)
    }
}

/// The thesis's example of §5.1 in this program's formats: 100 objects of 512² texels and 100 planes each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MemoryExample {
    /// Level maps of all objects, with their pyramids and normals, bytes.
    pub level_maps_bytes: u64,
    /// Slice images of all objects, bytes, if all were kept as in the thesis; this program keeps those of one object at a time.
    pub slices_bytes: u64,
}

/// A shape.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshResult {
    /// Name in the catalogue.
    pub name: String,
    /// Triangles.
    pub triangles: u64,
    /// Relative L1 error of the float64 reference by its own estimate; absent without a reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth_error: Option<f64>,
    /// Each number of planes.
    pub planes: Vec<PlanePoint>,
    /// Placement by hits, with several numbers of water cells.
    pub hits: Vec<HitPoint>,
}

/// A number of planes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanePoint {
    /// The requested number of planes.
    pub planes: u32,
    /// A slice image for each.
    pub volumetric: TechniqueFigures,
    /// All on the level map.
    pub uniform: TechniqueFigures,
    /// Those with a surface near them.
    pub smart: TechniqueFigures,
    /// The number of these planes.
    pub used: u32,
    /// Pieces of the box that hold them.
    pub sub_boxes: u32,
    /// Mean CIE Luv distance of smart and uniform (eq. 2-9).
    pub luv_smart: f64,
    /// Mean CIE Luv distance of volumetric and uniform.
    pub luv_volumetric: f64,
    /// Texels in which volumetric and uniform differ at all.
    pub texels_apart: u32,
    /// Texels that are compared: lit in one of them.
    pub texels: u32,
}

/// Cost and error of a technique.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TechniqueFigures {
    /// GPU time of the frame, ms.
    pub ms: SpreadMs,
    /// Of that, the passes that place light by planes (median), ms; absent when passes cannot be timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_ms: Option<f64>,
    /// Peak memory by the plan, bytes.
    pub planned_bytes: u64,
    /// Measured peak by the program's own account, bytes.
    pub peak_bytes: u64,
    /// Memory by the allocator, bytes; absent where the backend does not report it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub allocated_bytes: Option<u64>,
    /// Relative L1 error against the float64 reference; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
}

/// Placement by hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HitPoint {
    /// Water cells along each side of the window.
    pub water_cells: u32,
    /// How often a beam that straddles receivers is split.
    pub split_levels: u32,
    /// Cost and error.
    pub figures: TechniqueFigures,
}
