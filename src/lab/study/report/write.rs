//! Writes all files of a study into a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::csv::to_csv;
use super::error::ReportError;
use super::json::to_json;
use super::markdown::{ReportLinks, SweepLinks, to_markdown};
use crate::lab::study::equal_time;
use crate::lab::study::error_images::{error_images, method_images};
use crate::lab::study::plot::{convergence, error_against_time};
use crate::lab::study::study::{Study, StudyImages};
use crate::output_files::{Pending, clear_leftovers};

/// Writes `study.json`, `study.csv`, `study.md`, `error_time.svg` and `.png`, and for each sweep `convergence_<dial>.svg` and
/// `.png` and `errors_<dial>.png` into `folder`, which is created if needed. A comparison of methods has `methods.png` instead of files
/// for each sweep. Returns their paths, the report first.
///
/// Everything is drawn before anything is written, and written to temporary files before anything is moved to its place, so a failure
/// leaves the files of an earlier study unchanged. A sweep without settings has no pictures.
///
/// # Errors
///
/// See [`ReportError`].
pub fn write_study(
    folder: &Path,
    study: &Study,
    images: &StudyImages,
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = vec![
        ("study.json".to_owned(), to_json(study)?.into_bytes()),
        ("study.csv".to_owned(), to_csv(study).into_bytes()),
    ];
    let mut links = ReportLinks {
        json: Some("study.json".to_owned()),
        csv: Some("study.csv".to_owned()),
        ..ReportLinks::default()
    };
    if study.sweeps.iter().any(|sweep| !sweep.points.is_empty()) {
        let plot = error_against_time(study)?;
        links.error_time = Some("error_time.svg".to_owned());
        files.push(("error_time.svg".to_owned(), plot.svg.into_bytes()));
        files.push(("error_time.png".to_owned(), plot.png));
    }
    if let Some(limit_ms) = equal_time::limit_ms(study).filter(|_| study.is_comparison()) {
        let sheet = method_images(study, images, limit_ms)?;
        files.push(("methods.png".to_owned(), sheet));
        links.methods = Some("methods.png".to_owned());
    }
    let names = match study.is_comparison() {
        true => Vec::new(),
        false => file_names(study),
    };
    for (index, name) in names.into_iter().enumerate() {
        let mut sweep = SweepLinks::default();
        if !study.sweeps[index].points.is_empty() {
            let plot = convergence(study, index)?;
            let (svg, errors) = (
                format!("convergence_{name}.svg"),
                format!("errors_{name}.png"),
            );
            files.push((svg.clone(), plot.svg.into_bytes()));
            files.push((format!("convergence_{name}.png"), plot.png));
            files.push((errors.clone(), error_images(study, images, index)?));
            sweep = SweepLinks {
                convergence: Some(svg),
                errors: Some(errors),
            };
        }
        links.sweeps.push(sweep);
    }
    let report = to_markdown(study, &links).into_bytes();
    files.insert(0, ("study.md".to_owned(), report));
    write_all(folder, &files)
}

/// A distinct name for each sweep that is valid in any file system: `beams`, `beams_x_steps`, `beams_2`.
fn file_names(study: &Study) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for sweep in &study.sweeps {
        let plain: String = sweep
            .dial
            .replace('×', "x")
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c } else { ' ' })
            .collect();
        let words: Vec<&str> = plain.split_whitespace().collect();
        let stem = match words.join("_").to_ascii_lowercase() {
            empty if empty.is_empty() => "sweep".to_owned(),
            stem => stem,
        };
        let mut name = stem.clone();
        let mut number = 2;
        while names.contains(&name) {
            name = format!("{stem}_{number}");
            number += 1;
        }
        names.push(name);
    }
    names
}

/// Writes all files under temporary names, then moves them to their places.
fn write_all(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, ReportError> {
    let failed = |path: &Path, reason: io::Error| ReportError::Write {
        path: path.to_owned(),
        reason,
    };
    fs::create_dir_all(folder).map_err(|reason| failed(folder, reason))?;
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
    clear_leftovers(paths.iter().map(PathBuf::as_path));
    let mut ready = Vec::new();
    for (path, (_, bytes)) in paths.iter().zip(files) {
        let pending = Pending::new(path, bytes).map_err(|reason| failed(path, reason))?;
        ready.push((path, pending));
    }
    for (path, pending) in ready {
        pending.finish().map_err(|reason| failed(path, reason))?;
    }
    Ok(paths)
}
