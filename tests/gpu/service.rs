//! The service with the real renderer: pictures, caches, and harmful inputs.

use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::http::Request;
use caustica::config::{Limits, RenderConfig};
use caustica::gpu::GpuError;
use caustica::gpu_queue::{GpuQueue, GpuState, QueueSettings, RenderBackend};
use caustica::http::{AppState, app};
use caustica::render::Renderer;
use serde_json::{Value, json};
use tower::ServiceExt as _;

use super::scene_files;

pub(crate) const OBJ: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

pub(crate) struct Service(pub(crate) AppState);

pub(crate) struct Reply {
    pub(crate) status: u16,
    pub(crate) media_type: String,
    pub(crate) body: Vec<u8>,
}

impl Reply {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|error| panic!("{error} in {}", String::from_utf8_lossy(&self.body)))
    }
}

impl Service {
    pub(crate) async fn start(config: RenderConfig, limits: Limits) -> Self {
        let for_thread = config.clone();
        let factory = move || Ok(Box::new(Renderer::new(&for_thread)?) as Box<dyn RenderBackend>);
        Self::with_backend(config, limits, factory).await
    }

    /// The same with a backend of one's own; ready.
    pub(crate) async fn with_backend<F>(config: RenderConfig, limits: Limits, factory: F) -> Self
    where
        F: FnMut() -> Result<Box<dyn RenderBackend>, GpuError> + Send + 'static,
    {
        let settings = QueueSettings {
            waiting: 4,
            deadline: Duration::from_secs(300),
        };
        let queue = GpuQueue::start(settings, factory).unwrap();
        let state = AppState::new(queue, limits, config);
        let mut status = state.queue().watch();
        let ready = status.wait_for(|status| status.state == GpuState::Ready);
        tokio::time::timeout(Duration::from_secs(120), ready)
            .await
            .expect("the device is ready in time")
            .unwrap();
        Self(state)
    }

    pub(crate) async fn post(
        &self,
        path: &str,
        media_type: &str,
        accept: &str,
        body: impl Into<Body>,
    ) -> Reply {
        let request = Request::post(path)
            .header("content-type", media_type)
            .header("accept", accept)
            .body(body.into())
            .unwrap();
        let response = app(self.0.clone()).oneshot(request).await.unwrap();
        Reply {
            status: response.status().as_u16(),
            media_type: response
                .headers()
                .get("content-type")
                .map_or_else(String::new, |v| v.to_str().unwrap().to_owned()),
            body: to_bytes(response.into_body(), usize::MAX)
                .await
                .unwrap()
                .to_vec(),
        }
    }

    pub(crate) async fn render(&self, scene: impl ToString) -> Reply {
        self.post("/v1/render", "application/json", "*/*", scene.to_string())
            .await
    }

    /// Image (base64) and stats of a render that must succeed.
    pub(crate) async fn render_json(&self, scene: &Value) -> (Value, Value) {
        let body = scene.to_string();
        let reply = self
            .post("/v1/render", "application/json", "application/json", body)
            .await;
        let answer = reply.json();
        assert_eq!(reply.status, 200, "{answer}");
        (answer["image"].clone(), answer["stats"].clone())
    }

    async fn upload(&self, obj: impl Into<Body>) -> Reply {
        self.post("/v1/meshes", "text/plain", "*/*", obj).await
    }

    /// The id of a mesh that must be accepted.
    pub(crate) async fn mesh(&self, obj: impl Into<Body>) -> Value {
        let reply = self.upload(obj).await;
        assert_eq!(reply.status, 201, "{}", reply.json());
        reply.json()
    }

    /// A picture of the usual scene, after whatever went before.
    pub(crate) async fn picture(&self) -> Vec<u8> {
        let reply = self.render(pool(&[])).await;
        assert_eq!(
            reply.status,
            200,
            "{}",
            String::from_utf8_lossy(&reply.body)
        );
        assert_eq!(reply.media_type, "image/png");
        reply.body
    }
}

/// Checks a refusal: status, kind, and, where one is given, the pointer of a finding.
pub(crate) fn assert_refused(reply: &Reply, status: u16, kind: &str, pointer: &str) -> Value {
    let problem = reply.json();
    assert_eq!(reply.status, status, "{problem}");
    assert_eq!(reply.media_type, "application/problem+json");
    assert_eq!(problem["status"], status);
    assert_eq!(
        problem["type"],
        format!("urn:caustica:problem:{kind}"),
        "{problem}"
    );
    if !pointer.is_empty() {
        let found = problem["errors"].as_array().unwrap();
        assert!(found.iter().any(|e| e["pointer"] == pointer), "{problem}");
    }
    problem
}

