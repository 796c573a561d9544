//! Dependencies between the rooms (the folders and files directly under `src/`), read from the sources and compared with the table
//! in `src/lib.rs`.
//!
//! A use is a path that starts at the root of the crate: `crate::…`, alone or in groups, or as many `super::` as lead there.
//! Comments and strings are ignored.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What the reference may use, so that it stays independent of what it judges.
/// It writes its files like all others.
const UNDER_THE_REFERENCE: [&str; 5] = ["mesh", "output_files", "physics", "scene", "waves"];

/// Who may use the laboratory: the faces. The engine has to run without it.
const ABOVE_THE_LAB: [&str; 2] = ["cli", "http"];

/// By room, the rooms that it uses, each with a file that does.
type Uses = BTreeMap<String, BTreeMap<String, String>>;

/// A source file: its path under `src/` with `/`, and its code without comments and texts.
struct Source {
    path: String,
    code: String,
}

impl Source {
    fn room(&self) -> &str {
        let room = self.path.split('/').next().unwrap();
        room.strip_suffix(".rs").unwrap_or(room)
    }

    /// Names of the module that it is, from the root.
    fn module(&self) -> Vec<&str> {
        let path = self.path.strip_suffix(".rs").unwrap();
        let path = path.strip_suffix("/mod").unwrap_or(path);
        path.split('/').collect()
    }

    /// First names of all paths from the root of the crate.
    fn roots(&self) -> BTreeSet<String> {
        let mut roots = BTreeSet::new();
        for (at, _) in words(&self.code, "crate") {
            first_names(&self.code[at + "crate".len()..], &mut roots);
        }
        // A chain of `super` that is as long as the module's own path ends at the root.
        for (at, before) in words(&self.code, "super") {
            if before.ends_with("::") {
                continue; // not the first of its chain
            }
            let mut rest = &self.code[at..];
            let mut steps = 0;
            while let Some(after) = rest.trim_start().strip_prefix("super") {
                steps += 1;
                let Some(next) = after.trim_start().strip_prefix("::") else {
                    break;
                };
                rest = next;
            }
            if steps >= self.module().len() && rest.len() < self.code.len() - at {
                first_names(&format!("::{rest}"), &mut roots);
            }
        }
        roots.remove("self");
        roots
    }
}

/// Where `word` stands alone in `code`, and the code before that without the spaces at its end.
fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = (usize, &'a str)> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).filter_map(move |(at, _)| {
        let (before, after) = (&code[..at], &code[at + word.len()..]);
        let alone = !before.ends_with(is_part) && !after.starts_with(is_part);
        alone.then(|| (at, before.trim_end()))
    })
}

/// Adds the names that follow right after the `::` at the start of `rest`; of a group, those of all its parts.
fn first_names(rest: &str, names: &mut BTreeSet<String>) {
    let Some(rest) = rest.trim_start().strip_prefix("::") else {
        return;
    };
    let rest = rest.trim_start();
    let Some(group) = rest.strip_prefix('{') else {
        let name: String = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        if !name.is_empty() {
            names.insert(name);
        }
        return;
    };
    let (mut depth, mut start) = (0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                first_names(&format!("::{}", &group[start..at]), names);
                start = at + 1;
                if c == '}' {
                    return;
                }
            }
            _ => {}
        }
    }
}

/// Code with a space for each comment, text and character.
fn without_comments_and_texts(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let skipped = comment(rest).or_else(|| literal(rest, code.chars().next_back()));
        if let Some(length) = skipped {
            code.push(' ');
            rest = &rest[length..];
        } else {
            code.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    code
}

/// Length of the comment that `rest` starts with.
fn comment(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    let mut inner = rest.strip_prefix("/*")?;
    let mut depth = 1;
    while depth > 0 {
        let (open, close) = (inner.find("/*"), inner.find("*/"));
        let close = close.expect("a comment ends");
        let (at, step) = match open {
            Some(open) if open < close => (open, 1),
            _ => (close, -1),
        };
        depth += step;
        inner = &inner[at + 2..];
    }
    Some(rest.len() - inner.len())
}

/// Length of the text or character that `rest` starts with; `before` stands before it.
fn literal(rest: &str, before: Option<char>) -> Option<usize> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    if !before.is_some_and(is_part) {
        let raw = rest.trim_start_matches(['b', 'c']);
        if let Some(raw) = raw.strip_prefix('r')
            && rest.len() - raw.len() <= 2
        {
            let hashes = raw.len() - raw.trim_start_matches('#').len();
            if let Some(inner) = raw[hashes..].strip_prefix('"') {
                let end = format!("\"{}", "#".repeat(hashes));
                let length = inner.find(&end).expect("a text ends") + end.len();
                return Some(rest.len() - inner.len() + length);
            }
        }
    }
    let quote = rest.chars().next().filter(|c| ['"', '\''].contains(c))?;
    if quote == '\'' {
        let mut chars = rest[1..].chars();
        // A lifetime is no character.
        if chars.next()? != '\\' && chars.next()? != '\'' {
            return None;
        }
    }
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return Some(at + 1),
            _ => {}
        }
    }
    panic!("a text without an end: {rest}");
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// All sources, but the two files that name every room.
fn sources() -> Vec<Source> {
    let mut sources = Vec::new();
    let mut folders = vec![folder()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let names = path.strip_prefix(folder()).unwrap().iter();
                let names: Vec<&str> = names.map(|name| name.to_str().unwrap()).collect();
                let text = std::fs::read_to_string(&path).unwrap();
                sources.push(Source {
                    path: names.join("/"),
                    code: without_comments_and_texts(&text),
                });
            }
        }
    }
    sources.retain(|source| !["main.rs", "lib.rs"].contains(&source.path.as_str()));
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    assert!(sources.len() > 100, "the sources are not there");
    sources
}

