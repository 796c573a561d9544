//! The Utah teapot of `scenes/meshes`.

use std::collections::HashMap;

use super::{Outline, Shape};
use crate::config::Limits;
use crate::mesh::obj;

const TEXT: &[u8] = include_bytes!("../../../scenes/meshes/teapot.obj");

pub(super) const SHAPES: &[Shape] = &[Shape {
    name: "teapot",
    description: "Utah teapot of 32 patches (Newell 1975), without thickness",
    triangles: 4_032,
    open_edges: 128,
    build: teapot,
}];

fn teapot() -> Outline {
    let mesh =
        obj::read(TEXT, &[], &Limits::default()).expect("a mesh of the repository can be read");
    let mut outline = Outline::default();
    let mut number_of = HashMap::new();
    for triangle in &mesh.triangles {
        let corners = triangle.positions_m.map(|p| {
            *number_of
                .entry(p.to_array().map(f32::to_bits))
                .or_insert_with(|| outline.point(p.as_dvec3()))
        });
        outline.faces.push(corners);
    }
    outline
}
