//! A real socket: start, drain, shutdown.

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::time::Duration;

use caustica::config::{Limits, RenderConfig, ServeConfig};
use caustica::gpu::GpuError;
use caustica::http::{ConnectionLimits, ServeError, serve, serve_on, serve_with};
use tokio::net::TcpListener;
use tokio::task::{JoinHandle, spawn_blocking};
use tokio_util::sync::CancellationToken;

use super::support::{Behaviour, Control, Service, scenes};

struct Running {
    service: Service,
    address: SocketAddr,
    stop: CancellationToken,
    server: JoinHandle<Result<(), ServeError>>,
}

async fn run(drain: Duration) -> Running {
    let service = Service::start().await;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let stop = CancellationToken::new();
    let server = tokio::spawn(serve_on(
        listener,
        service.state.clone(),
        ConnectionLimits::default(),
        drain,
        stop.clone().cancelled_owned(),
    ));
    Running {
        service,
        address,
        stop,
        server,
    }
}

/// Sends raw bytes and reads until the server closes.
fn exchange(address: SocketAddr, request: &str, hang_up: bool) -> std::io::Result<String> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(Duration::from_secs(20)))?;
    stream.write_all(request.as_bytes())?;
    if hang_up {
        stream.shutdown(Shutdown::Write)?;
    }
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer)?;
    Ok(String::from_utf8_lossy(&answer).into_owned())
}

fn get(path: &str) -> String {
    format!("GET {path} HTTP/1.1\r\nhost: test\r\nconnection: close\r\n\r\n")
}

fn render() -> String {
    let scene = scenes::small().to_string();
    format!(
        "POST /v1/render HTTP/1.1\r\nhost: test\r\nconnection: close\r\ncontent-type: application/json\r\n\
         content-length: {}\r\n\r\n{scene}",
        scene.len()
    )
}

