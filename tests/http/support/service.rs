//! A service around a fake backend.

use std::time::Duration;

use axum::body::Body;
use axum::http::{Method, Request};
use caustica::config::{Limits, RenderConfig};
use caustica::gpu_queue::{GpuQueue, GpuState, QueueSettings};
use caustica::http::{AppState, app};
use tower::ServiceExt as _;

use super::{Control, Reply};

/// A running service.
#[derive(Clone)]
pub(crate) struct Service {
    pub(crate) state: AppState,
    pub(crate) control: Control,
}

impl Service {
    /// One waiting place, a deadline that no test reaches, default limits; ready.
    pub(crate) async fn start() -> Self {
        let service = Self::with(Control::default(), settings(), Limits::default());
        service.until(|state| *state == GpuState::Ready).await;
        service
    }

    /// The same with other limits.
    pub(crate) async fn start_limited(limits: Limits) -> Self {
        let service = Self::with(Control::default(), settings(), limits);
        service.until(|state| *state == GpuState::Ready).await;
        service
    }

    /// The same with another queue.
    pub(crate) async fn start_queued(settings: QueueSettings) -> Self {
        let service = Self::with(Control::default(), settings, Limits::default());
        service.until(|state| *state == GpuState::Ready).await;
        service
    }

    /// As prepared; not waited for.
    pub(crate) fn with(control: Control, settings: QueueSettings, limits: Limits) -> Self {
        let factory = control.clone();
        let queue = GpuQueue::start(settings, move || factory.build()).unwrap();
        Self {
            state: AppState::new(queue, limits, RenderConfig::default()),
            control,
        }
    }

    /// Waits for a state of the device.
    pub(crate) async fn until(&self, wanted: impl Fn(&GpuState) -> bool) {
        let mut status = self.state.queue().watch();
        let reached = status.wait_for(|status| wanted(&status.state));
        tokio::time::timeout(Duration::from_secs(20), reached)
            .await
            .expect("the device reaches the state in time")
            .unwrap();
    }

    /// Waits for a number of jobs that wait or run.
    pub(crate) async fn until_depth(&self, depth: usize) {
        for _ in 0..1000 {
            if self.state.queue().depth() == depth {
                return;
            }
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        panic!(
            "the queue is {} deep, not {depth}",
            self.state.queue().depth()
        );
    }

    /// Sends a request and reads the whole answer.
    pub(crate) async fn send(&self, request: Request<Body>) -> Reply {
        let (method, path) = (request.method().clone(), request.uri().path().to_owned());
        let response = app(self.state.clone()).oneshot(request).await.unwrap();
        Reply::read(method, path, response).await
    }

    /// GET.
    pub(crate) async fn get(&self, path: &str) -> Reply {
        self.bare(Method::GET, path).await
    }

    /// Any method without a body.
    pub(crate) async fn bare(&self, method: Method, path: &str) -> Reply {
        let request = Request::builder().method(method).uri(path);
        self.send(request.body(Body::empty()).unwrap()).await
    }

    /// POST with a content type.
    pub(crate) async fn post(
        &self,
        path: &str,
        content_type: &str,
        body: impl Into<Body>,
    ) -> Reply {
        self.send(post(path, content_type, body)).await
    }

    /// POST of JSON.
    pub(crate) async fn post_json(&self, path: &str, body: impl ToString) -> Reply {
        self.post(path, "application/json", body.to_string()).await
    }

    /// A render that must succeed: whatever went before has done no harm.
    pub(crate) async fn assert_whole(&self) {
        let reply = self.post_json("/v1/render", super::scenes::small()).await;
        assert_eq!(reply.status, 200, "{}", reply.text());
        assert_eq!(reply.header("content-type"), "image/png");
    }
}

/// A request to send.
pub(crate) fn post(path: &str, content_type: &str, body: impl Into<Body>) -> Request<Body> {
    Request::builder()
        .method(Method::POST)
        .uri(path)
        .header("content-type", content_type)
        .body(body.into())
        .unwrap()
}

/// One waiting place and a deadline that no test reaches.
pub(crate) fn settings() -> QueueSettings {
    QueueSettings {
        waiting: 1,
        deadline: Duration::from_secs(60),
    }
}
