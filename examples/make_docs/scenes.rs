//! The scenes of the page.

use std::error::Error;

use caustica::cli::scene_file;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::config::Limits;
use caustica::lab::study::dial::{Dial, DialError};
use caustica::scene::ResolvedScene;

/// A scene and the required accuracy of its truth.
#[derive(Debug)]
pub(crate) struct Scene {
    /// File name without `.json`.
    pub name: &'static str,
    /// What is difficult about it.
    pub about: &'static str,
    /// Relative L1 error of the truth.
    pub truth_error: f64,
    /// Sweeps that replace the scene's default ones.
    pub dials: Option<&'static [&'static str]>,
}

impl Scene {
    /// What is swept.
    pub(crate) fn dials(&self, resolved: &ResolvedScene) -> Result<Vec<Dial>, DialError> {
        match self.dials {
            Some(texts) => texts.iter().map(|text| Dial::parse(text)).collect(),
            None => Ok(Dial::for_scene(resolved)),
        }
    }
}

/// In the order of the page.
pub(crate) const ALL: [Scene; 7] = [
    Scene {
        name: "flat",
        about: "Flat water with absorption: every beam has the same footprint, and the result is one number.",
        truth_error: 1e-5,
        dials: None,
    },
    Scene {
        name: "sine_pool",
        about: "Three sines over a floor below the first focus: the scene that the design is measured by.",
        truth_error: 5e-4,
        dials: None,
    },
    Scene {
        name: "steep_pool",
        about: "Four steeper sines over a floor at 4 m depth: the light has folded over itself several times.",
        truth_error: 8e-4,
        dials: None,
    },
    Scene {
        name: "low_sun",
        about: "A sun 12° above the horizon: long paths through the water, and very long, thin footprints.",
        truth_error: 8e-4,
        dials: None,
    },
    Scene {
        name: "teapot_floor",
        about: "The floor under a teapot: caustics with a shadow in them.",
        truth_error: 8e-4,
        dials: None,
    },
    Scene {
        name: "reef",
        about: "Twenty-five meshes over a floor: many small shadows.",
        truth_error: 8e-4,
        dials: Some(&[
            "water_cells=64..1024",
            "split_levels=0..5",
            "level_map_texels=64..256",
        ]),
    },
    Scene {
        name: "teapot_pool",
        about: "A camera view of the pool with the teapot, compared pixel by pixel, meshes included.",
        truth_error: 3e-3,
        // Frames of seconds: fewer of them.
        dials: Some(&[
            "water_cells=128..1024",
            "split_levels=0,2,4",
            "map_texels=256..2048",
        ]),
    },
];

/// A scene with its meshes.
pub(crate) fn load(name: &str) -> Result<ResolvedScene, Box<dyn Error>> {
    let args = SceneArgs {
        scene: format!("scenes/{name}.json").into(),
        overrides: SceneOverrides::default(),
    };
    Ok(scene_file::load(&args, None, &Limits::default())?.resolved)
}
