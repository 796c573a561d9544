//! The figures of a scene that decide what has to be done, computed once, without a GPU.
//!
//! Everything is in *local* coordinates: the origin lies on the water at rest, in the middle of what is looked at, so that
//! f32 is as good far from the world's origin as near it.

mod detail;
mod lamp_window;
pub mod placement;
pub mod source;
mod stopped;
pub mod unfollowed;
pub mod warnings;
pub mod window;

use glam::{DVec2, DVec3};

use self::placement::{LevelBox, ObjectFacts};
use self::source::{AirLight, Grid, Source};
use self::window::{Rect, Region};
use crate::physics::{fresnel, sky};
use crate::scene::ranges::DEFAULT_MAP_SIDE;
use crate::scene::{
    Camera, Issue, LayerName, Light, Output, Quality, Receiver, ResolvedScene, Scene, SceneError,
};
use crate::stats::Warning;
use crate::waves::Surface;

/// Most suns and point lights that the camera's pass has room for.
pub const MOST_LIGHTS: usize = 64;

/// A sun or point light that lights something under water.
#[derive(Clone, Debug)]
pub struct LightFacts {
    /// Index into the scene's `lights`.
    pub index: u32,
    /// Where its light comes from.
    pub source: Source,
    /// Of a sun the irradiance of a plane facing it, W/m²; of a point light its radiant intensity, W/sr.
    pub power: [f64; 3],
    /// The piece of water whose light can reach the receivers, local (x, z); of a light under water its directions, as octahedral
    /// places.
    pub window: Rect,
    /// How the grid of rays lies in the window.
    pub grid: Grid,
    /// The piece of water whose light can reach an object under water; `None` where there is none.
    pub objects_window: Option<Rect>,
    /// Level map of each wet object, in the order of `SceneFacts::objects`; `None` for dry ones.
    pub boxes: Vec<Option<LevelBox>>,
}

impl LightFacts {
    /// Whether the light is under water, so that its rays pass no surface.
    pub fn is_submerged(&self) -> bool {
        matches!(self.source, Source::Submerged { .. })
    }

    /// Side of a square of water in which all of `cells` × `cells` cells are as large as the largest one is, m; 0 of a light under
    /// water, whose rays pass no surface.
    pub fn span_m(&self, cells: u32) -> f64 {
        match self.source {
            Source::Submerged { .. } => 0.0,
            _ => self.grid.widest_cell_m(cells) * f64::from(cells),
        }
    }
}

/// The floor.
#[derive(Clone, Debug)]
pub struct FloorFacts {
    /// Height, m (negative).
    pub y_m: f64,
    /// Its rectangle.
    pub rect: Rect,
    /// Diffuse reflectance.
    pub albedo: [f64; 3],
}

/// An irradiance map on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorMap {
    /// What it covers.
    pub rect: Rect,
    /// Texels along x.
    pub width: u32,
    /// Texels along z.
    pub height: u32,
}

/// The camera.
#[derive(Clone, Copy, Debug)]
pub struct CameraFacts {
    /// Eye (or the middle of the image plane).
    pub eye: DVec3,
    /// Unit viewing direction.
    pub forward: DVec3,
    /// To the right edge of the picture, at unit distance (orthographic: m).
    pub right: DVec3,
    /// To the upper edge of the picture.
    pub up: DVec3,
    /// Parallel rays.
    pub orthographic: bool,
    /// Picture width, pixels.
    pub width: u32,
    /// Picture height, pixels.
    pub height: u32,
}

/// How much of a frame is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All that the output asks for.
    Frame,
    /// Nothing but the light's own estimate of its error.
    Estimate,
    /// Nothing but the level maps, for frames to come.
    LevelMaps,
}

