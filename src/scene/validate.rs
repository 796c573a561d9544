//! Checks ranges and references of a scene that has been read.

use glam::DVec3;

use super::error::SceneError;
use super::findings::Findings;
use super::height_field;
use super::parse::ROTATION_LENGTH_TOLERANCE;
use super::quality::Quality;
use super::ranges::{self, number};
use super::types::{Camera, Floor, Intrinsics, Light, Object, Output, Scale, Scene, Water};
use super::waves::{GerstnerWave, Ripples, SpectrumWaves, Wave};
use super::{validate_obstacles, validate_output};
use crate::config::Limits;

/// Smallest distance from a camera to its target, m.
pub const MIN_VIEW_DISTANCE_M: f64 = 1e-6;

/// Smallest sine of the angle between the up direction and the view.
pub const MIN_UP_SINE: f64 = 1e-6;

/// Largest ratio of the sides of a pixel.
const MAX_PIXEL_ASPECT: f64 = 1000.0;

impl Scene {
    /// Checks every range and reference.
    ///
    /// Whether the meshes exist is checked in [`super::resolve`].
    ///
    /// # Errors
    ///
    /// All findings, in the order of the fields; at most 100 are listed.
    pub fn validate(&self, limits: &Limits) -> Result<(), SceneError> {
        let mut findings = Findings::default();
        findings.number("/time_s", self.time_s, &ranges::TIME);
        water(&mut findings, &self.water, limits);
        validate_obstacles::obstacles(&mut findings, self);
        if let Some(floor_there) = &self.floor {
            floor(&mut findings, floor_there);
        }
        lights(&mut findings, &self.lights, limits);
        objects(&mut findings, &self.objects, limits);
        if let Some(camera_there) = &self.camera {
            camera(&mut findings, camera_there, &self.output);
        }
        quality(&mut findings, &self.quality);
        validate_output::output(&mut findings, self, limits);
        let issues = findings.into_issues();
        if issues.is_empty() {
            Ok(())
        } else {
            Err(SceneError { issues })
        }
    }
}

fn water(findings: &mut Findings, water: &Water, limits: &Limits) {
    findings.number("/water/level_m", water.level_m, &ranges::COORDINATE);
    findings.number("/water/ior", water.ior, &ranges::IOR);
    let coefficients = &ranges::COEFFICIENT;
    findings.numbers(
        "/water/absorption_per_m",
        &water.absorption_per_m,
        coefficients,
    );
    findings.numbers(
        "/water/scattering_per_m",
        &water.scattering_per_m,
        coefficients,
    );
    let waves = &water.waves;
    if !findings.count("/water/waves", "waves", waves.len(), limits.max_waves) {
        return;
    }
    let sum = |of: fn(&Wave) -> u64| waves.iter().map(of).fold(0, u64::saturating_add);
    let samples = sum(Wave::grid_samples);
    if samples > ranges::MAX_GRID_SAMPLES {
        findings.over_limit(
            "/water/waves",
            format!("all spectra and basins together have {samples} samples"),
            format!(
                "at most {}, as of four spectra of 2048 × 2048",
                ranges::MAX_GRID_SAMPLES
            ),
        );
        return;
    }
    let swings = sum(Wave::swings);
    if swings > ranges::MAX_SWINGS {
        findings.over_limit(
            "/water/waves",
            format!("all drops together move {swings} waves of their basins"),
            format!(
                "at most {} (samples² × drops, sixteen times that where walls absorb; as of one reflecting basin of 1024 samples with 256 drops)",
                ranges::MAX_SWINGS
            ),
        );
        return;
    }
    for (index, wave) in waves.iter().enumerate() {
        let at = |field: &str| format!("/water/waves/{index}/{field}");
        let angle = &ranges::TURNING_ANGLE;
        match wave {
            Wave::Sine(sine) => {
                findings.number(at("amplitude_m"), sine.amplitude_m, &ranges::AMPLITUDE);
                findings.number(at("wavelength_m"), sine.wavelength_m, &ranges::WAVELENGTH);
                findings.number(at("direction_deg"), sine.direction_deg, angle);
                findings.number(at("phase_deg"), sine.phase_deg, angle);
                if let Some(period_s) = sine.period_s {
                    findings.number(at("period_s"), period_s, &ranges::PERIOD);
                }
            }
            Wave::Gerstner(wave) => gerstner(findings, wave, &at),
            Wave::Spectrum(waves) => spectrum(findings, waves, &at),
            Wave::Ripples(waves) => ripples(findings, waves, &at),
            Wave::HeightField(waves) => height_field::check(findings, waves, &at),
        }
    }
}

