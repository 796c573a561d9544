//! The page itself.

use std::fmt::Write as _;

use caustica::lab::study::order::level_number;
use caustica::lab::study::report::conclusions;
use caustica::lab::study::study::{Point, Study};
use caustica::lab::study::words::{percent, significant};
use caustica::scene::{Output, Quality};
use caustica::tuning::ladder;

use crate::scenes::Scene;
use crate::targets::Target;

/// Estimates are evaluated where the true error is at least this many times the truth's own.
const CLEAR: f64 = 3.0;

/// Measurements of a scene.
#[derive(Debug)]
pub(crate) struct Chapter {
    pub scene: &'static Scene,
    pub study: Study,
    pub targets: Vec<Target>,
}

/// All of `docs/accuracy.md`.
pub(crate) fn write(chapters: &[Chapter]) -> String {
    let mut page = head(chapters);
    page += &dials(chapters);
    page += &targets(chapters);
    page += &estimates(chapters);
    page += &orders(chapters);
    page += &shadow_edges(chapters);
    page += "\n## The scenes\n";
    for chapter in chapters {
        page += &scene(chapter);
    }
    page
}

fn head(chapters: &[Chapter]) -> String {
    let machine = chapters.first().map_or_else(String::new, |chapter| {
        let adapter = &chapter.study.adapter;
        format!(
            "{} ({}), {}, {} CPU cores",
            adapter.name,
            adapter.driver,
            if adapter.software {
                "a CPU driver"
            } else {
                "a GPU"
            },
            chapter.study.cores
        )
    });
    format!(
        "# What accuracy costs in time\n\n\
         Written by `make docs` from the program's own measurements. Every number below is from one run on\n{machine}.\n\n\
         Errors are relative L1 errors of the irradiance, Σ|E − truth| / Σ truth, against a float64 reference that traces single\n\
         rays and shares only the formulas, the waves and the scene with the renderer. Times are medians of warm frames, from the\n\
         scene to the finished linear result. A GPU is far faster, but the relative cost of the settings is much the same.\n\
         `caustica accuracy SCENE -o FOLDER` makes such a study of any scene. [The glossary](glossary.md) explains the terms.\n"
    )
}

fn dials(chapters: &[Chapter]) -> String {
    let mut text = "\n## Where to set the dials\n\n\
     - Request an error or a time: `quality.target_error` chooses the dials for an error, `quality.time_budget_ms` for a time. The\n  \
     table below shows the results.\n\
     - **`water_cells`** matters most. Twice the cells cost two to four times the time and divide the error by about four.\n  \
     64 is enough for a preview, 256 for pictures, 512 and more for ground truth. Steep or deep water and a low sun need more, because\n  \
     the footprints of the cells are larger there.\n\
     - **`map_texels`** (views only) decides how sharp caustics are. Give the floor's map about as many texels as the picture has pixels\n  \
     across the floor. Fewer texels blur, and more cells do not undo the blur.\n\
     - **`split_levels`** sharpens the shadows of meshes. Each further level gains less and takes more time"
        .to_owned();
    text += &levels(chapters);
    text += "  Without meshes it has no cost and no effect.\n\
     - **`level_map_texels`** is the resolution of light *on* meshes. Their shadows hardly depend on it, because edges are\n  \
     found on the triangles themselves; but parts thinner than a texel let light through.\n";
    text
}

/// The effect of each level of `split_levels`, and the levels that the ladder uses.
fn levels(chapters: &[Chapter]) -> String {
    let mut text = String::new();
    for (from, name) in ["first", "second", "third", "fourth"]
        .into_iter()
        .enumerate()
    {
        let mut gains = Vec::new();
        let mut costs = Vec::new();
        for sweep in chapters.iter().flat_map(|chapter| &chapter.study.sweeps) {
            let at = |level: usize| {
                let point = sweep
                    .points
                    .iter()
                    .find(|point| level_number(sweep, point) == Some(level as f64))?;
                let edges = point.error.relative_l1 * point.error.shadow_edge_share?;
                Some((edges, point.cost.wall_ms.median))
            };
            if let (Some(before), Some(after)) = (at(from), at(from + 1)) {
                gains.push(before.0 / after.0);
                costs.push(after.1 / before.1);
            }
        }
        if !gains.is_empty() {
            let (before, what) = if text.is_empty() {
                (":", "divided the error along the edges by")
            } else {
                (",", "by")
            };
            let _ = write!(
                text,
                "{before}\n  the {name} {what} {} in {} the time",
                spread(&gains),
                range(&costs)
            );
        }
    }
    let rung = |cells| ladder::rung(&Quality::default(), &Output::default(), cells).split_levels;
    let _ = writeln!(
        text,
        ".\n  `target_error` uses `split_levels` {} with 256 cells, {} with 512 and {} with 1024.",
        rung(256),
        rung(512),
        rung(1024)
    );
    text
}