/// What a scene boils down to.
#[derive(Clone, Debug)]
pub struct SceneFacts {
    /// World position of the local origin, m.
    pub origin_m: DVec3,
    /// The waves around the local origin.
    pub surface: Surface,
    /// Index of refraction.
    pub ior: f64,
    /// Absorption a, 1/m.
    pub absorption_per_m: [f64; 3],
    /// Extinction c = a + b, 1/m.
    pub extinction_per_m: [f64; 3],
    /// Suns and point lights that light a receiver under water.
    pub lights: Vec<LightFacts>,
    /// All suns above the horizon and point lights above the water.
    pub air_lights: Vec<AirLight>,
    /// Sum of the skies, W/(m² sr).
    pub sky_radiance: [f64; 3],
    /// Share of sky light that flat water lets through; 1 without a sky.
    pub sky_transmittance: f64,
    /// Mean path of sky light per depth; 1 without a sky.
    pub sky_path_factor: f64,
    /// The floor.
    pub floor: Option<FloorFacts>,
    /// Where the floor's irradiance is wanted.
    pub floor_map: Option<FloorMap>,
    /// The objects.
    pub objects: Vec<ObjectFacts>,
    /// Bytes of hierarchies (32 a node) and triangles (64 each) of the distinct meshes.
    pub geometry_bytes: u64,
    /// The camera of a view.
    pub camera: Option<CameraFacts>,
    /// Layers of a view; of an irradiance map only [`LayerName::Irradiance`].
    pub layers: Vec<LayerName>,
    /// The receiver of an irradiance map.
    pub map_receiver: Option<Receiver>,
    /// Layers that the scene asks for; `quality.layers` is 1 where the output has no use for more.
    pub asked_layers: u32,
    /// Its layer, 0 the nearest along the light; of a view and on the floor 0.
    pub map_layer: u32,
    /// How much of the frame is wanted.
    pub wanted: Wanted,
    /// Sky irradiance to be added to an irradiance map on the floor, W/m².
    pub map_sky_w_m2: [f64; 3],
    /// The dials.
    pub quality: Quality,
    /// Radiance of a white dry surface, W/(m² sr): horizontal under suns and skies, and under each point light facing it in the
    /// middle of what is looked at, at the height of the floor (or of the water where there is none), 0.1 m away at least.
    pub white_radiance: f64,
    /// What is not simulated.
    pub warnings: Vec<Warning>,
}

impl SceneFacts {
    /// The facts of a validated scene; of its warnings only those about lights that are left out.
    pub fn of(resolved: &ResolvedScene) -> Result<Self, SceneError> {
        let scene = &resolved.scene;
        let origin_m = origin(resolved);
        let surface = Surface::of(scene).recentred(DVec2::new(origin_m.x, origin_m.z));
        let water = &scene.water;
        let extinction_per_m =
            std::array::from_fn(|c| water.absorption_per_m[c] + water.scattering_per_m[c]);
        let air_lights = air_lights(&scene.lights, origin_m, &surface)?;
        let sky_radiance = sky_sum(&scene.lights);
        // Integrals that take as long as planning a small frame.
        let (sky_transmittance, sky_path_factor) = if sky_radiance == [0.0; 3] {
            (1.0, 1.0)
        } else {
            (
                fresnel::diffuse_transmittance(water.ior),
                sky::sky_path_factor(water.ior),
            )
        };
        let floor = scene.floor.as_ref().map(|f| {
            let centre = DVec2::from(f.center_m) - DVec2::new(origin_m.x, origin_m.z);
            let half = DVec2::from(f.size_m) * 0.5;
            FloorFacts {
                y_m: -f.depth_m,
                rect: Rect {
                    min: centre - half,
                    max: centre + half,
                },
                albedo: f.albedo,
            }
        });
        let mut facts = Self {
            origin_m,
            ior: water.ior,
            absorption_per_m: water.absorption_per_m,
            extinction_per_m,
            lights: Vec::new(),
            white_radiance: white_radiance(scene, origin_m, &surface, sky_radiance),
            air_lights,
            sky_radiance,
            sky_transmittance,
            sky_path_factor,
            floor,
            floor_map: None,
            objects: resolved.placed_objects(origin_m, surface.max_height_m()),
            geometry_bytes: geometry_bytes(resolved),
            camera: None,
            layers: vec![LayerName::Irradiance],
            map_receiver: None,
            asked_layers: scene.quality.layers,
            map_layer: 0,
            wanted: Wanted::Frame,
            map_sky_w_m2: [0.0; 3],
            quality: scene.quality.clone(),
            warnings: Vec::new(),
            surface,
        };
        facts.want_output(&scene.output, scene.camera.as_ref());
        facts.size_maps();
        facts.find_lights(resolved)?;
        Ok(facts)
    }

