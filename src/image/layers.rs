//! Names and contents of the layers in a file, and the check whether a layer can be written.

use crate::frame::{Frame, Layer};
use crate::scene::LayerName;

use super::encode::EncodeError;

/// Depth written for pixels whose ray meets nothing, m; a frame holds +∞ there.
pub const FAR_DEPTH_M: f32 = 1e10;

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
pub const IRRADIANCE_MAP: LayerFormat = LayerFormat {
    word: "irradiance",
    exr_channels: &["R", "G", "B"],
    follows_exr_pixel: false,
    holds: "R G B: irradiance, W/m2",
};

/// How `name` appears in a file of a view.
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
            holds: "Z: distance along the viewing axis, m, 1e10 where nothing is seen",
        },
        LayerName::Normal => LayerFormat {
            word: "normal",
            exr_channels: &["N.X", "N.Y", "N.Z"],
            follows_exr_pixel: false,
            holds: "N: world normal",
        },
        LayerName::Position => LayerFormat {
            word: "position",
            exr_channels: &["P.X", "P.Y", "P.Z"],
            follows_exr_pixel: false,
            holds: "P: world position, m",
        },
        LayerName::Albedo => LayerFormat {
            word: "albedo",
            exr_channels: &["albedo.R", "albedo.G", "albedo.B"],
            follows_exr_pixel: true,
            holds: "albedo: diffuse reflectance",
        },
        LayerName::Irradiance => LayerFormat {
            word: "irradiance",
            exr_channels: &["irradiance.R", "irradiance.G", "irradiance.B"],
            follows_exr_pixel: false,
            holds: "irradiance: W/m2",
        },
    }
}

/// Whether the frame is an irradiance map: it holds irradiance and nothing else.
pub fn is_irradiance_map(frame: &Frame) -> bool {
    frame.layers.keys().eq([&LayerName::Irradiance])
}

/// Checks the shape of a layer and that all its numbers can be written.
///
/// # Errors
/// [`EncodeError::Shape`], or [`EncodeError::NonFinite`] for the first NaN or infinity in row order; +∞ is a legal depth.
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
    let is_depth = name == LayerName::Depth;
    let writable = |v: &f32| v.is_finite() || (is_depth && *v == f32::INFINITY);
    match layer.data.iter().position(|v| !writable(v)) {
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
                exception: if is_depth {
                    ", and +inf where nothing is seen"
                } else {
                    ""
                },
            })
        }
    }
}