/// The room of each exported macro, which stands at the root of the crate wherever it is written.
fn macros(sources: &[Source]) -> BTreeMap<String, &str> {
    let mut found = BTreeMap::new();
    for source in sources {
        for (at, _) in words(&source.code, "macro_export") {
            let name = source.code[at..].split_once("macro_rules!");
            let name = name.map(|(_, rest)| rest.trim_start());
            let name: String = (name.unwrap_or_default().chars())
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            found.insert(name, source.room());
        }
    }
    found
}

/// Who uses whom. Every path from the root has to begin with a room or an exported macro.
fn uses(sources: &[Source]) -> Uses {
    let rooms: BTreeSet<&str> = sources.iter().map(Source::room).collect();
    let macros = macros(sources);
    let mut uses = Uses::new();
    for source in sources {
        let own = uses.entry(source.room().to_owned()).or_default();
        for root in source.roots() {
            let root = macros.get(&root).map_or(root, |room| (*room).to_owned());
            assert!(
                rooms.contains(root.as_str()),
                "{}: crate::{root} is no room",
                source.path
            );
            if root != source.room() {
                own.entry(root).or_insert_with(|| source.path.clone());
            }
        }
    }
    uses
}

/// The rooms from `from` to `to`, both included, by the fewest steps.
fn way(uses: &Uses, from: &str, to: &str) -> Option<Vec<String>> {
    let mut ways = std::collections::VecDeque::from([vec![from.to_owned()]]);
    let mut seen = BTreeSet::new();
    while let Some(way) = ways.pop_front() {
        let last = &way[way.len() - 1];
        if last == to {
            return Some(way);
        }
        for next in uses.get(last).into_iter().flat_map(BTreeMap::keys) {
            if seen.insert(next.clone()) {
                ways.push_back(way.iter().chain([next]).cloned().collect());
            }
        }
    }
    None
}

/// A circle, as `a → b → a` with the file of each use.
fn circle(uses: &Uses) -> Option<String> {
    uses.iter().find_map(|(room, used)| {
        let back = used.keys().find_map(|next| way(uses, next, room))?;
        let rooms: Vec<&String> = std::iter::once(room).chain(&back).collect();
        let steps = rooms.windows(2).map(|pair| {
            let file = &uses[pair[0]][pair[1]];
            format!("{} → {} ({file})", pair[0], pair[1])
        });
        Some(steps.collect::<Vec<_>>().join(", "))
    })
}

/// The rooms in the order of the table in `src/lib.rs`, from its text.
fn table(text: &str) -> Vec<&str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("//! | [`")?.split_once("`] | "))
        .map(|(room, _)| room)
        .collect()
}

/// A use of a room that does not stand below its user in `order`, as `a → b` with the file of the use.
fn upward_use(uses: &Uses, order: &[&str]) -> Option<String> {
    let row = |room: &str| order.iter().position(|listed| *listed == room);
    uses.iter().find_map(|(room, used)| {
        let (above, file) = used.iter().find(|(next, _)| row(next) < row(room))?;
        Some(format!("{room} → {above} ({file})"))
    })
}

#[test]
fn the_reference_stands_alone() {
    let uses = uses(&sources());
    let used = uses.get("reference").expect("the reference");
    for (room, file) in used {
        assert!(
            UNDER_THE_REFERENCE.contains(&room.as_str()),
            "src/{file} uses {room}; the reference may use {UNDER_THE_REFERENCE:?}"
        );
    }
    // The list has no more than is needed.
    for room in UNDER_THE_REFERENCE {
        assert!(used.contains_key(room), "the reference does not use {room}");
    }
}

#[test]
fn the_engine_runs_without_the_laboratory() {
    let uses = uses(&sources());
    assert!(uses.contains_key("lab"), "there is no laboratory");
    for (room, used) in &uses {
        if let Some(file) = used.get("lab") {
            assert!(
                ABOVE_THE_LAB.contains(&room.as_str()),
                "src/{file} uses lab; only {ABOVE_THE_LAB:?} may"
            );
        }
    }
}

