//! `caustica serve` as a process: logs that fail or stall, few files, signals.
#![cfg(unix)]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};

use super::scene_files;

/// Longer than a start, a render or an end takes.
const LIMIT: Duration = Duration::from_secs(120);

struct Program {
    process: Child,
    address: SocketAddr,
}

impl Program {
    /// Starts the program by a shell, after `setup`; returns it with the reader of its stderr, which has read one line.
    fn start(setup: &str, log: &str) -> (Self, BufReader<ChildStderr>) {
        let program = env!("CARGO_BIN_EXE_caustica");
        let mut process = Command::new("sh")
            .arg("-c")
            .arg(format!(
                "{setup} exec '{program}' serve --listen 127.0.0.1:0"
            ))
            .env("RUST_LOG", log)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr = BufReader::new(process.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains("listening") {
            line.clear();
            assert!(
                stderr.read_line(&mut line).unwrap() > 0,
                "the program ended"
            );
        }
        let address = line.split("address=").nth(1).unwrap();
        let address = address.split_whitespace().next().unwrap().parse().unwrap();
        let program = Self { process, address };
        let start = Instant::now();
        while !program
            .ask("GET", "/readyz", "")
            .starts_with("HTTP/1.1 200")
        {
            assert!(start.elapsed() < LIMIT, "it is not ready");
            std::thread::sleep(Duration::from_millis(50));
        }
        (program, stderr)
    }

    fn ask(&self, method: &str, path: &str, body: &str) -> String {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        let request = format!(
            "{method} {path} HTTP/1.1\r\nhost: test\r\nconnection: close\r\ncontent-type: application/json\r\n\
             content-length: {}\r\n\r\n{body}",
            body.len()
        );
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Renders, is refused, stays ready.
    fn assert_works(&self) {
        let scene = std::fs::read_to_string(scene_files::folder().join("pool.json")).unwrap();
        let picture = self.ask("POST", "/v1/render", &scene);
        assert!(picture.starts_with("HTTP/1.1 200"), "{:.300}", picture);
        let refused = self.ask("POST", "/v1/render", "{");
        assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");
        let ready = self.ask("GET", "/readyz", "");
        assert!(ready.starts_with("HTTP/1.1 200"), "{ready}");
    }

    /// The value of a metric.
    fn metric(&self, name: &str) -> f64 {
        let text = self.ask("GET", "/metrics", "");
        let value = text.split(&format!("\n{name} ")).nth(1);
        value.unwrap().lines().next().unwrap().parse().unwrap()
    }

    /// Ends by SIGTERM, with this exit code.
    fn assert_ends(mut self) {
        let kill = format!("kill -TERM {}", self.process.id());
        assert!(
            Command::new("sh")
                .args(["-c", &kill])
                .status()
                .unwrap()
                .success()
        );
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.process.try_wait().unwrap() {
                break status;
            }
            assert!(start.elapsed() < LIMIT, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        };
        assert_eq!(status.code(), Some(0), "{status}");
    }
}

/// A test that fails leaves no process.
impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn a_log_without_a_reader_costs_only_its_lines() {
    let (program, stderr) = Program::start("", "info");
    drop(stderr);
    program.assert_works();
    assert!(program.metric("caustica_log_lines_dropped_total") >= 1.0);
    program.assert_ends();
}

#[test]
fn a_log_whose_reader_has_stalled_costs_only_its_lines() {
    let (program, stderr) = Program::start("", "trace");
    // More lines than pipe and queue hold.
    let start = Instant::now();
    while program.metric("caustica_log_lines_dropped_total") == 0.0 {
        assert!(start.elapsed() < LIMIT, "the queue does not fill");
        for _ in 0..500 {
            program.ask("GET", "/nowhere", "");
        }
    }
    program.assert_works();
    program.assert_ends();
    drop(stderr);
}

#[test]
fn silent_clients_do_not_use_up_the_files() {
    let (program, stderr) = Program::start("ulimit -n 200;", "info");
    let mut silent = Vec::new();
    for number in 0..300 {
        let mut stream = TcpStream::connect(program.address).unwrap();
        if number % 2 == 0 {
            stream.write_all(b"GET /healthz HT").unwrap();
        }
        silent.push(stream);
    }
    program.assert_works();
    let open = program.metric("caustica_connections");
    assert!(open > 1.0 && open < 200.0, "{open}");
    let evicted = program.metric("caustica_connections_closed_total{reason=\"evicted\"}");
    assert!(evicted >= 100.0, "{evicted}");
    program.assert_ends();
    drop((silent, stderr));
}
