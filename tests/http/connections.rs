//! Real sockets: silence, half headers, eviction, clients that do not read.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use axum::{Router, routing};
use caustica::http::connections::serve;
use caustica::http::{ConnectionLimits, app, layered};
use tokio::net::TcpListener;
use tokio::task::{JoinHandle, spawn_blocking};
use tokio_util::sync::CancellationToken;

use super::support::{Behaviour, Service, scenes};

/// Longer than anything here takes.
const LIMIT: Duration = Duration::from_secs(20);

/// Longer than a test runs.
const NEVER: Duration = Duration::from_secs(600);

const PING: &[u8] = b"GET /healthz HTTP/1.1\r\nhost: test\r\n\r\n";

struct Running {
    address: SocketAddr,
    closing: CancellationToken,
    server: JoinHandle<()>,
}

async fn run(service: &Service, app: Router, most: u32, idle: Duration) -> Running {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let closing = CancellationToken::new();
    let limits = ConnectionLimits { most, idle };
    let metrics = service.state.metrics();
    let server = tokio::spawn(serve(listener, app, limits, metrics, closing.clone()));
    Running {
        address,
        closing,
        server,
    }
}

impl Running {
    async fn end(self) {
        self.closing.cancel();
        let ended = tokio::time::timeout(LIMIT, self.server).await;
        ended.expect("the server ends").unwrap();
    }
}

/// Connects and sends bytes.
fn connect(address: SocketAddr, bytes: &[u8]) -> TcpStream {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    stream.write_all(bytes).unwrap();
    stream
}

/// Reads one short answer, whose end is the end of JSON.
fn answer(stream: &mut TcpStream) -> String {
    let mut text = Vec::new();
    while !text.ends_with(b"}") {
        let mut chunk = [0; 1024];
        let count = stream.read(&mut chunk).unwrap();
        assert!(count > 0, "closed after {}", String::from_utf8_lossy(&text));
        text.extend_from_slice(&chunk[..count]);
    }
    String::from_utf8(text).unwrap()
}

/// Reads until the server closes; panics if it does not.
fn closed(mut stream: TcpStream) -> usize {
    let mut rest = Vec::new();
    match stream.read_to_end(&mut rest) {
        Ok(count) => count,
        Err(error) if error.kind() == std::io::ErrorKind::ConnectionReset => rest.len(),
        Err(error) => panic!("it stays open: {error}"),
    }
}

async fn blocking<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    spawn_blocking(work).await.unwrap()
}

/// A render request on a connection that stays open.
fn render() -> Vec<u8> {
    let scene = scenes::small().to_string();
    format!(
        "POST /v1/render HTTP/1.1\r\nhost: test\r\naccept: application/json\r\ncontent-type: application/json\r\n\
         content-length: {}\r\n\r\n{scene}",
        scene.len()
    )
    .into_bytes()
}