#[test]
fn rooms_are_in_no_circle() {
    let uses = uses(&sources());
    if let Some(circle) = circle(&uses) {
        panic!("rooms that use each other in a circle: {circle}");
    }
}

#[test]
fn rooms_use_only_rooms_below_them_in_the_table() {
    let text = std::fs::read_to_string(folder().join("lib.rs")).unwrap();
    let (order, sources) = (table(&text), sources());
    let mut listed = order.clone();
    listed.sort_unstable();
    let rooms: BTreeSet<&str> = sources.iter().map(Source::room).collect();
    let rooms: Vec<&str> = rooms.into_iter().collect();
    assert_eq!(listed, rooms, "src/lib.rs lists every room once");
    if let Some(upward) = upward_use(&uses(&sources), &order) {
        panic!("a room uses a room above it in the table of src/lib.rs: {upward}");
    }
}

#[test]
fn only_the_waves_know_how_water_is_represented() {
    let waves = std::fs::read_to_string(folder().join("waves/mod.rs")).unwrap();
    let waves = without_comments_and_texts(&waves);
    assert!(waves.contains("\nmod sines;"), "a kind of water is private");
    assert!(!waves.contains("sines::"), "nothing of a kind leaves waves");
}

fn source(path: &str, text: &str) -> Source {
    Source {
        path: path.to_owned(),
        code: without_comments_and_texts(text),
    }
}

fn roots(path: &str, text: &str) -> Vec<String> {
    source(path, text).roots().into_iter().collect()
}

#[test]
fn uses_are_found_however_they_are_written() {
    assert_eq!(roots("a/b.rs", "use crate::x::y;"), ["x"]);
    assert_eq!(
        roots(
            "a/b.rs",
            "use crate::{\n  self, p,\n  q::{r, s::{t}}, u::*,\n};"
        ),
        ["p", "q", "u"]
    );
    assert_eq!(
        roots("a.rs", "fn f() -> crate :: x::T { $crate::z!() }"),
        ["x", "z"]
    );
    // Up to the root, and no further than the own room.
    assert_eq!(
        roots("a/b.rs", "use super::super::x::Y; use super::c;"),
        ["x"]
    );
    assert_eq!(
        roots("a/mod.rs", "use super::{x, y::Z}; use self::c;"),
        ["x", "y"]
    );
    assert_eq!(roots("a/b/c.rs", "use super::super::x;"), [] as [&str; 0]);
    assert_eq!(
        roots("a/b.rs", "pub(super) fn f(); pub(crate) fn g();"),
        [] as [&str; 0]
    );
    // What is not code.
    let no_code = r##"
        //! See [`crate::x`].
        /* crate::x /* and */ crate::y */
        const A: &str = "crate::x \" crate::y";
        const B: &str = r#"crate::x " crate::y"#;
        fn f<'a>(q: char) -> &'a str { if q == '"' || q == '\'' { "crate::x" } else { "" } }
        fn my_crate() { other_crate::x(); }
    "##;
    assert_eq!(roots("a/b.rs", no_code), [] as [&str; 0]);
    let after = format!("{no_code} use crate::z;");
    assert_eq!(roots("a/b.rs", &after), ["z"]);
}

#[test]
fn circles_are_found() {
    let tree = |files: &[(&str, &str)]| {
        let sources = files.iter().map(|(path, text)| source(path, text));
        circle(&uses(&sources.collect::<Vec<_>>()))
    };
    assert_eq!(
        tree(&[
            ("a.rs", "use crate::{b, c};"),
            ("b.rs", "use crate::c;"),
            ("c/mod.rs", "")
        ]),
        None
    );
    let found = tree(&[
        ("a.rs", "use crate::b;"),
        ("b.rs", ""),
        ("b/x.rs", "use crate::c;"),
        ("c/y.rs", "fn f() { crate::a::f() }"),
    ]);
    let expected = "a → b (a.rs), b → c (b/x.rs), c → a (c/y.rs)";
    assert_eq!(found.as_deref(), Some(expected));
    assert_eq!(
        tree(&[("a/b.rs", "use crate::a::c;")]),
        None,
        "a room may use itself"
    );
}

#[test]
fn upward_uses_are_found() {
    let lib = "//! | room | holds |\n//! |---|---|\n//! | [`a`] | x |\n//! | [`b`] | see [`c`] |\npub mod a;";
    assert_eq!(table(lib), ["a", "b"]);
    let sources = [source("a.rs", "use crate::b;"), source("b/x.rs", "")];
    let uses = uses(&sources);
    assert_eq!(upward_use(&uses, &["a", "b"]), None);
    let found = upward_use(&uses, &["b", "a"]);
    assert_eq!(found.as_deref(), Some("a → b (a.rs)"));
}
