//! The lights of a scene, and the beam sets that carry their light into the water.

use glam::DVec3;

use super::field::FieldKey;
use super::placement::LevelBox;
use super::source::{self, AirLight, Grid, Source};
use super::water::Band;
use super::window::Rect;
use super::{SceneFacts, lamp_window, window};
use crate::physics::{fresnel, sky};
use crate::scene::{Issue, Light, Output, ResolvedScene, Scene, SceneError};
use crate::stats::Warning;
use crate::waves::Surface;

/// Largest number of suns and point lights in the air: the size of the camera pass's array.
pub const MOST_LIGHTS: usize = 64;

/// The lights.
#[derive(Clone, Debug)]
pub struct LightsFacts {
    /// Suns and point lights that light a receiver under water.
    pub lit: Vec<LitLight>,
    /// The beam sets that are traced, light by light.
    pub beam_sets: Vec<BeamSet>,
    /// All suns above the horizon and point lights above the water.
    pub in_air: Vec<AirLight>,
    /// The sky.
    pub sky: SkyFacts,
    /// Radiance of a white dry surface, W/(m² sr), the reference for exposure. The surface is horizontal for suns and skies. For a point
    /// light it faces the light, in the middle of the output's region, at the height of the floor (of the water where there is no floor),
    /// at least 0.1 m away.
    pub white_radiance: f64,
}

/// A sun or point light that lights something under water.
#[derive(Clone, Debug)]
pub struct LitLight {
    /// Index into the scene's `lights`.
    pub index: u32,
    /// Level map of each wet object, in the order of the objects; `None` for dry ones. All beam sets of the light share them.
    pub boxes: Vec<Option<LevelBox>>,
}

/// A beam set: the beams that are traced together, for one direction sample of a light (a sun's disc may have several) in one band of
/// wavelengths. The beam sets of a light share its level maps and add into its irradiance maps.
#[derive(Clone, Debug)]
pub struct BeamSet {
    /// Its light: index into [`LightsFacts::lit`].
    pub light: usize,
    /// Index of that light in the scene's `lights`.
    pub light_index: u32,
    /// Where its light comes from.
    pub source: Source,
    /// Optics of the water for its wavelengths.
    pub band: Band,
    /// Its share of the light's power. For a sun the irradiance of a plane facing it, W/m²; for a point light its radiant intensity, W/sr.
    pub power: [f64; 3],
    /// The rectangle of water whose light can reach the receivers, local (x, z). For a light under water its directions, as octahedral
    /// coordinates.
    pub window: Rect,
    /// The grid of rays in the window.
    pub grid: Grid,
    /// The rectangle of water whose light can reach an object under water; `None` where there is no such object.
    pub objects_window: Option<Rect>,
    /// Its kept field, for methods that make one.
    pub field: Option<FieldKey>,
}

impl BeamSet {
    /// Whether the light is under water, so that its rays cross no surface.
    pub fn is_submerged(&self) -> bool {
        matches!(self.source, Source::Submerged { .. })
    }

    /// `cells` times the longest side of any cell of a grid of `cells` × `cells`, m. 0 for a light under water, whose rays cross no
    /// surface.
    pub fn span_m(&self, cells: u32) -> f64 {
        match self.source {
            Source::Submerged { .. } => 0.0,
            _ => self.grid.widest_cell_m(cells) * f64::from(cells),
        }
    }
}

/// The sum of the scene's skies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyFacts {
    /// Radiance, W/(m² sr).
    pub radiance: [f64; 3],
    /// Transmittance of flat water for its light; 1 without a sky.
    pub transmittance: f64,
    /// Mean path length of its light per depth; 1 without a sky.
    pub path_factor: f64,
}

impl SkyFacts {
    fn of(lights: &[Light], ior: f64) -> Self {
        let mut radiance = [0.0; 3];
        for light in lights {
            if let Light::Sky(sky) = light {
                for (s, l) in radiance.iter_mut().zip(sky.radiance_w_m2_sr) {
                    *s += l;
                }
            }
        }
        // These integrals take as long as planning a small frame.
        let (transmittance, path_factor) = if radiance == [0.0; 3] {
            (1.0, 1.0)
        } else {
            (
                fresnel::diffuse_transmittance(ior),
                sky::sky_path_factor(ior),
            )
        };
        Self {
            radiance,
            transmittance,
            path_factor,
        }
    }

    /// Whether any sky shines.
    pub fn shines(&self) -> bool {
        self.radiance.iter().any(|&l| l != 0.0)
    }
}

impl LightsFacts {
    /// The lights in the air, and the sky. Which lights reach a receiver under water is found later, when the receivers are known
    /// ([`SceneFacts::find_lights`]). A map of the water has none of them.
    pub(super) fn of(
        scene: &Scene,
        origin_m: DVec3,
        surface: &Surface,
    ) -> Result<Self, SceneError> {
        let lights: &[Light] = if scene.output.is_water_map() {
            &[]
        } else {
            &scene.lights
        };
        let in_air = air_lights(lights, origin_m, surface)?;
        let sky = SkyFacts::of(lights, scene.water.ior);
        Ok(Self {
            lit: Vec::new(),
            beam_sets: Vec::new(),
            in_air,
            sky,
            white_radiance: white_radiance(scene, lights, origin_m, surface, sky.radiance),
        })
    }

