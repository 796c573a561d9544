//! The figures of a scene that decide what has to be done, computed once, without a GPU.
//!
//! Everything is in *local* coordinates: the origin lies on the water at rest, in the middle of what is looked at, so that
//! f32 is as good far from the world's origin as near it.

use glam::{DVec2, DVec3};

use super::placement::{LevelBox, ObjectFacts};
use super::ranges::DEFAULT_MAP_SIDE;
use super::window::{self, Rect, Region};
use super::{
    Camera, Issue, LayerName, Light, Output, Quality, Receiver, ResolvedScene, SceneError,
};
use crate::physics::{fresnel, refraction, sky};
use crate::stats::Warning;
use crate::waves::WaterSurface;

/// Cells along the shortest wave below which caustics are washed out.
const CELLS_PER_WAVE: f64 = 8.0;

/// A sun that lights something under water.
#[derive(Clone, Debug)]
pub struct SunFacts {
    /// Index into `lights`.
    pub light: u32,
    /// Unit direction to the sun.
    pub to_light: DVec3,
    /// Irradiance on a plane facing it, W/m².
    pub irradiance_w_m2: [f64; 3],
    /// The piece of water whose light can reach the receivers.
    pub window: Rect,
    /// Level map of each wet object, in the order of `SceneFacts::objects`; `None` for dry ones.
    pub boxes: Vec<Option<LevelBox>>,
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

/// What a scene boils down to.
#[derive(Clone, Debug)]
pub struct SceneFacts {
    /// World position of the local origin, m.
    pub origin_m: DVec3,
    /// The waves around the local origin.
    pub surface: WaterSurface,
    /// Index of refraction.
    pub ior: f64,
    /// Absorption a, 1/m.
    pub absorption_per_m: [f64; 3],
    /// Extinction c = a + b, 1/m.
    pub extinction_per_m: [f64; 3],
    /// Suns that light a receiver under water.
    pub suns: Vec<SunFacts>,
    /// All suns above the horizon: unit direction and irradiance, W/m².
    pub air_suns: Vec<(DVec3, [f64; 3])>,
    /// Sum of the skies, W/(m² sr).
    pub sky_radiance: [f64; 3],
    /// Share of sky light that flat water lets through.
    pub sky_transmittance: f64,
    /// Mean path of sky light per depth.
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
    /// Whether nothing but the light's own estimate of its error is wanted.
    pub only_estimate: bool,
    /// Sky irradiance to be added to an irradiance map on the floor, W/m².
    pub map_sky_w_m2: [f64; 3],
    /// The dials.
    pub quality: Quality,
    /// Radiance of a white dry horizontal surface under all lights, W/(m² sr).
    pub white_radiance: f64,
    /// What is not simulated.
    pub warnings: Vec<Warning>,
}

impl SceneFacts {
    /// The facts of a validated scene.
    pub fn of(resolved: &ResolvedScene) -> Result<Self, SceneError> {
        let scene = &resolved.scene;
        let origin_m = origin(resolved);
        let surface = WaterSurface::of(scene).recentred(DVec2::new(origin_m.x, origin_m.z));
        let water = &scene.water;
        let extinction_per_m =
            std::array::from_fn(|c| water.absorption_per_m[c] + water.scattering_per_m[c]);
        let air_suns = air_suns(&scene.lights);
        let sky_radiance = sky_sum(&scene.lights);
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
            suns: Vec::new(),
            white_radiance: white_radiance(&air_suns, sky_radiance),
            air_suns,
            sky_radiance,
            sky_transmittance: fresnel::diffuse_transmittance(water.ior),
            sky_path_factor: sky::sky_path_factor(water.ior),
            floor,
            floor_map: None,
            objects: resolved.placed_objects(origin_m, surface.max_height_m()),
            geometry_bytes: geometry_bytes(resolved),
            camera: None,
            layers: vec![LayerName::Irradiance],
            map_receiver: None,
            only_estimate: false,
            map_sky_w_m2: [0.0; 3],
            quality: scene.quality.clone(),
            warnings: Vec::new(),
            surface,
        };
        facts.want_output(&scene.output, scene.camera.as_ref());
        facts.find_suns(resolved)?;
        facts.collect_warnings(&water.scattering_per_m);
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

    fn find_suns(&mut self, resolved: &ResolvedScene) -> Result<(), SceneError> {
        if !self.has_receiver() {
            return Ok(());
        }
        let only = match &resolved.scene.output {
            Output::IrradianceMap(map) => map.light,
            Output::View(_) => None,
        };
        for (index, light) in resolved.scene.lights.iter().enumerate() {
            let light_index = u32::try_from(index).unwrap_or(u32::MAX);
            let Light::Sun(sun) = light else { continue };
            if only.is_some_and(|wanted| wanted != light_index) || sun.elevation_deg <= 0.0 {
                continue;
            }
            if sun.irradiance_w_m2.iter().all(|&e| e == 0.0) {
                continue;
            }
            let to_light = refraction::direction_to_light(
                sun.elevation_deg.to_radians(),
                sun.azimuth_deg.to_radians(),
            );
            let Some(flat) = refraction::refract_direction(-to_light, DVec3::Y, self.ior) else {
                continue;
            };
            let layers = self.quality.layers;
            let boxes: Vec<Option<LevelBox>> = self
                .objects
                .iter()
                .zip(&resolved.meshes)
                .map(|(object, mesh)| {
                    object
                        .wet
                        .then(|| LevelBox::new(object, mesh, flat, layers))
                })
                .collect();
            let window = window::light_window(self, to_light).ok_or_else(|| SceneError {
                issues: vec![Issue::invalid(
                    format!("/lights/{index}"),
                    "the refracted light cannot be followed to the receivers",
                    "a sun whose light goes down into the water",
                )],
            })?;
            self.suns.push(SunFacts {
                light: light_index,
                to_light,
                irradiance_w_m2: sun.irradiance_w_m2,
                window,
                boxes,
            });
        }
        Ok(())
    }

