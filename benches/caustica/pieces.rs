//! Long dispatches in pieces: the number of pieces of heavy frames, and the time of the longest.

use std::error::Error;

use caustica::config::RenderConfig;
use caustica::gpu::pieces::LONGEST_MS;
use caustica::render::Renderer;
use tokio_util::sync::CancellationToken;

use crate::Effort;
use crate::frames::scene;
use crate::report::{Cell, Table};
use crate::spread::repeat;

/// A scene, its name in the table, and changes that make it heavy.
type Heavy = (
    &'static str,
    &'static str,
    &'static [(&'static str, &'static str)],
);

/// Heavy in rays, in objects and splitting, in texels under few wide beams, and in pixels.
const SCENES: [Heavy; 4] = [
    (
        "sine_pool",
        "2048 water cells",
        &[("/quality/water_cells", "2048")],
    ),
    (
        "reef",
        "1024 water cells, 4 split levels",
        &[
            ("/quality/water_cells", "1024"),
            ("/quality/split_levels", "4"),
        ],
    ),
    (
        "low_sun",
        "8 water cells on 2048 × 2048 texels",
        &[
            ("/quality/water_cells", "8"),
            ("/output/width", "2048"),
            ("/output/height", "2048"),
        ],
    ),
    (
        "teapot_pool",
        "3840 × 2160 pixels",
        &[("/output/width", "3840"), ("/output/height", "2160")],
    ),
];

/// The table of pieces.
pub(crate) fn pieces(effort: Effort) -> Result<Table, Box<dyn Error>> {
    let note = format!(
        "Heavy frames: ms, median (smallest..largest); the pieces of one frame, and the longest piece of all, from submission \
        to its end as measured by the host. Pieces aim at {LONGEST_MS} ms at most."
    );
    let columns = ["scene", "made heavy by", "frame", "pieces", "longest"];
    let mut table = Table::new("Long dispatches in pieces", &note, &columns);
    for (name, what, changes) in SCENES {
        eprintln!("pieces, {name}, {what} …");
        let scene = scene(&format!("scenes/{name}.json"), changes)?;
        let mut renderer = Renderer::new(&RenderConfig::default())?;
        // The first frame builds what is kept between frames; its pieces wait for kernels as well.
        renderer.render(&scene, &CancellationToken::new())?;
        renderer.forget_pieces();
        let (counts, frame) = repeat(effort, || {
            let before = renderer.pieces().0;
            renderer.render(&scene, &CancellationToken::new())?;
            Ok::<_, Box<dyn Error>>(renderer.pieces().0 - before)
        })?;
        let (_, longest_ms) = renderer.pieces();
        let last = counts.last().copied().unwrap_or_default();
        table.rows.push(vec![
            Cell::text(name),
            Cell::text(what),
            Cell::Runs(frame),
            Cell::count(usize::try_from(last)?),
            Cell::figure(longest_ms),
        ]);
    }
    Ok(table)
}
