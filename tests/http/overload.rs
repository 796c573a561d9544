//! Full queue, deadline, clients that disconnect.

use std::time::{Duration, Instant};

use caustica::gpu_queue::QueueSettings;
use caustica::http::ProblemKind;

use super::support::{Behaviour, Reply, Service, scenes};

/// Starts a render that waits for the gate, and waits until it runs.
async fn occupy(service: &Service) -> tokio::task::JoinHandle<Reply> {
    let begun = service.control.count("render");
    service.control.script([Behaviour::Block]);
    let running = start(service);
    service.control.wait_for("render", begun + 1).await;
    running
}

fn start(service: &Service) -> tokio::task::JoinHandle<Reply> {
    let service = service.clone();
    tokio::spawn(async move { service.post_json("/v1/render", scenes::small()).await })
}

fn hasty(waiting: usize) -> QueueSettings {
    QueueSettings {
        waiting,
        deadline: Duration::from_millis(300),
    }
}

#[tokio::test]
async fn one_too_many_is_refused_at_once() {
    let service = Service::start().await;
    let running = occupy(&service).await;
    let waiting = start(&service);
    service.until_depth(2).await;

    let before = Instant::now();
    let reply = service.post_json("/v1/render", scenes::small()).await;
    assert!(before.elapsed() < Duration::from_secs(5));
    reply.problem(ProblemKind::QueueFull);
    let seconds: u64 = reply.header("retry-after").parse().unwrap();
    assert!((1..=60).contains(&seconds));
    // Plans need the thread too.
    let plan = service.post_json("/v1/plan", scenes::small()).await;
    plan.problem(ProblemKind::QueueFull);
    // A full queue is no reason to send traffic elsewhere for good.
    let ready = service.get("/readyz").await;
    assert_eq!(ready.status, 200);
    assert_eq!(
        ready.json::<serde_json::Value>()["would_accept_work"],
        false
    );

    service.control.open_gate();
    assert_eq!(running.await.unwrap().status, 200);
    assert_eq!(waiting.await.unwrap().status, 200);
    assert_eq!(service.control.count("render"), 2);
    service.until_depth(0).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn a_queue_without_waiting_places_serves_one() {
    let service = Service::start_queued(QueueSettings {
        waiting: 0,
        deadline: Duration::from_secs(60),
    })
    .await;
    let running = occupy(&service).await;
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::QueueFull);
    service.control.open_gate();
    assert_eq!(running.await.unwrap().status, 200);
}

#[tokio::test]
async fn the_time_in_the_queue_is_measured() {
    let service = Service::start().await;
    let running = occupy(&service).await;
    let waiting = start(&service);
    service.until_depth(2).await;
    tokio::time::sleep(Duration::from_millis(50)).await;
    service.control.open_gate();
    running.await.unwrap();
    let timing = waiting.await.unwrap().header("server-timing").to_owned();
    let queued = timing.strip_prefix("queue;dur=").unwrap();
    let queued: f64 = queued.split(',').next().unwrap().parse().unwrap();
    assert!(queued >= 50.0, "{timing}");
}

#[tokio::test]
async fn a_job_whose_deadline_passes_in_the_queue_never_runs() {
    let service = Service::start_queued(hasty(4)).await;
    service.control.script([Behaviour::BlockDeaf]);
    let running = start(&service);
    service.control.wait_for("render", 1).await;
    let late = service.post_json("/v1/render", scenes::small()).await;
    let problem = late.problem(ProblemKind::DeadlinePassed);
    assert!(problem.detail.contains("0.3"), "{}", problem.detail);
    assert!(!late.header("retry-after").is_empty());
    // The one that runs has met its deadline as well, and holds its place until it ends.
    running.await.unwrap().problem(ProblemKind::DeadlinePassed);
    assert_eq!(service.state.queue().depth(), 1);
    service.control.open_gate();
    service.until_depth(0).await;
    assert_eq!(service.control.count("render"), 1);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_render_whose_deadline_passes_is_cancelled() {
    let service = Service::start_queued(hasty(4)).await;
    let running = occupy(&service).await;
    running.await.unwrap().problem(ProblemKind::DeadlinePassed);
    service.control.wait_for("render cancelled", 1).await;
    service.until_depth(0).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn a_client_that_leaves_the_queue_is_never_served() {
    let service = Service::start().await;
    let running = occupy(&service).await;
    let waiting = start(&service);
    service.until_depth(2).await;
    waiting.abort();
    service.until_depth(1).await;
    service.control.open_gate();
    assert_eq!(running.await.unwrap().status, 200);
    service.until_depth(0).await;
    assert_eq!(service.control.count("render"), 1);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_client_that_leaves_cancels_its_render() {
    let service = Service::start().await;
    let running = occupy(&service).await;
    running.abort();
    service.control.wait_for("render cancelled", 1).await;
    service.until_depth(0).await;
    service.assert_whole().await;
    let metrics = service.get("/metrics").await.text();
    assert!(
        metrics.contains(r#"method="POST",route="/v1/render",status="499""#),
        "{metrics}"
    );
}

#[tokio::test]
async fn an_abandoned_render_keeps_its_place_until_it_ends() {
    // Otherwise clients that come and go could pile up work without bound.
    let service = Service::start_queued(QueueSettings {
        waiting: 0,
        deadline: Duration::from_secs(60),
    })
    .await;
    let running = occupy(&service).await;
    assert_eq!(service.state.queue().depth(), 1);
    running.abort();
    service.control.wait_for("render cancelled", 1).await;
    service.until_depth(0).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn many_clients_are_each_served_or_refused() {
    let service = Service::start_queued(QueueSettings {
        waiting: 3,
        deadline: Duration::from_secs(60),
    })
    .await;
    let running = occupy(&service).await;
    let clients: Vec<_> = (0..10).map(|_| start(&service)).collect();
    service.until_depth(4).await;
    tokio::time::sleep(Duration::from_millis(100)).await;
    service.control.open_gate();
    let mut statuses = vec![running.await.unwrap().status];
    for client in clients {
        statuses.push(client.await.unwrap().status);
    }
    let served = statuses.iter().filter(|status| **status == 200).count();
    let refused = statuses.iter().filter(|status| **status == 429).count();
    assert_eq!((served, refused), (4, 7), "{statuses:?}");
    assert_eq!(service.control.count("render"), 4);
}
