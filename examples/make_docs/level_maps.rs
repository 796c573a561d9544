//! Writes `docs/level-maps.md`: the thesis's experiments with our measurements.

use std::cell::RefCell;
use std::error::Error;
use std::path::Path;

use caustica::config::RenderConfig;
use caustica::lab::experiment::level_map::{self as experiment, Experiment, FEATURED, Settings};
use caustica::lab::shapes;
use caustica::reference::{TruthSettings, truth};
use caustica::render::Renderer;
use tokio_util::sync::CancellationToken;

use super::{layers, residual};

/// The argument that writes this page only.
pub(crate) const NAME: &str = "level_maps";

/// Numbers of planes, as in the page's tables.
const PLANES: [u32; 6] = [3, 9, 25, 50, 75, 101];
/// Every second shape of the catalogue is measured, and also those with a section of their own and the one with most triangles: more than
/// the thesis's 30.
const EACH: usize = 2;
/// The shape with most triangles.
const LARGEST: &str = "terrain";
/// Folder of the measurements of each shape, so that an interrupted run can continue.
const FOUND: &str = "out/level-maps";

/// Measures all shapes and writes the page with the plots of those with a section of their own.
pub(crate) fn write() -> Result<(), Box<dyn Error>> {
    let meshes: Vec<&str> = shapes::ALL
        .iter()
        .enumerate()
        .filter(|(index, shape)| {
            index % EACH == 0 || shape.name == LARGEST || FEATURED.contains(&shape.name)
        })
        .map(|(_, shape)| shape.name)
        .collect();
    let renderer = RefCell::new(Renderer::new(&RenderConfig::default())?);
    renderer.borrow_mut().watch_allocator(true);
    let mut found = Experiment::default();
    for (index, name) in meshes.iter().enumerate() {
        eprintln!("  {} of {}: {name}", index + 1, meshes.len());
        let mut one = kept_or_measured(name, &renderer)?;
        let before = std::mem::take(&mut found.meshes);
        one.meshes.splice(0..0, before);
        found = one;
    }
    write_page(&found, &renderer)
}

/// A shape's measurements: those of an earlier run of this version with the same settings, or measured now.
fn kept_or_measured(
    name: &str,
    renderer: &RefCell<Renderer>,
) -> Result<Experiment, Box<dyn Error>> {
    let settings = Settings {
        meshes: vec![name.to_owned()],
        planes: PLANES.to_vec(),
        runs: 3,
        water_cells: 96,
        texels: 64,
    };
    let path = Path::new(FOUND).join(format!("{name}.json"));
    if let Ok(text) = std::fs::read_to_string(&path) {
        let kept: Experiment = serde_json::from_str(&text)?;
        if kept.is_of(&settings) {
            return Ok(kept);
        }
    }
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
        &mut |_, _, what| eprintln!("    {what}"),
    )?;
    std::fs::create_dir_all(FOUND)?;
    std::fs::write(&path, serde_json::to_string_pretty(&found)?)?;
    Ok(found)
}

fn write_page(found: &Experiment, renderer: &RefCell<Renderer>) -> Result<(), Box<dyn Error>> {
    let folder = Path::new("docs/level-maps");
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("level_maps.csv"), experiment::to_csv(found))?;
    for mesh in found
        .meshes
        .iter()
        .filter(|mesh| FEATURED.contains(&mesh.name.as_str()))
    {
        for (stem, plot) in experiment::plots(found, mesh)? {
            std::fs::write(folder.join(format!("{stem}.svg")), plot.svg)?;
        }
    }
    let mut page = experiment::to_markdown(found, "level-maps/");
    page.push_str(&residual::chapter(renderer, folder)?);
    page.push_str(&layers::chapter(renderer)?);
    std::fs::write("docs/level-maps.md", page)?;
    eprintln!("docs/level-maps.md");
    Ok(())
}
