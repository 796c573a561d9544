//! The fields of a scene. Every default is stated here once; `openapi.yaml` is generated from these types.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::parse::{inner, integer, integer_of, optional_integer, rotation, tagged, wrong_type};
use super::quality::Quality;
use super::ranges::{Integer, Layer, LightIndex, MapSide, PngBits, ReceiverIndex, ViewSide};
use super::strict::carry;
use super::water_map::WaterMapOutput;
use super::waves::Wave;

/// A scene: water, receivers, lights, a camera and the output to make.
///
/// Right-handed, Y up, metres, seconds, SI radiometry; angles in degrees; linear RGB (Rec. 709 primaries).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The water body. Default: flat water at y = 0 with ior 1.333 and no absorption.
    #[serde(default)]
    pub water: Water,
    /// The rectangular floor under the water. Default: none, the water has no bottom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<Floor>,
    /// Suns, point lights and skies. May be empty: the picture is then black.
    #[serde(default)]
    pub lights: Vec<Light>,
    /// Mesh instances.
    #[serde(default)]
    #[schema(value_type = Vec<MeshInstance>)]
    pub objects: Vec<Object>,
    /// The camera. Needed only if `output.kind` is `view`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// The dials that trade accuracy for time.
    #[serde(default)]
    pub quality: Quality,
    /// What to make.
    #[serde(default)]
    pub output: Output,
    /// Time of the frame, s, −10¹² … 10¹². Default 0.
    #[serde(default)]
    pub time_s: f64,
}

/// The water body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Water {
    /// Wave components, added up. Default: none, flat water.
    pub waves: Vec<Wave>,
    /// Height of the water at rest, m, −10⁸ … 10⁸. Default 0.
    pub level_m: f64,
    /// Index of refraction relative to air, 1 … 4. Default 1.333.
    pub ior: f64,
    /// Absorption coefficient a per channel, 1/m, 0 … 10⁴. Default 0.
    #[schema(min_items = 3, max_items = 3)]
    pub absorption_per_m: [f64; 3],
    /// Scattering coefficient b per channel, 1/m, 0 … 10⁴. Default 0. Beams lose scattered light (extinction c = a + b). Light
    /// scattered towards the camera is not simulated: a warning says so, and the energy account has the scattered flux.
    #[schema(min_items = 3, max_items = 3)]
    pub scattering_per_m: [f64; 3],
    /// How a wave's period follows from its wavelength if `period_s` is not given. Default `finite_depth`.
    pub dispersion: Dispersion,
}

impl Default for Water {
    fn default() -> Self {
        Self {
            waves: Vec::new(),
            level_m: 0.0,
            ior: 1.333,
            absorption_per_m: [0.0; 3],
            scattering_per_m: [0.0; 3],
            dispersion: Dispersion::default(),
        }
    }
}

/// Dispersion relation of sines and Gerstner waves. Spectra and ripples have surface tension as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Dispersion {
    /// ω² = g k.
    Deep,
    /// ω² = g k tanh(k d), d = `floor.depth_m`; without a floor the same as `deep`.
    #[default]
    FiniteDepth,
}

/// The rectangular, horizontal floor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Floor {
    /// Depth below the water at rest, m, 0 … 11 000.
    pub depth_m: f64,
    /// Extent along x and z, m, 10⁻⁶ … 10⁶.
    #[schema(min_items = 2, max_items = 2)]
    pub size_m: [f64; 2],
    /// Centre (x, z), m, −10⁸ … 10⁸. Default (0, 0).
    #[serde(default)]
    #[schema(min_items = 2, max_items = 2)]
    pub center_m: [f64; 2],
    /// Diffuse reflectance per channel, 0 … 1. Default (0.7, 0.65, 0.5), pale sand.
    #[serde(default = "default_floor_albedo")]
    #[schema(min_items = 3, max_items = 3)]
    pub albedo: [f64; 3],
}

impl Floor {
    /// Lower and upper corner, (x, z) in m.
    pub fn corners_m(&self) -> [[f64; 2]; 2] {
        [-0.5, 0.5].map(|half| [0, 1].map(|axis| self.center_m[axis] + half * self.size_m[axis]))
    }
}

fn default_floor_albedo() -> [f64; 3] {
    [0.7, 0.65, 0.5]
}

/// A light. Its `kind` selects its type.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Light {
    /// `kind = "sun"`.
    Sun(Sun),
    /// `kind = "point"`.
    Point(PointLight),
    /// `kind = "sky"`.
    Sky(Sky),
}

