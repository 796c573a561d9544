//! Files are written whole: links, modes, several names, devices, and what killed processes leave.

#![cfg(unix)]

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::os::fd::AsRawFd;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use caustica::cli::animate::is_rendered;
use caustica::cli::files::Destination;
use caustica::output_files::{
    Pending, check, clear_leftovers, is_same_file, is_stdout, target_of, write,
};

use super::folder::Folder;

#[test]
fn a_link_stays_and_its_target_is_written() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.join(name);
    folder.write("store/7.png", "an old picture");
    symlink("store/7.png", path("latest.png")).unwrap();
    symlink("latest.png", path("chain.png")).unwrap();
    symlink("store/new.png", path("dangling.png")).unwrap();
    symlink(path("store/absolute.png"), path("absolute.png")).unwrap();
    for (name, target) in [
        ("latest.png", "7.png"),
        ("chain.png", "7.png"),
        ("dangling.png", "new.png"),
        ("absolute.png", "absolute.png"),
    ] {
        check(&path(name)).unwrap();
        write(&path(name), name.as_bytes()).unwrap();
        assert!(path(name).is_symlink(), "{name}");
        let written = fs::read(path("store").join(target)).unwrap();
        assert_eq!(written, name.as_bytes(), "{name}");
    }
    assert_eq!(fs::read_dir(path("store")).unwrap().count(), 3);
}

#[test]
fn links_in_a_circle_are_an_error() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.join(name);
    symlink("b.png", path("a.png")).unwrap();
    symlink("a.png", path("b.png")).unwrap();
    let error = write(&path("a.png"), b"x").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidInput);
    assert!(error.to_string().contains("in a circle"), "{error}");
    assert_eq!(folder.names(), ["a.png", "b.png"]);
}

#[test]
fn an_existing_file_keeps_its_mode_and_a_new_one_has_the_usual() {
    let folder = Folder::new();
    let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o7777;
    let usual = mode(&folder.write("usual", ""));
    let new = folder.0.join("new.png");
    write(&new, b"x").unwrap();
    assert_eq!(mode(&new), usual);
    for wanted in [0o664, 0o600, 0o777, 0o440] {
        fs::set_permissions(&new, fs::Permissions::from_mode(wanted)).unwrap();
        let before = new.metadata().unwrap().ino();
        write(&new, b"y").unwrap();
        assert_eq!(mode(&new), wanted, "{wanted:o}");
        assert_ne!(new.metadata().unwrap().ino(), before, "it was replaced");
    }
}

#[test]
fn all_names_of_a_file_have_the_new_picture() {
    let folder = Folder::new();
    let one = folder.write("one.png", "a picture that is longer than the next");
    let two = folder.0.join("two.png");
    fs::hard_link(&one, &two).unwrap();
    write(&one, b"short").unwrap();
    assert_eq!(fs::read(&two).unwrap(), b"short");
    assert_eq!(one.metadata().unwrap().nlink(), 2);
    assert_eq!(folder.names(), ["one.png", "two.png"]);
}

#[test]
fn nothing_is_seen_of_a_file_until_it_is_finished() {
    let folder = Folder::new();
    let path = folder.write("x.png", "old");
    let pending = Pending::new(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    let names = folder.names();
    let [temporary, _] = names.as_slice() else {
        panic!("a temporary file and the old one are expected: {names:?}");
    };
    assert!(temporary.starts_with(".x.png."), "{temporary}");
    assert!(temporary.ends_with(".tmp"), "{temporary}");
    drop(pending);
    assert_eq!(folder.names(), ["x.png"], "nothing is left of it");
    Pending::new(&path, b"new").unwrap().finish().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(folder.names(), ["x.png"]);
}

#[test]
fn names_of_any_length_have_temporary_names() {
    let folder = Folder::new();
    // The system's limit is 255 bytes. An ä has two, so that a cut can be within one.
    for name in [
        "x".repeat(255),
        "ä".repeat(127),
        format!("a{}", "ä".repeat(127)),
    ] {
        let path = folder.0.join(&name);
        let pending = Pending::new(&path, b"x").unwrap();
        let names = folder.names();
        assert!(names.iter().all(|name| name.len() < 143), "{names:?}");
        clear_leftovers([path.as_path()]);
        assert_eq!(folder.names(), names, "it is in use");
        pending.finish().unwrap();
        assert_eq!(folder.names(), [name]);
        fs::remove_file(path).unwrap();
    }
    let error = write(&folder.0.join("x".repeat(256)), b"x").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidFilename);
    let error = check(&folder.0.join("x".repeat(256))).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidFilename);
}

#[test]
fn only_own_files_of_ended_processes_are_removed() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.join(name);
    let stay = [
        ".other.png.abc123.tmp", // of an output that this command does not write
        ".x.png.abc12.tmp",
        ".x.png.abc-23.tmp",
        ".x.png.abc123.tmp.bak",
        ".x.pngabc123.tmp",
        "x.png.abc123.tmp",
        "x.png",
    ];
    for name in stay {
        folder.write(name, name);
    }
    fs::create_dir(path(".x.png.folder.tmp")).unwrap();
    symlink("x.png", path(".x.png.linked.tmp")).unwrap();
    // Another process is still writing this one.
    folder.write(".x.png.inuse1.tmp", "");
    let used = File::open(path(".x.png.inuse1.tmp")).unwrap();
    used.lock().unwrap();
    let mut expected = folder.names();
    for name in [
        ".x.png.abc123.tmp",
        ".x.png.Zz9Zz9.tmp",
        ".y.exr.000000.tmp",
    ] {
        folder.write(name, "half");
    }
    symlink("y.exr", path("link.exr")).unwrap();
    expected.push("link.exr".to_owned());
    expected.sort();
    let paths = [path("x.png"), path("link.exr"), path("no/folder.png")];
    clear_leftovers(paths.iter().map(std::path::PathBuf::as_path));
    assert_eq!(folder.names(), expected);
    drop(used);
    clear_leftovers([paths[0].as_path()]);
    assert!(!folder.names().contains(&".x.png.inuse1.tmp".to_owned()));
}

