//! Renders the maps and time series of every place.

use super::disc::Disc;
use super::flashes::{Flashes, THRESHOLD, flashes};
use super::fluctuation::{Fluctuation, Grid, fluctuation};
use super::scene::{self, Place, View, texel_m};
use super::study::{Check, Checks, Estimate, FlashFigures, PlaceResult, SeaStudy, SlopeResult};
use crate::frame::Frame;
use crate::reference::closed_form::flat_water_irradiance;
use crate::scene::{LayerName, Light, ResolvedScene};

/// Time from frame to frame of a series, s: flashes last 5 ms and more.
const STEP_S: f64 = 2e-3;
/// Seas that the time series of a place are taken from.
const SERIES: u32 = 4;
/// Most texels along the side of the map of a time series.
const MOST_SERIES_TEXELS: u32 = 48;
/// Texels along the side of the map of the water, to measure its slopes.
const SLOPE_TEXELS: u32 = 512;
/// Time between the moments of maps, s. Each has a sea of its own, too.
const APART_S: f64 = 13.7;
/// The greatest depth at which flashes are measured, m. Time series of greater depths would need as many cells as their maps.
pub(super) const FLASH_DEPTH_M: f64 = 5.0;
/// Most water cells of a map.
const MOST_CELLS: u32 = 2048;
/// The place of the checks is the one nearest to this.
const CHECKED: Place = Place {
    wind_m_s: 5.0,
    depth_m: 2.5,
};