fn gerstner(findings: &mut Findings, wave: &GerstnerWave, at: &dyn Fn(&str) -> String) {
    let angle = &ranges::TURNING_ANGLE;
    let mut is_sound = findings.number(at("amplitude_m"), wave.amplitude_m, &ranges::AMPLITUDE);
    is_sound &= findings.number(at("wavelength_m"), wave.wavelength_m, &ranges::WAVELENGTH);
    findings.number(at("direction_deg"), wave.direction_deg, angle);
    findings.number(at("phase_deg"), wave.phase_deg, angle);
    if let Some(period_s) = wave.period_s {
        findings.number(at("period_s"), period_s, &ranges::PERIOD);
    }
    match wave.steepness {
        Some(steepness) => {
            findings.number(at("steepness"), steepness, &ranges::STEEPNESS);
        }
        None if is_sound && !ranges::STEEPNESS.contains(wave.steepness_used()) => {
            let limit_m = ranges::STEEPNESS.max * wave.wavelength_m / std::f64::consts::TAU;
            findings.invalid(
                at("amplitude_m"),
                format!(
                    "the steepness 2π · amplitude / wavelength is {}, at which crests fold over themselves or nearly do",
                    number(wave.steepness_used())
                ),
                format!("at most {} m for this wavelength, or a `steepness` of 0 … {}", number(limit_m), ranges::STEEPNESS.max),
            );
        }
        None => {}
    }
}

fn spectrum(findings: &mut Findings, waves: &SpectrumWaves, at: &dyn Fn(&str) -> String) {
    findings.number(
        at("wind_speed_m_s"),
        waves.wind_speed_m_s,
        &ranges::WIND_SPEED,
    );
    let angle = &ranges::TURNING_ANGLE;
    findings.number(at("wind_direction_deg"), waves.wind_direction_deg, angle);
    findings.number(at("fetch_m"), waves.fetch_m, &ranges::FETCH);
    findings.number(at("gamma"), waves.gamma, &ranges::GAMMA);
    findings.number(at("swell"), waves.swell, &ranges::SWELL);
    findings.number(at("choppiness"), waves.choppiness, &ranges::CHOPPINESS);
    let is_sound = findings.number(at("tile_m"), waves.tile_m, &ranges::TILE);
    let is_sound =
        is_sound & findings.integer::<ranges::SpectrumSamples>(&at("samples"), waves.samples);
    let wavelength = &ranges::WAVELENGTH;
    for (field, value, range) in [
        ("min_wavelength_m", waves.min_wavelength_m, wavelength),
        ("max_wavelength_m", waves.max_wavelength_m, wavelength),
        (
            "significant_height_m",
            waves.significant_height_m,
            &ranges::SIGNIFICANT_HEIGHT,
        ),
        ("loop_s", waves.loop_s, &ranges::LOOP),
    ] {
        if let Some(value) = value {
            findings.number(at(field), value, range);
        }
    }
    if is_sound {
        let [shortest_m, longest_m] = waves.band_m();
        if shortest_m > longest_m {
            findings.invalid(
                at("min_wavelength_m"),
                format!("the shortest wave, {} m, is longer than the longest, {} m", number(shortest_m), number(longest_m)),
                "`min_wavelength_m` of at most `max_wavelength_m`; a tile of `tile_m` carries no longer waves than itself".to_owned(),
            );
        }
        let carried_m = waves.shortest_carried_m();
        if waves
            .min_wavelength_m
            .is_some_and(|shortest_m| shortest_m < carried_m)
        {
            findings.invalid(
                at("min_wavelength_m"),
                format!(
                    "{} samples on {} m do not carry it",
                    waves.samples,
                    number(waves.tile_m)
                ),
                format!(
                    "at least {} m, four samples; or more `samples`, or a smaller `tile_m`",
                    number(carried_m)
                ),
            );
        }
    }
}

