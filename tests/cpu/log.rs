//! The log: nothing that happens to its stream stops the work.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use caustica::log::Log;

/// Long enough for a busy machine; reached only by a failing test.
const LONG: Duration = Duration::from_secs(60);

/// A reader that takes nothing until it is allowed to, and then everything.
struct Stalled {
    allowed: Receiver<()>,
    taken: Sender<String>,
}

impl Write for Stalled {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // An error says that the test needs no further stall.
        let _ = self.allowed.recv();
        let text = String::from_utf8(bytes.to_vec()).unwrap();
        let _ = self.taken.send(text);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_stalled_reader_stops_nobody_and_gets_everything_later() {
    let (allow, allowed) = channel();
    let (taken, texts) = channel();
    let log = Log::start(Stalled { allowed, taken }).unwrap();
    for number in 0..1000 {
        log.put(format!("{number}\n"));
    }
    assert!(!log.flush(Duration::from_millis(1)), "nothing was taken");
    drop(allow);
    assert!(log.flush(LONG));
    let expected: Vec<String> = (0..1000).map(|number| format!("{number}\n")).collect();
    assert_eq!(texts.try_iter().collect::<Vec<_>>(), expected);
}

#[test]
fn what_waits_for_a_stalled_reader_is_bounded() {
    let (allow, allowed) = channel();
    let (taken, texts) = channel();
    let log = Log::start(Stalled { allowed, taken }).unwrap();
    let megabyte = "x".repeat(1 << 20);
    for _ in 0..10 {
        log.put(megabyte.clone());
    }
    drop(allow);
    assert!(log.flush(LONG));
    assert_eq!(texts.try_iter().count(), 4, "4 MiB");
    assert_eq!(log.dropped(), 6);
    log.put("later".to_owned());
    assert!(log.flush(LONG));
    assert_eq!(texts.recv().unwrap(), "later");
}

#[test]
fn a_text_that_is_longer_than_the_queue_is_written() {
    let (allow, allowed) = channel();
    let (taken, texts) = channel();
    let log = Log::start(Stalled { allowed, taken }).unwrap();
    let long = "x".repeat(5 << 20);
    log.put("short\n");
    log.put(long.clone());
    log.put("this finds the queue full\n");
    drop(allow);
    assert!(log.flush(LONG));
    assert_eq!(texts.recv().unwrap(), "short\n");
    assert!(texts.recv().unwrap() == long, "the whole text");
    assert_eq!(texts.try_iter().count(), 0);
    assert_eq!(log.dropped(), 1);
}

/// A disk that is full.
struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn errors_of_the_stream_are_counted() {
    let log = Log::start(Full).unwrap();
    for _ in 0..3 {
        log.put("a note\n");
        assert!(log.flush(LONG));
    }
    assert_eq!(log.dropped(), 3);
    assert!(caustica::log::dropped() >= 3);
}
