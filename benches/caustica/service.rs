//! The cost of requests: the real service on a loopback port, over real connections.

use std::error::Error;
use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use caustica::config::{Limits, RenderConfig};
use caustica::gpu_queue::{GpuQueue, GpuState, QueueSettings, RenderBackend};
use caustica::http::{AppState, ConnectionLimits, serve_on};
use caustica::render::Renderer;
use serde_json::{Value, json};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio_util::sync::CancellationToken;

use crate::Effort;
use crate::frames::scene;
use crate::memory::{Stage, begin_stage, resident_peak};
use crate::report::{Cell, Table};
use crate::spread::{Spread, ms};

/// Requests of each connection before the clock starts.
const WARM_UP: usize = 3;

/// Results of the service.
#[derive(Debug)]
pub(crate) struct Service {
    pub table: Table,
    pub memory: Stage,
}

/// Requests per second from one connection and from eight.
pub(crate) fn requests(effort: Effort) -> Result<Service, Box<dyn Error>> {
    let mut table = Table::new(
        "Service",
        "`POST /v1/render` of the sine pool with 32 water cells on 32 × 32 texels, EXR; keep-alive connections, every scene \
        different; ms per request.",
        &[
            "connections",
            "requests",
            "requests/s",
            "median",
            "p95",
            "largest",
        ],
    );
    let small = [
        ("/quality/water_cells", "32"),
        ("/output/width", "32"),
        ("/output/height", "32"),
    ];
    let scenes = Scenes {
        first: serde_json::to_value(&scene("scenes/sine_pool.json", &small)?.scene)?,
        next: AtomicU64::new(0),
    };
    begin_stage();
    let runtime = Runtime::new()?;
    let running = Running::start(&runtime)?;
    let rows = running.rows(&scenes, effort);
    // Stop the service also after an error: if the process ends while the GPU thread runs, the driver is unloaded under that thread.
    let stopped = runtime.block_on(running.stop());
    table.rows = rows?;
    stopped?;
    Ok(Service {
        table,
        memory: Stage {
            what: "service, 8 connections".to_owned(),
            frame: None,
            resident_peak: resident_peak(),
        },
    })
}

/// Scenes with different times, so that no answer can come from an earlier one.
#[derive(Debug)]
struct Scenes {
    first: Value,
    next: AtomicU64,
}

impl Scenes {
    fn take(&self) -> String {
        let mut scene = self.first.clone();
        scene["time_s"] = json!(self.next.fetch_add(1, Ordering::Relaxed) as f64 * 1e-3);
        scene.to_string()
    }
}

/// A service that listens.
#[derive(Debug)]
struct Running {
    address: SocketAddr,
    queue: GpuQueue,
    stop: CancellationToken,
    served: tokio::task::JoinHandle<Result<(), caustica::http::ServeError>>,
}

/// Results of a load.
#[derive(Debug)]
struct Load {
    times: Spread,
    took: Duration,
}

impl Running {
    fn start(runtime: &Runtime) -> Result<Self, Box<dyn Error>> {
        let config = RenderConfig::default();
        let settings = QueueSettings {
            waiting: 16,
            deadline: Duration::from_secs(60),
        };
        let backend = config.clone();
        let queue = GpuQueue::start(settings, move || {
            let renderer = Renderer::new(&backend)?;
            Ok(Box::new(renderer) as Box<dyn RenderBackend>)
        })?;
        let state = AppState::new(queue.clone(), Limits::default(), config);
        let listener = runtime.block_on(TcpListener::bind((Ipv4Addr::LOCALHOST, 0)))?;
        let address = listener.local_addr()?;
        let stop = CancellationToken::new();
        let stopped = stop.clone().cancelled_owned();
        let connections = ConnectionLimits::default();
        let served = runtime.spawn(serve_on(
            listener,
            state,
            connections,
            Duration::ZERO,
            stopped,
        ));
        let mut status = queue.watch();
        let running = Self {
            address,
            queue,
            stop,
            served,
        };
        let settled = status.wait_for(|status| status.state != GpuState::Initializing);
        let state = runtime.block_on(settled)?.state.clone();
        if state != GpuState::Ready {
            runtime.block_on(running.stop())?;
            return Err(format!("the service is not ready: {state:?}").into());
        }
        Ok(running)
    }

