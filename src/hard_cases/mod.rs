//! Hard cases: scenes that break caustics renderers, each with what could break and how that would show.
//!
//! The suite runs on whatever adapter there is: in the tests (one test a case), and from `caustica hard-cases` on the machine
//! that matters. Whatever a case checks of its own, every picture in it is finite, made twice with the same bits, and its energy
//! account closes.
//!
//! - `case`: what a case is, and what came of it;
//! - `bench`: rendering with the checks that hold for all;
//! - `truths`: what pictures are compared with;
//! - `page`: the suite as a document;
//! - the families: `light`, `water`, `place`, `mesh`, `fold`, `camera`.

mod bench;
mod camera;
pub mod case;
mod fold;
mod light;
mod mesh;
pub mod page;
mod place;
mod truths;
mod water;

pub use case::{Case, Family, Outcome, Verdict};
pub use truths::Truths;

use crate::render::Renderer;

/// All cases, family by family.
pub fn all() -> impl Iterator<Item = &'static Case> {
    [
        light::CASES,
        water::CASES,
        place::CASES,
        mesh::CASES,
        fold::CASES,
        camera::CASES,
    ]
    .into_iter()
    .flatten()
}

/// The case of this name.
pub fn find(name: &str) -> Option<&'static Case> {
    all().find(|case| case.name == name)
}

/// Runs a case.
pub fn run(case: &'static Case, renderer: &mut Renderer) -> Outcome {
    run_with(case, renderer, &mut Truths::default())
}

/// Runs a case with references that earlier runs may have left.
pub fn run_with(case: &'static Case, renderer: &mut Renderer, truths: &mut Truths) -> Outcome {
    let mut bench = bench::Bench::new(Some(renderer), truths);
    let result = (case.run)(&mut bench);
    bench.outcome(case, result)
}

/// The scene that a case begins with, as JSON with the texts of OBJ files for meshes; nothing is rendered.
pub fn scene(case: &'static Case) -> Option<serde_json::Value> {
    let mut truths = Truths::default();
    let mut bench = bench::Bench::new(None, &mut truths);
    // Without a renderer every case ends at its first scene.
    let _ = (case.run)(&mut bench);
    bench.into_scene()
}
