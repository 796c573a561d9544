//! The generated meshes: the teapot (`teapot`), solids from formulas (`solids`), and how both become OBJ (`surface`).

mod solids;
mod surface;
mod teapot;

/// File name and text of every generated mesh.
pub(crate) fn all() -> Vec<(&'static str, String)> {
    vec![
        ("box.obj", solids::unit_box()),
        ("floor_tiles.obj", solids::floor_tiles()),
        ("post.obj", solids::post()),
        ("teapot.mtl", teapot::mtl()),
        ("teapot.obj", teapot::obj()),
        ("torus_knot.obj", solids::torus_knot()),
    ]
}
