//! The requested output: a camera's view, the irradiance of a receiver, or the water.

use glam::{DVec2, DVec3};

use super::SceneFacts;
use super::receivers::FloorMap;
use super::window::{self, Rect, Region};
use crate::physics::sky;
use crate::scene::projection::{Lens, Projection};
use crate::scene::ranges::DEFAULT_MAP_SIDE;
use crate::scene::{Camera, Floor, LayerName, Output, Receiver, Scene, WaterMapOutput};

/// The output of a scene.
#[derive(Clone, Debug)]
pub struct OutputFacts {
    /// The camera of a view.
    pub camera: Option<CameraFacts>,
    /// Layers of a view; for an irradiance map only [`LayerName::Irradiance`], for a map of the water only [`LayerName::Water`].
    pub layers: Vec<LayerName>,
    /// The receiver of an irradiance map.
    pub receiver: Option<Receiver>,
    /// The map of the water, if that is the output.
    pub water_map: Option<WaterMapFacts>,
    /// The layer of that receiver: 0 is the nearest along the light. 0 for a view and for the floor.
    pub receiver_layer: u32,
    /// Sky irradiance that is added to an irradiance map of the floor, W/m².
    pub sky_w_m2: [f64; 3],
    /// Layers of objects that the scene requests; `quality.layers` of the facts is 1 where the output uses no more.
    pub requested_layers: u32,
}

/// A map of the water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterMapFacts {
    /// The rectangle it covers.
    pub rect: Rect,
    /// Texels along x.
    pub width: u32,
    /// Texels along z.
    pub height: u32,
}

impl WaterMapFacts {
    /// The map around the local origin `origin_m`; `None` without corners, which a validated scene has.
    fn of(map: &WaterMapOutput, floor: Option<&Floor>, origin_m: DVec3) -> Option<Self> {
        let [width, height] = map.size();
        let [min, max] = map
            .corners_m(floor)?
            .map(|corner| DVec2::from(corner) - DVec2::new(origin_m.x, origin_m.z));
        Some(Self {
            rect: Rect { min, max },
            width,
            height,
        })
    }

    /// Size of a texel along x and z, m.
    pub fn texel_m(&self) -> DVec2 {
        self.rect.size() / DVec2::new(f64::from(self.width), f64::from(self.height))
    }
}

/// The camera.
#[derive(Clone, Copy, Debug)]
pub struct CameraFacts {
    /// Eye (or the middle of the image plane).
    pub eye: DVec3,
    /// Unit viewing direction.
    pub forward: DVec3,
    /// From the eye to the middle of the picture at unit distance along the viewing direction; `forward` if the principal point is
    /// there, and for parallel rays.
    pub middle: DVec3,
    /// From the middle of the picture to its right edge, at unit distance (orthographic: m).
    pub right: DVec3,
    /// From the middle of the picture to its upper edge, likewise.
    pub up: DVec3,
    /// Parallel rays.
    pub orthographic: bool,
    /// Way from the eye to where rays start, m; 0 for parallel rays.
    pub start_m: f64,
    /// Picture width, pixels.
    pub width: u32,
    /// Picture height, pixels.
    pub height: u32,
}

impl OutputFacts {
    /// The output of a scene around the local origin `origin_m`.
    pub(super) fn of(scene: &Scene, origin_m: DVec3) -> Self {
        let (camera, layers) = match &scene.output {
            Output::View(view) => {
                let camera = scene.camera.as_ref();
                (
                    camera.map(|c| camera_facts(c, origin_m, view.width, view.height)),
                    view.layers.clone(),
                )
            }
            Output::IrradianceMap(_) => (None, vec![LayerName::Irradiance]),
            Output::WaterMap(_) => (None, vec![LayerName::Water]),
        };
        let map = match &scene.output {
            Output::IrradianceMap(map) => Some(map),
            Output::View(_) | Output::WaterMap(_) => None,
        };
        let water_map = match &scene.output {
            Output::WaterMap(map) => WaterMapFacts::of(map, scene.floor.as_ref(), origin_m),
            Output::View(_) | Output::IrradianceMap(_) => None,
        };
        Self {
            camera,
            layers,
            receiver: map.map(|map| map.receiver),
            water_map,
            receiver_layer: map.map_or(0, |map| map.layer),
            sky_w_m2: [0.0; 3],
            requested_layers: scene.quality.layers,
        }
    }