/// A small pool with waves, with values replaced or added.
pub(crate) fn pool(changes: &[(&str, Value)]) -> Value {
    let mut scene = json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9 }],
                   "absorption_per_m": [0.3, 0.06, 0.03] },
        "floor": { "depth_m": 2, "size_m": [6, 6] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1000, 1000, 1000] }],
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1, 0] },
        "quality": { "water_cells": 64, "map_texels": 64, "level_map_texels": 64 },
        "output": { "kind": "view", "width": 64, "height": 36 }
    });
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).unwrap()[key] = value.clone();
    }
    scene
}

pub(crate) fn default_service() -> impl Future<Output = Service> {
    Service::start(RenderConfig::default(), Limits::default())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_scene_gives_the_same_picture_from_the_cache() {
    let service = default_service().await;
    let teapot = std::fs::read(scene_files::folder().join("meshes/teapot.obj")).unwrap();
    let mesh = service.mesh(teapot.clone()).await;
    assert!(mesh["triangles"].as_u64().unwrap() > 1000);
    assert_eq!(service.upload(teapot).await.status, 200, "known already");

    let object = json!([{ "mesh": mesh["id"], "translation_m": [0, -1, 0], "scale": 0.5 }]);
    let scene = pool(&[("/objects", object)]);
    let (first, first_stats) = service.render_json(&scene).await;
    let (second, second_stats) = service.render_json(&scene).await;
    assert_eq!(first, second, "the bytes differ");
    let passes = |stats: &Value, list: &str| -> Vec<String> {
        let passes = stats[list].as_array().unwrap().iter();
        passes
            .map(|p| p["name"].as_str().unwrap().to_owned())
            .collect()
    };
    let of_level_map =
        |names: &[String]| names.iter().filter(|n| n.starts_with("level_map")).count();
    assert_eq!(of_level_map(&passes(&first_stats, "passes")), 2);
    assert_eq!(of_level_map(&passes(&second_stats, "passes")), 0);
    assert_eq!(of_level_map(&passes(&second_stats, "absent")), 2);
    assert_eq!(first_stats["memory"]["level_maps"]["misses"], 1);
    assert_eq!(second_stats["memory"]["level_maps"]["hits"], 1);
    assert!(second_stats["energy"][0]["closure"].as_f64().unwrap() <= 1e-5);
    for stats in [&first_stats, &second_stats] {
        let memory = &stats["memory"];
        let (planned, peak) = (&memory["planned_peak_bytes"], &memory["peak_bytes"]);
        println!("planned {planned}, held {peak}");
        assert!(peak.as_u64().unwrap() <= planned.as_u64().unwrap());
        assert!(!stats["adapter"]["name"].as_str().unwrap().is_empty());
        assert!(stats["time_ms"]["gpu"].as_f64().unwrap() > 0.0);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_scenes_are_refused_and_do_no_harm() {
    let service = default_service().await;
    let good = service.picture().await;
    let text = pool(&[]).to_string();
    let with_number =
        |number: &str| text.replacen("\"depth_m\":2", &format!("\"depth_m\":{number}"), 1);
    assert!(with_number("7") != text);
    let cases: [(&str, String, u16, &str, &str); 11] = [
        ("empty", String::new(), 400, "malformed-json", ""),
        (
            "half",
            text[..text.len() / 2].to_owned(),
            400,
            "malformed-json",
            "",
        ),
        ("NaN", with_number("NaN"), 400, "malformed-json", ""),
        (
            "\"NaN\"",
            with_number("\"NaN\""),
            422,
            "invalid-scene",
            "/floor/depth_m",
        ),
        ("1e400", with_number("1e400"), 400, "malformed-json", ""),
        (
            "negative depth",
            with_number("-1"),
            422,
            "invalid-scene",
            "/floor/depth_m",
        ),
        (
            "unknown field",
            pool(&[("/floor/dept_m", json!(1))]).to_string(),
            422,
            "invalid-scene",
            "/floor/dept_m",
        ),
        (
            "no pixels",
            pool(&[("/output/width", json!(0))]).to_string(),
            422,
            "invalid-scene",
            "/output/width",
        ),
        (
            "huge",
            pool(&[
                ("/output/width", json!(100_000)),
                ("/output/height", json!(100_000)),
            ])
            .to_string(),
            422,
            "invalid-scene",
            "/output/width",
        ),
        (
            "above the limit",
            pool(&[
                ("/output/width", json!(16_000)),
                ("/output/height", json!(16_000)),
            ])
            .to_string(),
            422,
            "limit-exceeded",
            "",
        ),
        (
            "unknown mesh",
            pool(&[(
                "/objects",
                json!([{ "mesh": format!("blake3:{}", "0".repeat(64)) }]),
            )])
            .to_string(),
            422,
            "missing-mesh",
            "/objects/0/mesh",
        ),
    ];
    for (name, body, status, kind, pointer) in cases {
        let reply = service.render(body).await;
        println!("{name}: {} {}", reply.status, reply.media_type);
        assert_refused(&reply, status, kind, pointer);
        assert!(
            service.picture().await == good,
            "{name} has changed the next picture"
        );
    }
    // The camera looks along its own up: (0, −3.5, −3) against (0, 3.5, 3) is the same line.
    let along = pool(&[("/camera/up", json!([0, 7, 6]))]);
    let reply = service.render(&along).await;
    assert_refused(&reply, 422, "invalid-scene", "/camera/up");
    assert!(service.picture().await == good);
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_meshes_are_refused_and_do_no_harm() {
    let limits = Limits {
        max_triangles: 3,
        ..Limits::default()
    };
    let strict = Service::start(RenderConfig::default(), limits).await;
    let problem = assert_refused(&strict.upload(OBJ).await, 422, "invalid-mesh", "");
    assert!(problem.to_string().contains('3'), "{problem}");
    drop(strict);

    let service = default_service().await;
    let good = service.picture().await;
    for (name, obj) in [
        ("empty", String::new()),
        ("index out of range", OBJ.replace("f 2 3 4", "f 2 3 5")),
        ("negative out of range", OBJ.replace("f 2 3 4", "f -9 3 4")),
        ("NaN", OBJ.replace("v 0 0 1", "v 0 0 nan")),
        ("infinite", OBJ.replace("v 0 0 1", "v 0 0 inf")),
        ("1e400", OBJ.replace("v 0 0 1", "v 0 0 1e400")),
        ("no text", "\u{0}\u{1}\u{2}".to_owned()),
    ] {
        let reply = service.upload(obj).await;
        println!("{name}: {}", String::from_utf8_lossy(&reply.body));
        assert_refused(&reply, 422, "invalid-mesh", "");
        assert!(
            service.picture().await == good,
            "{name} has changed the next picture"
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn odd_meshes_are_repaired_and_drawn() {
    let service = default_service().await;
    // A face without area is left out with a warning; a library elsewhere on the disk is never read.
    let flat_face = format!("{OBJ}v 2 0 0\nv 3 0 0\nf 1 5 6\n");
    let elsewhere = format!("mtllib ../../etc/passwd\nusemtl root\n{OBJ}");
    for (name, obj, warns) in [("flat face", flat_face, true), ("mtllib", elsewhere, false)] {
        let mesh = service.mesh(obj).await;
        println!("{name}: {mesh}");
        assert_eq!(mesh["triangles"], 4, "{name}");
        assert!(!mesh.to_string().contains("root:"), "{mesh}");
        if warns {
            assert!(!mesh["warnings"].as_array().unwrap().is_empty(), "{name}");
        }
        let object = json!([{ "mesh": mesh["id"], "translation_m": [0, -1, 0], "scale": 0.5 }]);
        let (_, stats) = service.render_json(&pool(&[("/objects", object)])).await;
        assert!(
            stats["energy"][0]["closure"].as_f64().unwrap() <= 1e-5,
            "{name}"
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_scene_above_the_memory_budget_is_refused_with_figures() {
    let config = RenderConfig {
        memory_budget_mib: 48,
        level_map_budget_mib: 1,
        ..RenderConfig::default()
    };
    let service = Service::start(config, Limits::default()).await;
    let good = service.picture().await;
    let large = pool(&[
        ("/quality/map_texels", json!(4096)),
        ("/quality/water_cells", json!(2048)),
    ]);
    let problem = assert_refused(&service.render(&large).await, 422, "over-budget", "");
    let text = problem.to_string();
    assert!(text.contains(&(48_u64 << 20).to_string()), "{text}");
    assert!(service.picture().await == good);

    // Level maps have a budget of their own.
    let mesh = service.mesh(OBJ).await;
    let object = json!([{ "mesh": mesh["id"], "translation_m": [0, -1, 0] }]);
    let detailed = pool(&[
        ("/objects", object),
        ("/quality/level_map_texels", json!(512)),
    ]);
    let problem = assert_refused(&service.render(&detailed).await, 422, "over-budget", "");
    assert!(
        problem.to_string().contains(&(1_u64 << 20).to_string()),
        "{problem}"
    );
    assert!(service.picture().await == good);
}