impl<'de> Deserialize<'de> for Light {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        tagged(
            deserializer,
            None,
            &["sun", "point", "sky"],
            |kind, value| match kind {
                "sun" => inner(value).map(Self::Sun),
                "point" => inner(value).map(Self::Point),
                _ => inner(value).map(Self::Sky),
            },
        )
    }
}

/// Parallel light from direction (cos e cos a, sin e, cos e sin a).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    /// Always `sun`.
    pub kind: SunKind,
    /// Elevation e above the horizon, degrees, −90 … 90. At or below 0 the sun gives no light, and the plan says so.
    pub elevation_deg: f64,
    /// Azimuth a, degrees from +X towards +Z, −10⁶ … 10⁶. Default 0.
    #[serde(default)]
    pub azimuth_deg: f64,
    /// Irradiance per channel on a plane facing the sun, W/m², 0 … 10⁹.
    #[schema(min_items = 3, max_items = 3)]
    pub irradiance_w_m2: [f64; 3],
}

/// A point that emits evenly in all directions, above or under the water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "kind": "point", "position_m": [0.5, 1.1, -0.3], "intensity_w_sr": [60, 50, 38] }))]
pub struct PointLight {
    /// Always `point`.
    pub kind: PointKind,
    /// Position, m, each −10⁸ … 10⁸. The waves at `time_s` decide whether it is above or under the water. Of a light under the
    /// water, the light that goes up to the surface is not followed.
    #[schema(min_items = 3, max_items = 3)]
    pub position_m: [f64; 3],
    /// Radiant intensity per channel, W/sr, 0 … 10⁹. The power, W, is 4π times that.
    #[schema(min_items = 3, max_items = 3)]
    pub intensity_w_sr: [f64; 3],
}

/// A uniform sky over the whole upper hemisphere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    /// Always `sky`.
    pub kind: SkyKind,
    /// Radiance per channel, W/(m² sr), 0 … 10⁹.
    #[schema(min_items = 3, max_items = 3)]
    pub radiance_w_m2_sr: [f64; 3],
}

/// A mesh placed in the world: p_world = translation + rotation · (scale · p_mesh).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Object {
    // The command line puts the id in the place of a path before it reads the scene.
    /// Mesh id, `blake3:…`, from the answer of `POST /v1/meshes`.
    pub mesh: String,
    /// Translation, m, −10⁸ … 10⁸. Default (0, 0, 0).
    #[serde(default)]
    #[schema(min_items = 3, max_items = 3)]
    pub translation_m: [f64; 3],
    /// Rotation as a quaternion (x, y, z, w) of length 1 ± 10⁻³, which is normalised on reading. Default (0, 0, 0, 1): no
    /// rotation.
    #[serde(default = "identity_rotation", deserialize_with = "rotation")]
    #[schema(min_items = 4, max_items = 4)]
    pub rotation: [f64; 4],
    /// Scale: one number or (x, y, z), each 10⁻⁶ … 10⁶. Default 1.
    #[serde(default)]
    pub scale: Scale,
    /// Diffuse reflectance per channel, 0 … 1. Default: that of the mesh's materials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 3, max_items = 3)]
    pub albedo: Option<[f64; 3]>,
}

/// The schema's derive macro takes a type called `Object` for any JSON object; hence this alias.
type MeshInstance = Object;

fn identity_rotation() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

/// One factor, or one per axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Scale {
    /// The same along all axes.
    Uniform(f64),
    /// Along x, y, z of the mesh.
    PerAxis([f64; 3]),
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        match value {
            Value::Number(_) => inner(&value).map(Self::Uniform),
            Value::Array(_) => inner(&value).map(Self::PerAxis),
            other => return Err(wrong_type(&other, "a number or an array of length 3")),
        }
        .map_err(serde::de::Error::custom)
    }
}

impl Default for Scale {
    fn default() -> Self {
        Self::Uniform(1.0)
    }
}

impl Scale {
    /// The factor along each axis.
    pub fn per_axis(self) -> [f64; 3] {
        match self {
            Self::Uniform(s) => [s; 3],
            Self::PerAxis(s) => s,
        }
    }
}

/// A camera. Its `kind` selects its type (default `perspective`).
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Camera {
    /// `kind = "perspective"`.
    Perspective(PerspectiveCamera),
    /// `kind = "orthographic"`.
    Orthographic(OrthographicCamera),
}