    /// Boxes of the objects' level maps for a beam set's light, in the order of the objects.
    pub fn boxes_of(&self, set: &BeamSet) -> &[Option<LevelBox>] {
        &self.lit[set.light].boxes
    }

    /// Whether beam set number `index` is the first of its light.
    pub fn is_first_of_light(&self, index: usize) -> bool {
        index == 0 || self.beam_sets[index - 1].light != self.beam_sets[index].light
    }
}

impl SceneFacts {
    /// Finds the lights that can reach a receiver, and the window of water they shine through.
    pub(super) fn find_lights(&mut self, resolved: &ResolvedScene) -> Result<(), SceneError> {
        if !self.has_receiver() {
            return Ok(());
        }
        let only = match &resolved.scene.output {
            Output::IrradianceMap(map) => map.light,
            Output::View(_) | Output::WaterMap(_) => None,
        };
        for (index, light) in resolved.scene.lights.iter().enumerate() {
            let light_index = u32::try_from(index).unwrap_or(u32::MAX);
            let found = Source::of(light, self.origin_m, &self.water.surface);
            let Some((source, power)) = found else {
                continue;
            };
            if only.is_some_and(|wanted| wanted != light_index) || power.iter().all(|&e| e == 0.0) {
                continue;
            }
            if let (Some(position_m), Some(floor)) = (source.position_m(), &self.receivers.floor)
                && position_m.y <= floor.y_m
            {
                let mut warning = Warning::new(
                    "light_under_floor",
                    "the light is not above the floor and lights nothing",
                );
                warning.pointer = Some(format!("/lights/{index}"));
                warning.flux_w = Some(power.map(|i| 2.0 * std::f64::consts::TAU * i));
                self.warnings.push(warning);
                continue;
            }
            let boxes = self.level_boxes(resolved, &source);
            let band = self.water.band();
            let set = self.beam_set(light_index, source, power, band)?;
            self.lights.lit.push(LitLight {
                index: light_index,
                boxes,
            });
            self.lights.beam_sets.push(set);
        }
        Ok(())
    }

    /// The box of each wet object's level map for light from `source` through flat water.
    fn level_boxes(&self, resolved: &ResolvedScene, source: &Source) -> Vec<Option<LevelBox>> {
        let layers = self.quality.layers;
        let objects = self.receivers.objects.iter().zip(&resolved.meshes);
        objects
            .map(|(object, mesh)| {
                let flat = object
                    .wet
                    .then(|| source.direction_at(object.wet_middle(), self.water.ior))?;
                Some(LevelBox::new(object, mesh, flat?, layers))
            })
            .collect()
    }

    /// The beam set of the next lit light, from `source`, in one band.
    fn beam_set(
        &self,
        light_index: u32,
        source: Source,
        power: [f64; 3],
        band: Band,
    ) -> Result<BeamSet, SceneError> {
        let window = match source {
            Source::Sun { to_light } => window::light_window(self, to_light),
            Source::Point { position_m } => {
                lamp_window::water_window(self, position_m, &window::receivers(self))
            }
            Source::Submerged { position_m } => {
                lamp_window::direction_window(position_m, &window::receivers(self))
            }
        };
        let window = window.ok_or_else(|| SceneError {
            issues: vec![Issue::invalid(
                format!("/lights/{light_index}"),
                "none of its refracted rays reach the receivers; rays that fall less than a metre per kilometre under water are not traced",
                "a light whose rays fall more steeply under water",
            )],
        })?;
        Ok(BeamSet {
            light: self.lights.lit.len(),
            light_index,
            source,
            band,
            power: std::array::from_fn(|c| power[c] * band.rgb_weight[c]),
            grid: Grid::over(window, &source),
            window,
            objects_window: window::objects_window(self, &source),
            field: None,
        })
    }
}

fn air_lights(
    lights: &[Light],
    origin_m: DVec3,
    surface: &Surface,
) -> Result<Vec<AirLight>, SceneError> {
    let all: Vec<AirLight> = lights
        .iter()
        .filter_map(|light| Source::of(light, origin_m, surface))
        .filter(|(source, _)| !matches!(source, Source::Submerged { .. }))
        .map(|(source, power)| AirLight { source, power })
        .collect();
    if all.len() > MOST_LIGHTS {
        return Err(SceneError {
            issues: vec![Issue::invalid(
                "/lights".to_owned(),
                format!("{} suns and point lights shine in the air", all.len()),
                format!("at most {MOST_LIGHTS}"),
            )],
        });
    }
    Ok(all)
}

fn white_radiance(
    scene: &Scene,
    lights: &[Light],
    origin_m: DVec3,
    surface: &Surface,
    sky_radiance: [f64; 3],
) -> f64 {
    let mean = |rgb: [f64; 3]| rgb.iter().sum::<f64>() / 3.0;
    let floor_y_m = scene.floor.as_ref().map(|floor| -floor.depth_m);
    let lit: f64 = lights
        .iter()
        .filter_map(|light| Source::of(light, origin_m, surface))
        .map(|(source, power)| match source {
            Source::Sun { to_light } => to_light.y * mean(power),
            Source::Point { position_m } | Source::Submerged { position_m } => {
                source::facing_w_m2(position_m, floor_y_m, mean(power))
            }
        })
        .sum();
    lit / std::f64::consts::PI + mean(sky_radiance)
}
