//! Why the error of reference planes does not go to 0 with more planes. The error is split into the map's rim, where texels are partly
//! covered, and the rest, and measured for several numbers of texels and planes and heights of the waves.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use caustica::accuracy::LinearImage;
use caustica::lab::experiment::level_map::{Technique, scene};
use caustica::lab::study::error_images::error_images;
use caustica::lab::study::study::{
    CostFigures, ErrorFigures, Point, SpreadMs, Study, StudyImages, Sweep, TruthFigures,
};
use caustica::lab::study::words::{percent, signed_percent};
use caustica::reference::{Truth, TruthSettings, truth};
use caustica::render::Renderer;
use caustica::scene::{LayerName, ResolvedScene, Wave};
use serde_json::json;
use tokio_util::sync::CancellationToken;

/// A solid with normals in all directions, one of flat faces, and a single flat face.
const SHAPES: [&str; 3] = ["sphere", "box", "plate"];
/// Texels along each side of the maps, the share of the waves' height, and the error that the reference may have.
const SETTINGS: [(u32, f64, f64); 4] = [
    (32, 1.0, 1e-2),
    (64, 1.0, 3e-3),
    (128, 1.0, 1e-2),
    (64, 0.5, 5e-3),
];
const PLANES: [u32; 4] = [9, 25, 101, 401];
const WATER_CELLS: u32 = 96;

/// A map's error, as shares of the light that the truth has on it.
struct Parts {
    inner: f64,
    rim: f64,
    /// Excess (above 0) or missing light on the rim.
    rim_signed: f64,
}

/// Measures, draws the errors of the shapes into `folder`, and returns the chapter in Markdown.
pub(crate) fn chapter(
    renderer: &RefCell<Renderer>,
    folder: &Path,
) -> Result<String, Box<dyn Error>> {
    let mut text = "\n## Where the error of planes comes from\n\n\
        Planes and hits on the same maps against the float64 reference, as shares of the light on the map: `rim` is the error \
        in texels next to a texel without a surface, `inner` the error in all others. 96² water cells; all values include the \
        reference's own error.\n\n\
        | shape | texels | waves | planes: 9 inner | 25 | 101 | 401 | 401 rim | signed rim | hits inner | rim | reference |\n\
        |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
        .to_owned();
    for name in SHAPES {
        for (texels, waves, truth_error) in SETTINGS {
            eprintln!("  residual of {name}, {texels}² texels, waves × {waves}");
            let mut base = scene(name, WATER_CELLS, texels)?;
            for wave in &mut base.scene.water.waves {
                if let Wave::Sine(wave) = wave {
                    wave.amplitude_m *= waves;
                }
            }
            let settings = TruthSettings {
                target_error: Some(truth_error),
                disk: Some("out/truth".into()),
                ..TruthSettings::default()
            };
            let truth = truth(&base, &settings, &|_| {}, &|| false)?;
            let rim = rim(&truth);
            let (mut images, mut costs) = (Vec::new(), Vec::new());
            let mut parts_of = |technique: Technique| -> Result<Parts, Box<dyn Error>> {
                let (image, ms) = render(renderer, &technique.of(&base))?;
                let parts = parts(&image, &truth, &rim);
                costs.push((parts.inner + parts.rim, ms));
                images.push(image);
                Ok(parts)
            };
            let planes = PLANES
                .map(|planes| parts_of(Technique::Smart(planes)))
                .into_iter()
                .collect::<Result<Vec<_>, _>>()?;
            let hit = parts_of(Technique::Hit)?;
            let inner: Vec<String> = planes.iter().map(|p| percent(p.inner)).collect();
            let most = &planes[PLANES.len() - 1];
            let _ = writeln!(
                text,
                "| {name} | {texels}² | × {waves} | {} | {} | {} | {} | {} | {} |",
                inner.join(" | "),
                percent(most.rim),
                signed_percent(most.rim_signed),
                percent(hit.inner),
                percent(hit.rim),
                percent(truth.relative_error),
            );
            if (texels, waves) == (64, 1.0) {
                images.truncate(PLANES.len());
                let png = sheet(name, &base, &truth, images, &costs)?;
                std::fs::write(folder.join(format!("{name}_residual.png")), png)?;
            }
        }
    }
    text.push_str(EXPLANATION);
    for name in SHAPES {
        let _ = write!(
            text,
            "\n![Errors of planes: {name}](level-maps/{name}_residual.png)\n"
        );
    }
    Ok(text)
}

