//! Broken, thin, tiny, huge and awkwardly placed meshes.

use std::fmt::Write as _;

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use super::bench::{Bench, texels};
use super::case::Family::Mesh;
use super::case::{Case, Failure};
use super::obj::{comb, cuboid, hills, shifted, triangle, turned};
use super::truths::{
    flat_irradiance, largest_to_mean, pool, reference_error, relative_l1, seen_error, sun, waves,
    with, worst,
};
use crate::methods;
use crate::methods::reference_planes::PLANES;
use crate::physics::refraction::{direction_to_light, refract_direction};
use crate::scene::{LayerName, MethodChoice, Quality};

const REFERENCE: &str = "relative L1 of the floor against the reference";
const SAME: &str =
    "largest difference of the floor from that under the intact mesh, relative to the mean";
const SHADOW: &str = "missing flux on the floor against irradiance times the area of the shadow";
const OPEN: &str =
    "largest difference of the floor from that without the mesh, relative to the mean";

pub(super) const CASES: &[Case] = &[
    Mesh.case(
        "one_triangle",
        "boxes without thickness",
        REFERENCE,
        0.01,
        |b| {
            reference_error(
                b,
                under_waves(&triangle(
                    [-0.3, 0.0, -0.3],
                    [0.3, 0.1, -0.3],
                    [0.0, -0.1, 0.3],
                )),
            )
        },
    ),
    Mesh.case(
        "degenerate_triangles_among_sound_ones",
        "normals of length 0",
        SAME,
        1e-6,
        |b| {
            let broken = cuboid([0.4; 3]) + "f 1 1 2\nf 3 3 3\nf 1 2 1\n";
            same_as_box(b, &broken)
        },
    ),
    Mesh.case(
        "duplicate_triangles",
        "surfaces that shadow themselves",
        SAME,
        1e-6,
        |b| {
            let faces: String = cuboid([0.4; 3])
                .lines()
                .filter(|l| l.starts_with('f'))
                .fold(String::new(), |mut all, line| {
                    let _ = writeln!(all, "{line}");
                    all
                });
            same_as_box(b, &(cuboid([0.4; 3]) + &faces))
        },
    ),
    Mesh.case(
        "needle_triangles",
        "determinants close to 0",
        SHADOW,
        2e-5,
        |b| {
            // A disk of needles 1600 times as long as wide.
            let (count, length_m) = (10_000_u32, 0.4);
            let turn = std::f64::consts::TAU / f64::from(count);
            let mut disk = String::new();
            for i in 0..count {
                let (sin, cos) = (f64::from(i) * turn).sin_cos();
                let (next_sin, next_cos) = (f64::from(i + 1) * turn).sin_cos();
                let _ = writeln!(
                    disk,
                    "v 0 0 0\nv {:.9} 0 {:.9}\nv {:.9} 0 {:.9}\nf -3 -2 -1",
                    length_m * cos,
                    length_m * sin,
                    length_m * next_cos,
                    length_m * next_sin
                );
            }
            // The shadow of a level object is as large as the object.
            let disk_m2 = 0.5 * f64::from(count) * length_m * length_m * turn.sin();
            shadow_error(b, &disk, disk_m2, 256)
        },
    ),
    Mesh.case(
        "nothing_but_zero_area",
        "a mesh without any surface",
        "0 if it is refused with a message",
        0.0,
        |b| match b.map(under_waves("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")) {
            Err(Failure::Check(message)) if message.contains("refused") => Ok(0.0),
            Err(other) => Err(other),
            Ok(_) => Ok(1.0),
        },
    ),
    Mesh.case(
        "flipped_winding",
        "sides that depend on the winding",
        SAME,
        1e-6,
        |b| {
            let flipped = turned(&cuboid([0.4; 3]), |_| true);
            same_as_box(b, &flipped)
        },
    ),
    Mesh.case("mixed_winding", "sides that depend on the winding", SAME, 1e-6, |b| {
        let mixed = turned(&cuboid([0.4; 3]), |face| face % 2 == 0);
        same_as_box(b, &mixed)
    }),
    Mesh.case(
        "an_open_box",
        "visible insides",
        "worst pixel of its bottom and of a wall, seen from above its rim, against E at their depths, on the wall times tan θ_t",
        2e-3,
        inside_an_open_box,
    ),
    Mesh.case(
        "a_mesh_through_itself",
        "insides within insides",
        REFERENCE,
        0.01,
        |b| {
            let both = cuboid([0.5, 0.2, 0.2]) + &shifted(&cuboid([0.2, 0.2, 0.5]), 8);
            reference_error(b, under_waves(&both))
        },
    ),
    Mesh.case(
        "three_sheets_on_an_edge",
        "edges of three faces",
        REFERENCE,
        0.01,
        |b| {
            let sheets = "v -0.3 0 0\nv 0.3 0 0\nv 0.3 0.3 0.1\nv -0.3 0.3 0.1\nv 0.3 -0.2 0.3\nv -0.3 -0.2 0.3\nv 0.3 0 -0.3\nv -0.3 0 -0.3\n\
                      f 1 2 3\nf 1 3 4\nf 1 2 5\nf 1 5 6\nf 1 2 7\nf 1 7 8\n";
            reference_error(b, under_waves(sheets))
        },
    ),
    Mesh.case(
        "wholly_above_the_water",
        "dry meshes that block light under water",
        OPEN,
        0.0,
        |b| as_open(b, at(&cuboid([0.4; 3]), 1.0)),
    ),
    Mesh.case(
        "cut_by_the_surface",
        "rays that start inside",
        REFERENCE,
        0.01,
        |b| reference_error(b, at(&cuboid([0.4; 3]), 0.0)),
    ),
    Mesh.case(
        "touching_the_floor",
        "faces of the mesh in the plane of the floor",
        REFERENCE,
        0.01,
        |b| reference_error(b, at(&cuboid([0.4; 3]), -1.8)),
    ),
    Mesh.case(
        "below_the_floor",
        "meshes that no light reaches",
        OPEN,
        0.0,
        |b| as_open(b, at(&cuboid([0.4; 3]), -3.0)),
    ),
    Mesh.case(
        "around_the_camera",
        "rays that start inside a mesh",
        "relative L1 of the irradiance seen against the reference",
        0.01,
        |b| {
            let scene = with(
                at(&cuboid([3.0, 3.0, 3.0]), 0.0),
                &[
                    // The visible surfaces are behind the upper side, which is in the air.
                    ("/quality/layers", json!(2)),
                    (
                        "/camera",
                        json!({ "position_m": [0, 0.5, 0.2], "target_m": [0, -1, 0] }),
                    ),
                    (
                        "/output",
                        json!({ "kind": "view", "width": 48, "height": 32, "format": "exr", "layers": ["radiance", "irradiance"] }),
                    ),
                ],
            );
            seen_error(b, scene)
        },
    ),
    Mesh.case(
        "a_plate_across_the_light",
        "a level map without depth",
        REFERENCE,
        0.01,
        |b| {
            // Level under a slanted sun: one triangle, whose level map is nothing but an edge beside a slope.
            reference_error(
                b,
                under_waves(&triangle(
                    [-0.4, 0.0, -0.4],
                    [0.4, 0.0, -0.4],
                    [0.0, 0.0, 0.4],
                )),
            )
        },
    ),
    Mesh.case(
        "a_plate_on_a_reference_plane",
        "depths that belong to neither of two planes, or to both",
        "worst texel of the plate's own map against E cos θ T e^(−cd), with a plane through the plate and with the plate half-way between two planes",
        1e-4,
        on_a_reference_plane,
    ),
    // A fiftieth of the floor's texels wide, and exactly as wide as those of its level map.
    Mesh.case(
        "a_rod_thinner_than_a_map_texel",
        "objects between the texels",
        SHADOW,
        5e-4,
        |b| rod_error(b, 1024),
    ),
    Mesh.case(
        "a_rod_thinner_than_a_level_map_texel",
        "objects between the texels",
        SHADOW,
        0.05,
        |b| rod_error(b, 256),
    )
    .known_to_fail("a mesh that covers no centre of a level map's texel is not drawn there, and lets light through"),
    Mesh.case(
        "a_million_triangles",
        "buffers, counts and draws of a million triangles",
        REFERENCE,
        0.01,
        |b| reference_error(b, at(&hills(708), -1.2)),
    ),
    Mesh.case(
        "detail_of_a_centimetre_a_thousand_kilometres_out",
        "f32 coordinates",
        "largest difference of a comb's shadow from that of the comb at the origin, relative to the mean",
        1e-5,
        |b| {
            // Half a decimetre above the floor the waves blur the teeth only a little.
            let of = |out_m: f64| {
                with(
                    at(&comb(out_m), -1.95),
                    &[
                        ("/objects/0/translation_m", json!([-out_m, -1.95, out_m])),
                        ("/quality/water_cells", json!(512)),
                        ("/output/min_m", json!([-0.16, -0.16])),
                        ("/output/max_m", json!([0.16, 0.16])),
                        ("/output/width", json!(128)),
                        ("/output/height", json!(4)),
                    ],
                )
            };
            let near = b.map(of(0.0))?;
            let open = b.map(with(of(0.0), &[("/objects", json!([]))]))?;
            // Every second centimetre is dark: half of the light is missing, and neighbours differ as much as they can.
            let teeth = relative_l1(&near, &open)?;
            if !(0.4..0.6).contains(&teeth) {
                return Err(Failure::Check(format!("the teeth take {teeth} of the light")));
            }
            Ok(largest_to_mean(&b.map(of(1e6))?, &near))
        },
    ),
    Mesh.case(
        "a_wall_without_thickness_edge_on",
        "a shadow of width 0",
        OPEN,
        1e-3,
        |b| {
            let wall = triangle([-0.4, -0.4, 0.0], [0.4, -0.4, 0.0], [0.0, 0.4, 0.0]);
            let zenith = |objects: Value| {
                with(
                    pool(),
                    &[("/lights/0", sun(90.0, 0.0)), ("/objects", objects)],
                )
            };
            let open = b.map(zenith(json!([])))?;
            let walled = b.map(zenith(
                json!([{ "mesh": wall, "translation_m": [0, -1, 0.013] }]),
            ))?;
            relative_l1(&walled, &open)
        },
    ),
];

