//! The cost of frames: time per pass, and error against the float64 truth.

use std::error::Error;
use std::time::Instant;

use caustica::accuracy::metrics::relative_l1;
use caustica::cli::scene_file;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::config::Limits;
use caustica::frame::Frame;
use caustica::reference::{ReferenceSettings, irradiance_map};
use caustica::render::Renderer;
use caustica::scene::{LayerName, ResolvedScene};
use caustica::stats::Stats;
use tokio_util::sync::CancellationToken;

use crate::Effort;
use crate::memory::{Stage, begin_stage, resident_peak};
use crate::report::{Cell, Table};
use crate::spread::{Spread, ms, repeat};

const SINE_POOL: &str = "scenes/sine_pool.json";
const TEAPOT_POOL: &str = "scenes/teapot_pool.json";

/// Results of the sine pool.
#[derive(Debug)]
pub(crate) struct SinePool {
    pub table: Table,
    pub memory: Vec<Stage>,
}

/// Results of the teapot pool.
#[derive(Debug)]
pub(crate) struct TeapotPool {
    pub table: Table,
    pub memory: Vec<Stage>,
    /// The largest frame.
    pub frame: Frame,
}

/// The sine pool with finer and finer water, and the error of each.
pub(crate) fn sine_pool(
    renderer: &mut Renderer,
    effort: Effort,
) -> Result<SinePool, Box<dyn Error>> {
    let mut rows = Vec::new();
    let mut memory = Vec::new();
    let mut frames = Vec::new();
    for cells in [64, 128, 256, 512, 1024] {
        eprintln!("sine pool, {cells} water cells …");
        let scene = scene(SINE_POOL, &[("/quality/water_cells", &cells.to_string())])?;
        begin_stage();
        // The first one builds what is kept between frames.
        frames.push(render(renderer, &scene)?);
        let runs = repeat(effort, || render(renderer, &scene).map(|frame| frame.stats))?;
        memory.push(stage(format!("sine pool, {cells} cells"), &runs.0));
        rows.push((Cell::count(cells), runs));
    }
    eprintln!("sine pool, float64 truth …");
    let truth_started = Instant::now();
    let settings = ReferenceSettings {
        target_error: Some(effort.truth_error),
        ..ReferenceSettings::default()
    };
    let truth = irradiance_map(&scene(SINE_POOL, &[])?, &settings, &|_| {})?;
    let note = format!(
        "`{SINE_POOL}`, 256 × 256 texels; ms, median (smallest..largest). L1: relative L1 error against {:.1e} float64 rays, \
         whose own error is {:.2} % ({:.0} s).",
        truth.rays as f64,
        truth.relative_error * 100.0,
        truth_started.elapsed().as_secs_f64(),
    );
    let errors: Vec<f64> = frames
        .iter()
        .map(|frame| {
            let irradiance = frame.layers.get(&LayerName::Irradiance);
            let irradiance = irradiance.ok_or("the sine pool gave no irradiance")?;
            relative_l1(&irradiance.data, truth.irradiance.as_flattened())
                .map_err(|error| Box::<dyn Error>::from(error.to_string()))
        })
        .collect::<Result<_, _>>()?;
    let mut table = pass_table(
        "Sine pool: time and error",
        &note,
        &["cells", "L1"],
        rows.iter().map(|(_, (stats, _))| stats),
    );
    let names = pass_names(rows.iter().map(|(_, (stats, _))| stats));
    for ((cells, runs), error) in rows.into_iter().zip(errors) {
        let head = vec![cells, Cell::percent(error)];
        table.rows.push(pass_row(head, &names, &runs));
    }
    Ok(SinePool { table, memory })
}

