//! Awkward cameras and sizes of pictures.

use glam::DVec3;
use serde_json::{Value, json};

use super::bench::{Bench, texels};
use super::case::Family::Camera;
use super::case::{Case, Failure};
use super::truths::{flat_irradiance, pool, sun, waves, waves_at, with, worst};
use crate::physics::fresnel::{diffuse_transmittance, fresnel_reflectance, fresnel_transmittance};
use crate::physics::refraction::{reflect_direction, refract_direction};
use crate::scene::{self, LayerName, Light, ResolvedScene};

const RADIANCE: &str =
    "worst pixel against ρE/π and the sky, refracted and reflected by the water's surface";
const REFUSED: &str = "0 if the scene is refused at that field";
/// Closer to the floor's rim than this share of its distance, rounding may put a ray's end on either side.
const RIM: f64 = 1e-3;

pub(super) const CASES: &[Case] = &[
    Camera.case(
        "a_micrometre_under_the_surface",
        "a ray that starts on the wrong side of the surface",
        RADIANCE,
        5e-5,
        |b| flat_error(b, looking(-1e-6)),
    ),
    Camera.case(
        "a_micrometre_over_the_surface",
        "a ray that starts on the wrong side of the surface",
        RADIANCE,
        5e-5,
        |b| flat_error(b, looking(1e-6)),
    ),
    Camera.case(
        "on_the_surface",
        "a ray that starts on neither side of the surface",
        RADIANCE,
        5e-5,
        |b| flat_error(b, looking(0.0)),
    ),
    Camera.case(
        "on_a_wave",
        "a ray that starts inside a crest",
        "worst pixel against ρE/π refracted and the sky reflected by the wave's surface, or against ρE/π seen from under the water",
        2.5e-6,
        |b| {
            let on = on_a_wave(b, 0.0)?;
            let over = on_a_wave(b, 1e-6)?;
            let under = on_a_wave(b, -1e-6)?;
            Ok([on, over, under].into_iter().fold(0.0, worst))
        },
    ),
    Camera.case(
        "a_view_of_a_floor_at_depth_0",
        "camera rays that start behind what they should hit",
        RADIANCE,
        5e-5,
        |b| flat_error(b, over_a_floor_at(0.0)),
    ),
    Camera.case(
        "a_view_of_a_floor_at_a_tenth_of_a_millimetre",
        "camera rays that start behind what they should hit",
        RADIANCE,
        5e-5,
        |b| flat_error(b, over_a_floor_at(1e-4)),
    ),
    Camera.case(
        "along_its_own_up",
        "a camera basis without a right vector",
        REFUSED,
        0.0,
        |b| {
            b.refused_at(
                camera(
                    [0.0, 2.0, 0.0],
                    [0.0, -1.0, 0.0],
                    json!({ "up": [0, 1, 0] }),
                ),
                "/camera/up",
            )
        },
    ),
    Camera.case(
        "a_field_of_view_of_a_tenth_of_a_degree",
        "pixels whose rays are almost the same",
        RADIANCE,
        2e-4,
        |b| {
            flat_error(
                b,
                camera(
                    [0.0, 30.0, 10.0],
                    [0.0, -2.0, 0.0],
                    json!({ "vertical_fov_deg": 0.1 }),
                ),
            )
        },
    ),
    Camera.case(
        "a_field_of_view_of_179_degrees",
        "pixels with grazing rays",
        RADIANCE,
        5e-6,
        |b| {
            let scene = camera(
                [0.0, 1.0, 0.0],
                [0.0, -1.0, -0.1],
                json!({ "vertical_fov_deg": 179 }),
            );
            flat_error(b, under_the_sky(scene))
        },
    ),
    Camera.case(
        "under_water_at_the_critical_angle",
        "total reflection exactly at its limit",
        RADIANCE,
        1e-4,
        |b| {
            // The angle lies between the two columns in the middle.
            let scene = camera(
                [0.0, -1.0, 0.0],
                [(1.0_f64 / 1.333).asin().tan(), 0.0, 0.0],
                json!({ "vertical_fov_deg": 5 }),
            );
            flat_error(b, under_the_sky(scene))
        },
    ),
    Camera.case(
        "one_pixel",
        "a pixel without neighbours",
        RADIANCE,
        1e-5,
        |b| {
            flat_error(
                b,
                with(
                    looking(-0.5),
                    &[("/output/width", json!(1)), ("/output/height", json!(1))],
                ),
            )
        },
    ),
    Camera.case(
        "one_column_of_8192_pixels",
        "bands and aspects",
        RADIANCE,
        5e-5,
        |b| {
            flat_error(
                b,
                with(
                    looking(3.0),
                    &[("/output/width", json!(1)), ("/output/height", json!(8192))],
                ),
            )
        },
    ),
    Camera.case(
        "pictures_of_8192_by_8192_pixels",
        "unbounded memory",
        REFUSED,
        0.0,
        |b| {
            b.refused_at(
                with(
                    looking(1.0),
                    &[
                        ("/output/width", json!(8192)),
                        ("/output/height", json!(8192)),
                    ],
                ),
                "/output",
            )
        },
    ),
];

