//! Water on a grid: the time for the surface of one more moment.

use std::error::Error;

use caustica::scene::{ResolvedScene, Scene};
use caustica::waves::Surface;
use serde_json::{Value, json};

use crate::Effort;
use crate::report::{Cell, Table};
use crate::spread::repeat;

/// The table of seas and basins.
pub(crate) fn water(effort: Effort) -> Result<Table, Box<dyn Error>> {
    let note = "ms, median (smallest..largest) for the surface of a moment, with its bounds. The first frame also finds what does not \
        depend on time; all others have only that of it.";
    let columns = ["water", "samples", "first frame", "each further"];
    let mut table = Table::new("Water on a grid", note, &columns);
    let sea = |samples: u32| json!({ "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 8, "tile_m": 50, "samples": samples });
    let basin = json!({
        "kind": "ripples", "min_m": [-1, -1], "max_m": [1, 1], "samples": 256,
        "drops": [{ "position_m": [0.2, 0.1], "radius_m": 0.05, "height_m": 0.01, "at_s": -3 }]
    });
    let mut choppy = sea(512);
    choppy["choppiness"] = json!(0.8);
    for (name, samples, waves) in [
        ("a sea", 256, sea(256)),
        ("a sea", 512, sea(512)),
        ("a sea", 1024, sea(1024)),
        ("a choppy sea", 512, choppy),
        ("a basin", 256, basin),
    ] {
        eprintln!("water, {name} of {samples} samples …");
        let (_, first) = repeat(effort, || surface(&mut bare(&waves)?, 0))?;
        let mut scene = bare(&waves)?;
        let mut frame = 0;
        surface(&mut scene, frame)?;
        let (_, further) = repeat(effort, || {
            frame += 1;
            surface(&mut scene, frame)
        })?;
        table.rows.push(vec![
            Cell::text(name),
            Cell::count(samples),
            Cell::Runs(first),
            Cell::Runs(further),
        ]);
    }
    Ok(table)
}

fn bare(waves: &Value) -> Result<ResolvedScene, Box<dyn Error>> {
    let scene: Scene = serde_json::from_value(json!({ "water": { "waves": [waves] } }))?;
    Ok(ResolvedScene::bare(scene))
}

/// The surface of a frame, at 24 frames a second.
fn surface(scene: &mut ResolvedScene, frame: u32) -> Result<(), Box<dyn Error>> {
    scene.scene.time_s = f64::from(frame) / 24.0;
    let surface = Surface::of(scene)?;
    if surface.max_slope() > 0.0 {
        Ok(())
    } else {
        Err("the water is flat".into())
    }
}
