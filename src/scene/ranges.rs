//! The ranges of a scene's numbers. The range of an integer is a type, so that `types` can name it where the field is read.

use std::fmt;

/// A closed range of f64 with its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest accepted value.
    pub min: f64,
    /// Largest accepted value.
    pub max: f64,
    /// Unit, empty for pure numbers.
    pub unit: &'static str,
}

impl Range {
    const fn new(min: f64, max: f64, unit: &'static str) -> Self {
        Self { min, max, unit }
    }

    /// Whether `value` lies inside; NaN does not.
    pub fn contains(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (min, max) = (number(self.min), number(self.max));
        write!(f, "a number, {min} … {max}")?;
        match self.unit {
            "" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}

/// Formats a number for messages: in scientific notation below 10⁻³ and from 10⁶ on.
pub(super) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-3..1e6).contains(&magnitude) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// `time_s`.
pub const TIME: Range = Range::new(-1e12, 1e12, "s");
/// Positions, translations, corners and the water level: enough for map projections (UTM reaches 10⁷ m, Web Mercator 2·10⁷ m) and
/// earth-centred coordinates. Steps of f64 are 1.5·10⁻⁸ m there.
pub const COORDINATE: Range = Range::new(-1e8, 1e8, "m");
/// `floor.size_m`, the height of an orthographic picture.
pub const EXTENT: Range = Range::new(1e-6, 1e6, "m");
/// Angles that may exceed a full turn.
pub const TURNING_ANGLE: Range = Range::new(-1e6, 1e6, "degrees");
/// `dome_radius_m` of a camera.
pub const DOME_RADIUS: Range = Range::new(0.0, 10.0, "m");
/// `water.ior`.
pub const IOR: Range = Range::new(1.0, 4.0, "");
/// `water.absorption_per_m` and `water.scattering_per_m`.
pub const COEFFICIENT: Range = Range::new(0.0, 1e4, "1/m");
/// `amplitude_m`.
pub const AMPLITUDE: Range = Range::new(0.0, 100.0, "m");
/// `wavelength_m`.
pub const WAVELENGTH: Range = Range::new(1e-3, 1e5, "m");
/// `period_s`.
pub const PERIOD: Range = Range::new(1e-6, 1e12, "s");
/// `steepness` of a Gerstner wave: its curvature grows as 1/(1 − s)².
pub const STEEPNESS: Range = Range::new(0.0, 0.95, "");
/// `wind_speed_m_s`.
pub const WIND_SPEED: Range = Range::new(0.0, 60.0, "m/s");
/// `fetch_m`.
pub const FETCH: Range = Range::new(1.0, 1e7, "m");
/// `gamma`.
pub const GAMMA: Range = Range::new(1.0, 10.0, "");
/// `swell`.
pub const SWELL: Range = Range::new(0.0, 1.0, "");
/// `choppiness`.
pub const CHOPPINESS: Range = Range::new(0.0, 2.0, "");
/// `significant_height_m`.
pub const SIGNIFICANT_HEIGHT: Range = Range::new(0.0, 100.0, "m");
/// `tile_m`, and the sides of a basin.
pub const TILE: Range = Range::new(0.01, 1e4, "m");
/// `loop_s`.
pub const LOOP: Range = Range::new(1e-3, 1e6, "s");
/// `radius_m` of a drop.
pub const DROP_RADIUS: Range = Range::new(1e-4, 1e4, "m");
/// `height_m` of a drop.
pub const DROP_HEIGHT: Range = Range::new(-100.0, 100.0, "m");
/// `damping_per_s`.
pub const DAMPING: Range = Range::new(0.0, 1e3, "1/s");
/// `scale_m` and `slope_scale` of a height field.
pub const FIELD_SCALE: Range = Range::new(-1e6, 1e6, "");
/// `range_m` and `slope_range` of a height field.
pub const FIELD_RANGE: Range = Range::new(-1e5, 1e5, "");
/// `rest_m` of a height field.
pub const REST_HEIGHT: Range = Range::new(-1e6, 1e6, "m");
/// `sample_m` of a height field.
pub const SAMPLE_DISTANCE: Range = Range::new(1e-5, 1e3, "m");
/// `rim_m` of a height field: its other limits depend on the samples.
pub const TILE_OR_LESS: Range = Range::new(0.0, 1e4, "m");
/// `frames_per_s` of a height field.
pub const FRAME_RATE: Range = Range::new(1e-6, 1e6, "1/s");
/// Most samples of all spectra, basins and height fields of a scene: 64 MiB on the GPU.
pub const MAX_GRID_SAMPLES: u64 = 1 << 24;
/// Most standing waves of all drops of a scene: a few seconds.
pub const MAX_SWINGS: u64 = 1 << 28;
/// Most samples × steps of all basins with obstacles of a scene, from their first drops to the time of the frame: some ten seconds.
pub const MAX_SAMPLE_STEPS: f64 = 4e9;
/// Most drops of one basin.
pub const MAX_DROPS: usize = 256;
/// `floor.depth_m`.
pub const DEPTH: Range = Range::new(0.0, 11_000.0, "m");
/// Diffuse reflectances.
pub const ALBEDO: Range = Range::new(0.0, 1.0, "");
/// `elevation_deg`.
pub const ELEVATION: Range = Range::new(-90.0, 90.0, "degrees");
/// `irradiance_w_m2`.
pub const IRRADIANCE: Range = Range::new(0.0, 1e9, "W/m²");
/// `intensity_w_sr`.
pub const INTENSITY: Range = Range::new(0.0, 1e9, "W/sr");
/// `radiance_w_m2_sr`.
pub const RADIANCE: Range = Range::new(0.0, 1e9, "W/(m² sr)");
/// `scale`.
pub const SCALE: Range = Range::new(1e-6, 1e6, "");
/// Components of `up`.
pub const UP: Range = Range::new(-1e6, 1e6, "");
/// `vertical_fov_deg`.
pub const FIELD_OF_VIEW: Range = Range::new(0.1, 179.0, "degrees");
/// `fx` and `fy` of `intrinsics`.
pub const FOCAL_LENGTH: Range = Range::new(1e-3, 1e8, "pixels");
/// `cx` and `cy` of `intrinsics`.
pub const PRINCIPAL_POINT: Range = Range::new(-1e6, 1e6, "pixels");
/// Largest angle between the axis and an edge of the picture, degrees: half of the largest field of view.
pub const MAX_OFF_AXIS_DEG: f64 = 89.5;
/// `exposure_ev`.
pub const EXPOSURE: Range = Range::new(-40.0, 40.0, "stops");

/// `quality.level_of_detail`.
pub const LEVEL_OF_DETAIL: Range = Range::new(0.0, 16.0, "texels per pixel");
/// `quality.target_error`.
pub const TARGET_ERROR: Range = Range::new(1e-4, 0.5, "");
/// `quality.time_budget_ms`.
pub const TIME_BUDGET: Range = Range::new(0.1, 3.6e6, "ms");

/// Default number of texels along a side of a floor map.
pub const DEFAULT_MAP_SIDE: u32 = 512;

/// The range of an integer field.
pub trait Integer {
    /// Smallest accepted value.
    const MIN: u32;
    /// Largest accepted value.
    const MAX: u32;