fn at(obj: &str, y_m: f64) -> Value {
    with(
        pool(),
        &[
            ("/water/waves", waves()),
            ("/quality/split_levels", json!(3)),
            (
                "/objects",
                json!([{ "mesh": obj, "translation_m": [0, y_m, 0] }]),
            ),
        ],
    )
}

fn under_waves(obj: &str) -> Value {
    at(obj, -1.0)
}

fn same_as_box(bench: &mut Bench<'_>, obj: &str) -> Result<f64, Failure> {
    let sound = bench.map(under_waves(&cuboid([0.4; 3])))?;
    let broken = bench.map(under_waves(obj))?;
    Ok(largest_to_mean(&broken, &sound))
}

fn as_open(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let open = bench.map(with(scene.clone(), &[("/objects", json!([]))]))?;
    let found = bench.map(scene)?;
    Ok(largest_to_mean(&found, &open))
}

/// Rotation of the rod away from the lines of the grid, rad around y.
const TURN: f64 = 0.65;

/// The direction of the light of [`pool`]'s sun under flat water.
fn light_under_water() -> DVec3 {
    let to_light = direction_to_light(60_f64.to_radians(), 30_f64.to_radians());
    refract_direction(-to_light, DVec3::Y, 1.333).unwrap_or(DVec3::NEG_Y)
}