fn ripples(findings: &mut Findings, waves: &Ripples, at: &dyn Fn(&str) -> String) {
    let coordinate = &ranges::COORDINATE;
    let mut is_sound = findings.numbers(&at("min_m"), &waves.min_m, coordinate);
    is_sound &= findings.numbers(&at("max_m"), &waves.max_m, coordinate);
    findings.integer::<ranges::BasinSamples>(&at("samples"), waves.samples);
    findings.number(at("damping_per_s"), waves.damping_per_s, &ranges::DAMPING);
    if is_sound {
        for axis in [0, 1] {
            let side_m = waves.max_m[axis] - waves.min_m[axis];
            if !ranges::TILE.contains(side_m) {
                findings.invalid(
                    format!("{}/{axis}", at("max_m")),
                    format!(
                        "along {} the basin is {} m long",
                        ["x", "z"][axis],
                        number(side_m)
                    ),
                    format!(
                        "{} … {} m beyond `min_m`",
                        number(ranges::TILE.min),
                        number(ranges::TILE.max)
                    ),
                );
                is_sound = false;
            }
        }
    }
    if !findings.count(&at("drops"), "drops", waves.drops.len(), ranges::MAX_DROPS) {
        return;
    }
    for (index, drop) in waves.drops.iter().enumerate() {
        let at = |field: &str| at(&format!("drops/{index}/{field}"));
        let is_sized = findings.number(at("radius_m"), drop.radius_m, &ranges::DROP_RADIUS);
        let shorter_m = (waves.max_m[0] - waves.min_m[0]).min(waves.max_m[1] - waves.min_m[1]);
        if is_sound && is_sized && drop.radius_m > shorter_m {
            findings.invalid(
                at("radius_m"),
                format!(
                    "the drop is wider than the basin, whose shorter side is {} m",
                    number(shorter_m)
                ),
                "at most the shorter side".to_owned(),
            );
        }
        findings.number(at("height_m"), drop.height_m, &ranges::DROP_HEIGHT);
        findings.number(at("at_s"), drop.at_s, &ranges::TIME);
        let is_placed = findings.numbers(&at("position_m"), &drop.position_m, coordinate);
        let is_inside = (0..2)
            .all(|axis| (waves.min_m[axis]..=waves.max_m[axis]).contains(&drop.position_m[axis]));
        if is_sound && is_placed && !is_inside {
            findings.invalid(
                at("position_m"),
                "the drop is outside of the basin",
                format!("a position from {:?} to {:?} m", waves.min_m, waves.max_m),
            );
        }
    }
}

fn floor(findings: &mut Findings, floor: &Floor) {
    findings.number("/floor/depth_m", floor.depth_m, &ranges::DEPTH);
    findings.numbers("/floor/size_m", &floor.size_m, &ranges::EXTENT);
    findings.numbers("/floor/center_m", &floor.center_m, &ranges::COORDINATE);
    findings.numbers("/floor/albedo", &floor.albedo, &ranges::ALBEDO);
}