fn camera(position_m: [f64; 3], target_m: [f64; 3], mut more: Value) -> Value {
    let mut camera = json!({ "position_m": position_m, "target_m": target_m });
    if let (Some(camera), Some(more)) = (camera.as_object_mut(), more.as_object_mut()) {
        camera.append(more);
    }
    with(
        pool(),
        &[
            ("/camera", camera),
            (
                "/output",
                json!({ "kind": "view", "width": 48, "height": 32 }),
            ),
        ],
    )
}

/// Straight down from this height.
fn looking(y_m: f64) -> Value {
    camera(
        [0.0, y_m, 0.0],
        [0.0, -2.0, 0.0],
        json!({ "up": [0, 0, -1], "vertical_fov_deg": 20 }),
    )
}

/// The same with a sky beside the sun.
fn under_the_sky(scene: Value) -> Value {
    let sky = json!({ "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] });
    with(scene, &[("/lights", json!([sun(60.0, 30.0), sky]))])
}

/// The expected view of clear water over an evenly lit floor: Snell and Fresnel for the ray of each pixel.
struct Clear {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    size: [u32; 2],
    ior: f64,
    depth_m: f64,
    half_m: [f64; 2],
    floor: [f64; 3],
    sky: [f64; 3],
}

impl Clear {
    /// For a scene at the origin that has a floor and a perspective camera.
    fn of(resolved: &ResolvedScene) -> Result<Self, Failure> {
        let scene = &resolved.scene;
        let (Some(floor), Some(scene::Camera::Perspective(camera)), scene::Output::View(output)) =
            (&scene.floor, &scene.camera, &scene.output)
        else {
            return Err(Failure::Check("it is no view of a floor".to_owned()));
        };
        let mut sky = [0.0; 3];
        for light in &scene.lights {
            if let Light::Sky(one) = light {
                sky = std::array::from_fn(|c| sky[c] + one.radiance_w_m2_sr[c]);
            }
        }
        let suns = flat_irradiance(resolved, floor.depth_m);
        let through = diffuse_transmittance(scene.water.ior);
        let eye = DVec3::from(camera.position_m);
        let forward = (DVec3::from(camera.target_m) - eye).normalize();
        let right = forward.cross(DVec3::from(camera.up)).normalize();
        let degrees = camera
            .vertical_fov_deg
            .unwrap_or(scene::DEFAULT_FIELD_OF_VIEW_DEG);
        let half = (0.5 * degrees.to_radians()).tan();
        Ok(Self {
            eye,
            forward,
            right: right * half * f64::from(output.width) / f64::from(output.height),
            up: right.cross(forward) * half,
            size: [output.width, output.height],
            ior: scene.water.ior,
            depth_m: floor.depth_m,
            half_m: floor.size_m.map(|side_m| 0.5 * side_m),
            floor: std::array::from_fn(|c| {
                floor.albedo[c] * (suns[c] / std::f64::consts::PI + sky[c] * through)
            }),
            sky,
        })
    }

    /// Unit directions of the pixels' rays, row by row from the top.
    fn rays(&self) -> impl Iterator<Item = DVec3> + '_ {
        let [width, height] = self.size;
        let share = |i: u32, n: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
        (0..width * height).map(move |at| {
            let aside = self.right * share(at % width, width);
            (self.forward + aside - self.up * share(at / width, height)).normalize()
        })
    }

    /// 1 where a ray under water ends on the floor, 0 where it misses the floor; `None` on the floor's rim.
    fn on_floor(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        if direction.y >= 0.0 {
            return Some(0.0);
        }
        let way_m = (from.y + self.depth_m) / -direction.y;
        let end = from + direction * way_m;
        let beside_m = (end.x.abs() - self.half_m[0]).max(end.z.abs() - self.half_m[1]);
        let is_clear = beside_m.abs() > RIM * (from.length() + way_m);
        is_clear.then(|| f64::from(u8::from(beside_m < 0.0)))
    }

    /// Through a surface at `from` whose unit normal is on the ray's side; `eta` is n_to / n_from.
    fn at_surface(
        &self,
        from: DVec3,
        direction: DVec3,
        normal: DVec3,
        eta: f64,
    ) -> Option<[f64; 3]> {
        let cos_i = -direction.dot(normal);
        let mirrored = reflect_direction(direction, normal);
        let refracted = refract_direction(direction, normal, eta);
        let through = fresnel_transmittance(cos_i, eta) / (eta * eta);
        let back = fresnel_reflectance(cos_i, eta);
        // One of the two paths is in the water, the other in the air.
        let (floor, sky) = if eta > 1.0 {
            let on = refracted.map_or(Some(0.0), |ray| self.on_floor(from, ray))?;
            (through * on, back)
        } else {
            (back * self.on_floor(from, mirrored)?, through)
        };
        Some(std::array::from_fn(|c| {
            floor * self.floor[c] + sky * self.sky[c]
        }))
    }

    /// Radiance along a ray over or under flat water; a camera on the surface is over it.
    fn over_flat(&self, direction: DVec3) -> Option<[f64; 3]> {
        let is_dry = self.eye.y >= 0.0;
        let (normal, eta) = if is_dry {
            (DVec3::Y, self.ior)
        } else {
            (DVec3::NEG_Y, 1.0 / self.ior)
        };
        if direction.dot(normal) < 0.0 {
            let at = self.eye + direction * (self.eye.y / -direction.y);
            self.at_surface(at, direction, normal, eta)
        } else if is_dry {
            Some(self.sky)
        } else {
            self.down_in_water(direction)
        }
    }

    /// Radiance along a ray that goes down from the camera in the water.
    fn down_in_water(&self, direction: DVec3) -> Option<[f64; 3]> {
        let on = self.on_floor(self.eye, direction)?;
        Some(self.floor.map(|l| on * l))
    }

    /// Largest relative error of the picture against the radiance of each pixel's ray; where none is expected, any is an error of 1.
    /// Only few pixels may show the floor's rim.
    fn error(
        &self,
        found: &[[f64; 3]],
        radiance: impl Fn(DVec3) -> Option<[f64; 3]>,
    ) -> Result<f64, Failure> {
        let mut error = 0.0;
        let mut compared = 0;
        for (ray, found) in self.rays().zip(found) {
            let Some(truth) = radiance(ray) else { continue };
            compared += 1;
            for (&found, truth) in found.iter().zip(truth) {
                error = worst(
                    error,
                    if truth > 0.0 {
                        (found / truth - 1.0).abs()
                    } else {
                        f64::from(u8::from(found != 0.0))
                    },
                );
            }
        }
        let pixels = self.size[0] * self.size[1];
        if found.len() != pixels as usize || 20 * compared < 19 * pixels {
            return Err(Failure::Check(format!(
                "only {compared} of {pixels} pixels can be compared"
            )));
        }
        Ok(error)
    }
}

/// Worst pixel of a view of flat water.
fn flat_error(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let resolved = bench.scene(scene)?;
    let clear = Clear::of(&resolved)?;
    let frame = bench.render_resolved(&resolved)?;
    clear.error(&texels(&frame, LayerName::Radiance), |ray| {
        clear.over_flat(ray)
    })
}

/// A floor at the given depth, seen at an angle from the air.
fn over_a_floor_at(depth_m: f64) -> Value {
    with(
        camera([0.0, 2.0, 1.5], [0.0, 0.0, 0.0], json!({})),
        &[("/floor/depth_m", json!(depth_m))],
    )
}

/// Worst pixel of two views, down and up, of a camera on a wave or at a given height above it, against the expected view from its side of
/// the wave. A sky lights the floor evenly regardless of the waves; rays cross the surface at the camera. On the wave itself rounding puts
/// the camera on either side, which has to be the same for all pixels of a view.
fn on_a_wave(bench: &mut Bench<'_>, above_m: f64) -> Result<f64, Failure> {
    let (x_m, z_m) = (0.3, 0.1);
    let (height_m, normal) = waves_at(x_m, z_m);
    let up = json!({ "up": [0, 0, -1], "vertical_fov_deg": 20 });
    let mut error = 0.0;
    for (target_m, more) in [([0.5, -1.0, 0.4], json!({})), ([0.4, 3.0, 0.2], up)] {
        let scene = with(
            under_the_sky(camera([x_m, height_m + above_m, z_m], target_m, more)),
            &[
                ("/water/waves", waves()),
                ("/lights/0/irradiance_w_m2", json!([0, 0, 0])),
            ],
        );
        let resolved = bench.scene(scene)?;
        let clear = Clear::of(&resolved)?;
        let frame = bench.render_resolved(&resolved)?;
        let found = texels(&frame, LayerName::Radiance);
        let dry = clear.error(&found, |ray| {
            if ray.dot(normal) < 0.0 {
                clear.at_surface(clear.eye, ray, normal, clear.ior)
            } else {
                Some(clear.sky)
            }
        })?;
        let wet = clear.error(&found, |ray| {
            if ray.dot(normal) > 0.0 {
                clear.at_surface(clear.eye, ray, -normal, 1.0 / clear.ior)
            } else {
                clear.down_in_water(ray)
            }
        })?;
        // Exactly on the wave each of the two views may be on either side, because each rounds the wave's height by itself.
        let of_side = if above_m > 0.0 {
            dry
        } else if above_m < 0.0 {
            wet
        } else {
            dry.min(wet)
        };
        error = worst(error, of_side);
    }
    Ok(error)
}
