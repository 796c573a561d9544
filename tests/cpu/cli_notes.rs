//! Stderr of commands.

use std::path::Path;

use caustica::cli::notes::printable;

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let table = [
        ("a\tb\nc ä 水\n", "a\tb\nc ä 水\n"),
        ("\u{1b}[31mred", "\u{fffd}[31mred"),
        (
            "a\rb\u{7}\u{8}\u{0}\u{7f}",
            "a\u{fffd}b\u{fffd}\u{fffd}\u{fffd}\u{fffd}",
        ),
        ("\u{9b}2J", "\u{fffd}2J"),
    ];
    for (text, expected) in table {
        assert_eq!(printable(text), expected);
    }
}

#[test]
fn commands_write_to_stderr_in_one_place() {
    let mut paths = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src/cli")];
    let mut files = 0;
    while let Some(path) = paths.pop() {
        if path.is_dir() {
            let entries = std::fs::read_dir(path).unwrap();
            paths.extend(entries.map(|entry| entry.unwrap().path()));
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        // `eprint!` and `eprintln!` panic when stderr is closed, and wait when its reader stalls.
        assert!(!text.contains("eprint"), "{}", path.display());
        assert!(!text.contains(" print!"), "{}", path.display());
        assert!(!text.contains(" println!"), "{}", path.display());
        files += 1;
    }
    assert!(files > 20, "the sources are not there");
}
