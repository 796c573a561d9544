//! Meshes as OBJ text.

use std::fmt::Write as _;

/// Teeth of a centimetre along z with a centimetre between them, 0.4 m across, `out_m` away from the origin along x and −z.
pub(super) fn comb(out_m: f64) -> String {
    let mut text = String::new();
    let (near_z, far_z) = (-0.2 - out_m, 0.2 - out_m);
    for tooth in 0..20 {
        let from_x = out_m - 0.2 + 0.02 * f64::from(tooth);
        let to_x = from_x + 0.01;
        let _ = writeln!(
            text,
            "v {from_x} 0 {near_z}\nv {to_x} 0 {near_z}\nv {to_x} 0 {far_z}\nv {from_x} 0 {far_z}\nf -4 -3 -2\nf -4 -2 -1"
        );
    }
    text
}

/// One triangle.
pub(super) fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> String {
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
pub(super) fn turned(obj: &str, which: impl Fn(usize) -> bool) -> String {
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
pub(super) fn shifted(obj: &str, first: usize) -> String {
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
pub(super) fn hills(side: usize) -> String {
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
