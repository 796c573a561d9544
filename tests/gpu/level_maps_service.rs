//! Level maps behind HTTP, with the real renderer: warm-ups, deleted meshes, budgets, and the loss of the device.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::body::Body;
use axum::http::Request;
use caustica::cache::{WarmUp, WarmedMap};
use caustica::config::{Limits, RenderConfig};
use caustica::frame::Frame;
use caustica::gpu::GpuError;
use caustica::gpu_queue::RenderBackend;
use caustica::http::app;
use caustica::mesh::Mesh;
use caustica::plan::Plan;
use caustica::render::{Prepared, RenderError, Renderer, SelfCheck};
use caustica::stats::{AdapterStats, CacheStats};
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;
use tower::ServiceExt as _;

use super::service::{OBJ, Service, assert_refused, default_service, pool};

/// The usual scene with the usual mesh.
fn with_mesh(id: &Value, changes: &[(&str, Value)]) -> Value {
    let object = json!([{ "mesh": id, "translation_m": [-0.5, -1.5, -0.5] }]);
    let mut all = vec![("/objects", object)];
    all.extend_from_slice(changes);
    pool(&all)
}

/// Hits and misses of a frame.
fn counts(stats: &Value) -> (u64, u64) {
    let cache = &stats["memory"]["level_maps"];
    let count = |name: &str| cache[name].as_u64().unwrap();
    (count("hits"), count("misses"))
}

/// Waits for what the service says of its cache.
async fn until_cache(service: &Service, wanted: impl Fn(&CacheStats) -> bool) {
    let mut status = service.0.queue().watch();
    let seen = status.wait_for(|status| wanted(&status.level_maps));
    let seen = tokio::time::timeout(std::time::Duration::from_secs(60), seen).await;
    drop(seen.expect("the cache gets there in time").unwrap());
}