impl<'de> Deserialize<'de> for Camera {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        tagged(
            deserializer,
            Some("perspective"),
            &["perspective", "orthographic"],
            |kind, value| match kind {
                "orthographic" => inner(value).map(Self::Orthographic),
                _ => inner(value).map(|camera| Self::Perspective(with_field_of_view(camera))),
            },
        )
    }
}

impl Camera {
    /// Position, target and up direction.
    pub fn pose(&self) -> ([f64; 3], [f64; 3], [f64; 3]) {
        match self {
            Self::Perspective(c) => (c.position_m, c.target_m, c.up),
            Self::Orthographic(c) => (c.position_m, c.target_m, c.up),
        }
    }
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde calls it by reference"
)]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Gives a camera without `intrinsics` the default field of view.
fn with_field_of_view(mut camera: PerspectiveCamera) -> PerspectiveCamera {
    if camera.intrinsics.is_none() {
        camera
            .vertical_fov_deg
            .get_or_insert(DEFAULT_FIELD_OF_VIEW_DEG);
    }
    camera
}

/// Full vertical field of view of a camera that states none, degrees.
pub const DEFAULT_FIELD_OF_VIEW_DEG: f64 = 45.0;

/// A pinhole camera. Its lens is given by `vertical_fov_deg` (square pixels, the target in the middle of the picture) or by
/// `intrinsics`. The picture's aspect ratio follows from width and height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PerspectiveCamera {
    /// Always `perspective`; may be omitted.
    #[serde(default)]
    pub kind: PerspectiveKind,
    /// Position of the eye, m, −10⁸ … 10⁸.
    #[schema(min_items = 3, max_items = 3)]
    pub position_m: [f64; 3],
    /// A point on the viewing axis, m, −10⁸ … 10⁸; at least 10⁻⁶ m from `position_m`. It is in the middle of the picture, or with
    /// `intrinsics` at (`cx`, `cy`).
    #[schema(min_items = 3, max_items = 3)]
    pub target_m: [f64; 3],
    /// Up direction of any length above 0, each component −10⁶ … 10⁶; not parallel to the view. Default (0, 1, 0).
    #[serde(default = "default_up")]
    #[schema(min_items = 3, max_items = 3)]
    pub up: [f64; 3],
    /// Full vertical field of view, degrees, 0.1 … 179. Default 45. Not together with `intrinsics`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertical_fov_deg: Option<f64>,
    /// The lens of a calibrated camera.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<Intrinsics>,
    /// Radius of the dome port around the eye, m, 0 … 10. Default 0: none. Rays start at the dome, which they cross at right angles, so
    /// a camera whose dome is cut by the water shows a split picture: what lies over and what lies under the water line.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub dome_radius_m: f64,
}

/// Intrinsic parameters of a pinhole camera, pixels of a picture of `output.width` × `output.height`.
///
/// A point with the camera coordinates X (right), Y (down), Z (ahead) is seen at u = fx X / Z + cx, v = fy Y / Z + cy. u and v count
/// from the upper left corner of the picture: the middle of the first pixel is at (½, ½). OpenCV counts from the middle of the first
/// pixel: add ½ to its `cx` and `cy`. Every pixel has to be within 89.5° of the axis. Lens distortion is not simulated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Intrinsics {
    /// Focal length along x, pixels, 10⁻³ … 10⁸.
    pub fx: f64,
    /// Focal length along y, pixels, 10⁻³ … 10⁸.
    pub fy: f64,
    /// Column of the principal point, pixels from the left edge, −10⁶ … 10⁶.
    pub cx: f64,
    /// Row of the principal point, pixels from the upper edge, −10⁶ … 10⁶.
    pub cy: f64,
}

/// A camera with parallel rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OrthographicCamera {
    /// Always `orthographic`.
    pub kind: OrthographicKind,
    /// Middle of the image plane, m, −10⁸ … 10⁸.
    #[schema(min_items = 3, max_items = 3)]
    pub position_m: [f64; 3],
    /// The point in the middle of the picture, m, −10⁸ … 10⁸; at least 10⁻⁶ m from `position_m`.
    #[schema(min_items = 3, max_items = 3)]
    pub target_m: [f64; 3],
    /// Up direction of any length above 0, each component −10⁶ … 10⁶; not parallel to the view. Default (0, 1, 0).
    #[serde(default = "default_up")]
    #[schema(min_items = 3, max_items = 3)]
    pub up: [f64; 3],
    /// Height of the picture in the world, m, 10⁻⁶ … 10⁶.
    pub height_m: f64,
}