fn lights(findings: &mut Findings, lights: &[Light], limits: &Limits) {
    if !findings.count("/lights", "lights", lights.len(), limits.max_lights) {
        return;
    }
    for (index, light) in lights.iter().enumerate() {
        let at = |field: &str| format!("/lights/{index}/{field}");
        match light {
            Light::Sun(sun) => {
                findings.number(at("elevation_deg"), sun.elevation_deg, &ranges::ELEVATION);
                findings.number(at("azimuth_deg"), sun.azimuth_deg, &ranges::TURNING_ANGLE);
                let pointer = at("irradiance_w_m2");
                findings.numbers(&pointer, &sun.irradiance_w_m2, &ranges::IRRADIANCE);
            }
            Light::Point(point) => {
                let position = at("position_m");
                findings.numbers(&position, &point.position_m, &ranges::COORDINATE);
                let intensity = at("intensity_w_sr");
                findings.numbers(&intensity, &point.intensity_w_sr, &ranges::INTENSITY);
            }
            Light::Sky(sky) => {
                let pointer = at("radiance_w_m2_sr");
                findings.numbers(&pointer, &sky.radiance_w_m2_sr, &ranges::RADIANCE);
            }
        }
    }
}

fn objects(findings: &mut Findings, objects: &[Object], limits: &Limits) {
    if !findings.count("/objects", "objects", objects.len(), limits.max_objects) {
        return;
    }
    for (index, object) in objects.iter().enumerate() {
        let at = |field: &str| format!("/objects/{index}/{field}");
        if object.mesh.is_empty() {
            findings.invalid(at("mesh"), "the mesh id is empty", "`blake3:…`");
        }
        let translation = at("translation_m");
        findings.numbers(&translation, &object.translation_m, &ranges::COORDINATE);
        rotation(findings, at("rotation"), object.rotation);
        match object.scale {
            Scale::Uniform(scale) => {
                findings.number(at("scale"), scale, &ranges::SCALE);
            }
            Scale::PerAxis(scales) => {
                findings.numbers(&at("scale"), &scales, &ranges::SCALE);
            }
        }
        if let Some(albedo) = object.albedo {
            findings.numbers(&at("albedo"), &albedo, &ranges::ALBEDO);
        }
    }
}

fn rotation(findings: &mut Findings, pointer: String, rotation: [f64; 4]) {
    let length = rotation.iter().map(|v| v * v).sum::<f64>().sqrt();
    // Written so that NaN is refused too.
    let is_unit = (length - 1.0).abs() <= ROTATION_LENGTH_TOLERANCE;
    if !is_unit {
        findings.invalid(
            pointer,
            format!("the quaternion has length {}", number(length)),
            format!("[x, y, z, w] of length 1 ± {ROTATION_LENGTH_TOLERANCE}; [0, 0, 0, 1] is no rotation"),
        );
    }
}

fn camera(findings: &mut Findings, camera: &Camera, output: &Output) {
    let (position_m, target_m, up) = camera.pose();
    let coordinate = &ranges::COORDINATE;
    let mut is_sound = findings.numbers("/camera/position_m", &position_m, coordinate);
    is_sound &= findings.numbers("/camera/target_m", &target_m, coordinate);
    is_sound &= findings.numbers("/camera/up", &up, &ranges::UP);
    match camera {
        Camera::Perspective(c) => {
            let pointer = "/camera/vertical_fov_deg";
            if let Some(degrees) = c.vertical_fov_deg {
                findings.number(pointer, degrees, &ranges::FIELD_OF_VIEW);
            }
            if c.vertical_fov_deg.is_some() && c.intrinsics.is_some() {
                let detail = "the lens is given by `vertical_fov_deg` and by `intrinsics`";
                findings.invalid(pointer, detail, "one of the two");
            }
            if let Some(intrinsics) = &c.intrinsics {
                lens(findings, intrinsics, output);
            }
            let pointer = "/camera/dome_radius_m";
            findings.number(pointer, c.dome_radius_m, &ranges::DOME_RADIUS);
        }
        Camera::Orthographic(c) => {
            findings.number("/camera/height_m", c.height_m, &ranges::EXTENT);
        }
    }
    if !is_sound {
        return;
    }
    let view = DVec3::from(target_m) - DVec3::from(position_m);
    if view.length() < MIN_VIEW_DISTANCE_M {
        findings.invalid(
            "/camera/target_m",
            "the target is at the position of the camera",
            format!(
                "a point at least {} m from `position_m`",
                number(MIN_VIEW_DISTANCE_M)
            ),
        );
        return;
    }
    // Divide by the largest component, so that the length neither underflows nor overflows.
    let up = DVec3::from(up);
    let up = up / up.abs().max_element();
    if !up.is_finite() {
        let detail = "the up direction has length 0";
        findings.invalid("/camera/up", detail, "a direction, such as [0, 1, 0]");
        return;
    }
    let sine = up.cross(view).length() / (up.length() * view.length());
    if sine < MIN_UP_SINE {
        findings.invalid(
            "/camera/up",
            "the up direction is parallel to the view",
            "a direction across the view, such as [0, 0, -1] for a camera that looks straight down",
        );
    }
}