const EXPLANATION: &str = "\nThree errors add up, and only the first depends on the distance d between planes:\n\n\
    1. A beam lights a texel at the plane's depth, up to d/2 from the surface. This error falls with d, and from about 25 \
    planes on only the other two remain.\n\
    2. The planes form a staircase that has treads but no risers. Let a be the axis of the level map, n the normal and w the \
    direction of a ray. A texel receives the light that goes through its tread, in proportion to a·w. Converted to the surface \
    by n·a this is (n·a)(a·w), while the correct factor is n·w. The two differ by tan θ tan δ for a slope of θ and a ray δ off \
    the axis, independent of d and of the size of texels. Halved waves halve δ and with it `inner`; more texels do not reduce \
    it; a face perpendicular to the axis does not have it. On steep parts a tilted ray passes between two treads, or through \
    both. `tests/gpu/planes.rs` checks this formula with a tilted plate under evenly tilted water.\n\
    3. On the rim a texel counts as covered if its centre is covered, and then receives the light of the whole texel. This is \
    `rim`: it is at least halved with every doubling of the texels, and does not depend on planes.\n\n\
    All three are properties of the method: slice images have the same treads and the same rim, and agree with level maps to \
    the byte except for texels on a border of slices. Placement by hits has none of the three, because it uses the surface \
    itself.\n";

/// Texels with a surface that have a neighbour without one.
fn rim(truth: &Truth) -> Vec<bool> {
    let (width, height) = (i64::from(truth.width), i64::from(truth.height));
    let has = |x: i64, y: i64| {
        (0..width).contains(&x)
            && (0..height).contains(&y)
            && truth.compared[(y * width + x) as usize]
    };
    (0..width * height)
        .map(|at| {
            let (x, y) = (at % width, at / width);
            has(x, y) && !(-1..=1).all(|dy| (-1..=1).all(|dx| has(x + dx, y + dy)))
        })
        .collect()
}

fn render(
    renderer: &RefCell<Renderer>,
    scene: &ResolvedScene,
) -> Result<(LinearImage, SpreadMs), Box<dyn Error>> {
    let frame = renderer
        .borrow_mut()
        .render(scene, &CancellationToken::new())?;
    let layer = &frame.layers[&LayerName::Irradiance];
    let pixels = layer.data.chunks_exact(layer.channels);
    let ms = SpreadMs::of(vec![frame.stats.time_ms.total]).unwrap_or_default();
    let image = LinearImage {
        width: frame.width,
        height: frame.height,
        rgb: pixels
            .map(|p| std::array::from_fn(|c| f64::from(p[c])))
            .collect(),
    };
    Ok((image, ms))
}

fn parts(image: &LinearImage, truth: &Truth, rim: &[bool]) -> Parts {
    let mut parts = Parts {
        inner: 0.0,
        rim: 0.0,
        rim_signed: 0.0,
    };
    let mut all = 0.0;
    for (at, (value, right)) in image.rgb.iter().zip(&truth.irradiance).enumerate() {
        if !truth.compared[at] {
            continue;
        }
        for (value, right) in value.iter().zip(right) {
            all += right;
            if rim[at] {
                parts.rim += (value - right).abs();
                parts.rim_signed += value - right;
            } else {
                parts.inner += (value - right).abs();
            }
        }
    }
    Parts {
        inner: parts.inner / all,
        rim: parts.rim / all,
        rim_signed: parts.rim_signed / all,
    }
}

/// The truth, pictures and signed errors for each number of planes.
fn sheet(
    name: &str,
    base: &ResolvedScene,
    truth: &Truth,
    images: Vec<LinearImage>,
    costs: &[(f64, SpreadMs)],
) -> Result<Vec<u8>, Box<dyn Error>> {
    let point = |(&planes, &(relative_l1, ms)): (&u32, &(f64, SpreadMs))| Point {
        dials: BTreeMap::from([("planes".to_owned(), json!(planes))]),
        error: ErrorFigures {
            relative_l1,
            ..ErrorFigures::default()
        },
        cost: CostFigures {
            runs: 1,
            wall_ms: ms,
            gpu_ms: ms,
            ..CostFigures::default()
        },
        ..Point::default()
    };
    let study = Study {
        scene: name.to_owned(),
        truth: TruthFigures {
            relative_error: truth.relative_error,
            ..TruthFigures::default()
        },
        sweeps: vec![Sweep {
            dial: "planes".to_owned(),
            points: PLANES.iter().zip(costs).map(point).collect(),
            ..Sweep::default()
        }],
        ..Study::default()
    };
    let images = StudyImages {
        truth: LinearImage {
            width: truth.width,
            height: truth.height,
            rgb: truth.irradiance.clone(),
        },
        white_w_m2: std::f64::consts::PI * caustica::methods::facts(base)?.lights.white_radiance,
        points: vec![images],
    };
    Ok(error_images(&study, &images, 0)?)
}