/// A line of `/metrics` as a number.
async fn metric(service: &Service, name: &str) -> f64 {
    let request = Request::get("/metrics").body(Body::empty()).unwrap();
    let response = app(service.0.clone()).oneshot(request).await.unwrap();
    let body = axum::body::to_bytes(response.into_body(), usize::MAX).await;
    let text = String::from_utf8(body.unwrap().to_vec()).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix(name));
    line.unwrap_or_else(|| panic!("no {name} in\n{text}"))
        .trim()
        .parse()
        .unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_warms_the_first_frame() {
    let service = default_service().await;
    // The scene's sun stands at azimuth 0.
    let address = "/v1/meshes?warm=60,0&warm=35,120&warm_texels=64";
    let reply = service.post(address, "text/plain", "*/*", OBJ).await;
    let uploaded = reply.json();
    assert_eq!(reply.status, 201, "{uploaded}");
    let warmed = uploaded["warmed"].as_array().unwrap();
    let told: Vec<_> = warmed
        .iter()
        .map(|map| (&map["elevation_deg"], &map["texels"], &map["cached"]))
        .collect();
    let (no, texels) = (json!(false), json!(64));
    assert_eq!(
        told,
        [(&json!(60.0), &texels, &no), (&json!(35.0), &texels, &no)]
    );
    let id = &uploaded["id"];
    let plan = service
        .post(
            "/v1/plan",
            "application/json",
            "*/*",
            with_mesh(id, &[]).to_string(),
        )
        .await
        .json();
    let planned = plan["passes"].as_array().unwrap();
    assert!(
        planned
            .iter()
            .all(|pass| !pass["name"].as_str().unwrap().starts_with("level_map"))
    );
    let (picture, stats) = service.render_json(&with_mesh(id, &[])).await;
    assert_eq!(counts(&stats), (1, 0));
    // Another sun than those two has to be drawn.
    let other = [("/lights/0/elevation_deg", json!(50))];
    let (_, stats) = service.render_json(&with_mesh(id, &other)).await;
    assert_eq!(counts(&stats), (0, 1));
    // Once more: everything is there, and is said to be.
    let again = service.post(address, "text/plain", "*/*", OBJ).await;
    assert_eq!(again.status, 200);
    let cached = again.json()["warmed"].as_array().unwrap().clone();
    assert!(cached.iter().all(|map| map["cached"] == true), "{cached:?}");
    // A service that was not warmed draws the same picture.
    let cold = default_service().await;
    cold.mesh(OBJ).await;
    let (other, stats) = cold.render_json(&with_mesh(id, &[])).await;
    assert_eq!(counts(&stats), (0, 1));
    assert!(picture == other, "a warm map changes the picture");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_deleted_mesh_frees_its_maps() {
    let service = default_service().await;
    let id = service.mesh(OBJ).await["id"].clone();
    let other = service.mesh(OBJ.replace("v 1 0 0", "v 2 0 0")).await["id"].clone();
    let low = [("/lights/0/elevation_deg", json!(30))];
    service.render_json(&with_mesh(&id, &[])).await;
    service.render_json(&with_mesh(&id, &low)).await;
    service.render_json(&with_mesh(&other, &[])).await;
    until_cache(&service, |cache| cache.entries == 3).await;
    let bytes = service.0.queue().status().level_maps.bytes;

    let address = format!("/v1/meshes/{}", id.as_str().unwrap());
    let request = Request::delete(address).body(Body::empty()).unwrap();
    let response = app(service.0.clone()).oneshot(request).await.unwrap();
    assert_eq!(response.status().as_u16(), 204);
    until_cache(&service, |cache| cache.entries == 1).await;
    let after = service.0.queue().status().level_maps;
    assert_eq!((after.bytes, after.evictions), (bytes / 3, 0));
    assert_eq!(
        metric(&service, "caustica_level_map_cache_entries ").await,
        1.0
    );
    assert_eq!(
        metric(&service, "caustica_level_map_cache_bytes ").await,
        (bytes / 3) as f64
    );
    // The other mesh has kept its map, and the deleted one begins anew.
    let (_, stats) = service.render_json(&with_mesh(&other, &[])).await;
    assert_eq!(counts(&stats), (1, 0));
    assert_eq!(service.mesh(OBJ).await["id"], id);
    let (_, stats) = service.render_json(&with_mesh(&id, &[])).await;
    assert_eq!(counts(&stats), (0, 1));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_budget_for_no_map_is_reported_and_does_no_harm() {
    let config = RenderConfig {
        level_map_budget_mib: 1,
        ..RenderConfig::default()
    };
    let service = Service::start(config, Limits::default()).await;
    let good = service.picture().await;
    // 512 texels: (front, back) at ten levels, and the normals.
    let needed = 4 * (512_u64 * 512 + 2 * (0..10).map(|l| (512_u64 >> l).pow(2)).sum::<u64>());
    let assert_told = |problem: &Value| {
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("CAUSTICA_LEVEL_MAP_BUDGET_MIB"), "{detail}");
        assert_eq!(problem["needed_bytes"], needed);
        assert_eq!(problem["budget_bytes"], 1 << 20);
        assert_eq!(problem["retryable"], false);
    };

    // The mesh is welcome, the warm-up is not.
    let address = "/v1/meshes?warm=60,0&warm_texels=512";
    let reply = service.post(address, "text/plain", "*/*", OBJ).await;
    assert_eq!(reply.status, 201, "{}", reply.json());
    let uploaded = reply.json();
    assert_eq!(uploaded["warmed"], json!([]));
    let problem = &uploaded["warm_problem"];
    assert_eq!(problem["type"], "urn:caustica:problem:over-budget");
    assert_told(problem);

    let fine = [("/quality/level_map_texels", json!(512))];
    let scene = with_mesh(&uploaded["id"], &fine);
    let refused = service.render(&scene).await;
    assert_told(&assert_refused(&refused, 422, "over-budget", ""));
    assert!(service.picture().await == good, "a scene without meshes");
    let (_, stats) = service.render_json(&with_mesh(&uploaded["id"], &[])).await;
    assert_eq!(counts(&stats), (0, 1));
}

/// The real renderer on a device that can be taken away.
struct Breakable {
    renderer: Renderer,
    unplug: Arc<AtomicBool>,
}

impl Breakable {
    /// Loses the device, once per pull of the plug.
    fn maybe_lose(&self) {
        if self.unplug.swap(false, Ordering::SeqCst) {
            self.renderer.gpu().device.destroy();
        }
    }
}

impl RenderBackend for Breakable {
    fn adapter(&self) -> AdapterStats {
        self.renderer.adapter()
    }

    fn dial_basis(&self) -> String {
        self.renderer.dial_basis()
    }

    fn plan(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError> {
        self.renderer.plan_prepared(prepared, cancel)
    }

    fn render(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        self.maybe_lose();
        self.renderer.render_prepared(prepared, cancel)
    }

    fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError> {
        self.maybe_lose();
        self.renderer.warm(mesh, wanted, cancel)
    }

    fn self_check(&mut self) -> Result<SelfCheck, GpuError> {
        self.renderer.self_check()
    }

    fn forget_mesh(&mut self, id: &str) {
        self.renderer.forget_mesh(id);
    }

    fn level_map_cache(&self) -> CacheStats {
        self.renderer.level_map_cache()
    }

    fn idle(&mut self) -> Result<(), GpuError> {
        self.maybe_lose();
        self.renderer.idle()
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn after_the_loss_of_the_device_the_maps_are_built_again() {
    let config = RenderConfig::default();
    let unplug = Arc::new(AtomicBool::new(false));
    let (for_thread, plug) = (config.clone(), Arc::clone(&unplug));
    let service = Service::with_backend(config, Limits::default(), move || {
        Ok(Box::new(Breakable {
            renderer: Renderer::new(&for_thread)?,
            unplug: Arc::clone(&plug),
        }))
    })
    .await;
    let id = service.mesh(OBJ).await["id"].clone();
    let scene = with_mesh(&id, &[]);
    let (first, stats) = service.render_json(&scene).await;
    assert_eq!(counts(&stats), (0, 1));
    let (second, stats) = service.render_json(&scene).await;
    assert_eq!(counts(&stats), (1, 0));

    // During a render: it runs again, on a device without maps.
    unplug.store(true, Ordering::SeqCst);
    let (third, stats) = service.render_json(&scene).await;
    assert_eq!(counts(&stats), (0, 1), "the maps of the lost device");
    assert_eq!(service.0.queue().status().losses, 1);

    // In idleness: the cache is seen to be empty before anybody asks.
    unplug.store(true, Ordering::SeqCst);
    let mut status = service.0.queue().watch();
    let rebuilt = status.wait_for(|status| status.losses == 2 && status.self_check.is_some());
    let rebuilt = tokio::time::timeout(std::time::Duration::from_secs(120), rebuilt).await;
    drop(rebuilt.expect("the device is rebuilt in time").unwrap());
    let cache = service.0.queue().status().level_maps;
    assert_eq!((cache.entries, cache.bytes), (0, 0));
    assert_eq!(
        (cache.hits, cache.misses),
        (1, 2),
        "counts outlive the device"
    );
    let (fourth, stats) = service.render_json(&scene).await;
    assert_eq!(counts(&stats), (0, 1));
    assert!(
        first == second && second == third && third == fourth,
        "the bytes differ"
    );

    // During a warm-up: what it builds is on the new device.
    unplug.store(true, Ordering::SeqCst);
    let reply = service
        .post(
            "/v1/meshes?warm=60,0&warm_texels=64",
            "text/plain",
            "*/*",
            OBJ,
        )
        .await;
    assert_eq!(
        reply.json()["warmed"][0]["cached"],
        false,
        "{}",
        reply.json()
    );
    assert_eq!(service.0.queue().status().losses, 3);
    let (fifth, stats) = service.render_json(&scene).await;
    assert_eq!(counts(&stats), (1, 0));
    assert!(fifth == first);
}
