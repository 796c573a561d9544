//! `docs/level-maps.md`: the thesis's experiments in our numbers.

use std::cell::RefCell;
use std::error::Error;
use std::path::Path;

use caustica::config::RenderConfig;
use caustica::experiment::{self, FEATURED, Settings};
use caustica::mesh::shapes;
use caustica::reference::{TruthSettings, truth};
use caustica::render::Renderer;
use tokio_util::sync::CancellationToken;

/// What to ask for to have this page only.
pub(crate) const NAME: &str = "level_maps";

/// Numbers of planes, as in the page's tables.
const PLANES: [u32; 6] = [3, 9, 25, 50, 75, 101];
/// Of the shapes of the catalogue each second is measured, those that are shown one by one besides: more than the thesis's 30.
const EACH: usize = 2;

/// Measures all shapes and writes the page with the plots of those that it shows one by one.
pub(crate) fn write() -> Result<(), Box<dyn Error>> {
    let settings = Settings {
        meshes: shapes::ALL
            .iter()
            .enumerate()
            .filter(|(index, shape)| index % EACH == 0 || FEATURED.contains(&shape.name))
            .map(|(_, shape)| shape.name.to_owned())
            .collect(),
        planes: PLANES.to_vec(),
        runs: 3,
        water_cells: 96,
        texels: 64,
    };
    let renderer = RefCell::new(Renderer::new(&RenderConfig::default())?);
    renderer.borrow_mut().watch_allocator(true);
    let truth_settings = TruthSettings {
        target_error: Some(3e-3),
        disk: Some("out/truth".into()),
        ..TruthSettings::default()
    };
    let found = experiment::measure(
        &settings,
        &mut |scene| {
            Ok(renderer
                .borrow_mut()
                .render(scene, &CancellationToken::new())?)
        },
        &mut |scene| Ok(Some(truth(scene, &truth_settings, &|_| {}, &|| false)?)),
        &mut |done, total, what| eprintln!("  {done} of {total}: {what}"),
    )?;
    let folder = Path::new("docs/level-maps");
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("level_maps.csv"), experiment::to_csv(&found))?;
    for mesh in found
        .meshes
        .iter()
        .filter(|mesh| FEATURED.contains(&mesh.name.as_str()))
    {
        for (stem, plot) in experiment::plots(&found, mesh)? {
            std::fs::write(folder.join(format!("{stem}.svg")), plot.svg)?;
        }
    }
    std::fs::write(
        "docs/level-maps.md",
        experiment::to_markdown(&found, "level-maps/"),
    )?;
    eprintln!("docs/level-maps.md");
    Ok(())
}