/// The value of a counter of closed connections.
async fn count(service: &Service, reason: &str) -> u64 {
    let text = service.get("/metrics").await.text();
    let line = format!("\ncaustica_connections_closed_total{{reason=\"{reason}\"}} ");
    let value = text.split(&line).nth(1).unwrap().lines().next().unwrap();
    value.parse().unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn connections_without_a_request_are_closed() {
    let service = Service::start().await;
    let before = count(&service, "idle").await;
    let idle = Duration::from_millis(200);
    let running = run(&service, app(service.state.clone()), 8, idle).await;
    let address = running.address;
    blocking(move || {
        let silent = connect(address, b"");
        let half = connect(address, b"POST /v1/render HTTP/1.1\r\nhost: test\r\nconte");
        let mut kept = connect(address, PING);
        assert!(answer(&mut kept).starts_with("HTTP/1.1 200"));
        kept.write_all(PING).unwrap();
        assert!(answer(&mut kept).starts_with("HTTP/1.1 200"));
        for stream in [silent, half, kept] {
            assert_eq!(closed(stream), 0);
        }
    })
    .await;
    assert!(count(&service, "idle").await >= before + 3);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_in_flight_is_not_idle() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let idle = Duration::from_millis(100);
    let running = run(&service, app(service.state.clone()), 8, idle).await;
    let address = running.address;
    let mut stream = blocking(move || connect(address, &render())).await;
    service.control.wait_for("render", 1).await;
    // The render outlasts the limit several times.
    tokio::time::sleep(6 * idle).await;
    service.control.open_gate();
    let text = blocking(move || answer(&mut stream)).await;
    assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    running.end().await;
}

/// A request for a render whose body has only begun.
const HALF_BODY: &[u8] =
    b"POST /v1/render HTTP/1.1\r\nhost: test\r\ncontent-type: application/json\r\n\
    content-length: 1000\r\n\r\n{";

#[tokio::test(flavor = "multi_thread")]
async fn a_body_that_stops_arriving_is_idle() {
    let service = Service::start().await;
    let before = count(&service, "idle").await;
    let idle = Duration::from_millis(200);
    let running = run(&service, app(service.state.clone()), 8, idle).await;
    let address = running.address;
    blocking(move || assert_eq!(closed(connect(address, HALF_BODY)), 0)).await;
    assert!(count(&service, "idle").await > before);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_that_arrives_slowly_is_not_idle() {
    let service = Service::start().await;
    let idle = Duration::from_secs(3);
    let running = run(&service, app(service.state.clone()), 8, idle).await;
    let address = running.address;
    let text = blocking(move || {
        let request = render();
        let (start, end) = request.split_at(request.len() - 20);
        let mut stream = connect(address, start);
        // All of it together takes longer than the limit.
        for byte in end {
            std::thread::sleep(idle / 15);
            stream.write_all(&[*byte]).unwrap();
        }
        answer(&mut stream)
    });
    let text = text.await;
    assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn half_sent_bodies_keep_nobody_out() {
    let service = Service::start().await;
    let before = count(&service, "evicted").await;
    let running = run(&service, app(service.state.clone()), 3, NEVER).await;
    let address = running.address;
    blocking(move || {
        let half: Vec<_> = (0..3).map(|_| connect(address, HALF_BODY)).collect();
        let mut probe = connect(address, PING);
        assert!(answer(&mut probe).starts_with("HTTP/1.1 200"));
        drop(half);
    })
    .await;
    assert!(count(&service, "evicted").await > before);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn the_connection_that_has_waited_longest_makes_room() {
    let service = Service::start().await;
    let before = count(&service, "evicted").await;
    let running = run(&service, app(service.state.clone()), 3, NEVER).await;
    let address = running.address;
    blocking(move || {
        let mut first = connect(address, PING);
        assert!(answer(&mut first).starts_with("HTTP/1.1 200"));
        let mut second = connect(address, PING);
        assert!(answer(&mut second).starts_with("HTTP/1.1 200"));
        let mut third = connect(address, PING);
        assert!(answer(&mut third).starts_with("HTTP/1.1 200"));
        // The first is used again, so the second has waited longest.
        first.write_all(PING).unwrap();
        assert!(answer(&mut first).starts_with("HTTP/1.1 200"));
        let mut fourth = connect(address, PING);
        assert!(answer(&mut fourth).starts_with("HTTP/1.1 200"));
        assert_eq!(closed(second), 0);
        for mut stream in [first, third, fourth] {
            stream.write_all(PING).unwrap();
            assert!(answer(&mut stream).starts_with("HTTP/1.1 200"));
        }
    })
    .await;
    assert!(count(&service, "evicted").await > before);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn many_silent_connections_keep_nobody_out() {
    let service = Service::start().await;
    let running = run(&service, app(service.state.clone()), 16, NEVER).await;
    let address = running.address;
    blocking(move || {
        let mut silent = Vec::new();
        for number in 0..200 {
            let half: &[u8] = if number % 2 == 0 {
                b""
            } else {
                b"GET /healthz HT"
            };
            silent.push(connect(address, half));
            if number % 20 == 0 {
                let mut probe = connect(address, PING);
                assert!(answer(&mut probe).starts_with("HTTP/1.1 200"));
            }
        }
    })
    .await;
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn busy_connections_are_not_closed_for_a_new_one() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let running = run(&service, app(service.state.clone()), 1, NEVER).await;
    let address = running.address;
    let mut busy = blocking(move || connect(address, &render())).await;
    service.control.wait_for("render", 1).await;
    let mut new = blocking(move || connect(address, PING)).await;
    let early = blocking(move || {
        new.set_read_timeout(Some(Duration::from_millis(200)))
            .unwrap();
        let error = new.read(&mut [0; 1]).unwrap_err();
        (new, error.kind())
    });
    let (mut new, kind) = early.await;
    assert!(
        matches!(
            kind,
            std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut
        ),
        "{kind:?}"
    );
    service.control.open_gate();
    let texts = blocking(move || {
        new.set_read_timeout(Some(LIMIT)).unwrap();
        // Its answer comes first; then it waits, and makes room.
        [answer(&mut busy), answer(&mut new)]
    });
    for text in texts.await {
        assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    }
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_does_not_read_its_answer_is_dropped() {
    let service = Service::start().await;
    let before = count(&service, "stalled").await;
    // More than the buffers of both sockets hold.
    let large = 256 << 20;
    let routes = Router::new().route("/", routing::get(move || async move { vec![0_u8; large] }));
    let app = layered(routes, service.state.clone());
    let running = run(&service, app, 8, Duration::from_millis(300)).await;
    let address = running.address;
    let request = b"GET / HTTP/1.1\r\nhost: test\r\n\r\n";
    let stream = blocking(move || connect(address, request)).await;
    for _ in 0..2000 {
        if count(&service, "stalled").await > before {
            break;
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    assert!(count(&service, "stalled").await > before);
    assert!(blocking(move || closed(stream)).await < large);
    // A client that reads slowly, but reads, gets everything.
    let mut stream = blocking(move || connect(address, request)).await;
    let read = blocking(move || {
        let (mut chunk, mut read) = (vec![0; 16 << 20], 0);
        while read < large {
            std::thread::sleep(Duration::from_millis(20));
            read += stream.read(&mut chunk).unwrap();
        }
        read
    });
    assert!(read.await >= large);
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_shutdown_closes_those_that_wait_and_finishes_those_that_do_not() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let running = run(&service, app(service.state.clone()), 8, NEVER).await;
    let address = running.address;
    let streams = blocking(move || {
        let mut kept = connect(address, PING);
        assert!(answer(&mut kept).starts_with("HTTP/1.1 200"));
        [kept, connect(address, b""), connect(address, b"GET /hea")]
    });
    let streams = streams.await;
    let mut busy = blocking(move || connect(address, &render())).await;
    service.control.wait_for("render", 1).await;
    running.closing.cancel();
    blocking(move || {
        for stream in streams {
            assert_eq!(closed(stream), 0);
        }
    })
    .await;
    assert!(!running.server.is_finished());
    service.control.open_gate();
    let text = blocking(move || answer(&mut busy)).await;
    assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    running.end().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn connections_end_with_the_server_that_is_dropped() {
    let service = Service::start().await;
    let running = run(&service, app(service.state.clone()), 8, NEVER).await;
    let address = running.address;
    let mut stream = blocking(move || connect(address, PING)).await;
    let stream = blocking(move || {
        answer(&mut stream);
        stream
    });
    let stream = stream.await;
    running.server.abort();
    assert_eq!(blocking(move || closed(stream)).await, 0);
}
