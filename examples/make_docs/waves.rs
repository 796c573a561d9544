//! Writes `docs/waves.md`: heights, slopes and caustics of each kind of water, side by side, and what each costs.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use caustica::config::RenderConfig;
use caustica::kept::Kept;
use caustica::reference::{ReferenceSettings, irradiance_map};
use caustica::render::Renderer;
use caustica::scene::{LayerName, ResolvedScene, Scene};
use caustica::waves::Surface;
use image::RgbImage;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::scenes;

/// What the page is called on the command line.
pub(crate) const NAME: &str = "waves";

/// Pixels along a side of a panel, and texels of its map.
const SIDE: u32 = 256;
/// Half the side of a panel, m.
const HALF_M: f64 = 1.5;
/// Moments of which the median time is given.
const MOMENTS: usize = 9;

/// A kind of water on the page.
struct Kind {
    /// Heading and file name.
    name: &'static str,
    /// What it is good for.
    about: &'static str,
    /// Its waves.
    waves: fn() -> Result<Water, Box<dyn Error>>,
}

/// Waves, and the scene from which they come if they need files.
enum Water {
    Json(Value),
    Scene(Box<ResolvedScene>),
}

const KINDS: &[Kind] = &[
    Kind {
        name: "sine",
        about: "Sums of sines: the plainest water, and that of the closed forms. Three of them here.",
        waves: || {
            Ok(Water::Json(json!([
                { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.3, "direction_deg": 20, "phase_deg": 23 },
                { "kind": "sine", "amplitude_m": 0.012, "wavelength_m": 0.8, "direction_deg": 100, "phase_deg": 97 },
                { "kind": "sine", "amplitude_m": 0.006, "wavelength_m": 0.5, "direction_deg": -35, "phase_deg": 166 }
            ])))
        },
    },
    Kind {
        name: "gerstner",
        about: "Trochoids: sharp crests and flat troughs, as swell and boat waves have them.",
        waves: || {
            Ok(Water::Json(json!([
                { "kind": "gerstner", "amplitude_m": 0.06, "wavelength_m": 1.1, "direction_deg": 15, "steepness": 0.7 },
                { "kind": "gerstner", "amplitude_m": 0.012, "wavelength_m": 0.5, "direction_deg": 70, "phase_deg": 40, "steepness": 0.5 }
            ])))
        },
    },
    Kind {
        name: "spectrum: phillips",
        about: "The Phillips spectrum, by a fast Fourier transform (Iwasaki, Dobashi and Nishita 2002): a quick choppy surface without a length of its own below the peak.",
        waves: || {
            Ok(Water::Json(sea(
                &json!({ "model": "phillips", "wind_speed_m_s": 4 }),
            )))
        },
    },
    Kind {
        name: "spectrum: jonswap",
        about: "JONSWAP: the sea under a wind that has blown over a given distance.",
        waves: || Ok(Water::Json(sea(&json!({ "model": "jonswap" })))),
    },
    Kind {
        name: "spectrum: elfouhaily",
        about: "Elfouhaily: measured short waves, down to capillaries. They make the finest caustics.",
        waves: || {
            Ok(Water::Json(sea(
                &json!({ "model": "elfouhaily", "wind_speed_m_s": 3 }),
            )))
        },
    },
    Kind {
        name: "spectrum: choppy",
        about: "The JONSWAP sea with a choppiness of 1: surface points move to the sides too, and crests become sharp.",
        waves: || {
            Ok(Water::Json(sea(
                &json!({ "model": "jonswap", "choppiness": 1.0 }),
            )))
        },
    },
    Kind {
        name: "ripples",
        about: "Drops in a basin, whose walls reflect the rings.",
        waves: || {
            Ok(Water::Json(json!([{
                "kind": "ripples", "min_m": [-1.5, -1.5], "max_m": [1.5, 1.5], "samples": 256,
                "drops": [
                    { "position_m": [-0.5, 0.3], "radius_m": 0.08, "height_m": 0.04, "at_s": -0.7 },
                    { "position_m": [0.7, -0.6], "radius_m": 0.08, "height_m": 0.04, "at_s": -0.4 }
                ]
            }])))
        },
    },
    Kind {
        name: "ripples: absorbing",
        about: "The same drops in open water: the walls absorb.",
        waves: || {
            Ok(Water::Json(json!([{
                "kind": "ripples", "min_m": [-1.5, -1.5], "max_m": [1.5, 1.5], "samples": 256, "walls": "absorbing",
                "drops": [
                    { "position_m": [-0.5, 0.3], "radius_m": 0.08, "height_m": 0.04, "at_s": -0.7 },
                    { "position_m": [0.7, -0.6], "radius_m": 0.08, "height_m": 0.04, "at_s": -0.4 }
                ]
            }])))
        },
    },
    Kind {
        name: "ripples: obstacle",
        about: "Shallow water with a post in it, which reflects the rings (`scenes/rain_pool_post.json`, 0.4 m deep). It moves in steps of time. In the map the post and its shadow are black.",
        waves: || Ok(Water::Scene(Box::new(scenes::load("rain_pool_post")?))),
    },
    Kind {
        name: "height_field",
        about: "Heights that a user computed elsewhere, read from a file (`scenes/own_water.json`, 1.5 m deep), and a light wind.",
        waves: || Ok(Water::Scene(Box::new(scenes::load("own_water")?))),
    },
];

