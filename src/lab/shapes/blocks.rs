//! Shapes from blocks on a grid of planes, which need not be evenly spaced.

use std::collections::HashMap;

use glam::DVec3;

use super::{Outline, Shape, noise};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "stairs",
        description: "Ten steps",
        triangles: 300,
        open_edges: 0,
        build: stairs,
    },
    Shape {
        name: "cross",
        description: "Upright cross",
        triangles: 44,
        open_edges: 0,
        build: cross,
    },
    Shape {
        name: "chair",
        description: "Chair with four legs and a back",
        triangles: 108,
        open_edges: 0,
        build: chair,
    },
    Shape {
        name: "sink",
        description: "Block with a basin",
        triangles: 92,
        open_edges: 0,
        build: sink,
    },
    Shape {
        name: "bridge",
        description: "Deck with parapets on six piers",
        triangles: 300,
        open_edges: 0,
        build: bridge,
    },
    Shape {
        name: "towers",
        description: "Slab with 36 towers of seven heights",
        triangles: 1_884,
        open_edges: 0,
        build: towers,
    },
    Shape {
        name: "lattice",
        description: "Cube of thin bars, 36 in each direction",
        triangles: 4_752,
        open_edges: 0,
        build: lattice,
    },
    Shape {
        name: "menger_sponge",
        description: "Menger sponge of the third level",
        triangles: 36_096,
        open_edges: 0,
        build: menger_sponge,
    },
];

/// The surface of the cells that are full; the cell (i, j, k) is between planes i and i + 1 in x, and so on. No two full
/// cells may meet in an edge only.
fn built(planes: [&[f64]; 3], full: impl Fn([usize; 3]) -> bool) -> Outline {
    let cells = planes.map(|axis| axis.len() - 1);
    let mut outline = Outline::default();
    let mut number_of = HashMap::new();
    // The offset wraps below the first cell to one that is past the last.
    let is_full = |cell: [usize; 3]| (0..3).all(|a| cell[a] < cells[a]) && full(cell);
    for i in 0..cells[0] {
        for j in 0..cells[1] {
            for k in 0..cells[2] {
                if !is_full([i, j, k]) {
                    continue;
                }
                for axis in 0..3 {
                    for above in [false, true] {
                        let mut beside = [i, j, k];
                        beside[axis] = if above {
                            beside[axis] + 1
                        } else {
                            beside[axis].wrapping_sub(1)
                        };
                        if is_full(beside) {
                            continue;
                        }
                        let corners = side([i, j, k], axis, above).map(|node| {
                            *number_of.entry(node).or_insert_with(|| {
                                let at = |a: usize| planes[a][node[a]];
                                outline.point(DVec3::new(at(0), at(1), at(2)))
                            })
                        });
                        outline.quad(corners);
                    }
                }
            }
        }
    }
    outline
}

/// Corners of one side of a cell, counter-clockwise from outside.
fn side(cell: [usize; 3], axis: usize, above: bool) -> [[usize; 3]; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let ring = if above {
        [(0, 0), (1, 0), (1, 1), (0, 1)]
    } else {
        [(0, 0), (0, 1), (1, 1), (1, 0)]
    };
    ring.map(|(du, dv)| {
        let mut node = cell;
        node[axis] += usize::from(above);
        node[u] += du;
        node[v] += dv;
        node
    })
}

/// The given number of equal steps.
fn even(cells: u32) -> Vec<f64> {
    (0..=cells).map(f64::from).collect()
}

/// Planes that bound thick and thin layers in turn, thick ones first and last.
fn alternating(layers: u32, thick: f64, thin: f64) -> Vec<f64> {
    (0..=2 * layers + 1)
        .map(|plane| f64::from(plane.div_ceil(2)) * thick + f64::from(plane / 2) * thin)
        .collect()
}

fn stairs() -> Outline {
    let steps = even(10);
    built([&steps, &steps, &[0.0, 8.0]], |[x, y, _]| y <= x)
}

fn cross() -> Outline {
    let planes = [[0.0, 2.0, 3.0, 5.0], [0.0, 4.0, 5.0, 7.0]];
    built([&planes[0], &planes[1], &[0.0, 1.0]], |[x, y, _]| {
        x == 1 || y == 1
    })
}

fn chair() -> Outline {
    let across = [0.0, 0.06, 0.44, 0.5];
    built(
        [&across, &[0.0, 0.45, 0.5, 1.0], &across],
        |[x, y, z]| match y {
            0 => x != 1 && z != 1,
            1 => true,
            _ => z == 0,
        },
    )
}

fn sink() -> Outline {
    let (x, z) = ([0.0, 0.08, 0.92, 1.0], [0.0, 0.08, 0.62, 0.7]);
    built([&x, &[0.0, 0.06, 0.4], &z], |cell| cell != [1, 1, 1])
}

fn bridge() -> Outline {
    // Piers and gaps along; parapet, pier, lane, pier, parapet across.
    let along = alternating(3, 3.0, 0.6);
    let across = [0.0, 0.15, 0.5, 1.5, 1.85, 2.0];
    built(
        [&along, &[0.0, 2.0, 2.3, 2.8], &across],
        |[x, y, z]| match y {
            0 => x % 2 == 1 && (z == 1 || z == 3),
            1 => true,
            _ => z == 0 || z == 4,
        },
    )
}

fn towers() -> Outline {
    let across = alternating(6, 0.5, 1.0);
    let up = even(8);
    built([&across, &up, &across], |[x, y, z]| {
        let height = 1 + noise::hash((16 * x + z) as u32) % 7;
        y == 0 || x % 2 == 1 && z % 2 == 1 && y <= height as usize
    })
}

fn lattice() -> Outline {
    // Bars are the thin layers; a cell is full where two of its three layers are bars'.
    let planes: Vec<f64> = alternating(6, 1.0, 0.15)[1..13].to_vec();
    built([&planes, &planes, &planes], |cell| {
        cell.iter().filter(|&&layer| layer % 2 == 0).count() >= 2
    })
}

fn menger_sponge() -> Outline {
    let planes = even(27);
    built([&planes, &planes, &planes], |cell| {
        [1, 3, 9].iter().all(|size| {
            let middles = cell.iter().filter(|&&x| x / size % 3 == 1).count();
            middles < 2
        })
    })
}