/// The cheapest setting of the study that stays under an error.
fn cheapest(study: &Study, target: f64) -> Option<&Point> {
    study
        .sweeps
        .iter()
        .flat_map(|sweep| &sweep.points)
        .filter(|point| point.error.relative_l1 <= target)
        .min_by(|a, b| a.cost.wall_ms.median.total_cmp(&b.cost.wall_ms.median))
}

fn targets(chapters: &[Chapter]) -> String {
    let mut text = "\n## Requesting an error\n\n\
        What `quality.target_error` chose, the true error with these dials, and the frame's time compared with the cheapest setting of the\n\
        sweeps below that stays under the target. *Choosing* is the extra time for trial renders in one request.\n\n\
        | scene | target | cells chosen | true error | met | frame (ms) | cheapest of the sweeps (ms) | ratio | choosing (ms) |\n\
        | --- | ---: | ---: | ---: | :---: | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    for chapter in chapters {
        for target in &chapter.targets {
            let kept = match (target.error <= target.target, target.chosen.meets) {
                (true, true) => "yes",
                (true, false) => "yes, though not predicted",
                (false, false) => "no, with a warning",
                (false, true) => "**no**",
            };
            let cheapest = cheapest(&chapter.study, target.target).map(|p| p.cost.wall_ms.median);
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {kept} | {} | {} | {} | {} |",
                chapter.scene.name,
                percent(target.target),
                target.chosen.water_cells,
                percent(target.error),
                significant(target.frame_ms, 3),
                cheapest.map_or_else(|| "none".to_owned(), |ms| significant(ms, 3)),
                cheapest.map_or_else(|| "–".to_owned(), |ms| significant(target.frame_ms / ms, 2)),
                significant(target.choosing_ms, 3),
            );
        }
    }
    text += "\nIn the same runs, predicted times were ";
    let ratios: Vec<f64> = chapters
        .iter()
        .flat_map(|chapter| &chapter.targets)
        .map(|target| target.chosen.predicted_ms / target.frame_ms)
        .collect();
    text += &range(&ratios);
    text += " of the measured ones.\n";
    text
}

/// "0.8 … 1.4 times".
fn range(ratios: &[f64]) -> String {
    format!("{} times", spread(ratios))
}

/// "0.8 … 1.4".
fn spread(ratios: &[f64]) -> String {
    let low = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let high = ratios.iter().copied().fold(0.0, f64::max);
    format!("{} … {}", significant(low, 2), significant(high, 2))
}

fn estimates(chapters: &[Chapter]) -> String {
    let mut text = "\n## A frame's own estimate\n\n\
        `quality.estimate_error` renders the light a second time with two fifths of the cells along a side (or somewhat fewer, in whole\n\
        workgroups), which is a sixth of the work or less, and with a quarter or a sixteenth of the floor's texels (all of them where\n\
        their number cannot be halved). It then compares the two. Estimate over true error, over all settings below whose error is at least\n\
        three times the truth's own:\n\n\
        | scene | settings | estimate ÷ true error |\n| --- | ---: | ---: |\n"
        .to_owned();
    for chapter in chapters {
        let floor = CLEAR * chapter.study.truth.relative_error;
        let ratios: Vec<f64> = chapter
            .study
            .sweeps
            .iter()
            .flat_map(|sweep| &sweep.points)
            .filter(|point| point.error.relative_l1 >= floor)
            .filter_map(|point| Some(point.error.estimated? / point.error.relative_l1))
            .collect();
        let found = if ratios.is_empty() {
            "–".to_owned()
        } else {
            range(&ratios)
        };
        let _ = writeln!(
            text,
            "| {} | {} | {found} |",
            chapter.scene.name,
            ratios.len()
        );
    }
    text
}

