//! Measures `quality.target_error`: whether the true error stays under the target, and how long the frame takes.

use std::error::Error;

use caustica::config::Limits;
use caustica::lab::study::comparison;
use caustica::lab::study::dial::Dial;
use caustica::lab::study::sweep::{Refusal, SweepSettings, run_study};
use caustica::reference::Truth;
use caustica::render::Renderer;
use caustica::scene::ResolvedScene;
use caustica::stats::ChosenDials;
use tokio_util::sync::CancellationToken;

/// Target errors, relative L1.
pub(crate) const TARGETS: [f64; 4] = [0.05, 0.02, 0.01, 0.003];

/// The outcome for one target.
#[derive(Debug)]
pub(crate) struct Target {
    pub target: f64,
    pub chosen: ChosenDials,
    /// True relative L1 error.
    pub error: f64,
    /// Median time of a frame with the chosen dials, ms.
    pub frame_ms: f64,
    /// Trial renders and choice, ms.
    pub choosing_ms: f64,
}

/// Renders the scene with each of [`TARGETS`].
pub(crate) fn measure(
    renderer: &mut Renderer,
    resolved: &ResolvedScene,
    truth: &Truth,
    runs: u32,
) -> Result<Vec<Target>, Box<dyn Error>> {
    let mut measured = Vec::new();
    for target in TARGETS {
        let mut asking = resolved.clone();
        asking.scene.quality.target_error = Some(target);
        // The first render compiles pipelines and builds level maps; the second is measured.
        renderer.render(&asking, &CancellationToken::new())?;
        let stats = renderer.render(&asking, &CancellationToken::new())?.stats;
        let chosen = stats
            .accuracy
            .and_then(|accuracy| accuracy.chosen)
            .ok_or("nothing was chosen")?;
        let mut by_name = resolved.clone();
        let quality = &mut by_name.scene.quality;
        quality.water_cells = chosen.water_cells;
        quality.map_texels = chosen.map_texels;
        quality.level_map_texels = chosen.level_map_texels;
        quality.split_levels = chosen.split_levels;
        let settings = SweepSettings {
            dials: vec![Dial::parse(&format!("water_cells={}", chosen.water_cells))?],
            grid: false,
            rungs: comparison::DEFAULT_RUNGS,
            runs,
        };
        let (study, _) = run_study(
            &by_name,
            "",
            truth,
            &settings,
            &Limits::default(),
            &mut |scene| {
                renderer
                    .render(&scene, &CancellationToken::new())
                    .map_err(Refusal::All)
            },
            &mut |_, _, _| true,
        )?;
        let point = &study.sweeps[0].points[0];
        eprintln!(
            "  target {target}: {} cells, true error {:.3e}, predicted {:.3e}, {:.1} ms (predicted {:.1}), {}",
            chosen.water_cells,
            point.error.relative_l1,
            chosen.predicted_error,
            point.cost.wall_ms.median,
            chosen.predicted_ms,
            chosen.reason,
        );
        measured.push(Target {
            target,
            error: point.error.relative_l1,
            frame_ms: point.cost.wall_ms.median,
            choosing_ms: stats.time_ms.plan,
            chosen,
        });
    }
    Ok(measured)
}
