//! Stderr of commands.

use std::path::Path;

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