fn orders(chapters: &[Chapter]) -> String {
    let mut text = "\n## Orders of convergence\n\n\
        The error falls as the dial to minus this power, fitted to the settings whose error is at least three times the truth's own.\n\
        `split_levels` counts halvings, so instead of an order it has a factor by which the whole error falls per level.\n\n\
        | scene | dial | order |\n| --- | --- | ---: |\n"
        .to_owned();
    for chapter in chapters {
        for sweep in &chapter.study.sweeps {
            if let Some(order) = sweep.order {
                let _ = writeln!(
                    text,
                    "| {} | {} | {order:.2} |",
                    chapter.scene.name, sweep.dial
                );
            }
            if let Some(factor) = sweep.factor_per_level {
                let _ = writeln!(
                    text,
                    "| {} | {} | ÷ {factor:.2} per level |",
                    chapter.scene.name, sweep.dial
                );
            }
        }
    }
    text += "\nBeams between exact rays, deposited on texels by exact coverage, are second order in `water_cells`: the straight edges between a\n\
    cell's corners differ from the curved light by the square of the cell's size. Fits are a little below 2 where the fewest cells do not\n\
    yet resolve the waves. The other dials are not second order, and cannot be:\n\n\
        - `map_texels` of a view: a map is interpolated linearly between its texels, but caustics are edges with unbounded brightness on one\n  \
        side. The error from blurring an edge that rises as 1/√x with width w falls with the first power of w or less.\n\
        - `split_levels`: an unresolved piece of a beam is deposited in thirds, so misplaced light is as wide as the piece, and half as wide\n  \
        with each level. That is only a part of the error: the table of shadow edges shows how it falls until only the cells' own error\n  \
        remains there, and the whole error falls far less.\n\
        - `water_cells` of a view: the map's texels limit the error from below.\n\
        - flat water has no error that could converge: only single precision remains.\n";
    text
}

fn shadow_edges(chapters: &[Chapter]) -> String {
    let mut text = "\n## Shadow edges\n\n\
        The share of the error within two texels (for a view: pixels) of a mesh's shadow edge. Only pieces of beams that still straddle\n\
        receivers are split further. Each level halves how far they reach across the edge. The cells' own error there remains, so further\n\
        levels gain nothing after a few.\n\n\
        | scene | split_levels | L1 | share at shadow edges | at shadow edges (L1) | rest (L1) | frame (ms) |\n\
        | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    for chapter in chapters {
        for sweep in chapter
            .study
            .sweeps
            .iter()
            .filter(|s| s.dial == "split_levels")
        {
            for point in &sweep.points {
                let Some(share) = point.error.shadow_edge_share else {
                    continue;
                };
                let levels = point.dials.get("split_levels").map(ToString::to_string);
                let error = point.error.relative_l1;
                let _ = writeln!(
                    text,
                    "| {} | {} | {} | {} | {} | {} | {} |",
                    chapter.scene.name,
                    levels.unwrap_or_default(),
                    percent(error),
                    percent(share),
                    percent(error * share),
                    percent(error * (1.0 - share)),
                    significant(point.cost.wall_ms.median, 3),
                );
            }
        }
        if let Some(area) = chapter.study.truth.shadow_edge_area {
            let _ = writeln!(
                text,
                "| {} | | | | {} of the area | | |",
                chapter.scene.name,
                percent(area)
            );
        }
    }
    text
}

fn scene(chapter: &Chapter) -> String {
    let Chapter { scene, study, .. } = chapter;
    let name = scene.name;
    let mut text = format!(
        "\n### {name}\n\n{}\n\nTruth: {}; {} rays, {} s, own error {}.\n\n\
         ![Error against time of {name}](accuracy/{name}/error_time.svg)\n\n\
         ![Error images of {name}](accuracy/{name}/errors_water_cells.png)\n\n",
        scene.about,
        study.truth.what,
        significant(study.truth.rays as f64, 2),
        significant(study.truth.seconds, 2),
        percent(study.truth.relative_error),
    );
    for sweep in &study.sweeps {
        let _ = writeln!(
            text,
            "- **`{}`**: {}",
            sweep.dial,
            conclusions(study, sweep).join(" ")
        );
    }
    let _ = writeln!(
        text,
        "\n[All measurements of {name}](accuracy/{name}/study.md): errors by five measures, times by pass, memory."
    );
    text
}
