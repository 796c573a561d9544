//! The catalogue: every shape by name, read in the same way as an upload.

use super::{
    Outline, blocks, height_field, implicit, plants, plates, polyhedra, revolution, stones,
    superquadric, sweep, swimmers, teapot, text,
};
use crate::config::Limits;
use crate::mesh::{Mesh, MeshError, obj};

/// A mesh that a formula makes. It fits a box of 1 m around the origin: the middle of its bounds is the origin, their
/// longest side is 1 m. Y is up.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Name: small letters and `_`; no other shape has it.
    pub name: &'static str,
    /// What it is, in a few words.
    pub description: &'static str,
    /// Triangles.
    pub triangles: usize,
    /// Edges of one triangle only; 0 where the surface is closed, and then it faces outward.
    pub open_edges: usize,
    /// Makes the surface, in any size and place.
    pub(super) build: fn() -> Outline,
}

/// Shapes by family, a file each.
const FAMILIES: &[&[Shape]] = &[
    polyhedra::SHAPES,
    stones::SHAPES,
    revolution::SHAPES,
    sweep::SHAPES,
    superquadric::SHAPES,
    blocks::SHAPES,
    implicit::SHAPES,
    height_field::SHAPES,
    plates::SHAPES,
    plants::SHAPES,
    swimmers::SHAPES,
    teapot::SHAPES,
];

/// Every shape.
pub const ALL: &[Shape] = &joined::<{ count(FAMILIES) }>(FAMILIES);

const fn count(families: &[&[Shape]]) -> usize {
    let (mut sum, mut family) = (0, 0);
    while family < families.len() {
        sum += families[family].len();
        family += 1;
    }
    sum
}

const fn joined<const N: usize>(families: &[&[Shape]]) -> [Shape; N] {
    let mut all = [families[0][0]; N];
    let (mut next, mut family) = (0, 0);
    while family < families.len() {
        let mut place = 0;
        while place < families[family].len() {
            all[next] = families[family][place];
            next += 1;
            place += 1;
        }
        family += 1;
    }
    all
}

impl Shape {
    /// The shape of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|shape| shape.name == name)
    }

    /// Positions and triangles, m.
    pub fn outline(&self) -> Outline {
        (self.build)().fitted()
    }

    /// The text of an OBJ file, with normals: the same bytes on every machine.
    pub fn obj(&self) -> String {
        let header = format!("{}: {}. Y up, metres.", self.name, self.description);
        text::obj(&self.outline(), &header)
    }

    /// The mesh, read from [`Shape::obj`] as an upload of that text is, under the same id.
    ///
    /// # Errors
    /// What [`obj::read`] refuses; nothing, as a test shows of every shape.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        obj::read(self.obj().as_bytes(), &[], &Limits::default())
    }
}