/// The intrinsic parameters, and the angles at which they show the edges of the picture.
fn lens(findings: &mut Findings, intrinsics: &Intrinsics, output: &Output) {
    let Intrinsics { fx, fy, cx, cy } = *intrinsics;
    let mut is_sound = true;
    for (name, value, range) in [
        ("fx", fx, &ranges::FOCAL_LENGTH),
        ("fy", fy, &ranges::FOCAL_LENGTH),
        ("cx", cx, &ranges::PRINCIPAL_POINT),
        ("cy", cy, &ranges::PRINCIPAL_POINT),
    ] {
        is_sound &= findings.number(format!("/camera/intrinsics/{name}"), value, range);
    }
    if !is_sound {
        return;
    }
    let aspect = fy / fx;
    if !(1.0 / MAX_PIXEL_ASPECT..=MAX_PIXEL_ASPECT).contains(&aspect) {
        findings.invalid(
            "/camera/intrinsics/fy",
            format!(
                "pixels are {} times as wide as they are high",
                number(aspect)
            ),
            format!("`fy` / `fx` of 1/{MAX_PIXEL_ASPECT} … {MAX_PIXEL_ASPECT}"),
        );
    }
    let Output::View(view) = output else {
        return;
    };
    for (name, center, focal, side) in [("cx", cx, fx, view.width), ("cy", cy, fy, view.height)] {
        let farthest = center.abs().max((f64::from(side) - center).abs());
        let degrees = (farthest / focal).atan().to_degrees();
        if degrees > ranges::MAX_OFF_AXIS_DEG {
            findings.invalid(
                format!("/camera/intrinsics/{name}"),
                format!("an edge of the picture of {side} pixels is {degrees:.3}° off the viewing axis"),
                format!(
                    "at most {}°: the principal point nearer to the picture, or a longer focal length",
                    ranges::MAX_OFF_AXIS_DEG
                ),
            );
        }
    }
}

fn quality(findings: &mut Findings, quality: &Quality) {
    findings.integer::<ranges::WaterCells>("/quality/water_cells", quality.water_cells);
    findings.integer::<ranges::MapTexels>("/quality/map_texels", quality.map_texels);
    let level_map_texels = quality.level_map_texels;
    findings.integer::<ranges::LevelMapTexels>("/quality/level_map_texels", level_map_texels);
    findings.integer::<ranges::Layers>("/quality/layers", quality.layers);
    let detail = &ranges::LEVEL_OF_DETAIL;
    findings.number("/quality/level_of_detail", quality.level_of_detail, detail);
    findings.integer::<ranges::SplitLevels>("/quality/split_levels", quality.split_levels);
    findings.integer::<ranges::PixelSamples>("/quality/pixel_samples", quality.pixel_samples);
    findings.integer::<ranges::Bounces>("/quality/bounces", quality.bounces);
    if let Some(target) = quality.target_error {
        findings.number("/quality/target_error", target, &ranges::TARGET_ERROR);
    }
    if let Some(budget_ms) = quality.time_budget_ms {
        findings.number("/quality/time_budget_ms", budget_ms, &ranges::TIME_BUDGET);
        if quality.target_error.is_some() {
            findings.invalid(
                "/quality/time_budget_ms",
                "time_budget_ms and target_error are both given",
                "one of the two",
            );
        }
    }
}