/// [`shadow_error`] of a rod of 0.6 mm.
fn rod_error(bench: &mut Bench<'_>, level_map_texels: u32) -> Result<f64, Failure> {
    let sides_m = [0.6, 0.6e-3, 0.6e-3];
    let light = DQuat::from_rotation_y(-TURN) * light_under_water();
    let shown_m2: f64 = (0..3)
        .map(|axis| sides_m[(axis + 1) % 3] * sides_m[(axis + 2) % 3] * light[axis].abs())
        .sum();
    let shadow_m2 = shown_m2 / light.y.abs();
    shadow_error(bench, &cuboid(sides_m), shadow_m2, level_map_texels)
}

/// Difference between the flux that a mesh a metre under flat water takes from the floor and that of a shadow of this area. Waves would
/// only hide this small difference.
fn shadow_error(
    bench: &mut Bench<'_>,
    obj: &str,
    shadow_m2: f64,
    level_map_texels: u32,
) -> Result<f64, Failure> {
    let light = light_under_water();
    // The shadow lies around the origin.
    let (x_m, z_m) = (light.x / light.y, light.z / light.y);
    let scene = with(
        pool(),
        &[
            ("/quality/water_cells", json!(1024)),
            ("/quality/split_levels", json!(6)),
            ("/quality/level_map_texels", json!(level_map_texels)),
            ("/output/min_m", json!([-0.5, -0.5])),
            ("/output/max_m", json!([0.5, 0.5])),
            (
                "/objects",
                json!([{
                    "mesh": obj, "translation_m": [x_m, -1, z_m],
                    "rotation": DQuat::from_rotation_y(TURN).to_array(),
                }]),
            ),
        ],
    );
    let open = mean(&bench.map(with(scene.clone(), &[("/objects", json!([]))]))?);
    let shaded = mean(&bench.map(scene)?);
    // The map is of one square metre.
    Ok(((open - shaded) / (open * shadow_m2) - 1.0).abs())
}