/// The teapot pool small and large, with an empty level-map cache and with a warm one.
pub(crate) fn teapot_pool(
    renderer: &mut Renderer,
    effort: Effort,
) -> Result<TeapotPool, Box<dyn Error>> {
    let mut rows = Vec::new();
    let mut memory = Vec::new();
    let mut last = None;
    for (width, height) in [(512, 512), (1920, 1080)] {
        eprintln!("teapot pool, {width} × {height} …");
        let changes = [
            ("/output/width", &*width.to_string()),
            ("/output/height", &*height.to_string()),
            ("/quality/pixel_samples", "1"),
        ];
        let scene = scene(TEAPOT_POOL, &changes)?;
        let name = |state: &str| {
            vec![
                Cell::text(&format!("{width} × {height}")),
                Cell::text(state),
            ]
        };
        begin_stage();
        if last.is_none() {
            let started = Instant::now();
            let stats = render(renderer, &scene)?.stats;
            let took = Spread::of(vec![ms(started.elapsed())]);
            rows.push((name("first"), (vec![stats], took)));
        }
        let cold = repeat(effort, || {
            for object in &scene.scene.objects {
                renderer.forget_mesh(&object.mesh);
            }
            render(renderer, &scene).map(|frame| frame.stats)
        })?;
        rows.push((name("new mesh"), cold));
        let warm = repeat(effort, || {
            let frame = render(renderer, &scene)?;
            let stats = frame.stats.clone();
            last = Some(frame);
            Ok::<_, Box<dyn Error>>(stats)
        })?;
        memory.push(stage(format!("teapot pool, {width} × {height}"), &warm.0));
        rows.push((name("warm"), warm));
    }
    let mut table = pass_table(
        "Teapot pool: time",
        &format!(
            "`{TEAPOT_POOL}` with one ray per pixel; ms, median (smallest..largest). `first`: the first frame after the start, \
            which compiles the pipelines. `new mesh`: includes the upload of the mesh and its level map. `warm`: all of these \
            exist."
        ),
        &["pixels", "state"],
        rows.iter().map(|(_, (stats, _))| stats),
    );
    let names = pass_names(rows.iter().map(|(_, (stats, _))| stats));
    for (head, runs) in rows {
        table.rows.push(pass_row(head, &names, &runs));
    }
    let frame = last.ok_or("the teapot pool was not rendered")?;
    Ok(TeapotPool {
        table,
        memory,
        frame,
    })
}

/// A scene file with some values replaced, as JSON.
pub(crate) fn scene(path: &str, changes: &[(&str, &str)]) -> Result<ResolvedScene, Box<dyn Error>> {
    let changes = changes
        .iter()
        .map(|(pointer, value)| ((*pointer).to_owned(), (*value).to_owned()));
    let args = SceneArgs {
        scene: path.into(),
        overrides: SceneOverrides(changes.collect()),
    };
    Ok(scene_file::load(&args, None, &Limits::default())?.resolved)
}

fn render(renderer: &mut Renderer, scene: &ResolvedScene) -> Result<Frame, Box<dyn Error>> {
    Ok(renderer.render(scene, &CancellationToken::new())?)
}

fn stage(what: String, stats: &[Stats]) -> Stage {
    Stage {
        what,
        frame: stats.last().map(|stats| stats.memory.clone()),
        resident_peak: resident_peak(),
    }
}

/// All passes that ran anywhere, in the order of the longest list.
fn pass_names<'a>(rows: impl Iterator<Item = &'a Vec<Stats>>) -> Vec<String> {
    let longest = rows
        .flatten()
        .map(|stats| &stats.passes)
        .max_by_key(|passes| passes.len());
    longest.map_or_else(Vec::new, |passes| {
        passes.iter().map(|pass| pass.name.clone()).collect()
    })
}

fn pass_table<'a>(
    title: &str,
    note: &str,
    head: &[&str],
    rows: impl Iterator<Item = &'a Vec<Stats>>,
) -> Table {
    let names = pass_names(rows);
    let wall = ["frame", "dispatch to readback"];
    let columns: Vec<&str> = head
        .iter()
        .copied()
        .chain(wall)
        .chain(names.iter().map(String::as_str))
        .collect();
    Table::new(title, note, &columns)
}

fn pass_row(
    mut row: Vec<Cell>,
    names: &[String],
    (stats, frame): &(Vec<Stats>, Spread),
) -> Vec<Cell> {
    row.push(Cell::Runs(frame.clone()));
    let wall = stats
        .iter()
        .map(|stats| stats.time_ms.gpu + stats.time_ms.readback);
    row.push(Cell::Runs(Spread::of(wall.collect())));
    for name in names {
        let times: Vec<f64> = stats
            .iter()
            .filter_map(|stats| stats.passes.iter().find(|pass| pass.name == *name)?.gpu_ms)
            .collect();
        row.push(if times.is_empty() {
            Cell::Absent
        } else {
            Cell::Median(Spread::of(times))
        });
    }
    row
}