    /// A row for one connection and one for eight.
    fn rows(&self, scenes: &Scenes, effort: Effort) -> io::Result<Vec<Vec<Cell>>> {
        let mut rows = Vec::new();
        for connections in [1, 8] {
            eprintln!("service, {connections} connections …");
            let load = self.load(scenes, connections, effort.service_row)?;
            rows.push(vec![
                Cell::count(connections),
                Cell::count(load.times.runs()),
                Cell::figure(load.times.runs() as f64 / load.took.as_secs_f64()),
                Cell::figure(load.times.median()),
                Cell::figure(load.times.percentile(95.0)),
                Cell::figure(load.times.max()),
            ]);
        }
        Ok(rows)
    }

    /// Keeps `connections` busy for `row`.
    fn load(&self, scenes: &Scenes, connections: usize, row: Duration) -> io::Result<Load> {
        let mut clients = Vec::new();
        for _ in 0..connections {
            let mut client = Client::connect(self.address)?;
            for _ in 0..WARM_UP {
                client.render(&scenes.take())?;
            }
            clients.push(client);
        }
        let started = Instant::now();
        let times = std::thread::scope(|scope| {
            let busy: Vec<_> = clients
                .iter_mut()
                .map(|client| scope.spawn(|| client.until(started + row, scenes)))
                .collect();
            let mut times = Vec::new();
            for thread in busy {
                let all = thread.join();
                times.extend(all.map_err(|_| io::Error::other("a client panicked"))??);
            }
            io::Result::Ok(times)
        })?;
        Ok(Load {
            times: Spread::of(times),
            took: started.elapsed(),
        })
    }

    async fn stop(self) -> Result<(), Box<dyn Error>> {
        self.stop.cancel();
        self.served.await??;
        // Joins the GPU thread, which must not happen on a thread of the runtime's own.
        tokio::task::spawn_blocking(move || self.queue.close()).await?;
        Ok(())
    }
}

/// One kept-alive connection.
#[derive(Debug)]
struct Client {
    stream: BufReader<TcpStream>,
}

impl Client {
    fn connect(address: SocketAddr) -> io::Result<Self> {
        let stream = TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(Duration::from_secs(60)))?;
        Ok(Self {
            stream: BufReader::new(stream),
        })
    }

    /// Renders one scene after the other; ms of each.
    fn until(&mut self, end: Instant, scenes: &Scenes) -> io::Result<Vec<f64>> {
        let mut times = Vec::new();
        while Instant::now() < end {
            let scene = scenes.take();
            let asked = Instant::now();
            self.render(&scene)?;
            times.push(ms(asked.elapsed()));
        }
        Ok(times)
    }

    /// One request and its whole answer, which must be a picture.
    fn render(&mut self, scene: &str) -> io::Result<()> {
        let head = format!(
            "POST /v1/render HTTP/1.1\r\nhost: caustica\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n",
            scene.len()
        );
        // In one packet where it fits.
        self.stream
            .get_mut()
            .write_all(&[head.as_bytes(), scene.as_bytes()].concat())?;
        let mut line = String::new();
        self.stream.read_line(&mut line)?;
        let status = line.trim().to_owned();
        let mut length = 0;
        loop {
            line.clear();
            self.stream.read_line(&mut line)?;
            match line.trim().split_once(':') {
                Some((name, value)) if name.eq_ignore_ascii_case("content-length") => {
                    length = value.trim().parse().map_err(io::Error::other)?;
                }
                Some(_) => {}
                None => break,
            }
        }
        let mut body = vec![0; length];
        self.stream.read_exact(&mut body)?;
        if !status.ends_with("200 OK") || body.is_empty() {
            let body = String::from_utf8_lossy(&body).into_owned();
            return Err(io::Error::other(format!("{status}: {body}")));
        }
        Ok(())
    }
}