/// A view over the rim of a box without its upper side, at its bottom and at the inside of the wall that the sun lights.
fn inside_an_open_box(bench: &mut Bench<'_>) -> Result<f64, Failure> {
    let open: String = cuboid([0.4; 3])
        .lines()
        .filter(|l| !l.starts_with("f 3 7") && !l.starts_with("f 3 8"))
        .fold(String::new(), |mut all, line| {
            let _ = writeln!(all, "{line}");
            all
        });
    let elevation_deg: f64 = 40.0;
    let scene = with(
        pool(),
        &[
            ("/water/absorption_per_m", json!([0.35, 0.07, 0.03])),
            ("/lights/0", sun(elevation_deg, 0.0)),
            (
                "/objects",
                json!([{ "mesh": open, "translation_m": [0, -1, 0] }]),
            ),
            // A camera under water sees the mirror image of the whole floor, so all of it is lit: a small floor has small beams.
            ("/floor/size_m", json!([2, 2])),
            ("/quality/water_cells", json!(512)),
            ("/quality/split_levels", json!(4)),
            (
                "/camera",
                json!({ "position_m": [0.5, -0.3, 0], "target_m": [-0.1, -1.1, 0], "vertical_fov_deg": 40 }),
            ),
            (
                "/output",
                json!({ "kind": "view", "width": 96, "height": 64, "format": "exr", "layers": ["radiance", "irradiance", "position"] }),
            ),
        ],
    );
    let resolved = bench.scene(scene)?;
    let frame = bench.render_resolved(&resolved)?;
    let sin_t = elevation_deg.to_radians().cos() / 1.333;
    let tan_t = sin_t / (1.0 - sin_t * sin_t).sqrt();
    let (mut on_wall, mut on_bottom) = (0, 0);
    let mut error = 0.0;
    let places = texels(&frame, LayerName::Position);
    let seen = texels(&frame, LayerName::Irradiance);
    for (&[x, y, z], found) in places.iter().zip(&seen) {
        // The wall at −x lies in the sun whole; on the bottom the shadow of the other one ends at −0.08 m. Edges, where a texel of
        // the map sees two faces, are left out.
        let is_wall = (x + 0.2).abs() < 1e-3 && (-1.17..-0.83).contains(&y);
        let is_bottom = (y + 1.2).abs() < 1e-3 && (-0.17..-0.11).contains(&x);
        if z.abs() > 0.17 || !(is_wall || is_bottom) {
            continue;
        }
        on_wall += u32::from(is_wall);
        on_bottom += u32::from(is_bottom);
        let turned = if is_wall { tan_t } else { 1.0 };
        for (found, level) in found.iter().zip(flat_irradiance(&resolved, -y)) {
            error = worst(error, (found / (level * turned) - 1.0).abs());
        }
    }
    if on_wall < 100 || on_bottom < 50 {
        return Err(Failure::Check(format!(
            "only {on_wall} pixels show the wall and {on_bottom} the bottom"
        )));
    }
    Ok(error)
}

