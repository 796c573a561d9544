//! The time saved by skipping work that has no effect, and by keeping level maps from frame to frame: each with and without the saving,
//! interleaved.

use std::error::Error;
use std::time::Instant;

use caustica::config::RenderConfig;
use caustica::methods;
use caustica::render::Renderer;
use caustica::scene::ResolvedScene;
use tokio_util::sync::CancellationToken;

use crate::Effort;
use crate::frames::scene;
use crate::report::{Cell, Table};
use crate::spread::{Spread, ms};

/// Frames of an animation, and the time between them.
const FRAMES: usize = 60;
const FRAME_S: f64 = 1.0 / 24.0;

/// Skipped work: its name, the affected pass, the scene with its dials, the shader file, and the text to replace with its replacement.
type Saving = (
    &'static str,
    &'static str,
    (&'static str, &'static [(&'static str, &'static str)]),
    (&'static str, &'static str, &'static str),
);

const SAVINGS: [Saving; 2] = [
    (
        "beams that miss a mesh's box, by 25 planes",
        "plane_deposit",
        (
            "scenes/teapot_floor.json",
            &[
                ("/quality/method", "planes"),
                ("/quality/method/planes", "25"),
            ],
        ),
        (
            "shared/cull.wgsl",
            "if any(max(high_first, high_last) < vec2f(0.0)) || any(min(low_first, low_last) > side) { return; }",
            "",
        ),
    ),
    (
        "water whose light cannot reach a mesh",
        "hits",
        ("scenes/teapot_pool.json", &[]),
        (
            "shared/trace_light.wgsl",
            "let may_meet = all(origin.xz >= light.objects_min_m) && all(origin.xz <= light.objects_max_m);",
            "let may_meet = true;",
        ),
    ),
];

/// The table of savings.
pub(crate) fn savings(effort: Effort) -> Result<Table, Box<dyn Error>> {
    let mut table = Table::new(
        "Savings: time",
        "With and without each saving, interleaved; ms, median (smallest..largest), and the ratio of the medians. The first \
        rows are the GPU time of the affected pass. The last is the time of a frame in an animation of 60 with moving waves, \
        whose level map is built once or for every frame.",
        &["what", "measured", "with", "without", "without ÷ with"],
    );
    for (what, pass, (path, dials), (file, from, to)) in SAVINGS {
        eprintln!("savings, {what} …");
        let scene = scene(path, dials)?;
        let without = methods::embedded()
            .with_replacement(file, from, to)
            .ok_or_else(|| format!("{file} has no `{from}`"))?;
        let mut renderers = [
            Renderer::new(&RenderConfig::default())?,
            Renderer::with_shaders(&RenderConfig::default(), without)?,
        ];
        let mut times = [Vec::new(), Vec::new()];
        for renderer in &mut renderers {
            pass_ms(renderer, &scene, pass)?;
        }
        let started = Instant::now();
        while times[0].len() < effort.least_runs || started.elapsed() < effort.row {
            for (renderer, times) in renderers.iter_mut().zip(&mut times) {
                times.push(pass_ms(renderer, &scene, pass)?);
            }
        }
        table.rows.push(row(what, pass, times));
    }
    eprintln!("savings, level maps …");
    table.rows.push(animation(effort)?);
    Ok(table)
}

fn row(what: &str, measured: &str, [with, without]: [Vec<f64>; 2]) -> Vec<Cell> {
    let (with, without) = (Spread::of(with), Spread::of(without));
    let ratio = without.median() / with.median();
    vec![
        Cell::text(what),
        Cell::text(measured),
        Cell::Runs(with),
        Cell::Runs(without),
        Cell::figure(ratio),
    ]
}

/// Frames whose level map is kept, and frames before each of which it is dropped.
fn animation(effort: Effort) -> Result<Vec<Cell>, Box<dyn Error>> {
    let dials = [
        ("/quality/water_cells", "128"),
        ("/quality/level_map_texels", "1024"),
    ];
    let mut scene = scene("scenes/teapot_floor.json", &dials)?;
    let frames = if effort.least_runs > 1 { FRAMES } else { 4 };
    let mut renderer = Renderer::new(&RenderConfig::default())?;
    let mut times = [Vec::new(), Vec::new()];
    for (forgets, times) in [false, true].into_iter().zip(&mut times) {
        let mut built = 0;
        for frame in 0..=frames {
            scene.scene.time_s = frame as f64 * FRAME_S;
            if forgets {
                renderer.forget_mesh(&scene.meshes[0].id);
            }
            let started = Instant::now();
            let stats = renderer.render(&scene, &CancellationToken::new())?.stats;
            // The first one compiles the shaders.
            if frame > 0 {
                times.push(ms(started.elapsed()));
            }
            built += stats.memory.level_maps.misses;
        }
        let expected = if forgets { frames + 1 } else { 1 };
        if built as usize != expected {
            return Err(format!("{built} level maps were built, not {expected}").into());
        }
    }
    Ok(row("level map kept over 60 frames", "frame", times))
}

fn pass_ms(
    renderer: &mut Renderer,
    scene: &ResolvedScene,
    pass: &str,
) -> Result<f64, Box<dyn Error>> {
    let stats = renderer.render(scene, &CancellationToken::new())?.stats;
    let found = stats.passes.iter().find(|p| p.name == pass);
    found
        .and_then(|p| p.gpu_ms)
        .ok_or_else(|| format!("pass {pass} was not timed").into())
}
