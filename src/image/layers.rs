//! Names and contents of the layers in a file, and the check whether a layer can be written.

use crate::frame::{Frame, FrameKind, Layer};
use crate::scene::LayerName;

use super::encode::EncodeError;

/// How a layer appears in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerFormat {
    /// Its name in a scene.
    pub word: &'static str,
    /// Name of its channels in EXR, one per value of a pixel, in the order of the frame.
    pub exr_channels: &'static [&'static str],
    /// Whether `exr_pixel` selects its number type; if not, it is 32-bit float.
    pub follows_exr_pixel: bool,
    /// The meaning of its values, with unit.
    pub holds: &'static str,
}

/// Channels of an irradiance map in EXR: the root, so that every viewer shows it.
const IRRADIANCE_MAP: LayerFormat = LayerFormat {
    word: "irradiance",
    exr_channels: &["R", "G", "B"],
    follows_exr_pixel: false,
    holds: "R G B: irradiance, W/m2",
};

/// How the layer `name` of `frame` appears in a file.
pub fn format_in(frame: &Frame, name: LayerName) -> LayerFormat {
    match frame.kind {
        FrameKind::IrradianceMap => IRRADIANCE_MAP,
        FrameKind::View | FrameKind::WaterMap => format_of(name),
    }
}

/// How `name` appears in a file of a view or of a map of the water.
pub fn format_of(name: LayerName) -> LayerFormat {
    match name {
        LayerName::Radiance => LayerFormat {
            word: "radiance",
            exr_channels: &["R", "G", "B", "A"],
            follows_exr_pixel: true,
            holds: "R G B: radiance, W/(m2 sr)",
        },
        LayerName::Depth => LayerFormat {
            word: "depth",
            exr_channels: &["Z"],
            follows_exr_pixel: false,
            holds: "Z: distance along the viewing axis (not the ray) to the first surface, the water's included, m, 1e10 where the ray meets nothing",
        },
        LayerName::SeenDepth => LayerFormat {
            word: "seen_depth",
            exr_channels: &["seen.Z"],
            follows_exr_pixel: false,
            holds: "seen.Z: distance along the viewing axis to P, the surface seen (it may lie behind the water, or be mirrored in it and then have any sign), m, 1e10 where none is seen",
        },
        LayerName::Normal => LayerFormat {
            word: "normal",
            exr_channels: &["N.X", "N.Y", "N.Z"],
            follows_exr_pixel: false,
            holds: "N: world normal of the surface seen, 0 where none is",
        },
        LayerName::Position => LayerFormat {
            word: "position",
            exr_channels: &["P.X", "P.Y", "P.Z"],
            follows_exr_pixel: false,
            holds: "P: world position of the surface seen, m, 0 where none is",
        },
        LayerName::Albedo => LayerFormat {
            word: "albedo",
            exr_channels: &["albedo.R", "albedo.G", "albedo.B"],
            follows_exr_pixel: true,
            holds: "albedo: diffuse reflectance of the surface seen, 0 where none is",
        },
        LayerName::Irradiance => LayerFormat {
            word: "irradiance",
            exr_channels: &["irradiance.R", "irradiance.G", "irradiance.B"],
            follows_exr_pixel: false,
            holds: "irradiance: on the surface seen, W/m2, 0 where none is",
        },
        LayerName::Water => LayerFormat {
            word: "water",
            exr_channels: &["height", "slope.x", "slope.z"],
            follows_exr_pixel: false,
            holds: "height: of the water above its level at rest, m; slope: its derivatives along x and z",
        },
    }
}

/// Checks the shape of a layer and that all its numbers can be written.
///
/// # Errors
/// [`EncodeError::Shape`], or [`EncodeError::NonFinite`] for the first NaN or infinity in row order.
pub fn check(frame: &Frame, name: LayerName, layer: &Layer) -> Result<(), EncodeError> {
    let format = format_of(name);
    let wanted_channels = format.exr_channels.len();
    let pixels = frame.width as usize * frame.height as usize;
    if layer.channels != wanted_channels || layer.data.len() != pixels * wanted_channels {
        return Err(EncodeError::Shape {
            layer: format.word,
            channels: layer.channels,
            values: layer.data.len(),
            width: frame.width,
            height: frame.height,
            wanted_channels,
        });
    }
    match layer.data.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(index) => {
            let pixel = (index / wanted_channels) as u64;
            let width = u64::from(frame.width);
            Err(EncodeError::NonFinite {
                layer: format.word,
                x: (pixel % width) as u32,
                y: (pixel / width) as u32,
                channel: index % wanted_channels,
                value: layer.data[index],
            })
        }
    }
}