/// What is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Depths of the floor, m, ascending.
    pub depths_m: Vec<f64>,
    /// Winds, m/s, ascending.
    pub winds_m_s: Vec<f64>,
    /// Maps for each place, each of a sea of its own, at least 2.
    pub moments: u32,
    /// Length of all time series of a place together, s.
    pub seconds: f64,
    /// Texels along each side of a map, 16 … 1024.
    pub texels: u32,
    /// Most water cells along each side of the light's window, 64 … 2048; fewer are used where the shortest wave needs fewer.
    pub water_cells: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            depths_m: vec![0.5, 1.0, 2.0, 5.0, 10.0, 25.0],
            winds_m_s: vec![2.0, 5.0, 7.0, 10.0, 15.0],
            moments: 8,
            seconds: 0.12,
            texels: 128,
            water_cells: 1024,
        }
    }
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum SeaError {
    /// The scene is refused.
    #[error("{0}")]
    Scene(String),
    /// A frame cannot be rendered.
    #[error(transparent)]
    Render(#[from] crate::render::RenderError),
    /// No light reaches the floor.
    #[error("no light reaches a floor at {depth_m} m under a wind of {wind_m_s} m/s")]
    Dark {
        /// Wind, m/s.
        wind_m_s: f64,
        /// Depth, m.
        depth_m: f64,
    },
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
pub type Render<'a> = dyn FnMut(&ResolvedScene) -> Result<Frame, SeaError> + 'a;

/// Runs the study; `progress` gets the number of finished frames, the total, and what is running.
///
/// # Errors
/// [`SeaError`]; any failure ends the study.
pub fn measure(
    settings: &Settings,
    render: &mut Render<'_>,
    progress: &mut dyn FnMut(usize, usize, &str),
) -> Result<SeaStudy, SeaError> {
    let mut study = SeaStudy {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        moments: settings.moments,
        seconds: f64::from(steps(settings, STEP_S)) * f64::from(SERIES) * STEP_S,
        series: SERIES,
        step_s: STEP_S,
        texels: settings.texels,
        series_texels: settings.texels.min(MOST_SERIES_TEXELS),
        water_cells: settings.water_cells,
        ..SeaStudy::default()
    };
    let mut camera = Camera {
        done: 0,
        total: total(settings),
        render,
        progress,
        closure: 0.0,
        undersampled: false,
    };
    for &wind_m_s in &settings.winds_m_s {
        let what = format!("slopes under {wind_m_s} m/s");
        let frame = camera.frame(&scene::water(wind_m_s, SLOPE_TEXELS)?, &what)?;
        study.adapter = frame.stats.adapter.clone();
        study.slopes.push(SlopeResult {
            wind_m_s,
            mean_square: mean_square_slope(&frame),
        });
        for &depth_m in &settings.depths_m {
            let place = Place { wind_m_s, depth_m };
            study.places.push(figures(place, settings, &mut camera)?);
        }
    }
    let [near, deepest] = checked(settings);
    let near = checks(near, &study, settings, &mut camera)?;
    study.checks.extend(near);
    let deepest = cells_check(deepest, &study, settings, &mut camera)?;
    study.checks.extend(deepest);
    study.closure = camera.closure;
    Ok(study)
}

/// Renders, and keeps count.
struct Camera<'a, 'b> {
    done: usize,
    total: usize,
    render: &'a mut Render<'b>,
    progress: &'a mut dyn FnMut(usize, usize, &str),
    closure: f64,
    undersampled: bool,
}

impl Camera<'_, '_> {
    fn frame(&mut self, scene: &ResolvedScene, what: &str) -> Result<Frame, SeaError> {
        (self.progress)(self.done, self.total, what);
        let frame = (self.render)(scene)?;
        self.done += 1;
        for account in &frame.stats.energy {
            self.closure = self.closure.max(account.closure);
        }
        let warnings = &frame.stats.warnings;
        self.undersampled |= warnings.iter().any(|w| w.code == "waves_undersampled");
        Ok(frame)
    }

    /// A map of irradiance over that under flat water.
    fn map(&mut self, place: Place, view: View) -> Result<Grid, SeaError> {
        let scene = scene::of_view(place, view)?;
        let flat_w_m2 = flat_w_m2(&scene);
        let Place { wind_m_s, depth_m } = place;
        let frame = self.frame(&scene, &format!("{wind_m_s} m/s, {depth_m} m"))?;
        let layer = &frame.layers[&LayerName::Irradiance];
        let texels = layer.data.chunks_exact(layer.channels);
        Ok(Grid {
            width: frame.width as usize,
            height: frame.height as usize,
            values: texels.map(|t| f64::from(t[0]) / flat_w_m2).collect(),
        })
    }
}

/// Irradiance under flat water, in the first channel: all have the same.
fn flat_w_m2(scene: &ResolvedScene) -> f64 {
    let scene = &scene.scene;
    let depth_m = scene.floor.as_ref().map_or(0.0, |floor| floor.depth_m);
    let suns = scene.lights.iter().map(|light| match light {
        Light::Sun(sun) => flat_water_irradiance(&scene.water, depth_m, sun)[0],
        Light::Point(_) | Light::Sky(_) => 0.0,
    });
    suns.sum()
}

fn mean_square_slope(frame: &Frame) -> f64 {
    let layer = &frame.layers[&LayerName::Water];
    let texels = layer.data.chunks_exact(layer.channels);
    let count = texels.len() as f64;
    let squares = texels.map(|t| f64::from(t[1]).powi(2) + f64::from(t[2]).powi(2));
    squares.sum::<f64>() / count
}

/// Steps of each time series.
fn steps(settings: &Settings, step_s: f64) -> u32 {
    ((settings.seconds / f64::from(SERIES) / step_s).round() as u32).max(1)
}

/// Frames of the whole study.
fn total(settings: &Settings) -> usize {
    let series = |step_s: f64| SERIES as usize * (steps(settings, step_s) as usize + 1);
    let maps = settings.moments as usize;
    let with_flashes = |depths: &[f64]| depths.iter().filter(|d| **d <= FLASH_DEPTH_M).count();
    let winds = settings.winds_m_s.len();
    let depths = &settings.depths_m;
    let places = winds * (depths.len() * maps + with_flashes(depths) * series(STEP_S));
    let [near, deepest] = checked(settings);
    let mut checks = 2 * maps;
    if near.depth_m <= FLASH_DEPTH_M {
        checks += series(STEP_S) + series(0.5 * STEP_S);
    }
    if deepest != near {
        checks += maps;
    }
    winds + places + checks
}

/// How a place is looked at: texels along the side of a map, their size, and water cells.
#[derive(Clone, Copy)]
struct Look {
    texels: u32,
    texel_m: f64,
    water_cells: u32,
}

impl Look {
    /// A map with this number of texels.
    fn of(place: Place, texels: u32, settings: &Settings) -> Result<Self, SeaError> {
        let mut look = Self {
            texels,
            texel_m: texel_m(place.depth_m),
            water_cells: settings.water_cells,
        };
        look.water_cells = scene::water_cells(place, look.view(0, 0.0))?;
        Ok(look)
    }

    /// The maps of a place.
    fn of_maps(place: Place, settings: &Settings) -> Result<Self, SeaError> {
        Self::of(place, settings.texels, settings)
    }

    /// The maps of its time series.
    fn of_series(place: Place, settings: &Settings) -> Result<Self, SeaError> {
        Self::of(place, settings.texels.min(MOST_SERIES_TEXELS), settings)
    }

    fn with_twice_the_cells(self) -> Self {
        Self {
            water_cells: (2 * self.water_cells).min(MOST_CELLS),
            ..self
        }
    }

    fn view(self, seed: u32, time_s: f64) -> View {
        View {
            seed,
            time_s,
            texels: self.texels,
            texel_m: self.texel_m,
            water_cells: self.water_cells,
        }
    }
}

fn figures(
    place: Place,
    settings: &Settings,
    camera: &mut Camera<'_, '_>,
) -> Result<PlaceResult, SeaError> {
    let look = Look::of_maps(place, settings)?;
    camera.undersampled = false;
    let maps = maps(place, look, settings.moments, camera)?;
    let disc = Disc::of_sun(place.depth_m, look.texel_m);
    let point_sun = of_maps(place, &maps)?;
    let sun = of_maps(place, &blurred(&disc, &maps))?;
    let flashes = if place.depth_m <= FLASH_DEPTH_M {
        let small = Look::of_series(place, settings)?;
        let mean = sun.mean.value;
        Some(series(place, small, mean, STEP_S, settings, camera)?)
    } else {
        None
    };
    Ok(PlaceResult {
        place,
        texel_mm: 1e3 * look.texel_m,
        sun,
        point_sun,
        flashes,
        water_cells: look.water_cells,
        undersampled: camera.undersampled,
    })
}

/// Maps at several moments, each of a sea of its own.
fn maps(
    place: Place,
    look: Look,
    moments: u32,
    camera: &mut Camera<'_, '_>,
) -> Result<Vec<Grid>, SeaError> {
    (0..moments)
        .map(|moment| camera.map(place, look.view(moment, APART_S * f64::from(moment))))
        .collect()
}

fn blurred(disc: &Disc, maps: &[Grid]) -> Vec<Grid> {
    maps.iter().map(|map| disc.blurred(map)).collect()
}

fn of_maps(place: Place, maps: &[Grid]) -> Result<Fluctuation, SeaError> {
    let Place { wind_m_s, depth_m } = place;
    fluctuation(maps).ok_or(SeaError::Dark { wind_m_s, depth_m })
}

/// Time series of the detectors of small maps, of seas other than those of the maps; `mean` is the mean of those.
fn series(
    place: Place,
    look: Look,
    mean: f64,
    step_s: f64,
    settings: &Settings,
    camera: &mut Camera<'_, '_>,
) -> Result<FlashFigures, SeaError> {
    let disc = Disc::of_sun(place.depth_m, look.texel_m);
    let mut seas = Vec::new();
    for sea in 0..SERIES {
        let mut counted = Flashes::over(THRESHOLD * mean);
        for step in 0..=steps(settings, step_s) {
            let time_s = f64::from(step) * step_s;
            let map = camera.map(place, look.view(settings.moments + sea, time_s))?;
            counted.push(&disc.blurred(&map).values);
        }
        seas.push(counted);
    }
    Ok(flashes(&seas, step_s).unwrap_or_default())
}

/// The places among those of the settings at which the settings are checked: the one nearest to [`CHECKED`], and the deepest under the
/// same wind.
fn checked(settings: &Settings) -> [Place; 2] {
    let near = |values: &[f64], wanted: f64| {
        let off = |value: &&f64| (**value / wanted).ln().abs();
        let nearest = values.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.copied().unwrap_or(wanted)
    };
    let wind_m_s = near(&settings.winds_m_s, CHECKED.wind_m_s);
    let depth_m = near(&settings.depths_m, CHECKED.depth_m);
    let deepest_m = settings.depths_m.iter().copied().fold(depth_m, f64::max);
    [depth_m, deepest_m].map(|depth_m| Place { wind_m_s, depth_m })
}

fn row(what: &str, found: Option<Fluctuation>, flashes: Option<FlashFigures>) -> Check {
    Check {
        what: what.to_owned(),
        cv: found.map(|f| f.cv),
        peak: found.map(|f| f.peak),
        flashes,
    }
}

/// The figures of the deepest place with twice the cells; `None` if it has been checked already.
fn cells_check(
    place: Place,
    study: &SeaStudy,
    settings: &Settings,
    camera: &mut Camera<'_, '_>,
) -> Result<Option<Checks>, SeaError> {
    let is_checked = study.checks.iter().any(|checks| checks.place == place);
    let Some(base) = study
        .at(place.wind_m_s, place.depth_m)
        .filter(|_| !is_checked)
    else {
        return Ok(None);
    };
    let look = Look::of_maps(place, settings)?.with_twice_the_cells();
    let disc = Disc::of_sun(place.depth_m, look.texel_m);
    let doubled = maps(place, look, settings.moments, camera)?;
    let doubled = of_maps(place, &blurred(&disc, &doubled))?;
    let what = format!("{} water cells", look.water_cells);
    Ok(Some(Checks {
        place,
        rows: vec![
            row("as in the tables", Some(base.sun), None),
            row(&what, Some(doubled), None),
        ],
    }))
}

/// The figures of a place with twice the cells, with texels of half the size, and with frames at half the time.
fn checks(
    place: Place,
    study: &SeaStudy,
    settings: &Settings,
    camera: &mut Camera<'_, '_>,
) -> Result<Option<Checks>, SeaError> {
    let Some(base) = study.at(place.wind_m_s, place.depth_m) else {
        return Ok(None);
    };
    let look = Look::of_maps(place, settings)?;
    let disc = Disc::of_sun(place.depth_m, look.texel_m);
    let doubled = look.with_twice_the_cells();
    let of_cells = maps(place, doubled, settings.moments, camera)?;
    let of_cells = of_maps(place, &blurred(&disc, &of_cells))?;
    let halved = Look {
        texels: 2 * look.texels,
        texel_m: 0.5 * look.texel_m,
        ..look
    };
    let fine = maps(place, halved, settings.moments, camera)?;
    let averaged: Vec<Grid> = fine.iter().map(Grid::halved).collect();
    let of_texels = of_maps(place, &blurred(&disc, &averaged))?;
    let fine_disc = Disc::of_sun(place.depth_m, halved.texel_m);
    let of_detectors = of_maps(place, &blurred(&fine_disc, &fine))?;
    let mut flashes = |look: Look, mean: f64, step_s: f64| {
        let wanted = base.flashes.is_some();
        let found = wanted.then(|| series(place, look, mean, step_s, settings, camera));
        found.transpose()
    };
    let small = Look::of_series(place, settings)?;
    let small_doubled = small.with_twice_the_cells();
    let cells_flashes = flashes(small_doubled, of_cells.mean.value, STEP_S)?;
    let of_step = flashes(small, base.sun.mean.value, 0.5 * STEP_S)?;
    let mut rows = vec![
        row("as in the tables", Some(base.sun), base.flashes),
        row("twice the water cells", Some(of_cells), cells_flashes),
        row(
            "texels of half the side, four averaged to a detector",
            Some(of_texels),
            None,
        ),
        row("detectors of half the side", Some(of_detectors), None),
    ];
    if of_step.is_some() {
        rows.push(row("a frame every 1 ms", None, of_step));
    }
    Ok(Some(Checks { place, rows }))
}

impl Estimate {
    /// Distance to another value in units of the larger standard error; `None` without one.
    pub(super) fn apart(self, other: Self) -> Option<f64> {
        let error = self
            .error
            .into_iter()
            .chain(other.error)
            .fold(0.0, f64::max);
        (error > 0.0).then(|| (self.value - other.value).abs() / error)
    }
}
