//! Writes `docs/sea.md`: sunlight under the sea, beside what others measured.

use std::error::Error;
use std::path::Path;

use caustica::config::RenderConfig;
use caustica::lab::experiment::sea::{self, SeaStudy, Settings};
use caustica::render::Renderer;
use tokio_util::sync::CancellationToken;

/// The argument that writes this page only.
pub(crate) const NAME: &str = "sea";

/// The measurements of an earlier run, so that the page can be written again.
const FOUND: &str = "out/sea/sea.json";

/// Measures, unless an earlier run of this version has left its measurements, and writes the page with its plots.
pub(crate) fn write() -> Result<(), Box<dyn Error>> {
    let found = kept_or_measured()?;
    let folder = Path::new("docs/sea");
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("sea.csv"), sea::to_csv(&found))?;
    for (stem, plot) in sea::plots(&found)? {
        std::fs::write(folder.join(format!("{stem}.svg")), plot.svg)?;
    }
    std::fs::write("docs/sea.md", sea::to_markdown(&found, "sea/"))?;
    eprintln!("docs/sea.md");
    Ok(())
}

fn kept_or_measured() -> Result<SeaStudy, Box<dyn Error>> {
    let path = Path::new(FOUND);
    if let Ok(text) = std::fs::read_to_string(path) {
        let kept: SeaStudy = serde_json::from_str(&text)?;
        if kept.version == env!("CARGO_PKG_VERSION") {
            return Ok(kept);
        }
    }
    let mut renderer = Renderer::new(&RenderConfig::default())?;
    renderer.time_by_host(false);
    let never = CancellationToken::new();
    let found = sea::measure(
        &Settings::default(),
        &mut |scene| Ok(renderer.render(scene, &never)?),
        &mut |done, total, what| eprintln!("    {done} of {total}: {what}"),
    )?;
    std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
    std::fs::write(path, serde_json::to_string_pretty(&found)?)?;
    Ok(found)
}