#[test]
fn files_in_use_are_left_alone_from_the_first_moment() {
    let folder = Folder::new();
    let path = folder.0.join("x.png");
    let is_over = AtomicBool::new(false);
    std::thread::scope(|threads| {
        threads.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                clear_leftovers([path.as_path()]);
            }
        });
        let lost = (0..500).filter(|_| {
            let pending = Pending::new(&path, b"x").unwrap();
            let is_there = folder.names().iter().any(|name| name.ends_with(".tmp"));
            pending.finish().unwrap();
            !is_there
        });
        let lost = lost.count();
        is_over.store(true, Ordering::Relaxed);
        assert_eq!(lost, 0, "removed while it was written");
    });
    assert_eq!(folder.names(), ["x.png"]);
}

#[test]
fn devices_and_pipes_are_written_through() {
    write(Path::new("/dev/null"), b"x").unwrap();
    let about = fs::metadata("/dev/null").unwrap();
    assert!(about.file_type().is_char_device());

    let folder = Folder::new();
    let pipe = folder.0.join("pipe.png");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    check(&pipe).unwrap();
    assert!(!is_rendered(&pipe, ""), "it is not read, which would wait");
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || {
            let mut read = Vec::new();
            File::open(pipe).unwrap().read_to_end(&mut read).unwrap();
            read
        })
    };
    write(&pipe, b"a picture").unwrap();
    assert_eq!(reader.join().unwrap(), b"a picture");
    assert_eq!(folder.names(), ["pipe.png"]);
}

#[test]
fn places_that_cannot_be_written_to_are_found_before() {
    let folder = Folder::new();
    folder.write("file", "");
    for (name, kind) in [
        ("file/x.png", ErrorKind::NotADirectory),
        ("no/x.png", ErrorKind::NotFound),
        ("x.png/", ErrorKind::InvalidInput),
        ("..", ErrorKind::InvalidInput),
    ] {
        assert_eq!(
            check(&folder.0.join(name)).unwrap_err().kind(),
            kind,
            "{name}"
        );
    }
    check(&folder.0.join("x.png")).unwrap();
    assert_eq!(folder.names(), ["file"], "checking leaves nothing");
    let error = check(&folder.0.join("no/x.png")).unwrap_err().to_string();
    assert!(!error.contains(".tmp"), "nobody knows that name: {error}");
}

#[test]
fn stdout_has_several_names() {
    let folder = Folder::new();
    for name in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        assert!(is_stdout(Path::new(name)), "{name}");
    }
    let link = folder.0.join("link.png");
    symlink("/dev/stdout", &link).unwrap();
    assert!(is_stdout(&link));
    for name in ["/dev/null", "/dev/fd/2", "x.png", "stdout"] {
        assert!(!is_stdout(Path::new(name)), "{name}");
    }
    assert_eq!(Destination::of(Path::new("-")), Destination::Stdout);
    assert_eq!(target_of(Path::new("x.png")).unwrap(), Path::new("x.png"));
    for (path, has_format) in [("-", false), ("/dev/null", false), ("x.png", true)] {
        let format = Destination::of(Path::new(path)).format().unwrap();
        assert_eq!(format.is_some(), has_format, "{path}");
    }
}

#[test]
fn an_open_file_without_an_extension_has_the_format_of_the_scene() {
    let folder = Folder::new();
    let file = File::create(folder.0.join("picture")).unwrap();
    let path = format!("/dev/fd/{}", file.as_raw_fd());
    let destination = Destination::of(Path::new(&path));
    assert_eq!(destination.format().unwrap(), None);
    destination.check().unwrap();
    destination.write(b"a picture").unwrap();
    let written = fs::read(folder.0.join("picture")).unwrap();
    assert_eq!(written, b"a picture");
}

#[test]
fn paths_that_lead_to_the_same_file_are_known() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.join(name);
    folder.write("store/a", "a");
    folder.write("store/b", "b");
    symlink("store/a", path("to_a")).unwrap();
    symlink("store/new", path("to_new")).unwrap();
    symlink("store", path("also_store")).unwrap();
    fs::hard_link(path("store/a"), path("hard_a")).unwrap();
    for (one, other, is_same) in [
        ("store/a", "store/a", true),
        ("store/a", "to_a", true),
        ("store/a", "hard_a", true),
        ("store/a", "also_store/../store/a", true),
        ("to_new", "store/new", true),
        ("store/new", "also_store/new", true),
        ("store/a", "store/b", false),
        ("store/a", "store/new", false),
        ("store/new", "new", false),
        ("/dev/null", "/dev/null", false),
    ] {
        assert_eq!(
            is_same_file(&path(one), &path(other)),
            is_same,
            "{one} {other}"
        );
    }
}
