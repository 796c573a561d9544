//! Broken, thin, tiny, huge and awkwardly placed meshes.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::bench::{Bench, texels};
use super::case::Family::Mesh;
use super::case::{Case, Failure};
use super::truths::{largest_to_mean, pool, reference_error, relative_l1, sun, waves, with};
use crate::scene::LayerName;

const REFERENCE: &str = "relative L1 of the floor against the reference";
const SAME: &str = "largest difference of the floor from that of the sound mesh, to the mean";
const OPEN: &str = "largest difference of the floor from that without the mesh, to the mean";

pub(super) const CASES: &[Case] = &[
    Mesh.case(
        "one_triangle",
        "boxes without thickness",
        REFERENCE,
        0.02,
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
        "normals of nothing",
        SAME,
        1e-6,
        |b| {
            let broken = cuboid([0.4; 3]) + "f 1 1 2\nf 3 3 3\nf 1 2 1\n";
            same_as_box(b, &broken)
        },
    ),
    Mesh.case(
        "duplicate_triangles",
        "surfaces that hide themselves",
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
        "determinants of nearly nothing",
        REFERENCE,
        0.02,
        |b| {
            let mut fan = String::new();
            for i in 0..64 {
                let turn = f64::from(i) * std::f64::consts::TAU / 64.0;
                let (sin, cos) = turn.sin_cos();
                let (side_x, side_z) = (-sin * 1e-4, cos * 1e-4);
                let _ = writeln!(
                    fan,
                    "v 0 0 0\nv {:.9} 0 {:.9}\nv {:.9} 0 {:.9}\nf -3 -2 -1",
                    0.4 * cos + side_x,
                    0.4 * sin + side_z,
                    0.4 * cos - side_x,
                    0.4 * sin - side_z
                );
            }
            reference_error(b, under_waves(&fan))
        },
    ),
    Mesh.case(
        "nothing_but_zero_area",
        "a mesh of no surface",
        "0 where it is refused in words",
        0.0,
        |b| match b.map(under_waves("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")) {
            Err(Failure::Check(message)) if message.contains("refused") => Ok(0.0),
            Err(other) => Err(other),
            Ok(_) => Ok(1.0),
        },
    ),
    Mesh.case(
        "flipped_winding",
        "sides told by winding",
        SAME,
        1e-6,
        |b| {
            let flipped = turned(&cuboid([0.4; 3]), |_| true);
            same_as_box(b, &flipped)
        },
    ),
    Mesh.case("mixed_winding", "sides told by winding", SAME, 1e-6, |b| {
        let mixed = turned(&cuboid([0.4; 3]), |face| face % 2 == 0);
        same_as_box(b, &mixed)
    }),
    Mesh.case(
        "an_open_box",
        "insides that are seen",
        REFERENCE,
        0.02,
        |b| {
            // Without the upper side.
            let open: String = cuboid([0.4; 3])
                .lines()
                .filter(|l| !l.starts_with("f 3 7") && !l.starts_with("f 3 8"))
                .fold(String::new(), |mut all, line| {
                    let _ = writeln!(all, "{line}");
                    all
                });
            reference_error(b, under_waves(&open))
        },
    ),
    Mesh.case(
        "a_mesh_through_itself",
        "insides within insides",
        REFERENCE,
        0.02,
        |b| {
            let both = cuboid([0.5, 0.2, 0.2]) + &shifted(&cuboid([0.2, 0.2, 0.5]), 8);
            reference_error(b, under_waves(&both))
        },
    ),
    Mesh.case(
        "three_sheets_on_an_edge",
        "edges of three faces",
        REFERENCE,
        0.02,
        |b| {
            let sheets = "v -0.3 0 0\nv 0.3 0 0\nv 0.3 0.3 0.1\nv -0.3 0.3 0.1\nv 0.3 -0.2 0.3\nv -0.3 -0.2 0.3\nv 0.3 0 -0.3\nv -0.3 0 -0.3\n\
                      f 1 2 3\nf 1 3 4\nf 1 2 5\nf 1 5 6\nf 1 2 7\nf 1 7 8\n";
            reference_error(b, under_waves(sheets))
        },
    ),
    Mesh.case(
        "wholly_above_the_water",
        "dry meshes that stop wet light",
        OPEN,
        0.0,
        |b| as_open(b, at(&cuboid([0.4; 3]), 1.0)),
    ),
    Mesh.case(
        "cut_by_the_surface",
        "rays that start inside",
        REFERENCE,
        0.05,
        |b| reference_error(b, at(&cuboid([0.4; 3]), 0.0)),
    ),
    Mesh.case(
        "touching_the_floor",
        "coplanar faces of floor and mesh",
        REFERENCE,
        0.02,
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
        "rays that start within a mesh",
        "share of pixels that are not finite and black or lit",
        0.0,
        |b| {
            let scene = with(
                at(&cuboid([3.0, 3.0, 3.0]), 0.0),
                &[
                    (
                        "/camera",
                        json!({ "position_m": [0, 0.5, 0.2], "target_m": [0, -1, 0] }),
                    ),
                    (
                        "/output",
                        json!({ "kind": "view", "width": 48, "height": 32 }),
                    ),
                ],
            );
            let frame = b.render(scene)?;
            let bad = texels(&frame, LayerName::Radiance)
                .iter()
                .filter(|p| p.iter().any(|v| *v < 0.0))
                .count();
            Ok(bad as f64)
        },
    ),
    Mesh.case(
        "a_plate_across_the_light",
        "a level map without depth",
        REFERENCE,
        0.02,
        |b| {
            // Perpendicular to the refracted sun: coplanar with a reference plane.
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
        "a_rod_thinner_than_a_map_texel",
        "objects between the texels",
        REFERENCE,
        0.02,
        |b| reference_error(b, under_waves(&cuboid([0.6, 0.6e-3, 0.6e-3]))),
    ),
    Mesh.case(
        "a_million_triangles",
        "buffers, counts and draws of a million",
        REFERENCE,
        0.03,
        |b| reference_error(b, at(&hills(708), -1.2)),
    ),
    Mesh.case(
        "detail_of_a_centimetre_a_thousand_kilometres_out",
        "coordinates in f32",
        SAME,
        1e-3,
        |b| {
            let near = b.map(under_waves(&cuboid([0.4; 3])))?;
            let far: String = cuboid([0.4; 3])
                .lines()
                .fold(String::new(), |mut all, line| {
                    match line.strip_prefix("v ") {
                        Some(numbers) => {
                            let at: Vec<f64> =
                                numbers.split(' ').filter_map(|n| n.parse().ok()).collect();
                            let _ = writeln!(all, "v {} {} {}", at[0] + 1e6, at[1], at[2] - 1e6);
                        }
                        None => {
                            let _ = writeln!(all, "{line}");
                        }
                    }
                    all
                });
            let moved = with(
                under_waves(&far),
                &[("/objects/0/translation_m", json!([-1e6, -1, 1e6]))],
            );
            Ok(largest_to_mean(&b.map(moved)?, &near))
        },
    ),
    Mesh.case(
        "a_wall_without_thickness_edge_on",
        "a shadow of no width",
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

fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> String {
    let mut text = String::new();
    for p in [a, b, c] {
        let _ = writeln!(text, "v {} {} {}", p[0], p[1], p[2]);
    }
    text + "f 1 2 3\n"
}

/// A box around the origin.
pub(super) fn cuboid(size_m: [f64; 3]) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let side = |axis: usize| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 } * size_m[axis];
        let _ = writeln!(text, "v {} {} {}", side(0), side(1), side(2));
    }
    text + "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n"
}