fn default_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// What to make. Its `kind` selects its type.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Output {
    /// `kind = "view"`: what the camera sees.
    View(ViewOutput),
    /// `kind = "irradiance_map"`: irradiance on a receiver, by texel.
    IrradianceMap(IrradianceMapOutput),
    /// `kind = "water_map"`: height and slope of the water over a rectangle.
    WaterMap(WaterMapOutput),
}

impl Default for Output {
    fn default() -> Self {
        Self::View(ViewOutput::default())
    }
}

impl<'de> Deserialize<'de> for Output {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        tagged(
            deserializer,
            None,
            &["view", "irradiance_map", "water_map"],
            |kind, value| match kind {
                "irradiance_map" => inner(value).map(Self::IrradianceMap),
                "water_map" => inner(value).map(Self::WaterMap),
                _ => inner(value).map(Self::View),
            },
        )
    }
}

impl Output {
    /// Whether it is an irradiance map of a mesh.
    pub fn is_object_map(&self) -> bool {
        matches!(self, Self::IrradianceMap(map) if matches!(map.receiver, Receiver::Object(_)))
    }

    /// Whether it is a map of the water, which has no light in it.
    pub fn is_water_map(&self) -> bool {
        matches!(self, Self::WaterMap(_))
    }

    /// Whether it is a view of the camera.
    pub fn is_view(&self) -> bool {
        matches!(self, Self::View(_))
    }

    /// How the result is written to a file.
    pub fn encoding(&self) -> Encoding {
        match self {
            Self::View(o) => Encoding {
                format: o.format,
                png_bits: o.png_bits,
                exposure_ev: o.exposure_ev,
                tone_curve: o.tone_curve,
                exr_pixel: o.exr_pixel,
                embed_scene: o.embed_scene,
            },
            Self::IrradianceMap(o) => Encoding {
                format: o.format,
                png_bits: o.png_bits,
                exposure_ev: o.exposure_ev,
                tone_curve: o.tone_curve,
                exr_pixel: ExrPixel::Float,
                embed_scene: o.embed_scene,
            },
            Self::WaterMap(o) => Encoding {
                format: o.format,
                png_bits: o.png_bits,
                exposure_ev: 0.0,
                tone_curve: ToneCurve::default(),
                exr_pixel: ExrPixel::Float,
                embed_scene: o.embed_scene,
            },
        }
    }
}

/// What the camera sees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ViewOutput {
    /// Always `view`.
    pub kind: ViewKind,
    /// Picture width, pixels, 1 … 16384. Default 960.
    #[serde(default = "default_width", deserialize_with = "integer::<ViewSide, _>")]
    #[schema(minimum = 1, maximum = 16384)]
    pub width: u32,
    /// Picture height, pixels, 1 … 16384. Default 540.
    #[serde(
        default = "default_height",
        deserialize_with = "integer::<ViewSide, _>"
    )]
    #[schema(minimum = 1, maximum = 16384)]
    pub height: u32,
    /// File format. Default `png`.
    #[serde(default)]
    pub format: ImageFormat,
    /// Bits per PNG channel, 8 or 16. Default 8. EXR ignores it.
    #[serde(
        default = "default_png_bits",
        deserialize_with = "integer::<PngBits, _>"
    )]
    #[schema(minimum = 8, maximum = 16)]
    pub png_bits: u32,
    /// Exposure, stops relative to the scene's own exposure (see `stats.exposure`), −40 … 40. Default 0. PNG only: EXR is not
    /// exposed.
    #[serde(default)]
    pub exposure_ev: f64,
    /// Tone curve of PNG. Default `pbr_neutral`.
    #[serde(default)]
    pub tone_curve: ToneCurve,
    /// Number type of the EXR channels R, G, B, A and `albedo.*`; all others are always float. Default `half`.
    #[serde(default)]
    pub exr_pixel: ExrPixel,
    /// Whether the file contains the scene as JSON (`caustica:scene`), with meshes named by content ids. Default true.
    #[serde(default = "yes", skip_serializing_if = "is_true")]
    pub embed_scene: bool,
    /// Layers to compute and write. PNG holds `radiance` only. `depth` is to the first surface, the water's included, `seen_depth` to the
    /// surface seen, which may lie behind the water like that of all other layers; both are along the viewing axis (z), not along the
    /// ray. Default [`radiance`].
    #[serde(default = "default_layers")]
    pub layers: Vec<LayerName>,
}