/// A sea over a tile of 6 m, with other values for some fields.
fn sea(fields: &Value) -> Value {
    let mut waves = json!({
        "kind": "spectrum", "wind_speed_m_s": 5, "fetch_m": 20_000, "tile_m": 6, "samples": 512, "seed": 7,
        "wind_direction_deg": 25, "min_wavelength_m": 0.1
    });
    for (name, value) in fields.as_object().into_iter().flatten() {
        waves[name] = value.clone();
    }
    json!([waves])
}

/// The scene of a panel, `time_s` after the first. Scenes from files keep their water, floor depth and objects.
fn scene(water: &Water, time_s: f64) -> Result<ResolvedScene, Box<dyn Error>> {
    let mut value = match water {
        Water::Json(waves) => {
            json!({ "water": { "waves": waves }, "floor": { "depth_m": 2 }, "time_s": 0 })
        }
        Water::Scene(resolved) => serde_json::to_value(&resolved.scene)?,
    };
    let start_s = value["time_s"].as_f64().unwrap_or_default();
    value["time_s"] = json!(start_s + time_s);
    value["water"]["absorption_per_m"] = json!([0, 0, 0]);
    value["floor"]["size_m"] = json!([60, 60]);
    value["lights"] = json!([
        { "kind": "sun", "elevation_deg": 70, "azimuth_deg": 30, "irradiance_w_m2": [1, 1, 1] }
    ]);
    value["quality"] = json!({ "water_cells": 256 });
    value["output"] = json!({
        "kind": "irradiance_map", "receiver": "floor", "min_m": [-HALF_M, -HALF_M], "max_m": [HALF_M, HALF_M],
        "width": SIDE, "height": SIDE
    });
    if let Some(fields) = value.as_object_mut() {
        fields.remove("camera");
    }
    let scene = Scene::from_value(value)?;
    Ok(match water {
        Water::Json(_) => ResolvedScene::bare(scene),
        Water::Scene(resolved) => ResolvedScene {
            scene,
            ..resolved.as_ref().clone()
        },
    })
}

/// Figures of a kind.
struct Figures {
    surface_ms: f64,
    frame_ms: f64,
    error: f64,
}

/// Writes the page and its pictures.
pub(crate) fn write() -> Result<(), Box<dyn Error>> {
    let folder = Path::new("docs/waves");
    std::fs::create_dir_all(folder)?;
    let mut renderer = Renderer::new(&RenderConfig::default())?;
    let mut rows = String::new();
    let mut panels = String::new();
    for kind in KINDS {
        eprintln!("  {}", kind.name);
        let water = (kind.waves)()?;
        let file = kind.name.replace(": ", "_") + ".png";
        let (picture, figures, scales) = measure(&mut renderer, &water)?;
        picture.save(folder.join(&file))?;
        writeln!(
            rows,
            "| `{}` | {:.1} | {:.1} | {:.2} % |",
            kind.name,
            figures.surface_ms,
            figures.frame_ms,
            100.0 * figures.error
        )?;
        writeln!(
            panels,
            "## {}\n\n{}\n\n![Height, slope and caustics](waves/{file})\n\n{scales}\n",
            kind.name, kind.about
        )?;
    }
    let adapter = renderer.adapter().clone();
    let page = format!(
        "# Water\n\n\
         Each row of pictures shows a square of {:.0} m × {:.0} m: the height of the water (black −, white +), the magnitude of its slope \
         (white is the largest), and the irradiance of the floor, 2 m below unless said otherwise, under a sun of 70°, without absorption (white is three times the mean). Written by `make docs`.\n\n\
         Times are medians of {MOMENTS} moments on {} with {} CPU cores: `surface` is what one more moment of the water costs on the CPU, \
         `frame` the whole frame with a map of {SIDE} × {SIDE} texels and 256 × 256 water cells, `surface` included. The error is the \
         relative L1 error of this map against the float64 reference: seas have waves down to 10 cm here, \
         for which 256 cells are few; more cells make it smaller ([accuracy](accuracy.md)).\n\n\
         | waves | surface, ms | frame, ms | error |\n|---|--:|--:|--:|\n{rows}\n{panels}",
        2.0 * HALF_M,
        2.0 * HALF_M,
        adapter.name,
        std::thread::available_parallelism()?
    );
    std::fs::write("docs/waves.md", page.trim_end().to_owned() + "\n")?;
    eprintln!("docs/waves.md");
    Ok(())
}

