//! Caustica renders water caustics: a scene (waves, lights, meshes, a camera) becomes a picture or an irradiance map, with
//! what it cost in time and memory and an account of every watt.
//!
//! # The life of a request
//!
//! ```text
//! scene.json ─ parse, validate, resolve ─> ResolvedScene ─> SceneFacts ─ plan ─> FramePlan
//! FramePlan ─ GPU thread ─> level maps ─> beam sets ─> estimate of the error ─> bands of the picture ─> Frame
//! Frame ─ encode (CPU) ─> PNG | EXR, and Stats
//! ```
//!
//! 1. [`scene::Scene::from_json`] reads JSON strictly; every complaint has a JSON pointer. [`methods::resolve()`] checks ranges and
//!    turns mesh ids into [`mesh::Mesh`]es.
//! 2. [`facts::SceneFacts`] holds the figures that decide what has to be done: the water's surface, which beam sets carry light to
//!    the receivers and through which rectangle of water, what the camera sees of the floor. All are in coordinates around what is
//!    looked at, so that f32 is as good far from the origin as near it.
//! 3. [`methods::of`] finds the method that the scene names, with its passes. [`plan::plan_scene`] walks the list of passes backwards
//!    from what is asked for and keeps what is needed, with a sentence for each pass that is in or out. No GPU is involved; the peak
//!    of the memory is known before anything is allocated.
//! 4. [`render::Renderer`] owns the device and the caches and runs the plan. It knows no method by name: what a pass does is in its
//!    description ([`stages::Pass`]), and bindings are matched by name from the WGSL. Level maps live in [`cache::LevelMapCache`]: one
//!    map serves every frame of an animation.
//! 5. [`frame::Frame`] holds linear f32 layers and [`stats::Stats`]; [`image::encode`] makes the file, on the CPU, so that the
//!    same request gives the same bytes.
//!
//! # How the default method carries light
//!
//! A grid of water vertices over just the rectangle that can light the receivers sends refracted rays; each ends on the floor
//! (exactly) or on a mesh (marched into its level map; at the map's edges tested against the mesh itself). A hierarchy over the objects
//! says which of them a ray may meet, and each object's surfaces along the light (`quality.layers`) are receivers of their own. Three
//! neighbouring rays bound a beam. Its flux is laid on the receiver's map in proportion to the exactly covered share of each texel,
//! never divided by a footprint that can vanish, as integer sums. Beams that straddle receivers are halved with rays of their own, and
//! their parts again while they straddle. The energy account closes: emitted = landed + absorbed + scattered + reflected + left the
//! region + missed, each summed where it happens.
//!
//! # Rooms
//!
//! A room knows the rooms below it and nothing else; `tests/cpu/rooms.rs` holds that.
//!
//! | room | holds |
//! |---|---|
//! | [`cli`], [`http`] | faces: words and status codes; each command or resource is one file |
//! | [`lab`] | studies, plots, reports, published experiments, hard cases, generated shapes; the engine never imports it |
//! | [`gpu_queue`] | the bounded queue and the one GPU thread; loss of the device and recovery |
//! | [`render`] | facts + plan → frame; the self-check |
//! | [`plan`] | what a frame awaits, and what its plan reads like |
//! | [`tuning`] | from a wanted error or time to dials |
//! | [`methods`] | one folder per published method and ours; [`methods::ALL`] is the list |
//! | [`stages`] | passes that several methods share, each with its slots |
//! | [`facts`] | what a scene boils down to: water, lights with their beam sets, receivers, output; warnings |
//! | [`cache`] | what stays on the GPU between frames |
//! | [`reference`] | float64 truth by plain rays: another algorithm, not a port; it places the scene by itself |
//! | [`accuracy`] | error of images, and a frame's estimate of its own error |
//! | [`graph`] | passes, slots, scopes and the planner's walk: generic, without water or wgpu calls |
//! | [`gpu`] | device, kernels, buffers, timing; knows nothing of water |
//! | [`image`] | PNG, EXR, tone curve |
//! | [`assets`] | what scenes refer to by content id |
//! | [`scene`] | what a request may say: types, ranges, parsing, validation |
//! | [`waves`] | the water's surface |
//! | [`mesh`] | OBJ in, repair report, ray hierarchy |
//! | [`physics`] | formulas in f64, each with its source; twins in `shaders/lib`, tied by [`physics::registry`] |
//! | [`config`] | every setting |
//! | [`calibration`] | what passes cost on one machine, and how far estimates of errors are off |

pub mod accuracy;
pub mod assets;
pub mod cache;
pub mod calibration;
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
