//! A log that fails or stalls costs only its lines.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use caustica::http::log::subscriber;
use caustica::log::Log;

use super::support::Service;

const LIMIT: Duration = Duration::from_secs(20);

/// Keeps what is written.
#[derive(Clone, Default)]
struct Kept(Arc<Mutex<Vec<u8>>>);

impl Write for Kept {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Kept {
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

/// Fails at every write, as on a full disk.
struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes only after the other end of the channel is gone, as a pipe whose reader has stalled.
struct Stalled(Receiver<()>, Kept);

impl Write for Stalled {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        while self.0.recv().is_ok() {}
        self.1.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn events(log: &Log, count: usize, json: bool) {
    let subscriber = subscriber(log, json, false);
    tracing::subscriber::with_default(subscriber, || {
        for number in 0..count {
            tracing::error!(number, "an event");
        }
    });
}

#[test]
fn lines_are_written_in_order_and_flushed() {
    let kept = Kept::default();
    let log = Log::start(kept.clone()).unwrap();
    events(&log, 3, true);
    assert!(log.flush(LIMIT));
    let lines: Vec<serde_json::Value> = kept
        .text()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let numbers: Vec<_> = lines.iter().map(|line| &line["fields"]["number"]).collect();
    assert_eq!(numbers, [0, 1, 2]);
    assert_eq!(log.dropped(), 0);
}

#[tokio::test]
async fn lines_that_cannot_be_written_are_counted() {
    let log = Log::start(Full).unwrap();
    events(&log, 5, false);
    assert!(log.flush(LIMIT));
    assert_eq!(log.dropped(), 5);
    let metrics = Service::start().await.get("/metrics").await.text();
    let name = "\ncaustica_log_lines_dropped_total ";
    let value = metrics.split(name).nth(1).unwrap().lines().next().unwrap();
    assert!(value.parse::<u64>().unwrap() >= 5, "{value}");
}

#[test]
fn a_stalled_reader_delays_nothing() {
    let kept = Kept::default();
    let (stalls, stalled) = channel();
    let log = Log::start(Stalled(stalled, kept.clone())).unwrap();
    // More than any queue of reasonable size holds; a writer that waits would not come back.
    let count = 100_000;
    events(&log, count, false);
    assert!(!log.flush(Duration::from_millis(1)));
    drop(stalls);
    assert!(log.flush(LIMIT));
    let written = kept.text().lines().count();
    assert!(written > 1000, "{written}");
    assert!(log.dropped() > 1000, "{}", log.dropped());
    assert_eq!(written as u64 + log.dropped(), count as u64);
}
