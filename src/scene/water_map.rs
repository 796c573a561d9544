//! A map of the water: its height and slope over a rectangle.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::parse::{integer, optional_integer};
use super::ranges::{DEFAULT_MAP_SIDE, MapSide, PngBits};
use super::types::{Floor, ImageFormat, WaterMapKind, default_map_format, is_true, yes};

/// Height and slope of the water over a rectangle, by texel. It has no light in it: lights, objects and the dials of `quality` have no
/// effect. A floor is not needed; where there is one, its depth has its effect on the speed of waves, and its corners are the default.
///
/// Texel (i, j) is that of an irradiance map of the same rectangle on the floor: its centre is at x = min + (i + ½)Δ,
/// z = min + (j + ½)Δ; row 0 is at min z. The values are those at the centre, not means over the texel.
///
/// - EXR has the 32-bit float channels `height` (m above the water at rest, `water.level_m`), `slope.x` (∂h/∂x) and `slope.z` (∂h/∂z).
/// - PNG is a normal map of the surface, n = (−∂h/∂x, 1, −∂h/∂z) / |…|, in the tangent space of the picture seen from above, with
///   "OpenGL" green: red is n along the columns (+x), green is n up the picture (−z, because row 0 is at the top), blue is n
///   upwards (+y). A code c of 0 … C (255 or 65535) stands for 2 c / C − 1, so ∂h/∂x = −red / blue and ∂h/∂z = green / blue. The codes
///   are no colours: programs have to read them without a colour space (Blender: Non-Color).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WaterMapOutput {
    /// Always `water_map`.
    pub kind: WaterMapKind,
    /// Lower corner (x, z) of the map, m, −10⁸ … 10⁸. Default: the floor's lower corner; required if the scene has no floor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub min_m: Option<[f64; 2]>,
    /// Upper corner (x, z) of the map, m, −10⁸ … 10⁸; greater than `min_m`, by at most 10⁶ m. Default: the floor's upper corner;
    /// required if the scene has no floor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub max_m: Option<[f64; 2]>,
    /// Texels along x, 1 … 8192. Default 512.
    #[serde(
        default,
        deserialize_with = "optional_integer::<MapSide, _>",
        skip_serializing_if = "Option::is_none"
    )]
    #[schema(minimum = 1, maximum = 8192)]
    pub width: Option<u32>,
    /// Texels along z, 1 … 8192. Default 512.
    #[serde(
        default,
        deserialize_with = "optional_integer::<MapSide, _>",
        skip_serializing_if = "Option::is_none"
    )]
    #[schema(minimum = 1, maximum = 8192)]
    pub height: Option<u32>,
    /// File format. Default `exr`: height and slopes as float. `png`: a normal map.
    #[serde(default = "default_map_format")]
    pub format: ImageFormat,
    /// Bits per PNG channel, 8 or 16. Default 16: a step of 8 bits is a slope of 0.008, as much as that of a ripple.
    #[serde(
        default = "default_normal_bits",
        deserialize_with = "integer::<PngBits, _>"
    )]
    #[schema(minimum = 8, maximum = 16)]
    pub png_bits: u32,
    /// Whether the file contains the scene as JSON (`caustica:scene`), with meshes named by content ids. Default true.
    #[serde(default = "yes", skip_serializing_if = "is_true")]
    pub embed_scene: bool,
}

fn default_normal_bits() -> u32 {
    16
}

impl WaterMapOutput {
    /// Lower and upper corner, (x, z) in m; `None` if one is missing and there is no floor to take it from.
    pub fn corners_m(&self, floor: Option<&Floor>) -> Option<[[f64; 2]; 2]> {
        let of_floor = floor.map(Floor::corners_m);
        Some([
            self.min_m.or(of_floor.map(|corners| corners[0]))?,
            self.max_m.or(of_floor.map(|corners| corners[1]))?,
        ])
    }

    /// Texels along x and z.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height].map(|side| side.unwrap_or(DEFAULT_MAP_SIDE))
    }
}