    /// The same with all that the scene tells is left out: for a plan or a frame. That looks for shadows with rays through the meshes,
    /// which nothing but the warnings needs.
    pub fn with_warnings(resolved: &ResolvedScene) -> Result<Self, SceneError> {
        let mut facts = Self::of(resolved)?;
        let found = warnings::warnings(&facts, resolved);
        facts.warnings.extend(found);
        Ok(facts)
    }

    /// 1 when all colour channels fade alike on their way, else 3.
    pub fn channels(&self) -> u32 {
        let c = self.extinction_per_m;
        if c[0] == c[1] && c[1] == c[2] { 1 } else { 3 }
    }

    /// Whether any light is lost on its way through the water.
    pub fn attenuates(&self) -> bool {
        self.extinction_per_m.iter().any(|&c| c > 0.0)
    }

    /// Whether a view of this layer is asked for.
    pub fn wants(&self, layer: LayerName) -> bool {
        self.camera.is_some() && self.layers.contains(&layer)
    }

    /// Whether the irradiance seen by the camera is needed.
    pub fn wants_camera_irradiance(&self) -> bool {
        self.wants(LayerName::Radiance) || self.wants(LayerName::Irradiance)
    }

    /// Indices of objects that can be struck by light under water.
    pub fn wet_objects(&self) -> impl Iterator<Item = usize> + '_ {
        self.objects
            .iter()
            .enumerate()
            .filter(|(_, o)| o.wet)
            .map(|(i, _)| i)
    }

    /// Whether anything under water waits for light.
    pub fn has_receiver(&self) -> bool {
        match self.map_receiver {
            Some(Receiver::Floor(_)) => self.floor_map.is_some(),
            Some(Receiver::Object(index)) => {
                self.objects.get(index as usize).is_some_and(|o| o.wet)
            }
            None => {
                self.wants_camera_irradiance()
                    && (self.floor_map.is_some() || self.wet_objects().next().is_some())
            }
        }
    }

    fn want_output(&mut self, output: &Output, camera: Option<&Camera>) {
        match output {
            Output::View(view) => {
                self.layers.clone_from(&view.layers);
                self.camera =
                    camera.map(|c| camera_facts(c, self.origin_m, view.width, view.height));
                let region = match &self.camera {
                    Some(camera) if self.wants_camera_irradiance() => {
                        window::visible_floor(self, camera)
                    }
                    _ => Region::Nothing,
                };
                if let Region::Rect(rect) = region {
                    let size = rect.size();
                    let texel = size.max_element() / f64::from(self.quality.map_texels);
                    let count = |length: f64| {
                        ((length / texel).ceil() as u32).clamp(1, self.quality.map_texels)
                    };
                    self.floor_map = Some(FloorMap {
                        rect,
                        width: count(size.x),
                        height: count(size.y),
                    });
                }
            }
            Output::IrradianceMap(map) => {
                self.map_receiver = Some(map.receiver);
                self.map_layer = map.layer;
                if matches!(map.receiver, Receiver::Floor(_)) {
                    self.quality.layers = 1;
                }
                let Some(floor) = &self.floor else { return };
                if matches!(map.receiver, Receiver::Object(_)) {
                    return;
                }
                let to_local =
                    |p: [f64; 2]| DVec2::from(p) - DVec2::new(self.origin_m.x, self.origin_m.z);
                self.floor_map = Some(FloorMap {
                    rect: Rect {
                        min: map.min_m.map_or(floor.rect.min, to_local),
                        max: map.max_m.map_or(floor.rect.max, to_local),
                    },
                    width: map.width.unwrap_or(DEFAULT_MAP_SIDE),
                    height: map.height.unwrap_or(DEFAULT_MAP_SIDE),
                });
                if map.include_sky {
                    self.map_sky_w_m2 = std::array::from_fn(|c| {
                        sky::sky_irradiance(
                            self.sky_radiance[c],
                            self.sky_transmittance,
                            self.extinction_per_m[c],
                            -floor.y_m,
                            self.sky_path_factor,
                            1.0,
                            1.0 / (self.ior * self.ior),
                        )
                    });
                }
            }
        }
    }

    fn find_lights(&mut self, resolved: &ResolvedScene) -> Result<(), SceneError> {
        if !self.has_receiver() {
            return Ok(());
        }
        let only = match &resolved.scene.output {
            Output::IrradianceMap(map) => map.light,
            Output::View(_) => None,
        };
        for (index, light) in resolved.scene.lights.iter().enumerate() {
            let light_index = u32::try_from(index).unwrap_or(u32::MAX);
            let Some((source, power)) = Source::of(light, self.origin_m, &self.surface) else {
                continue;
            };
            if only.is_some_and(|wanted| wanted != light_index) || power.iter().all(|&e| e == 0.0) {
                continue;
            }
            if let (Some(position_m), Some(floor)) = (source.position_m(), &self.floor)
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
            let layers = self.quality.layers;
            let boxes: Vec<Option<LevelBox>> = self
                .objects
                .iter()
                .zip(&resolved.meshes)
                .map(|(object, mesh)| {
                    let flat = object
                        .wet
                        .then(|| source.direction_at(object.wet_middle(), self.ior))?;
                    Some(LevelBox::new(object, mesh, flat?, layers))
                })
                .collect();
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
                    format!("/lights/{index}"),
                    "no refracted light of it was found on its way to the receivers; what falls less than a metre in a kilometre under water is not followed",
                    "a light whose rays fall more steeply under water",
                )],
            })?;
            self.lights.push(LightFacts {
                index: light_index,
                source,
                power,
                grid: Grid::over(window, &source),
                window,
                objects_window: window::objects_window(self, &source),
                boxes,
            });
        }
        Ok(())
    }
}

