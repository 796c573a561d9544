//! Surfaces where a function of space is 0, by marching tetrahedra.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;

use super::turn::sin_cos;
use super::{Outline, Shape, noise};

pub(super) const SHAPES: &[Shape] = &[
    Shape {
        name: "gyroid",
        description: "Thick gyroid cut to a ball",
        triangles: 77_616,
        open_edges: 0,
        build: gyroid,
    },
    Shape {
        name: "sponge",
        description: "Ball with worm holes",
        triangles: 95_420,
        open_edges: 0,
        build: sponge,
    },
    Shape {
        name: "coral",
        description: "Branching coral",
        triangles: 38_484,
        open_edges: 0,
        build: coral,
    },
    Shape {
        name: "drops",
        description: "Seven balls that have run together",
        triangles: 22_380,
        open_edges: 0,
        build: drops,
    },
];

/// The surface of where `field` is negative, on a grid of `cells`³ cubes over the cube of side 2 around the origin, on
/// whose sides the field must be positive.
///
/// Each cube is cut into six tetrahedra around its diagonal (Kuhn), which fit those of its neighbours; a linear function
/// in a tetrahedron vanishes on one plane, so the surface is closed and never meets itself. Crossings stay away from the
/// ends of edges: no triangle is without area, at the price of moving the surface by up to 1/500 of a cell.
fn surface(cells: u32, field: impl Fn(DVec3) -> f64) -> Outline {
    let side = cells + 1;
    let node = |[x, y, z]: [u32; 3]| (x * side + y) * side + z;
    let place = |[x, y, z]: [u32; 3]| {
        2.0 / f64::from(cells) * DVec3::new(x.into(), y.into(), z.into()) - DVec3::ONE
    };
    let values: Vec<f64> = grid(side).map(|at| field(place(at))).collect();
    let mut builder = Builder {
        field: &field,
        outline: Outline::default(),
        crossing_of: HashMap::new(),
    };
    for cube in grid(cells) {
        for (corners, turned) in tetrahedra(cube) {
            let corners = corners.map(|at| Node {
                number: node(at),
                p_m: place(at),
                value: values[node(at) as usize],
            });
            builder.tetrahedron(corners, turned);
        }
    }
    builder.outline
}

/// The points of a cube of whole numbers, the last coordinate fastest.
fn grid(side: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..side.pow(3)).map(move |i| [i / (side * side), i / side % side, i % side])
}

/// The six tetrahedra of a cube: from its lowest corner to its highest along the axes in every order, and whether the
/// corners turn by the left hand.
fn tetrahedra(cube: [u32; 3]) -> impl Iterator<Item = ([[u32; 3]; 4], bool)> {
    [
        ([0, 1, 2], false),
        ([1, 2, 0], false),
        ([2, 0, 1], false),
        ([1, 0, 2], true),
        ([0, 2, 1], true),
        ([2, 1, 0], true),
    ]
    .into_iter()
    .map(move |(axes, turned)| {
        let mut corners = [cube; 4];
        for (step, axis) in axes.into_iter().enumerate() {
            for corner in &mut corners[step + 1..] {
                corner[axis] += 1;
            }
        }
        (corners, turned)
    })
}

/// A point of the grid.
#[derive(Clone, Copy, Debug)]
struct Node {
    number: u32,
    p_m: DVec3,
    value: f64,
}

struct Builder<'a> {
    field: &'a dyn Fn(DVec3) -> f64,
    outline: Outline,
    crossing_of: HashMap<(u32, u32), u32>,
}

impl Builder<'_> {
    fn tetrahedron(&mut self, corners: [Node; 4], turned: bool) {
        let (mut sorted, mut turned) = (corners, turned);
        // Those inside first; every swap of two corners turns the tetrahedron.
        for i in 0..4 {
            for j in i + 1..4 {
                if sorted[i].value >= 0.0 && sorted[j].value < 0.0 {
                    sorted.swap(i, j);
                    turned = !turned;
                }
            }
        }
        let [a, b, c, d] = sorted;
        let edges: &[(Node, Node)] = match sorted.iter().filter(|n| n.value < 0.0).count() {
            1 => &[(a, b), (a, c), (a, d)],
            2 => &[(a, c), (a, d), (b, d), (b, c)],
            3 => &[(a, d), (b, d), (c, d)],
            _ => return,
        };
        let mut ring: Vec<u32> = edges.iter().map(|&(p, q)| self.crossing(p, q)).collect();
        if turned {
            ring.reverse();
        }
        for k in 1..ring.len() - 1 {
            self.outline.faces.push([ring[0], ring[k], ring[k + 1]]);
        }
    }

    /// The point where the field vanishes between two nodes, one of them inside.
    fn crossing(&mut self, inside: Node, outside: Node) -> u32 {
        let key = (
            inside.number.min(outside.number),
            inside.number.max(outside.number),
        );
        let (field, outline) = (self.field, &mut self.outline);
        *self.crossing_of.entry(key).or_insert_with(|| {
            let at = |t: f64| inside.p_m + t * (outside.p_m - inside.p_m);
            // Halving, since fields have kinks.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                if field(at(middle)) < 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let t: f64 = 0.5 * (low + high);
            outline.point(at(t.clamp(0.002, 0.998)))
        })
    }
}

