//! Caustica renders water caustics. It turns a scene (waves, lights, meshes, a camera) into a picture or an irradiance map. With it
//! come the time and memory of every pass, and an energy account that says where the light went.
//!
//! `docs/glossary.md` explains the terms, `docs/adding-a-method.md` how to add a method.
//!
//! # The life of a request
//!
//! ```text
//! scene.json ─ parse, validate, resolve ─> ResolvedScene ─> SceneFacts ─ plan ─> FramePlan
//! FramePlan ─ GPU thread ─> level maps ─> beam sets ─> estimate of the error ─> bands of the picture ─> Frame
//! Frame ─ encode (CPU) ─> PNG | EXR, and Stats
//! ```
//!
//! 1. [`scene::Scene::from_json`] reads JSON strictly: unknown fields are errors, and every error has a JSON pointer.
//!    [`methods::resolve()`] checks ranges and turns mesh ids into [`mesh::Mesh`]es, and ids of height fields into [`fields::Field`]s.
//! 2. [`facts::SceneFacts`] holds what decides which work is needed: the water's surface, the beam sets that light the receivers, the
//!    rectangle of water that each beam set passes through (its window), and what the camera sees of the floor. Its coordinates are
//!    relative to the visible region, so that f32 is as accurate far from the origin as near it.
//!    Facts are known before the job reaches the GPU thread, with one exception: for `target_error` and `time_budget_ms`, the facts of
//!    trial settings are derived on that thread (`src/render/tune.rs`).
//! 3. [`methods::of`] finds the method that the scene names, with its passes. [`plan::plan_scene`] walks the list of passes backwards
//!    from the requested output and keeps the passes that are needed. Each pass gets a sentence that says why it is present or absent.
//!    No GPU is involved, and the peak memory is known before anything is allocated.
//! 4. [`render::Renderer`] owns the device and the caches and runs the plan. It knows no method by name. What a pass does is in its
//!    description ([`stages::Pass`]), and bindings are matched by name from the WGSL. Level maps live in [`cache::LevelMapCache`]: one
//!    map serves every frame of an animation. Fields of light live in [`cache::FieldCache`]: one serves every frame in which only receivers or
//!    the camera move.
//! 5. [`frame::Frame`] holds linear f32 layers and [`stats::Stats`]. [`image::encode`] makes the file on the CPU, so that the
//!    same request gives the same bytes.
//!
//! # How the default method carries light
//!
//! A grid of water vertices covers the window: the rectangle of water that can light the receivers. Each vertex sends one refracted ray.
//! A ray ends on the floor (computed exactly) or on a mesh (found by marching through its level map, and at the map's edges by testing
//! the mesh itself). A hierarchy over the objects selects those that a ray may meet. Each layer of an object (`quality.layers`) is a
//! receiver of its own.
//!
//! Three neighbouring rays bound a beam. Its flux is deposited on the receiver's map as integer sums, in proportion to the exactly covered
//! share of each texel. It is never divided by the area of the footprint, which can vanish. A beam whose corners end on different
//! receivers is split with additional exact rays, and so are its pieces that still straddle receivers.
//!
//! The energy account closes: emitted = landed + absorbed + scattered + reflected + left the region + missed. Each term is summed where it
//! happens.
//!
//! # Rooms
//!
//! A *room* is a module of this crate. It uses only rooms below it in this table; `tests/cpu/rooms.rs` checks that.
//!
//! | room | holds |
//! |---|---|
//! | [`cli`] | the command line: arguments, texts and exit codes; each command is one file |
//! | [`http`] | the HTTP service: routes and status codes; each resource is one file |
//! | [`lab`] | studies, comparisons of methods, plots, reports, published experiments, hard cases, generated shapes; only `cli` and `http` use it |
//! | [`gpu_queue`] | the bounded queue and the one GPU thread; loss of the device and recovery |
//! | [`render`] | facts + plan → frame; the self-check |
//! | [`tuning`] | chooses dials for a target error or time, and says which method fits an error |
//! | [`plan`] | which results a frame needs, and the plan as text and JSON |
//! | [`methods`] | one folder per method, published or our own; [`methods::ALL`] is the list |
//! | [`stages`] | passes that several methods share, each with its slots |
//! | [`cache`] | what is kept on the GPU between frames |
//! | [`facts`] | what is derived from a scene: water, lights with their beam sets, receivers, output, warnings |
//! | [`reference`] | float64 truth by plain rays: an independent algorithm, not a port; it also derives the scene's geometry independently |
//! | [`accuracy`] | error metrics of images, and a frame's estimate of its own error |
//! | [`image`] | PNG, EXR, tone curve |
//! | [`frame`] | a rendered frame: linear f32 layers and their stats |
//! | [`assets`] | files that scenes refer to by content id |
//! | [`waves`] | the water's surface |
//! | [`scene`] | what a request may contain: types, ranges, parsing, validation |
//! | [`fronts`] | fields of light from its fronts: the eikonal equation and the wave equation under water, on the CPU |
//! | [`kept`] | computed results that may serve again, within a budget of bytes |
//! | [`fields`] | reading arrays of numbers: NPY, EXR, 16-bit PNG |
//! | [`mesh`] | reading OBJ, repairs with a report, ray hierarchy |
//! | [`graph`] | passes, slots, scopes and the planner's walk: generic, without water or wgpu calls |
//! | [`gpu`] | device, kernels, buffers, timing; knows nothing of water |
//! | [`output_files`] | writing files whole; what killed processes leave |
//! | [`physics`] | formulas in f64, each with its source; [`physics::registry`] pairs them with their twins in `shaders/lib` |
//! | [`stats`] | the cost of a frame, its energy account and its warnings |
//! | [`log`] | text on its way to a stream that may block or fail |
//! | [`config`] | every setting |
//! | [`calibration`] | what passes cost on one machine, how far error estimates may be off, and what each method achieves in a time |

pub mod accuracy;
pub mod assets;
pub mod cache;
pub mod calibration;
pub mod cli;
pub mod config;
pub mod facts;
pub mod fields;
pub mod frame;
pub mod fronts;
pub mod gpu;
pub mod gpu_queue;
pub mod graph;
pub mod http;
pub mod image;
pub mod kept;
pub mod lab;

pub mod log;
pub mod mesh;
pub mod methods;
pub mod output_files;
pub mod physics;
pub mod plan;
pub mod reference;
pub mod render;
pub mod scene;
pub mod stages;
pub mod stats;
pub mod tuning;
pub mod waves;
