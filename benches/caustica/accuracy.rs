//! The cost of a frame's estimate of its own error: each frame without and with it, interleaved.

use std::error::Error;
use std::time::Instant;

use caustica::render::Renderer;
use caustica::scene::ResolvedScene;
use tokio_util::sync::CancellationToken;

use crate::Effort;
use crate::frames::scene;
use crate::report::{Cell, Table};
use crate::spread::{Spread, ms};

/// Frames with and without the estimate, interleaved, so that a busy machine slows both.
pub(crate) fn estimates(renderer: &mut Renderer, effort: Effort) -> Result<Table, Box<dyn Error>> {
    let mut table = Table::new(
        "A frame's own estimate: time",
        "Frames without and with `quality.estimate_error`, interleaved; ms, median (smallest..largest), and the median of the \
        pairs' ratios. The two frames of a pair are at most seconds apart, so changes of a busy machine's speed affect both.",
        &["scene", "cells", "plain", "estimating", "ratio"],
    );
    let cases = [
        ("sine_pool", 64),
        ("sine_pool", 128),
        ("sine_pool", 256),
        ("sine_pool", 512),
        ("sine_pool", 1024),
        ("low_sun", 512),
        ("teapot_floor", 512),
        ("reef", 256),
        ("pool", 512),
        ("teapot_pool", 1024),
    ];
    for (name, cells) in cases {
        eprintln!("estimates, {name}, {cells} water cells …");
        let path = format!("scenes/{name}.json");
        let plain = scene(&path, &[("/quality/water_cells", &cells.to_string())])?;
        let mut estimating = plain.clone();
        estimating.scene.quality.estimate_error = true;
        let (mut without, mut with) = (Vec::new(), Vec::new());
        // The first of each builds what is kept between frames.
        time(renderer, &plain)?;
        time(renderer, &estimating)?;
        let started = Instant::now();
        while without.len() < effort.least_runs || started.elapsed() < effort.row {
            without.push(time(renderer, &plain)?);
            with.push(time(renderer, &estimating)?);
        }
        let ratios = with
            .iter()
            .zip(&without)
            .map(|(with, without)| with / without);
        let ratio = Spread::of(ratios.collect()).median();
        let (without, with) = (Spread::of(without), Spread::of(with));
        table.rows.push(vec![
            Cell::text(name),
            Cell::count(cells),
            Cell::Runs(without),
            Cell::Runs(with),
            Cell::figure(ratio),
        ]);
    }
    Ok(table)
}

fn time(renderer: &mut Renderer, scene: &ResolvedScene) -> Result<f64, Box<dyn Error>> {
    let started = Instant::now();
    renderer.render(scene, &CancellationToken::new())?;
    Ok(ms(started.elapsed()))
}
