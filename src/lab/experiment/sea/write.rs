//! Writes the study's files.

use std::path::{Path, PathBuf};

use super::csv::to_csv;
use super::markdown::to_markdown;
use super::measure::SeaError;
use super::study::{PlaceResult, SeaStudy};
use crate::lab::study::plot::{LineChart, Plot, PlotError, lines};
use crate::output_files::{self, clear_leftovers};

/// File of the plot of the coefficient of variation, without its end.
pub(super) const CV: &str = "cv";
/// File of the plot of the peaks, without its end.
pub(super) const PEAKS: &str = "peaks";
/// File of the plot of the flashes, without its end.
pub(super) const FLASHES: &str = "flashes";

/// Coefficient of variation, peaks and, where they were measured, flashes against depth, a line for each wind, by file name without its end.
///
/// # Errors
/// [`PlotError`].
pub fn plots(study: &SeaStudy) -> Result<Vec<(String, Plot)>, PlotError> {
    let chart = |title: &str, y_title: &str, of: &dyn Fn(&PlaceResult) -> Option<f64>| {
        let line = |wind_m_s: f64| {
            let places = study.places.iter();
            let places = places.filter(move |p| p.place.wind_m_s == wind_m_s);
            let points = places.filter_map(|p| Some((p.place.depth_m, of(p)?)));
            (format!("{wind_m_s} m/s"), points.collect())
        };
        lines(&LineChart {
            title: title.to_owned(),
            subtitle: format!(
                "light of the sun's disc · {} seas for each point · up to {}² water cells",
                study.moments, study.water_cells
            ),
            x_title: "depth (m)".to_owned(),
            y_title: y_title.to_owned(),
            lines: study.winds().into_iter().map(line).collect(),
            remarks: Vec::new(),
        })
    };
    let mut all = vec![
        (
            CV.to_owned(),
            chart(
                "Fluctuation against depth",
                "coefficient of variation",
                &|p| Some(p.sun.cv.value),
            )?,
        ),
        (
            PEAKS.to_owned(),
            chart(
                "Peaks against depth",
                "exceeded by one value in a thousand, over the mean",
                &|p| Some(p.sun.peak.value),
            )?,
        ),
    ];
    if study.has_flashes() {
        let chart = chart(
            "Flashes against depth",
            "flashes above 1.5 times the mean per minute",
            &|p| Some(p.flashes?.per_minute.value),
        )?;
        all.push((FLASHES.to_owned(), chart));
    }
    Ok(all)
}

/// Writes `sea.json`, `sea.csv`, `sea.md` and the plots into `folder`, which must be there; returns what was written.
///
/// # Errors
/// [`SeaError::Plot`], [`SeaError::Write`].
pub fn write(folder: &Path, study: &SeaStudy) -> Result<Vec<PathBuf>, SeaError> {
    let mut files = Vec::new();
    let mut put = |name: &str, bytes: &[u8]| -> Result<(), SeaError> {
        let path = folder.join(name);
        clear_leftovers([path.as_path()]);
        output_files::write(&path, bytes).map_err(|reason| SeaError::Write {
            path: path.clone(),
            reason,
        })?;
        files.push(path);
        Ok(())
    };
    let mut json = serde_json::to_string_pretty(study).expect("results always serialise");
    json.push('\n');
    put("sea.json", json.as_bytes())?;
    put("sea.csv", to_csv(study).as_bytes())?;
    put("sea.md", to_markdown(study, "").as_bytes())?;
    for (stem, plot) in plots(study)? {
        put(&format!("{stem}.svg"), plot.svg.as_bytes())?;
        put(&format!("{stem}.png"), &plot.png)?;
    }
    Ok(files)
}
