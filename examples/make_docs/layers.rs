//! Measures the accuracy and cost of each layer of a level map on the sides of a box.

use std::cell::RefCell;
use std::error::Error;
use std::fmt::Write as _;

use caustica::accuracy::metrics::relative_l1;
use caustica::cli::scene_file;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::config::Limits;
use caustica::frame::Frame;
use caustica::lab::study::words::{mib, ms, percent};
use caustica::reference::{TruthSettings, truth};
use caustica::render::Renderer;
use caustica::scene::{LayerName, ResolvedScene};
use tokio_util::sync::CancellationToken;

/// Pixels of the truth along x and y.
const SIZE: [usize; 2] = [64, 48];
/// Pixels of the renderer for each of those along both: the truth is the mean over a pixel, a picture shows its centre.
const FINER: usize = 4;
/// Timed runs of each number of layers.
const RUNS: usize = 5;

fn box_sides(layers: u32, finer: usize) -> Result<ResolvedScene, Box<dyn Error>> {
    let [width, height] = SIZE.map(|n| (n * finer).to_string());
    let overrides = [
        ("/output/width", width),
        ("/output/height", height),
        ("/output/format", "exr".to_owned()),
        ("/output/layers", "irradiance,normal,albedo".to_owned()),
        ("/quality/layers", layers.to_string()),
    ];
    let overrides = overrides.map(|(pointer, text)| (pointer.to_owned(), text));
    let args = SceneArgs {
        scene: "scenes/box_sides.json".into(),
        overrides: SceneOverrides(overrides.to_vec()),
    };
    Ok(scene_file::load(&args, None, &Limits::default())?.resolved)
}

/// A pixel of the truth: mean irradiance there, and the normal if the whole pixel shows one face of the box.
fn coarse(frame: &Frame) -> Vec<([f64; 3], Option<[f32; 3]>)> {
    let at = |name: LayerName, pixel: usize| -> [f32; 3] {
        let layer = &frame.layers[&name];
        std::array::from_fn(|c| layer.data[pixel * layer.channels + c])
    };
    let width = SIZE[0] * FINER;
    (0..SIZE[0] * SIZE[1])
        .map(|pixel| {
            let first = pixel / SIZE[0] * FINER * width + pixel % SIZE[0] * FINER;
            let all: Vec<usize> = (0..FINER * FINER)
                .map(|i| first + i / FINER * width + i % FINER)
                .collect();
            let mean = std::array::from_fn(|c| {
                let values = all.iter().map(|&i| at(LayerName::Irradiance, i)[c]);
                values.map(f64::from).sum::<f64>() / all.len() as f64
            });
            let normal = at(LayerName::Normal, first);
            // The box is brighter than the floor.
            let is_one = all
                .iter()
                .all(|&i| at(LayerName::Normal, i) == normal && at(LayerName::Albedo, i)[0] > 0.7);
            (mean, is_one.then_some(normal))
        })
        .collect()
}

/// Measures, and returns the chapter in Markdown.
pub(crate) fn chapter(renderer: &RefCell<Renderer>) -> Result<String, Box<dyn Error>> {
    let settings = TruthSettings {
        target_error: Some(2e-2),
        most_points: 20_000,
        disk: Some("out/truth".into()),
        ..TruthSettings::default()
    };
    let truth = truth(&box_sides(1, 1)?, &settings, &|_| {}, &|| false)?;
    let mut text = format!(
        "\n## Layers\n\n`scenes/box_sides.json`: a box under steep waves and a sun 35° high, seen from the side. Relative L1 errors of the \
        irradiance in the picture, over the pixels that show one upright side only, against a reference that is {} off by its \
        own estimate; GPU time of a frame with level maps cached, median of {RUNS} interleaved runs; memory by our own account \
        and by the allocator.\n\n\
        | layers | error, upright sides | error, side away from the sun | ms | MiB | allocator MiB | level maps MiB |\n\
        |---:|---:|---:|---:|---:|---:|---:|\n",
        percent(truth.relative_error)
    );
    let scenes = (1..=4)
        .map(|layers| box_sides(layers, FINER))
        .collect::<Result<Vec<_>, _>>()?;
    let render = |scene: &ResolvedScene| {
        renderer
            .borrow_mut()
            .render(scene, &CancellationToken::new())
    };
    for scene in &scenes {
        render(scene)?;
    }
    let mut runs: Vec<Vec<Frame>> = scenes.iter().map(|_| Vec::new()).collect();
    for _ in 0..RUNS {
        for (scene, frames) in scenes.iter().zip(&mut runs) {
            frames.push(render(scene)?);
        }
    }
    for (layers, (scene, frames)) in (1..).zip(scenes.iter().zip(&mut runs)) {
        frames.sort_by(|a, b| a.stats.time_ms.gpu.total_cmp(&b.stats.time_ms.gpu));
        let frame = &frames[RUNS / 2];
        let pixels = coarse(frame);
        let error_where = |wanted: fn([f32; 3]) -> bool| -> Result<f64, Box<dyn Error>> {
            let of = || (0..pixels.len()).filter(|&at| pixels[at].1.is_some_and(wanted));
            let seen: Vec<f64> = of().flat_map(|at| pixels[at].0).collect();
            let right: Vec<f64> = of().flat_map(|at| truth.irradiance[at]).collect();
            Ok(relative_l1(&seen, &right)?)
        };
        let facts = caustica::methods::facts(scene)?;
        let maps = caustica::plan::level_maps(&facts);
        let memory = &frame.stats.memory;
        let _ = writeln!(
            text,
            "| {layers} | {} | {} | {} | {} | {} | {} |",
            percent(error_where(|n| n[1].abs() < 0.5)?),
            percent(error_where(|n| n[2] > 0.5)?),
            ms(frame.stats.time_ms.gpu),
            mib(memory.peak_bytes),
            memory.allocated_bytes.map_or_else(String::new, mib),
            mib(maps.iter().map(|key| key.bytes()).sum()),
        );
    }
    text.push_str(
        "\nOne layer leaves the side away from the sun dark, the second lights it. A box has two surfaces along the light, so \
        the third and fourth layer cost memory and gain nothing.\n",
    );
    Ok(text)
}