async fn ask(address: SocketAddr, request: String) -> std::io::Result<String> {
    spawn_blocking(move || exchange(address, &request, false))
        .await
        .unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_shutdown_drains_refuses_and_finishes() {
    let running = run(Duration::from_millis(600)).await;
    let address = running.address;
    assert!(
        ask(address, get("/readyz"))
            .await
            .unwrap()
            .starts_with("HTTP/1.1 200")
    );

    running.service.control.script([Behaviour::Block]);
    let in_flight = tokio::spawn(ask(address, render()));
    running.service.control.wait_for("render", 1).await;
    running.stop.cancel();
    // Draining: not ready, still accepting.
    tokio::time::sleep(Duration::from_millis(100)).await;
    let ready = ask(address, get("/readyz")).await.unwrap();
    assert!(ready.starts_with("HTTP/1.1 503"), "{ready}");
    assert!(ready.contains("shutting down"));
    assert!(
        ask(address, get("/healthz"))
            .await
            .unwrap()
            .starts_with("HTTP/1.1 200")
    );
    // Then refusing, with the render still in flight.
    let mut refused = false;
    for _ in 0..100 {
        tokio::time::sleep(Duration::from_millis(30)).await;
        refused = ask(address, get("/healthz")).await.is_err();
        if refused {
            break;
        }
    }
    assert!(refused, "connections are still accepted");
    assert!(!running.server.is_finished());
    running.service.control.open_gate();
    let answer = in_flight.await.unwrap().unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    tokio::time::timeout(Duration::from_secs(10), running.server)
        .await
        .expect("the server ends")
        .unwrap()
        .unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connection_that_closes_cancels_its_render() {
    let running = run(Duration::ZERO).await;
    running.service.control.script([Behaviour::Block]);
    let address = running.address;
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(render().as_bytes()).unwrap();
    running.service.control.wait_for("render", 1).await;
    drop(stream);
    running
        .service
        .control
        .wait_for("render cancelled", 1)
        .await;
    assert!(
        ask(address, render())
            .await
            .unwrap()
            .starts_with("HTTP/1.1 200")
    );
    running.stop.cancel();
    running.server.await.unwrap().unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_that_breaks_off_is_reported() {
    let running = run(Duration::ZERO).await;
    let address = running.address;
    let cut = render().replace("content-length: ", "content-length: 9");
    let answer = spawn_blocking(move || exchange(address, &cut, true))
        .await
        .unwrap()
        .unwrap();
    // A client that has closed its side may be given up without an answer; if there is one, it says what happened.
    assert!(
        answer.is_empty() || answer.contains("urn:caustica:problem:malformed-body"),
        "{answer}"
    );
    assert!(
        ask(address, render())
            .await
            .unwrap()
            .starts_with("HTTP/1.1 200")
    );
    assert_eq!(running.service.control.count("render"), 1);
    running.stop.cancel();
    running.server.await.unwrap().unwrap();
}

fn config(address: SocketAddr) -> ServeConfig {
    ServeConfig {
        listen: address.into(),
        queue: 1,
        deadline_s: 60,
        drain_s: 0,
        max_connections: 64,
        idle_timeout_s: 60,
        cors_origin: Vec::new(),
        log_json: false,
    }
}

#[tokio::test]
async fn an_address_in_use_is_an_error() {
    let taken = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = taken.local_addr().unwrap();
    let error = serve(RenderConfig::default(), Limits::default(), config(address))
        .await
        .unwrap_err();
    assert!(matches!(error, ServeError::Listen { .. }), "{error}");
    assert!(error.to_string().contains(&address.to_string()));
    assert!(!error.is_refusal(), "the port may be free later");
}

#[tokio::test]
async fn an_address_of_another_machine_is_refused() {
    // TEST-NET-1 (RFC 5737) belongs to no machine.
    let address = SocketAddr::from(([192, 0, 2, 1], 0));
    let error = serve(RenderConfig::default(), Limits::default(), config(address))
        .await
        .unwrap_err();
    assert!(error.to_string().contains("192.0.2.1:0"), "{error}");
    assert!(error.is_refusal());
}

#[tokio::test]
async fn a_name_that_does_not_resolve_may_resolve_later() {
    let mut config = config(SocketAddr::from(([127, 0, 0, 1], 0)));
    config.listen = "no-such-host.invalid:8080".parse().unwrap();
    let error = serve(RenderConfig::default(), Limits::default(), config)
        .await
        .unwrap_err();
    assert!(matches!(error, ServeError::Resolve { .. }), "{error}");
    assert!(
        error.to_string().contains("no-such-host.invalid"),
        "{error}"
    );
    assert!(!error.is_refusal());
}

#[tokio::test]
async fn without_a_device_the_service_does_not_start() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let control = Control::default();
    control.fail_builds([GpuError::NoAdapter("no Vulkan driver".to_owned())]);
    let (render, limits) = (RenderConfig::default(), Limits::default());
    let config = config(address);
    let ended = serve_with(listener, move || control.build(), render, limits, &config);
    let error = tokio::time::timeout(Duration::from_secs(20), ended)
        .await
        .expect("it ends")
        .unwrap_err();
    assert!(matches!(error, ServeError::NoDevice(_)), "{error}");
    assert!(error.to_string().contains("no Vulkan driver"));
}

#[cfg(unix)]
#[tokio::test(flavor = "multi_thread")]
async fn sigterm_ends_the_service_and_frees_the_device() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let control = Control::default();
    let (render, limits) = (RenderConfig::default(), Limits::default());
    let factory = control.clone();
    let server = tokio::spawn(async move {
        serve_with(
            listener,
            move || factory.build(),
            render,
            limits,
            &config(address),
        )
        .await
    });
    // An answer means that the handler of the signal is installed.
    let answer = ask(address, get("/healthz")).await.unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    let process = std::process::id().to_string();
    let sent = std::process::Command::new("sh")
        .args(["-c", &format!("kill -TERM {process}")])
        .status()
        .unwrap();
    assert!(sent.success());
    tokio::time::timeout(Duration::from_secs(20), server)
        .await
        .expect("the service ends")
        .unwrap()
        .unwrap();
    assert_eq!(control.diary().last().unwrap(), "dropped");
}