/// The panels of a kind, its figures, and a sentence on the scales.
fn measure(
    renderer: &mut Renderer,
    water: &Water,
) -> Result<(RgbImage, Figures, String), Box<dyn Error>> {
    let never = CancellationToken::new();
    let first = scene(water, 0.0)?;
    let mut surface_ms = Vec::new();
    let mut frame_ms = Vec::new();
    // The first moment pays for what does not change with time, and is not counted.
    for moment in 0..=MOMENTS {
        let mut resolved = scene(water, moment as f64 / 25.0)?;
        resolved.kept = first.kept.clone();
        let started = Instant::now();
        let surface = Surface::of(&resolved)?;
        let took_ms = started.elapsed().as_secs_f64() * 1e3;
        std::hint::black_box(surface);
        let started = Instant::now();
        std::hint::black_box(renderer.render(&resolved, &never)?);
        if moment > 0 {
            surface_ms.push(took_ms);
            frame_ms.push(took_ms + started.elapsed().as_secs_f64() * 1e3);
        }
    }
    let frame = renderer.render(&first, &never)?;
    let layer = &frame.layers[&LayerName::Irradiance];
    let found: Vec<f64> = layer
        .data
        .chunks_exact(layer.channels)
        .map(|texel| f64::from(texel[0]))
        .collect();
    let settings = ReferenceSettings {
        target_error: Some(2e-3),
        max_rays: 200_000_000,
        ..ReferenceSettings::default()
    };
    let truth = irradiance_map(
        &ResolvedScene {
            kept: Kept::default(),
            ..first.clone()
        },
        &settings,
        &|_| {},
    )?;
    let apart: f64 = found
        .iter()
        .zip(&truth.irradiance)
        .map(|(a, b)| (a - b[0]).abs())
        .sum();
    let all: f64 = truth.irradiance.iter().map(|texel| texel[0]).sum();

    let surface = Surface::of(&first)?;
    let place = |pixel: u32| HALF_M * ((f64::from(pixel) + 0.5) * 2.0 / f64::from(SIDE) - 1.0);
    let points: Vec<_> = (0..SIDE * SIDE)
        .map(|index| surface.at(place(index % SIDE), place(index / SIDE)))
        .collect();
    let highest_m = points
        .iter()
        .fold(0.0, |most: f64, point| most.max(point.height_m.abs()));
    let steepest = points
        .iter()
        .fold(0.0, |most: f64, point| most.max(point.slope.length()));
    let mean_w_m2 = all / f64::from(SIDE * SIDE);
    let grey = |share: f64| image::Rgb([(255.0 * share.clamp(0.0, 1.0)).round() as u8; 3]);
    let mut picture = RgbImage::from_pixel(3 * SIDE + 8, SIDE, image::Rgb([255; 3]));
    for (index, (point, light)) in points.iter().zip(&found).enumerate() {
        let (x, y) = (index as u32 % SIDE, index as u32 / SIDE);
        let values = [
            0.5 + 0.5 * point.height_m / highest_m,
            point.slope.length() / steepest,
            (light / mean_w_m2 / 3.0).powf(1.0 / 2.2),
        ];
        for (panel, value) in values.into_iter().enumerate() {
            picture.put_pixel(panel as u32 * (SIDE + 4) + x, y, grey(value));
        }
    }
    let scales = format!(
        "Largest height {:.1} cm, largest slope {steepest:.2}.",
        100.0 * highest_m
    );
    let figures = Figures {
        surface_ms: median(surface_ms),
        frame_ms: median(frame_ms),
        error: apart / all,
    };
    Ok((picture, figures, scales))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