/// The local origin: the middle of what is lit, on the water at rest.
fn origin(resolved: &ResolvedScene) -> DVec3 {
    let scene = &resolved.scene;
    let xz = match (&scene.output, &scene.floor) {
        (Output::IrradianceMap(map), Some(floor)) if matches!(map.receiver, Receiver::Floor(_)) => {
            let centre = DVec2::from(floor.center_m);
            let half = DVec2::from(floor.size_m) * 0.5;
            let low = map.min_m.map_or(centre - half, DVec2::from);
            let high = map.max_m.map_or(centre + half, DVec2::from);
            (low + high) * 0.5
        }
        (Output::IrradianceMap(map), _) => match map.receiver {
            Receiver::Object(index) => scene.objects.get(index as usize).map_or(DVec2::ZERO, |o| {
                DVec2::new(o.translation_m[0], o.translation_m[2])
            }),
            Receiver::Floor(_) => DVec2::ZERO,
        },
        (Output::View(_), _) => scene.camera.as_ref().map_or(DVec2::ZERO, |camera| {
            let (_, target, _) = camera.pose();
            DVec2::new(target[0], target[2])
        }),
    };
    DVec3::new(xz.x, scene.water.level_m, xz.y)
}

fn geometry_bytes(resolved: &ResolvedScene) -> u64 {
    let distinct: std::collections::BTreeMap<&str, u64> = resolved
        .meshes
        .iter()
        .map(|m| {
            (
                m.id.as_str(),
                32 * m.hierarchy.len() as u64 + 64 * m.triangles.len() as u64,
            )
        })
        .collect();
    distinct.values().sum()
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

fn sky_sum(lights: &[Light]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for light in lights {
        if let Light::Sky(sky) = light {
            for (s, l) in sum.iter_mut().zip(sky.radiance_w_m2_sr) {
                *s += l;
            }
        }
    }
    sum
}

fn white_radiance(
    scene: &Scene,
    origin_m: DVec3,
    surface: &Surface,
    sky_radiance: [f64; 3],
) -> f64 {
    let mean = |rgb: [f64; 3]| rgb.iter().sum::<f64>() / 3.0;
    let floor_y_m = scene.floor.as_ref().map(|floor| -floor.depth_m);
    let lit: f64 = scene
        .lights
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

fn camera_facts(camera: &Camera, origin_m: DVec3, width: u32, height: u32) -> CameraFacts {
    let (eye, target, up) = camera.pose();
    let forward = (DVec3::from(target) - DVec3::from(eye)).normalize();
    let right = forward.cross(DVec3::from(up)).normalize();
    let half_height = match camera {
        Camera::Perspective(c) => (0.5 * c.vertical_fov_deg.to_radians()).tan(),
        Camera::Orthographic(c) => 0.5 * c.height_m,
    };
    let aspect = f64::from(width) / f64::from(height);
    CameraFacts {
        eye: DVec3::from(eye) - origin_m,
        forward,
        right: right * (half_height * aspect),
        up: right.cross(forward) * half_height,
        orthographic: matches!(camera, Camera::Orthographic(_)),
        width,
        height,
    }
}