/// The same with the winding of some faces turned round.
fn turned(obj: &str, which: impl Fn(usize) -> bool) -> String {
    let mut text = String::new();
    let mut face = 0;
    for line in obj.lines() {
        match line
            .strip_prefix("f ")
            .map(|corners| corners.split(' ').collect::<Vec<_>>())
        {
            Some(corners) if which(face) => {
                face += 1;
                let _ = writeln!(text, "f {} {} {}", corners[0], corners[2], corners[1]);
            }
            found => {
                face += usize::from(found.is_some());
                let _ = writeln!(text, "{line}");
            }
        }
    }
    text
}

/// The same with its faces counting from `first` vertices on.
fn shifted(obj: &str, first: usize) -> String {
    let mut text = String::new();
    for line in obj.lines() {
        match line.strip_prefix("f ") {
            Some(corners) => {
                let corners: Vec<String> = corners
                    .split(' ')
                    .filter_map(|c| c.parse::<usize>().ok())
                    .map(|c| (c + first).to_string())
                    .collect();
                let _ = writeln!(text, "f {}", corners.join(" "));
            }
            None => {
                let _ = writeln!(text, "{line}");
            }
        }
    }
    text
}

/// Hills of 2 (`side` − 1)² triangles over 1.6 m × 1.6 m.
fn hills(side: usize) -> String {
    let mut text = String::new();
    let place = |i: usize| 1.6 * (i as f64 / (side - 1) as f64 - 0.5);
    for j in 0..side {
        for i in 0..side {
            let (x, z) = (place(i), place(j));
            let y = 0.1 * (7.0 * x).sin() * (9.0 * z).cos();
            let _ = writeln!(text, "v {x:.6} {y:.6} {z:.6}");
        }
    }
    for j in 1..side {
        for i in 1..side {
            let d = j * side + i + 1;
            let (a, b, c) = (d - side - 1, d - side, d - 1);
            let _ = writeln!(text, "f {a} {c} {d}\nf {a} {d} {b}");
        }
    }
    text
}