impl Default for ViewOutput {
    fn default() -> Self {
        Self {
            kind: ViewKind::default(),
            width: default_width(),
            height: default_height(),
            format: ImageFormat::default(),
            png_bits: default_png_bits(),
            exposure_ev: 0.0,
            tone_curve: ToneCurve::default(),
            exr_pixel: ExrPixel::default(),
            embed_scene: true,
            layers: default_layers(),
        }
    }
}

pub(super) fn yes() -> bool {
    true
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde hands over a reference"
)]
pub(super) fn is_true(value: &bool) -> bool {
    *value
}

fn default_width() -> u32 {
    960
}

fn default_height() -> u32 {
    540
}

fn default_png_bits() -> u32 {
    8
}

fn default_layers() -> Vec<LayerName> {
    vec![LayerName::Radiance]
}

/// Irradiance on a receiver, by texel.
///
/// On the floor, texel (i, j) is centred at x = min + (i + ½)Δ, z = min + (j + ½)Δ; row 0 is at min z. On a mesh, the map covers
/// the same square as the mesh's level map, with `quality.level_map_texels` texels along each side; `min_m`, `max_m`, `width` and
/// `height` are not accepted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct IrradianceMapOutput {
    /// Always `irradiance_map`.
    pub kind: IrradianceMapKind,
    /// `"floor"` or an index into `objects`.
    pub receiver: Receiver,
    /// Lower corner (x, z) of the map on the floor, m, −10⁸ … 10⁸. Floor only. Default: the floor's lower corner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub min_m: Option<[f64; 2]>,
    /// Upper corner (x, z) of the map on the floor, m, −10⁸ … 10⁸; greater than `min_m`. Floor only. Default: the floor's upper
    /// corner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub max_m: Option<[f64; 2]>,
    /// Texels along x, 1 … 8192. Floor only. Default 512.
    #[serde(
        default,
        deserialize_with = "optional_integer::<MapSide, _>",
        skip_serializing_if = "Option::is_none"
    )]
    #[schema(minimum = 1, maximum = 8192)]
    pub width: Option<u32>,
    /// Texels along z, 1 … 8192. Floor only. Default 512.
    #[serde(
        default,
        deserialize_with = "optional_integer::<MapSide, _>",
        skip_serializing_if = "Option::is_none"
    )]
    #[schema(minimum = 1, maximum = 8192)]
    pub height: Option<u32>,
    /// Index into `lights`: the map then has the light of this sun or point light only. Required on a mesh if the scene has
    /// several of them. Default: all.
    #[serde(
        default,
        deserialize_with = "optional_integer::<LightIndex, _>",
        skip_serializing_if = "Option::is_none"
    )]
    pub light: Option<u32>,
    /// Which surface of the mesh, counted from 0 along the light's direction under flat water, nearest first: 0 …
    /// `quality.layers` − 1. Mesh only. Default 0.
    #[serde(default, deserialize_with = "integer::<Layer, _>")]
    pub layer: u32,
    /// Whether the light of skies is included. Default false.
    #[serde(default)]
    pub include_sky: bool,
    /// File format. Default `exr`, channels R, G, B as float, W/m².
    #[serde(default = "default_map_format")]
    pub format: ImageFormat,
    /// Bits per PNG channel, 8 or 16. Default 8.
    #[serde(
        default = "default_png_bits",
        deserialize_with = "integer::<PngBits, _>"
    )]
    #[schema(minimum = 8, maximum = 16)]
    pub png_bits: u32,
    /// Exposure, stops relative to the scene's own exposure (see `stats.exposure`), −40 … 40. Default 0. PNG only: EXR is not
    /// exposed.
    #[serde(default)]
    pub exposure_ev: f64,
    /// Tone curve of PNG. Default `pbr_neutral`.
    #[serde(default)]
    pub tone_curve: ToneCurve,
    /// Whether the file contains the scene as JSON (`caustica:scene`), with meshes named by content ids. Default true.
    #[serde(default = "yes", skip_serializing_if = "is_true")]
    pub embed_scene: bool,
}

pub(super) fn default_map_format() -> ImageFormat {
    ImageFormat::Exr
}

/// A surface that receives light: `"floor"` or an index into `objects`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Receiver {
    /// The floor rectangle.
    Floor(FloorWord),
    /// An index into `objects`.
    Object(u32),
}

