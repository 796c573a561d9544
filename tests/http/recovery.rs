//! Device loss, panics, failed self-checks, no device.

use std::time::{Duration, Instant};

use caustica::config::Limits;
use caustica::gpu::GpuError;
use caustica::gpu_queue::{GpuState, JobError};
use caustica::http::ProblemKind;
use caustica::render::RenderError;
use caustica::stats::CacheStats;

use super::support::service::settings;
use super::support::{Behaviour, Control, Service, scenes};

fn lost() -> Behaviour {
    Behaviour::Fail(RenderError::Gpu(GpuError::DeviceLost(
        "unplugged".to_owned(),
    )))
}

#[tokio::test]
async fn after_a_loss_the_job_runs_again_on_a_new_device() {
    let service = Service::start().await;
    service.control.script([lost()]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    let diary = service.control.diary();
    assert_eq!(
        diary,
        ["built", "render", "dropped", "built", "render", "drawn"],
        "the old device is freed before the new one is opened"
    );
    assert_eq!(service.state.queue().status().losses, 1);
    assert_eq!(service.get("/readyz").await.status, 200);
}

#[tokio::test]
async fn counts_of_caches_outlive_their_device() {
    let service = Service::start().await;
    let cache = |hits, entries| CacheStats {
        hits,
        misses: 2 * hits,
        evictions: hits + 1,
        entries,
        bytes: 100 * entries,
        budget_bytes: 1000,
    };
    service.control.set_cache(cache(7, 3));
    service.assert_whole().await;
    let mut status = service.state.queue().watch();
    let seen = status.wait_for(|status| status.level_maps == cache(7, 3));
    drop(seen.await.unwrap());

    // The next device begins with an empty cache that has counted nothing.
    service.control.hold_builds();
    service.control.script([lost()]);
    let client = {
        let service = service.clone();
        tokio::spawn(async move { service.post_json("/v1/render", scenes::small()).await })
    };
    service
        .until(|state| matches!(state, GpuState::Lost(_)))
        .await;
    let between = service.state.queue().status().level_maps;
    assert_eq!(
        between,
        CacheStats {
            entries: 0,
            bytes: 0,
            ..cache(7, 3)
        }
    );
    service.control.set_cache(CacheStats {
        evictions: 0,
        ..cache(1, 1)
    });
    service.control.release_builds();
    assert_eq!(client.await.unwrap().status, 200);
    let total = CacheStats {
        evictions: 8,
        ..cache(8, 1)
    };
    let seen = status.wait_for(|status| status.level_maps == total);
    drop(seen.await.unwrap());
}

#[tokio::test]
async fn a_second_loss_is_reported_and_recovered_from() {
    let service = Service::start().await;
    service.control.script([lost(), lost()]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::DeviceLost);
    assert!(!reply.header("retry-after").is_empty());
    assert_eq!(service.control.count("render"), 2);
    assert_eq!(service.control.count("built"), 3);
    service.until(|state| *state == GpuState::Ready).await;
    assert_eq!(service.get("/readyz").await.status, 200);
    service.assert_whole().await;
}

#[tokio::test]
async fn readiness_is_red_while_the_device_is_rebuilt() {
    let service = Service::start().await;
    service.control.hold_builds();
    service.control.script([lost()]);
    let client = {
        let service = service.clone();
        tokio::spawn(async move { service.post_json("/v1/render", scenes::small()).await })
    };
    service
        .until(|state| matches!(state, GpuState::Lost(_)))
        .await;
    let reply = service.get("/readyz").await;
    let problem = reply.problem(ProblemKind::NotReady);
    assert!(problem.obstacles[0].contains("unplugged"), "{problem:?}");
    assert_eq!(service.get("/healthz").await.status, 200);
    service.control.release_builds();
    assert_eq!(client.await.unwrap().status, 200);
    assert_eq!(service.get("/readyz").await.status, 200);
}

#[tokio::test]
async fn an_idle_device_that_is_lost_is_rebuilt_before_the_next_request() {
    let service = Service::start().await;
    service
        .control
        .fail_idle(GpuError::DeviceLost("asleep".to_owned()));
    service.control.wait_for("built", 2).await;
    service.until(|state| *state == GpuState::Ready).await;
    assert_eq!(service.control.count("render"), 0);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_hang_is_not_retried() {
    let service = Service::start().await;
    service
        .control
        .script([Behaviour::Fail(RenderError::Gpu(GpuError::Timeout(30)))]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::DeviceLost);
    assert_eq!(service.control.count("render"), 1);
    assert_eq!(service.control.count("built"), 2);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_panic_of_the_backend_is_an_answer_and_no_end() {
    let service = Service::start().await;
    service.control.script([Behaviour::Panic]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    let problem = reply.problem(ProblemKind::Internal);
    assert!(!problem.detail.contains("tangled"), "{}", problem.detail);
    assert_eq!(service.control.count("built"), 2);
    assert_eq!(service.get("/readyz").await.status, 200);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_failed_rebuild_is_reported_and_retried() {
    let service = Service::start().await;
    service
        .control
        .fail_builds([GpuError::NoAdapter("gone for good".to_owned())]);
    service.control.script([lost()]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    let problem = reply.problem(ProblemKind::NotReady);
    assert!(
        problem.detail.contains("gone for good"),
        "{}",
        problem.detail
    );
    // Until the device is back requests are refused at once.
    let before = Instant::now();
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::NotReady);
    assert!(before.elapsed() < Duration::from_secs(3));
    service.get("/readyz").await.problem(ProblemKind::NotReady);
    service.until(|state| *state == GpuState::Ready).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn without_a_device_the_service_lives_and_is_not_ready() {
    let control = Control::default();
    control.fail_builds([GpuError::NoAdapter("no Vulkan driver".to_owned())]);
    let service = Service::with(control, settings(), Limits::default());
    service
        .until(|state| matches!(state, GpuState::Failed(_)))
        .await;
    assert_eq!(service.get("/healthz").await.status, 200);
    let problem = service.get("/readyz").await.problem(ProblemKind::NotReady);
    assert!(problem.obstacles[0].contains("no Vulkan driver"));
    let reply = service.post_json("/v1/render", scenes::small()).await;
    let problem = reply.problem(ProblemKind::NotReady);
    assert!(
        problem.detail.contains("no Vulkan driver"),
        "{}",
        problem.detail
    );
    assert_eq!(service.get("/v1/meshes").await.status, 200);
}

#[tokio::test]
async fn a_device_that_fails_its_self_check_is_not_trusted() {
    let control = Control::default();
    control.fail_self_check("fresnel at 80 degrees");
    let service = Service::with(control, settings(), Limits::default());
    service.until(|state| *state == GpuState::Ready).await;
    let reply = service.get("/readyz").await;
    let problem = reply.problem(ProblemKind::NotReady);
    assert!(
        problem.obstacles[0].contains("fresnel at 80 degrees"),
        "{problem:?}"
    );
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::NotReady);
    assert_eq!(service.control.count("render"), 0);
    // A plan promises no picture.
    assert_eq!(
        service.post_json("/v1/plan", scenes::small()).await.status,
        200
    );
}

#[tokio::test]
async fn the_self_check_can_be_asked_for() {
    let service = Service::start().await;
    let check = service
        .state
        .queue()
        .self_check(Instant::now())
        .await
        .unwrap();
    assert!(check.passed);
    assert_eq!(check.checks[0].name, "snell");
}

#[tokio::test]
async fn closing_cancels_what_runs_and_refuses_the_rest() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let running = {
        let service = service.clone();
        tokio::spawn(async move { service.post_json("/v1/render", scenes::small()).await })
    };
    service.control.wait_for("render", 1).await;
    let queue = service.state.queue().clone();
    tokio::task::spawn_blocking(move || queue.close())
        .await
        .unwrap();
    running.await.unwrap().problem(ProblemKind::ShuttingDown);
    assert_eq!(service.control.diary().last().unwrap(), "dropped");
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::ShuttingDown);
    let error = service.state.queue().self_check(Instant::now()).await;
    assert_eq!(error, Err(JobError::Cancelled));
}
