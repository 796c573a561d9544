//! Caustica renders water caustics: a scene — waves, lights, meshes, a camera — becomes a picture or an irradiance map, with
//! what it cost in time and memory and where every watt went.
//!
//! # The life of a request
//!
//! ```text
//! scene.json ─ parse, validate, resolve ─> ResolvedScene ─> SceneFacts ─ plan ─> Plan
//! Plan ─ GPU thread ─> surface ─> beams ─> hits ─> deposit ─> irradiance ─> camera ─> shade ─> Frame
//! Frame ─ encode (CPU) ─> PNG | EXR, and Stats
//! ```
//!
//! 1. [`scene::Scene::from_json`] reads JSON strictly; every complaint has a JSON pointer. [`scene::resolve()`] checks ranges and
//!    turns mesh ids into [`mesh::Mesh`]es.
//! 2. [`scene::facts::SceneFacts`] holds the figures that decide what has to be done: which lights reach the water, which
//!    rectangle of water lights the receivers, which part of the floor the camera sees. All in coordinates around what is
//!    looked at, so that f32 is as good far from the origin as near it.
//! 3. [`plan::plan()`] walks the list [`passes::ALL`] backwards from what is asked for and keeps what is needed, with a
//!    sentence for each pass that is in or out. No GPU is involved; peak bytes are known before anything is allocated.
//! 4. [`render::Renderer`] owns the device and the caches and runs the plan. What a pass does is in its description
//!    ([`passes::PassDesc`]); bindings are matched by name from the WGSL ([`gpu::Kernel`]). Level maps live in
//!    [`level_map::LevelMapCache`]: one map serves every frame of an animation.
//! 5. [`frame::Frame`] holds linear f32 layers and [`stats::Stats`]; [`image::encode`] makes the file, on the CPU, so that the
//!    same request gives the same bytes.
//!
//! # How light is carried
//!
//! A grid of water vertices over just the rectangle that can light the receivers sends refracted rays; each ends on the floor
//! (exactly) or on a mesh (marched into its level map; at the map's edges tried against the mesh itself). A hierarchy over the objects
//! says which a ray may meet, and each object's surfaces along the light (`quality.layers`) are receivers of their own. Between three rays goes
//! a beam, whose flux is laid on the receiver's map in proportion to the exactly covered share of each texel — never divided by a
//! footprint that can vanish — as integer sums. Beams that straddle receivers are halved with rays of their own, and their parts
//! again while they straddle. The energy account closes: emitted = landed + absorbed + scattered + reflected + left the region +
//! missed, each summed where it happens.
//!
//! # Rooms
//!
//! | room | holds |
//! |---|---|
//! | [`scene`] | what a request may say, and the facts drawn from it |
//! | [`physics`] | formulas in f64, each with its source; twins in `shaders/lib`, tied by [`physics::registry`] |
//! | [`waves`] | wave models |
//! | [`mesh`] | OBJ in, repair report, ray hierarchy, store; shapes from formulas |
//! | [`plan`] | which passes, and why; knows nothing of wgpu |
//! | [`passes`] | one file per pass, and the table of what flows between them |
//! | [`gpu`] | device, shaders, buffers, timing; knows nothing of water |
//! | [`level_map`] | the cache |
//! | [`render`] | runs plans; self-check |
//! | [`reference`] | float64 truth by plain rays: another algorithm, not a port |
//! | [`accuracy`] | error of images, dials and their sweeps, plots and reports |
//! | [`experiment`] | published experiments done again |
//! | [`tuning`] | from a wanted error or time to dials |
//! | [`hard_cases`] | scenes that break caustics renderers, and how that would show |
//! | [`image`] | PNG, EXR, tone curve |
//! | [`jobs`] | bounded queue and the one GPU thread |
//! | [`http`] | routes; the only place that knows status codes is its error table |
//! | [`cli`] | the command line |
//! | [`config`] | every setting |
//!
//! Arrows go down: http, cli → jobs → render → {plan, passes, gpu, level_map} → {scene, physics, waves, mesh}.

pub mod accuracy;
pub mod assets;
pub mod cache;
pub mod cli;
pub mod config;
pub mod facts;
pub mod frame;
pub mod gpu;
pub mod gpu_queue;
pub mod graph;
pub mod http;
pub mod image;
pub mod lab;
pub mod mesh;
pub mod methods;
pub mod physics;
pub mod plan;
pub mod reference;
pub mod render;
pub mod scene;
pub mod stages;
pub mod stats;
pub mod tuning;
pub mod waves;