/// Schoen's gyroid (1970) with a period of `period_m`: about the distance from it, within half a wall.
fn gyroid_distance(p: DVec3, period_m: f64) -> f64 {
    let [(sx, cx), (sy, cy), (sz, cz)] = (p / period_m).to_array().map(sin_cos);
    // Its slope is about 2π / period.
    period_m / TAU * (sx * cy + sy * cz + sz * cx)
}

fn gyroid() -> Outline {
    surface(44, |p| {
        let wall = gyroid_distance(p, 1.2).abs() - 0.08;
        common(wall, p.length() - 0.94, 0.08)
    })
}

fn sponge() -> Outline {
    surface(48, |p| {
        let worn = p + 0.1 * noise::value(5, 3.0 * p) * DVec3::ONE;
        let holes = gyroid_distance(worn, 0.62) - 0.02;
        let ball = p.length() - 0.88 + 0.05 * noise::value(6, 4.0 * p);
        common(holes, ball, 0.06)
    })
}

fn drops() -> Outline {
    let balls: Vec<(DVec3, f64)> = (0..7)
        .map(|index| {
            let random = |what: u32| 2.0 * noise::unit(40 + what, index) - 1.0;
            let place = 0.55 * DVec3::new(random(0), random(1), random(2));
            (place, 0.26 + 0.08 * random(3))
        })
        .collect();
    surface(48, |p| {
        let away = balls.iter().map(|&(c, radius)| p.distance(c) - radius);
        away.fold(f64::INFINITY, |a, b| blended(a, b, 0.2))
    })
}

/// The lower of two distances, rounded where they are within `width` of each other: Quilez, *Smooth minimum*, 2013, the
/// quadratic one.
fn blended(a: f64, b: f64, width: f64) -> f64 {
    let closeness = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - 0.25 * width * closeness * closeness
}

/// The higher of two distances, rounded likewise.
fn common(a: f64, b: f64, width: f64) -> f64 {
    -blended(-a, -b, width)
}

/// A branch: a cone with round ends.
#[derive(Clone, Copy, Debug)]
struct Branch {
    from_m: DVec3,
    to_m: DVec3,
    radius_m: [f64; 2],
}

impl Branch {
    /// Distance from its surface, negative inside; about that where it tapers.
    fn distance(&self, p: DVec3) -> f64 {
        let along = self.to_m - self.from_m;
        let t = ((p - self.from_m).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let radius = self.radius_m[0] + t * (self.radius_m[1] - self.radius_m[0]);
        p.distance(self.from_m + t * along) - radius
    }
}

fn coral() -> Outline {
    let mut branches = Vec::new();
    let trunk = DVec3::new(0.0, -0.85, 0.0);
    grow(&mut branches, trunk, DVec3::Y, 0.55, 1);
    surface(60, |p| {
        branches
            .iter()
            .map(|branch| branch.distance(p))
            .fold(f64::INFINITY, |a, b| blended(a, b, 0.06))
    })
}

/// A branch and what grows from its tip; `name` numbers the branches as the nodes of a ternary tree.
fn grow(branches: &mut Vec<Branch>, from_m: DVec3, direction: DVec3, length_m: f64, name: u32) {
    let to_m = from_m + length_m * direction;
    branches.push(Branch {
        from_m,
        to_m,
        radius_m: [0.17 * length_m + 0.01, 0.12 * length_m + 0.01],
    });
    if length_m < 0.2 {
        return;
    }
    let side = direction.any_orthonormal_vector();
    let other = direction.cross(side);
    for twig in 0..3 {
        let random = |what: u32| noise::unit(60 + what, 3 * name + twig);
        let (sin, cos) = sin_cos((f64::from(twig) + 0.6 * random(0)) / 3.0);
        let spread = 0.45 + 0.45 * random(1);
        let twig_direction = (direction + spread * (cos * side + sin * other)).normalize();
        grow(
            branches,
            to_m,
            twig_direction,
            0.72 * length_m,
            3 * name + twig,
        );
    }
}
