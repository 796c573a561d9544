//! Figures that papers published about their methods, beside ours, measured by rendering like scenes. Other machines have other times, so
//! ratios are what can be compared.

use std::error::Error;
use std::fmt::Write as _;

use caustica::accuracy::metrics::relative_l1;
use caustica::config::RenderConfig;
use caustica::lab::study::points::Points;
use caustica::lab::study::words::{ms, percent, significant};
use caustica::render::Renderer;
use caustica::scene::LayerName;
use caustica::scene::{Dial, Light, MethodChoice, Output, ResolvedScene, ViewOutput};
use caustica::{methods::caustic_volume, methods::photon};
use tokio_util::sync::CancellationToken;

use crate::methods::load;

/// The name that measures this section alone.
pub(crate) const NAME: &str = "papers";
/// Timed frames, after one that warms up.
const RUNS: usize = 3;

/// Machine of Mihálik's table 2, and frames per second with and without caustics.
const CAUSTICS: [(&str, f64, f64); 3] = [
    ("Radeon X800", 27.0, 75.0),
    ("GeForce 7950GT", 130.0, 170.0),
    ("GeForce 6800", 57.0, 69.0),
];
/// Texels along a side of the caustics texture, and frames per second, of Mihálik's table 3.
const TEXTURES: [(u32, f64); 3] = [(256, 31.0), (512, 28.0), (1024, 17.0)];
/// Cells of the paper's water: 2401 vertices.
const MIHALIK_CELLS: u32 = 48;

/// A scene of Sandberg & Falemo: ours, water cells, pixels along a side, and their frames per second.
const VOLUMES: [(&str, &str, u32, u32, f64); 3] = [
    ("an empty pool (fig. 4)", "pool", 64, 512, 32.3),
    ("a complex object (fig. 3)", "teapot_pool", 128, 512, 8.6),
    ("a complex object (fig. 3)", "teapot_pool", 128, 1024, 3.0),
];

/// Median time of a warm frame, and the sum of its method's own passes, ms.
struct Measured {
    frame_ms: f64,
    own_ms: f64,
}

/// The whole section.
pub(crate) fn section() -> Result<String, Box<dyn Error>> {
    let mut renderer = Renderer::new(&RenderConfig::default())?;
    let mut text = "\n## The papers' figures beside ours\n\n\
        The papers measured other scenes on graphics cards of their time; these are scenes of this repository that are like them, on the machine\n\
        of this page. A ratio of two times says more than a time.\n"
        .to_owned();
    eprintln!("papers …");
    text += &photon_cost(&mut renderer)?;
    text += &photon_textures(&mut renderer)?;
    text += &photon_search(&mut renderer)?;
    text += &volumes(&mut renderer)?;
    Ok(text)
}

/// The radiance of a square view.
fn view(name: &str, pixels: u32) -> Result<ResolvedScene, Box<dyn Error>> {
    let side = pixels.to_string();
    let size = [("/output/width", side.as_str()), ("/output/height", &side)];
    let mut resolved = load(name, Points::View, &size)?;
    if let Output::View(view) = &mut resolved.scene.output {
        view.layers = ViewOutput::default().layers;
    }
    Ok(resolved)
}

fn with(resolved: &ResolvedScene, method: &MethodChoice) -> ResolvedScene {
    let mut resolved = resolved.clone();
    resolved.scene.quality.method = caustica::methods::shortest(method);
    resolved
}

fn photons(texels: u32, more: &[(&Dial, &str)]) -> MethodChoice {
    let choice = MethodChoice::named(photon::METHOD.name)
        .with(&photon::PHOTONS_PER_SIDE, texels)
        .with(&photon::MAP_TEXELS, texels);
    more.iter()
        .fold(choice, |choice, (dial, word)| choice.with(dial, *word))
}

