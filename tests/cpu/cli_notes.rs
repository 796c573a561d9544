//! Stderr: nothing that happens to it stops the work.

use std::io::{self, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use caustica::cli::notes::Notes;

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
    let notes = Notes::to(Stalled { allowed, taken }).unwrap();
    for number in 0..1000 {
        notes.put(format!("{number}\n"));
    }
    assert!(!notes.flush(Duration::from_millis(1)), "nothing was taken");
    drop(allow);
    assert!(notes.flush(LONG));
    let expected: Vec<String> = (0..1000).map(|number| format!("{number}\n")).collect();
    assert_eq!(texts.try_iter().collect::<Vec<_>>(), expected);
}

#[test]
fn what_waits_for_a_stalled_reader_is_bounded() {
    let (allow, allowed) = channel();
    let (taken, texts) = channel();
    let notes = Notes::to(Stalled { allowed, taken }).unwrap();
    let megabyte = "x".repeat(1 << 20);
    for _ in 0..10 {
        notes.put(megabyte.clone());
    }
    drop(allow);
    assert!(notes.flush(LONG));
    assert_eq!(texts.try_iter().count(), 4, "4 MiB");
    notes.put("later".to_owned());
    assert!(notes.flush(LONG));
    assert_eq!(texts.recv().unwrap(), "later");
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
fn errors_of_stderr_are_nobodys_problem() {
    let notes = Notes::to(Full).unwrap();
    for _ in 0..3 {
        notes.put("a note\n".to_owned());
        assert!(notes.flush(LONG));
    }
}

#[test]
fn commands_write_to_stderr_in_one_place() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/cli");
    let mut files = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        // `eprint!` and `eprintln!` panic when stderr is closed, and wait when its reader stalls.
        assert!(!text.contains("eprint"), "{}", path.display());
        assert!(!text.contains(" print!"), "{}", path.display());
        assert!(!text.contains(" println!"), "{}", path.display());
        files += 1;
    }
    assert!(files > 20, "the sources are not there");
}
