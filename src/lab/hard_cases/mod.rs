//! Hard cases: scenes that break caustics renderers, each with what could break and how it would show.
//!
//! The suite runs on any adapter: in the tests (one test per case), and from `caustica hard-cases` on the machine that matters.
//! In addition to a case's own check, every picture must be finite, must have the same bits when rendered twice, and its energy
//! account must close.
//!
//! - `case`: a case and its outcome;
//! - `bench`: rendering with the checks for all cases;
//! - `truths`: what pictures are compared with;
//! - `page`: the results as a page;
//! - the families: `light` (and `lamp`), `water`, `sea`, `place`, `mesh`, `fold`, `field`, `camera`, `machine` (with
//!   `sabotage`: how to break a device).

mod bench;
mod camera;
pub mod case;
mod field;
mod fold;
mod lamp;
mod light;
mod machine;
mod mesh;
mod obj;
pub mod page;
mod place;
mod sabotage;
mod sea;
mod truths;
mod unfollowed;
mod water;

pub use case::{Case, Family, Outcome, Verdict};
pub use truths::Truths;

use crate::render::Renderer;

/// All cases, family by family.
pub fn all() -> impl Iterator<Item = &'static Case> {
    [
        light::CASES,
        lamp::CASES,
        water::CASES,
        sea::CASES,
        place::CASES,
        mesh::CASES,
        fold::CASES,
        field::CASES,
        camera::CASES,
        machine::CASES,
    ]
    .into_iter()
    .flatten()
}

/// The case of this name.
pub fn find(name: &str) -> Option<&'static Case> {
    all().find(|case| case.name == name)
}

/// How a suite is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Frames of the case with many frames, at least 10.
    pub renders: u32,
    /// Whether nothing else runs in this process, so that its memory is the suite's.
    pub is_alone: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            renders: 300,
            is_alone: false,
        }
    }
}

/// Runs a case.
pub fn run(case: &'static Case, renderer: &mut Renderer) -> Outcome {
    run_with(case, renderer, &mut Truths::default(), Settings::default())
}

/// Runs a case with these settings, and with references from earlier runs if there are any.
pub fn run_with(
    case: &'static Case,
    renderer: &mut Renderer,
    truths: &mut Truths,
    settings: Settings,
) -> Outcome {
    let mut bench = bench::Bench::new(Some(renderer), truths, settings);
    let result = (case.run)(&mut bench);
    bench.outcome(case, result)
}

/// A scene of [`scene`], with its meshes; `None` where it is refused.
pub fn resolved(scene: serde_json::Value) -> Option<crate::scene::ResolvedScene> {
    bench::resolved(&mut crate::assets::MeshStore::default(), scene).ok()
}

/// The scene that a case begins with, as JSON with the texts of OBJ files for meshes; nothing is rendered.
pub fn scene(case: &'static Case) -> Option<serde_json::Value> {
    let mut truths = Truths::default();
    let mut bench = bench::Bench::new(None, &mut truths, Settings::default());
    // Without a renderer every case ends at its first scene.
    let _ = (case.run)(&mut bench);
    bench.into_scene()
}