impl<'de> Deserialize<'de> for Receiver {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        match &value {
            Value::String(word) if word == "floor" => Ok(Self::Floor(FloorWord::Word)),
            Value::Number(_) => integer_of::<ReceiverIndex>(&value)
                .map(Self::Object)
                .map_err(|issue| serde::de::Error::custom(carry(&issue))),
            other => Err(wrong_type(other, &ReceiverIndex::accepted())),
        }
    }
}

/// How linear layers are written to a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoding {
    /// File format.
    pub format: ImageFormat,
    /// Bits per PNG channel, 8 or 16.
    pub png_bits: u32,
    /// Stops relative to the scene's own exposure (PNG).
    pub exposure_ev: f64,
    /// Tone curve (PNG).
    pub tone_curve: ToneCurve,
    /// Number type of colour channels (EXR).
    pub exr_pixel: ExrPixel,
    /// Whether the file contains the scene.
    pub embed_scene: bool,
}

/// File format of a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ImageFormat {
    /// sRGB, exposed and tone-mapped; of a water map, the normals.
    #[default]
    Png,
    /// Scene-linear, unexposed, ZIP.
    Exr,
}

/// Tone curve of PNG, applied to exposed linear light before the sRGB encoding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToneCurve {
    /// Clip at 1. A warning states the number of clipped pixels.
    Clip,
    /// Khronos PBR Neutral: identity up to 0.76, then a shoulder that desaturates highlights.
    #[default]
    PbrNeutral,
}

/// Number type of EXR colour channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExrPixel {
    /// 16-bit float.
    #[default]
    Half,
    /// 32-bit float.
    Float,
}

/// A layer of a view.
///
/// - `radiance`: at the camera, W/(m² sr), with alpha; EXR R G B A.
/// - `depth`: distance along the viewing axis (z, not the length of the ray) to the first surface on the ray, the water's included, m;
///   EXR Z.
/// - `seen_depth`: distance along the viewing axis to the surface seen, which may lie behind the water, m; EXR seen.Z. For a surface that
///   the water mirrors it may be smaller than `depth`, and negative.
/// - `normal`, `position`, `albedo`, `irradiance`: of the surface seen; EXR N.X N.Y N.Z, P.X P.Y P.Z, albedo.R … and irradiance.R ….
///
/// Where a pixel sees no surface, `seen_depth` is 10¹⁰ m and these four are 0; `depth` is 10¹⁰ m only if there is no water either.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LayerName {
    /// Radiance at the camera, W/(m² sr), and alpha; EXR root R G B A.
    Radiance,
    /// Distance along the viewing axis (not along the ray) to the first surface on the ray, the water's included, m; EXR root Z;
    /// 10¹⁰ if the ray meets nothing. All other layers are those of the surface seen, which may lie behind the water.
    Depth,
    /// Distance along the viewing axis to the surface seen, m: (P − camera position) · viewing direction. It is `depth` where no water
    /// is in between; for a surface mirrored in the water it may be smaller, and negative; EXR seen.Z; 10¹⁰ if no surface is seen.
    SeenDepth,
    /// World normal of the surface seen through the water; EXR N.X N.Y N.Z.
    Normal,
    /// World position of the surface seen through the water, m; EXR P.X P.Y P.Z.
    Position,
    /// Diffuse reflectance of the surface seen; EXR albedo.R albedo.G albedo.B.
    Albedo,
    /// Irradiance on the surface seen, W/m²; EXR irradiance.R irradiance.G irradiance.B.
    Irradiance,
    /// Height of the water, m, and its slopes along x and z; EXR height slope.x slope.z. Only of a water map: no layer of a view.
    #[serde(skip)]
    Water,
}

/// Declares the one-word type of a `kind` field. (`tt`, not `literal`: the schema's derive macro cannot read a `literal`.)
macro_rules! kinds {
    ($($name:ident = $word:tt),+ $(,)?) => {$(
        #[doc = concat!("The word `", $word, "`.")]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
        pub enum $name {
            #[doc = concat!("`", $word, "`")]
            #[default]
            #[serde(rename = $word)]
            Word,
        }
    )+};
}

kinds! {
    FloorWord = "floor",
    SineKind = "sine",
    GerstnerKind = "gerstner",
    SpectrumKind = "spectrum",
    RipplesKind = "ripples",
    HeightFieldKind = "height_field",
    SunKind = "sun",
    PointKind = "point",
    SkyKind = "sky",
    PerspectiveKind = "perspective",
    OrthographicKind = "orthographic",
    ViewKind = "view",
    IrradianceMapKind = "irradiance_map",
    WaterMapKind = "water_map",
}
