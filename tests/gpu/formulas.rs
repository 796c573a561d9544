//! Every formula in f32 on this adapter against its f64 original. A broken one is detected, and the service refuses to work.

use std::collections::BTreeSet;
use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::http::Request;
use caustica::config::{Limits, RenderConfig};
use caustica::gpu::shader::ShaderSources;
use caustica::gpu_queue::{GpuQueue, QueueSettings, RenderBackend};
use caustica::http::{AppState, app};
use caustica::methods;
use caustica::physics::registry;
use caustica::render::{Renderer, twin_error};
use serde_json::{Value, json};
use tower::ServiceExt as _;

use super::harness::renderer;

const SAMPLES: usize = 20_000;

#[test]
fn every_formula_is_within_its_tolerance() {
    let renderer = renderer();
    let mut failed = Vec::new();
    for twin in registry::all() {
        let error = twin_error(renderer.gpu(), renderer.sources(), twin, SAMPLES).unwrap();
        println!(
            "{}: {:.3} of what is allowed, at {:?}",
            twin.name,
            error.share,
            &error.arguments[..twin.domain.len()]
        );
        if error.share > 1.0 {
            failed.push((twin.name, error));
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn this_machine_passes_its_self_check() {
    let mut renderer = renderer();
    let check = renderer.self_check().unwrap();
    assert!(check.passed, "{check:?}");
    assert_eq!(check.checks.len(), registry::all().count() + 2);
    renderer.gpu().check().unwrap();
}

/// Ways to break each formula slightly: file, text, replacement.
const BROKEN: [(&str, &str, &str); 11] = [
    (
        "lib/fresnel.wgsl",
        "return 0.5 * (r_s * r_s + r_p * r_p);",
        "return 0.501 * (r_s * r_s + r_p * r_p);",
    ),
    (
        "lib/fresnel.wgsl",
        "return 2.0 * cos_i",
        "return 2.001 * cos_i",
    ),
    (
        "lib/refraction.wgsl",
        "(eta - 1.0) * (eta + 1.0)",
        "(eta - 1.0) * (eta + 1.001)",
    ),
    (
        "lib/attenuation.wgsl",
        "return exp(-c_per_m * length_m);",
        "return exp(-1.001 * c_per_m * length_m);",
    ),
    ("lib/turns.wgsl", "* 6.2831853;", "* 6.2831;"),
    (
        "lib/coverage.wgsl",
        "let m_b = max(x_b, 0.0);",
        "let m_b = max(x_b, 0.001);",
    ),
    (
        "lib/sky.wgsl",
        "return normal_y; }",
        "return 1.01 * normal_y; }",
    ),
    ("lib/solid_angle.wgsl", "+ 1.99777106478e-1)", "+ 1.998e-1)"),
    (
        "lib/slicing.wgsl",
        "(index / (planes - 1.0))",
        "(index / (planes - 0.999))",
    ),
    ("lib/octahedral.wgsl", "abs(v) - 1.0;", "abs(v) - 1.0001;"),
    (
        "lib/interpolated_flux.wgsl",
        "2.0 * mixed * upper_density) / 3.0",
        "2.001 * mixed * upper_density) / 3.0",
    ),
];

fn broken(index: usize) -> ShaderSources {
    let (file, from, to) = BROKEN[index];
    methods::embedded()
        .with_replacement(file, from, to)
        .unwrap_or_else(|| panic!("`{from}` is not in {file}"))
}

#[test]
fn every_broken_formula_is_found() {
    // Every file of formulas is broken once at least.
    let files: BTreeSet<&str> = registry::all().map(|twin| twin.file).collect();
    let broken_files: BTreeSet<&str> = BROKEN.iter().map(|(file, ..)| *file).collect();
    assert_eq!(broken_files, files);
    let renderer = renderer();
    for (index, (file, _, to)) in BROKEN.iter().enumerate() {
        let sources = broken(index);
        let worst = registry::all()
            .filter(|twin| twin.file == *file)
            .map(|twin| {
                twin_error(renderer.gpu(), &sources, twin, 512)
                    .unwrap()
                    .share
            })
            .fold(0.0, f64::max);
        println!("{to}: {worst:.1}");
        assert!(worst > 1.0, "{file} with `{to}` passes: {worst}");
    }
}

#[test]
fn a_formula_that_gives_no_number_is_found() {
    let renderer = renderer();
    let sources = methods::embedded()
        .with_replacement(
            "lib/attenuation.wgsl",
            "return exp(-c_per_m * length_m);",
            "return sqrt(-1.0 - c_per_m * length_m);",
        )
        .unwrap();
    let twin = registry::all()
        .find(|twin| twin.name == "transmission")
        .unwrap();
    let error = twin_error(renderer.gpu(), &sources, twin, 512).unwrap();
    assert_eq!(error.share, f64::INFINITY);
}

#[test]
fn a_replacement_that_is_not_there_is_refused() {
    let sources = methods::embedded();
    assert!(
        sources
            .clone()
            .with_replacement("lib/sky.wgsl", "no such text", "")
            .is_none()
    );
    assert!(
        sources
            .with_replacement("lib/none.wgsl", "a", "b")
            .is_none()
    );
}

/// A broken renderer behind the whole service: it says why it is not ready, and renders nothing.
#[tokio::test(flavor = "multi_thread")]
async fn a_service_with_a_broken_formula_is_not_ready() {
    let settings = QueueSettings {
        waiting: 1,
        deadline: Duration::from_secs(300),
    };
    let queue = GpuQueue::start(settings, || {
        let renderer = Renderer::with_shaders(&RenderConfig::default(), broken(0))?;
        Ok(Box::new(renderer) as Box<dyn RenderBackend>)
    })
    .unwrap();
    let state = AppState::new(queue, Limits::default(), RenderConfig::default());
    let mut status = state.queue().watch();
    let checked = status.wait_for(|status| status.self_check.is_some());
    tokio::time::timeout(Duration::from_secs(120), checked)
        .await
        .expect("the self-check ends in time")
        .unwrap();

    let ready = Request::get("/readyz").body(Body::empty()).unwrap();
    let scene = json!({ "floor": { "depth_m": 1, "size_m": [2, 2] },
                        "output": { "kind": "irradiance_map", "receiver": "floor", "width": 4, "height": 4 } });
    let render = Request::post("/v1/render")
        .header("content-type", "application/json")
        .body(Body::from(scene.to_string()))
        .unwrap();
    for request in [ready, render] {
        let path = request.uri().path().to_owned();
        let response = app(state.clone()).oneshot(request).await.unwrap();
        assert_eq!(response.status(), 503, "{path}");
        assert_eq!(
            response.headers()["content-type"],
            "application/problem+json"
        );
        let body = to_bytes(response.into_body(), usize::MAX).await.unwrap();
        let problem: Value = serde_json::from_slice(&body).unwrap();
        assert_eq!(problem["status"], 503);
        let text = problem.to_string();
        assert!(text.contains("fresnel_reflectance"), "{text}");
    }
    let alive = Request::get("/healthz").body(Body::empty()).unwrap();
    assert_eq!(app(state).oneshot(alive).await.unwrap().status(), 200);
}
