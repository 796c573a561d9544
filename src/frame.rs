//! A rendered frame, before it is written to a file: linear f32 layers and their stats.

use std::collections::BTreeMap;

use crate::scene::LayerName;
use crate::scene::projection::Projection;
use crate::stats::Stats;

/// Depth of a pixel that sees nothing, m.
pub const FAR_DEPTH_M: f32 = 1e10;

/// What a frame shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// What a camera sees.
    View,
    /// Irradiance on a receiver, by texel.
    IrradianceMap,
    /// Height and slope of the water, by texel.
    WaterMap,
}

/// One layer: rows from the top (views) or from min z (maps), `channels` values per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Values per pixel: 1 for depths, 4 for radiance, else 3.
    pub channels: usize,
    /// Values: width × height × channels.
    pub data: Vec<f32>,
}

/// The linear result of a render.
#[derive(Clone, Debug)]
pub struct Frame {
    /// What it shows.
    pub kind: FrameKind,
    /// Pixels or texels along x.
    pub width: u32,
    /// Pixels or texels along y (or z).
    pub height: u32,
    /// The requested layers: a view has those named in the scene, an irradiance map has [`LayerName::Irradiance`] only, a map of
    /// the water [`LayerName::Water`].
    pub layers: BTreeMap<LayerName, Layer>,
    /// The camera of a view.
    pub projection: Option<Projection>,
    /// Cost, energy, warnings.
    pub stats: Stats,
    /// Canonical JSON of the scene, if `output.embed_scene` says that files contain it.
    pub scene: Option<String>,
}