fn measure(renderer: &mut Renderer, scene: &ResolvedScene) -> Result<Measured, Box<dyn Error>> {
    let never = CancellationToken::new();
    renderer.render(scene, &never)?;
    let own = caustica::methods::of(&scene.scene.quality).passes;
    let (mut frames, mut passes) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        let stats = renderer.render(scene, &never)?.stats;
        frames.push(stats.time_ms.total);
        let of_method = stats.passes.iter();
        let of_method = of_method.filter(|pass| own.iter().any(|p| p.name == pass.name));
        passes.push(of_method.filter_map(|pass| pass.gpu_ms).sum());
    }
    Ok(Measured {
        frame_ms: median(frames),
        own_ms: median(passes),
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A frame with caustics against one without.
fn photon_cost(renderer: &mut Renderer) -> Result<String, Box<dyn Error>> {
    let mut scene = view("teapot_pool", 512)?;
    scene.scene.quality.water_cells = MIHALIK_CELLS;
    let lit = with(&scene, &photons(256, &[]));
    let mut dark = lit.clone();
    dark.scene
        .lights
        .retain(|light| matches!(light, Light::Sky(_)));
    let on = measure(renderer, &lit)?.frame_ms;
    let off = measure(renderer, &dark)?.frame_ms;
    let mut text = format!(
        "\n### Mihálik 2008, table 2: what caustics cost (`{}`)\n\n\
         A frame with caustics, over one without (in ours: without the sun). 512 × 512 pixels, caustics texture of 256 × 256.\n\n\
         | machine | without | with | ratio |\n| --- | ---: | ---: | ---: |\n\
         | ours | {} ms | {} ms | {} |\n",
        photon::METHOD.name,
        ms(off),
        ms(on),
        significant(on / off, 3)
    );
    for (machine, with, without) in CAUSTICS {
        let _ = writeln!(
            text,
            "| {machine} | {without} fps | {with} fps | {} |",
            significant(without / with, 3)
        );
    }
    Ok(text)
}

/// Frames with finer textures.
fn photon_textures(renderer: &mut Renderer) -> Result<String, Box<dyn Error>> {
    let mut scene = view("teapot_pool", 512)?;
    scene.scene.quality.water_cells = MIHALIK_CELLS;
    let mut times = Vec::new();
    for word in ["atomic", photon::DRAWN] {
        let mut row = Vec::new();
        for (texels, _) in TEXTURES {
            let lit = with(&scene, &photons(texels, &[(&photon::DEPOSIT, word)]));
            row.push(measure(renderer, &lit)?.frame_ms);
        }
        times.push((word, row));
    }
    let mut text = "\n### Mihálik 2008, table 3: texture resolutions\n\n\
         Time of a frame; one photon per texel.\n\n| texture | paper |"
        .to_owned();
    for (word, _) in &times {
        let _ = write!(text, " ours, deposit `{word}` |");
    }
    text += "\n| --- | ---: | ---: | ---: |\n";
    for (index, (texels, fps)) in TEXTURES.into_iter().enumerate() {
        let paper = TEXTURES[0].1 / fps;
        let _ = write!(
            text,
            "| {texels}² | {fps} fps (× {}) |",
            significant(paper, 3)
        );
        for (_, row) in &times {
            let ratio = significant(row[index] / row[0], 3);
            let _ = write!(text, " {} ms (× {ratio}) |", ms(row[index]));
        }
        text.push('\n');
    }
    Ok(text)
}

/// What the search in image space misses.
fn photon_search(renderer: &mut Renderer) -> Result<String, Box<dyn Error>> {
    const STEPS: [u32; 4] = [1, 2, 3, 8];
    let never = CancellationToken::new();
    let mut text = "\n### Mihálik 2008, §7.1: the search in image space\n\n\
         How far the light on the floor is from that with exact intersections (relative L1 difference), after a number of steps. The paper has\n\
         no figures. 512 × 512 photons into 256 × 256 texels.\n\n| scene | 1 | 2 | 3 | 8 |\n| --- | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    for name in ["sine_pool", "low_sun", "teapot_floor", "reef"] {
        let scene = load(name, Points::Map, &[])?;
        let choice = || photons(256, &[]).with(&photon::PHOTONS_PER_SIDE, 512_u32);
        let mut light = |choice: MethodChoice| -> Result<Vec<f32>, Box<dyn Error>> {
            let frame = renderer.render(&with(&scene, &choice), &never)?;
            Ok(frame.layers[&LayerName::Irradiance].data.clone())
        };
        let exact = light(choice().with(&photon::SEARCH, photon::EXACT))?;
        let _ = write!(text, "| {name} |");
        for steps in STEPS {
            let found = light(choice().with(&photon::ITERATIONS, steps))?;
            let _ = write!(text, " {} |", percent(relative_l1(&found, &exact)?));
        }
        text.push('\n');
    }
    Ok(text)
}

fn volumes(renderer: &mut Renderer) -> Result<String, Box<dyn Error>> {
    let mut text = format!(
        "\n### Sandberg & Falemo 2005: frames per second (`{}`)\n\n\
         | scene | ours | water cells | pixels | paper | ours, its passes | ours, frame |\n\
         | --- | --- | ---: | ---: | ---: | ---: | ---: |\n",
        caustic_volume::METHOD.name
    );
    for (scene, name, cells, pixels, fps) in VOLUMES {
        let mut resolved = with(
            &view(name, pixels)?,
            &MethodChoice::named(caustic_volume::METHOD.name),
        );
        resolved.scene.quality.water_cells = cells;
        let found = measure(renderer, &resolved)?;
        let _ = writeln!(
            text,
            "| {scene} | {name} | {cells}² | {pixels}² | {fps} fps | {} ms | {} ms |",
            ms(found.own_ms),
            ms(found.frame_ms)
        );
    }
    Ok(text)
}