    /// The accepted values, for messages.
    fn accepted() -> String {
        format!("an integer, {} … {}", Self::MIN, Self::MAX)
    }

    /// Whether `value` is accepted.
    fn accepts(value: u32) -> bool {
        (Self::MIN..=Self::MAX).contains(&value)
    }
}

/// Declares the ranges of integer fields.
macro_rules! integers {
    ($($(#[$doc:meta])* $name:ident = $min:literal ..= $max:expr;)+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl Integer for $name {
            const MIN: u32 = $min;
            const MAX: u32 = $max;
        }
    )+};
}

integers! {
    /// `quality.water_cells`.
    WaterCells = 2..=2048;
    /// `quality.map_texels`.
    MapTexels = 16..=4096;
    /// `quality.layers`.
    Layers = 1..=4;
    /// `output.layer`. That it is below `quality.layers` is checked in `validate_output`.
    Layer = 0..=3;
    /// `quality.split_levels`.
    SplitLevels = 0..=8;
    /// `quality.pixel_samples`.
    PixelSamples = 1..=8;
    /// `quality.bounces`.
    Bounces = 0..=4;
    /// `samples` of ripples.
    BasinSamples = 16..=1024;
    /// `seed`.
    Seed = 0..=u32::MAX;
    /// `width` and `height` of a view.
    ViewSide = 1..=16_384;
    /// `width` and `height` of a map.
    MapSide = 1..=8192;
}

/// `quality.level_map_texels`.
#[derive(Clone, Copy, Debug)]
pub struct LevelMapTexels;

impl Integer for LevelMapTexels {
    const MIN: u32 = 16;
    const MAX: u32 = 2048;

    fn accepted() -> String {
        "a power of two, 16 … 2048".to_owned()
    }

    fn accepts(value: u32) -> bool {
        (Self::MIN..=Self::MAX).contains(&value) && value.is_power_of_two()
    }
}

/// `samples` of a spectrum.
#[derive(Clone, Copy, Debug)]
pub struct SpectrumSamples;

impl Integer for SpectrumSamples {
    const MIN: u32 = 64;
    const MAX: u32 = 2048;

    fn accepted() -> String {
        "a power of two, 64 … 2048".to_owned()
    }

    fn accepts(value: u32) -> bool {
        (Self::MIN..=Self::MAX).contains(&value) && value.is_power_of_two()
    }
}

/// `png_bits`.
#[derive(Clone, Copy, Debug)]
pub struct PngBits;

impl Integer for PngBits {
    const MIN: u32 = 8;
    const MAX: u32 = 16;

    fn accepted() -> String {
        "8 or 16".to_owned()
    }

    fn accepts(value: u32) -> bool {
        value == 8 || value == 16
    }
}

/// `output.light`. That the light exists is checked in `validate_output`.
#[derive(Clone, Copy, Debug)]
pub struct LightIndex;

impl Integer for LightIndex {
    const MIN: u32 = 0;
    const MAX: u32 = u32::MAX;

    fn accepted() -> String {
        "an index into `lights`".to_owned()
    }
}

/// `output.receiver` if it is a mesh.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverIndex;

impl Integer for ReceiverIndex {
    const MIN: u32 = 0;
    const MAX: u32 = u32::MAX;

    fn accepted() -> String {
        "\"floor\" or an index into `objects`".to_owned()
    }
}
