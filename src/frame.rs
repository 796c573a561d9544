//! A rendered frame, before it is written to a file: linear f32 layers and their stats.

use std::collections::BTreeMap;

use crate::scene::LayerName;
use crate::stats::Stats;

/// One layer: rows from the top (views) or from min z (maps), `channels` values per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Values per pixel: 1 for depth, 4 for radiance, else 3.
    pub channels: usize,
    /// Values: width × height × channels.
    pub data: Vec<f32>,
}

/// The linear result of a render.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Pixels or texels along x.
    pub width: u32,
    /// Pixels or texels along y (or z).
    pub height: u32,
    /// The requested layers: a view has those named in the scene, an irradiance map has [`LayerName::Irradiance`] only.
    pub layers: BTreeMap<LayerName, Layer>,
    /// Cost, energy, warnings.
    pub stats: Stats,
}