/// A level plate under the zenith: the middle one of an odd number of planes is in it to the last bit, and of an even number it lies
/// where the acceptance of one ends and that of the next begins.
fn on_a_reference_plane(bench: &mut Bench<'_>) -> Result<f64, Failure> {
    let plate = "v -0.4 0 -0.4\nv 0.4 0 -0.4\nv 0.4 0 0.4\nv -0.4 0 0.4\nf 1 2 3\nf 1 3 4\n";
    let side = 64;
    let of = |quality: Value| {
        with(
            pool(),
            &[
                ("/water/absorption_per_m", json!([0.35, 0.07, 0.03])),
                ("/lights/0", sun(90.0, 0.0)),
                (
                    "/objects",
                    json!([{ "mesh": plate, "translation_m": [0, -1, 0] }]),
                ),
                ("/quality", quality),
                (
                    "/output",
                    json!({ "kind": "irradiance_map", "receiver": 0 }),
                ),
            ],
        )
    };
    let mut error = 0.0;
    for planes in [5, 4] {
        for choice in methods::variants() {
            let Some(choice) = with_planes(choice, planes) else {
                continue;
            };
            let method = json!(choice);
            let quality = json!({ "water_cells": 128, "level_map_texels": side, "method": method });
            let resolved = bench.scene(of(quality))?;
            let truth = flat_irradiance(&resolved, 1.0);
            let frame = bench.render_resolved(&resolved)?;
            if frame
                .stats
                .planes
                .first()
                .is_none_or(|p| p.specified != planes)
            {
                return Err(Failure::Check(format!("{method}: no {planes} planes")));
            }
            for (at, found) in texels(&frame, LayerName::Irradiance).iter().enumerate() {
                // The plate is 60 texels wide; whether those along its edges are drawn is up to the rasteriser.
                let from_edge = [at % side, at / side].map(|i| i.min(side - 1 - i));
                if from_edge.iter().any(|&i| i < 3) {
                    continue;
                }
                for (found, truth) in found.iter().zip(truth) {
                    error = worst(error, (found / truth - 1.0).abs());
                }
            }
        }
    }
    Ok(error)
}

/// The same choice with another number of planes; `None` where the method has no planes.
pub(super) fn with_planes(choice: MethodChoice, planes: u32) -> Option<MethodChoice> {
    let quality = Quality {
        method: choice.clone(),
        ..Quality::default()
    };
    let has_planes = methods::of(&quality).dial(PLANES.name).is_some();
    has_planes.then(|| choice.with(&PLANES, planes))
}

fn mean(map: &[[f64; 3]]) -> f64 {
    let values = map.as_flattened();
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