    /// Whether a view with this layer is requested.
    pub fn wants(&self, layer: LayerName) -> bool {
        self.camera.is_some() && self.layers.contains(&layer)
    }

    /// Whether the camera's view needs irradiance.
    pub fn wants_irradiance(&self) -> bool {
        self.wants(LayerName::Radiance) || self.wants(LayerName::Irradiance)
    }

    /// Whether the output is a map of the water, so that nothing needs light.
    pub fn is_water_map(&self) -> bool {
        self.layers == [LayerName::Water]
    }

    /// Whether the output is the irradiance of the floor.
    pub fn is_floor_map(&self) -> bool {
        matches!(self.receiver, Some(Receiver::Floor(_)))
    }
}

impl SceneFacts {
    /// Sizes the floor's map for the output, and computes the skies' irradiance on it.
    pub(super) fn size_floor_map(&mut self, output: &Output) {
        match output {
            Output::WaterMap(_) => {}
            Output::View(_) => {
                let region = match &self.output.camera {
                    Some(camera) if self.output.wants_irradiance() => {
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
                    self.receivers.floor_map = Some(FloorMap {
                        rect,
                        width: count(size.x),
                        height: count(size.y),
                    });
                }
            }
            Output::IrradianceMap(map) => {
                let Some(floor) = &self.receivers.floor else {
                    return;
                };
                if matches!(map.receiver, Receiver::Object(_)) {
                    return;
                }
                let to_local =
                    |p: [f64; 2]| DVec2::from(p) - DVec2::new(self.origin_m.x, self.origin_m.z);
                self.receivers.floor_map = Some(FloorMap {
                    rect: Rect {
                        min: map.min_m.map_or(floor.rect.min, to_local),
                        max: map.max_m.map_or(floor.rect.max, to_local),
                    },
                    width: map.width.unwrap_or(DEFAULT_MAP_SIDE),
                    height: map.height.unwrap_or(DEFAULT_MAP_SIDE),
                });
                if map.include_sky {
                    let (sky, water) = (&self.lights.sky, &self.water);
                    self.output.sky_w_m2 = std::array::from_fn(|c| {
                        sky::sky_irradiance(
                            sky.radiance[c],
                            sky.transmittance,
                            water.extinction_per_m[c],
                            -floor.y_m,
                            sky.path_factor,
                            1.0,
                            1.0 / (water.ior * water.ior),
                        )
                    });
                }
            }
        }
    }
}

fn camera_facts(camera: &Camera, origin_m: DVec3, width: u32, height: u32) -> CameraFacts {
    let Projection {
        eye_m,
        axes: [right, up, forward],
        lens,
        ..
    } = camera.projection([width, height]);
    let half = [width, height].map(|side| 0.5 * f64::from(side));
    // Half of the picture at unit distance, and the way from the axis to the picture's middle.
    let ([half_width, half_height], middle) = match lens {
        Lens::Perspective { fx, fy, cx, cy } => (
            [half[0] / fx, half[1] / fy],
            forward + right * ((half[0] - cx) / fx) - up * ((half[1] - cy) / fy),
        ),
        Lens::Orthographic { pixels_per_m } => (half.map(|side| side / pixels_per_m), forward),
    };
    CameraFacts {
        eye: eye_m - origin_m,
        forward,
        middle,
        right: right * half_width,
        up: up * half_height,
        orthographic: matches!(lens, Lens::Orthographic { .. }),
        start_m: match camera {
            Camera::Perspective(camera) => camera.dome_radius_m,
            Camera::Orthographic(_) => 0.0,
        },
        width,
        height,
    }
}