    /// Says where a cell of the water is too large for the shortest wave.
    fn warn_of_coarse_cells(&mut self) {
        let waves = self
            .surface
            .components
            .iter()
            .filter(|c| c.amplitude_m > 0.0);
        let shortest_m = waves
            .map(|c| 1.0 / c.frequency_per_m.length())
            .fold(f64::INFINITY, f64::min);
        let widest_m = self
            .suns
            .iter()
            .map(|sun| sun.window.size().max_element())
            .fold(0.0, f64::max);
        let needed = (widest_m * CELLS_PER_WAVE / shortest_m).ceil();
        if needed > f64::from(self.quality.water_cells) {
            let mut warning = Warning::new(
                "waves_undersampled",
                format!(
                    "a water cell of {:.3} m is coarse for the shortest wave of {shortest_m:.3} m; {needed:.0} cells would do",
                    widest_m / f64::from(self.quality.water_cells)
                ),
            );
            warning.pointer = Some("/quality/water_cells".to_owned());
            self.warnings.push(warning);
        }
    }

    /// Says what placement by planes leaves out.
    fn warn_of_planes(&mut self) {
        let wet = self.wet_objects().count();
        if !self.quality.has_planes() || self.suns.is_empty() {
            return;
        }
        if wet > 1 {
            let mut warning = Warning::new(
                "planes_ignore_other_objects",
                "planes know nothing of other objects: what one object stops lights the others all the same",
            );
            warning.pointer = Some("/quality/placement".to_owned());
            self.warnings.push(warning);
        }
        if wet > 0 && self.quality.layers > 1 {
            let mut warning = Warning::new(
                "planes_light_the_first_layer",
                "planes light what the light direction sees first; further layers stay dark",
            );
            warning.pointer = Some("/quality/layers".to_owned());
            self.warnings.push(warning);
        }
    }

    fn collect_warnings(&mut self, scattering_per_m: &[f64; 3]) {
        if scattering_per_m.iter().any(|&b| b > 0.0) {
            let mut warning = Warning::new(
                "scattering_not_followed",
                "light scattered out of the beams is counted as lost; light scattered into the picture is not simulated",
            );
            warning.pointer = Some("/water/scattering_per_m".to_owned());
            self.warnings.push(warning);
        }
        for (index, object) in self.objects.iter().enumerate() {
            if object.wet && object.max.y > self.surface.max_height_m() {
                let mut warning = Warning::new(
                    "object_cuts_surface",
                    "the object reaches through the water; the shadow of its dry part on the water is not simulated",
                );
                warning.pointer = Some(format!("/objects/{index}"));
                self.warnings.push(warning);
            } else if !object.wet && self.has_receiver() && !self.suns.is_empty() {
                let mut warning = Warning::new(
                    "dry_object_casts_no_shadow",
                    "the object is above the water; its shadow on the water is not simulated",
                );
                warning.pointer = Some(format!("/objects/{index}"));
                self.warnings.push(warning);
            }
        }
        self.warn_of_planes();
        self.warn_of_coarse_cells();
        for sun in &self.suns {
            let steepest = self
                .surface
                .max_slope_along(DVec2::new(sun.to_light.x, sun.to_light.z).normalize_or_zero());
            if steepest * DVec2::new(sun.to_light.x, sun.to_light.z).length() > sun.to_light.y {
                let mut warning = Warning::new(
                    "waves_shade_waves",
                    "some wave slopes look away from the sun; the shadows of waves on waves are not simulated",
                );
                warning.pointer = Some(format!("/lights/{}", sun.light));
                self.warnings.push(warning);
            }
        }
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

fn air_suns(lights: &[Light]) -> Vec<(DVec3, [f64; 3])> {
    lights
        .iter()
        .filter_map(|light| match light {
            Light::Sun(sun) if sun.elevation_deg > 0.0 => Some((
                refraction::direction_to_light(
                    sun.elevation_deg.to_radians(),
                    sun.azimuth_deg.to_radians(),
                ),
                sun.irradiance_w_m2,
            )),
            _ => None,
        })
        .collect()
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

fn white_radiance(suns: &[(DVec3, [f64; 3])], sky_radiance: [f64; 3]) -> f64 {
    let mean = |rgb: [f64; 3]| rgb.iter().sum::<f64>() / 3.0;
    let sun: f64 = suns.iter().map(|(to_light, e)| to_light.y * mean(*e)).sum();
    sun / std::f64::consts::PI + mean(sky_radiance)
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
