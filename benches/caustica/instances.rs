//! The cost of many objects: 5, 50 and 200 instances under the same water, with and without the hierarchy over them.

use std::error::Error;

use caustica::assets::MeshStore;
use caustica::config::{Limits, RenderConfig};
use caustica::methods;
use caustica::render::Renderer;
use caustica::scene::{ResolvedScene, Scene};
use caustica::stats::Stats;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use crate::Effort;
use crate::report::{Cell, Table};
use crate::spread::{Spread, repeat};

#[path = "../../tests/support/instances.rs"]
mod instances_scene;

/// Passes whose rays search for objects.
const SEEKING: [&str; 3] = ["hits", "split", "camera_hits"];

/// The table of instances.
pub(crate) fn instances(effort: Effort) -> Result<Table, Box<dyn Error>> {
    let columns: Vec<&str> = ["instances", "walk", "frame"]
        .into_iter()
        .chain(SEEKING)
        .chain(["irradiance", "at the peak"])
        .collect();
    let mut table = Table::new(
        "Instances: time",
        "Instances of five meshes scattered over the same 6 m by 6 m of water, 384 water cells, 320 × 240 pixels; ms, median \
         (smallest..largest). `hierarchy`: rays test only the instances that the hierarchy selects. `each`: rays test the \
         bounds of every instance, without a hierarchy.",
        &columns,
    );
    let [from, to] = instances_scene::WITHOUT_HIERARCHY;
    let each = methods::embedded()
        .with_replacement("shared/geometry.wgsl", from, to)
        .ok_or("the loop over the instances is not found")?;
    for (walk, sources) in [("hierarchy", methods::embedded()), ("each", each)] {
        let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources)?;
        for count in [5, 50, 200] {
            eprintln!("instances, {count}, {walk} …");
            let scene = resolved(instances_scene::scene(count))?;
            // The first one builds what is kept between frames.
            render(&mut renderer, &scene)?;
            let (stats, frame) = repeat(effort, || render(&mut renderer, &scene))?;
            let mut row = vec![Cell::count(count), Cell::text(walk), Cell::Runs(frame)];
            for name in SEEKING.iter().copied().chain(["irradiance"]) {
                let times = stats.iter().filter_map(|stats| pass_ms(stats, name));
                row.push(Cell::Median(Spread::of(times.collect())));
            }
            let peak = stats.last().map_or(0, |stats| stats.memory.peak_bytes);
            row.push(Cell::Figure {
                value: peak as f64,
                text: caustica::cli::summary::bytes(peak),
            });
            table.rows.push(row);
        }
    }
    Ok(table)
}

fn render(renderer: &mut Renderer, scene: &ResolvedScene) -> Result<Stats, Box<dyn Error>> {
    Ok(renderer.render(scene, &CancellationToken::new())?.stats)
}

fn pass_ms(stats: &Stats, name: &str) -> Option<f64> {
    stats.passes.iter().find(|pass| pass.name == name)?.gpu_ms
}

/// The scene with its file names turned into meshes.
fn resolved(mut scene: Value) -> Result<ResolvedScene, Box<dyn Error>> {
    let limits = Limits::default();
    let store = MeshStore::new(&limits);
    let mut meshes = Vec::new();
    for object in scene["objects"].as_array_mut().into_iter().flatten() {
        let file = object["mesh"].as_str().ok_or("a file name")?;
        let mesh = store.insert_obj(&std::fs::read(format!("scenes/meshes/{file}"))?, &[])?;
        object["mesh"] = json!(mesh.mesh.id);
        meshes.push(mesh.mesh);
    }
    let find = |id: &str| meshes.iter().find(|mesh| mesh.id == id).cloned();
    Ok(methods::resolve(Scene::from_value(scene)?, &limits, find)?)
}
