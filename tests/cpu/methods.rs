//! Methods: their dials, their choice in a scene, and that no other source file or document lists them by hand.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use caustica::config::Limits;
use caustica::lab::study::comparison::contenders;
use caustica::methods::planes::{SLICING, SMART};
use caustica::methods::reference_planes::PLANES;
use caustica::methods::{self, Conformance, Method};
use caustica::scene::{Dial, DialKind, DialValue, Issue, MethodChoice, Quality, Scene};
use serde_json::{Value, json};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn quality(method: &Value) -> Quality {
    let scene = Scene::from_value(json!({ "quality": { "method": method } }));
    scene.unwrap_or_else(|e| panic!("{method}: {e}")).quality
}

fn pointers(issues: &[Issue]) -> Vec<&str> {
    issues.iter().map(|issue| issue.pointer.as_str()).collect()
}

#[test]
fn dials_are_well_formed() {
    let quality = json!(Quality {
        method: MethodChoice::named("any"),
        target_error: Some(0.1),
        time_budget_ms: Some(1.0),
        ..Quality::default()
    });
    for method in methods::ALL {
        let mut names = BTreeSet::new();
        for dial in method.dials {
            let name = dial.name;
            assert!(names.insert(name), "{method:?} has {name} twice");
            let is_snake = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
            assert!(name.chars().all(is_snake), "{method:?}: {name}");
            assert_ne!(name, "kind", "{method:?}");
            assert!(
                quality.get(name).is_none(),
                "{method:?}: `quality` has a field {name}"
            );
            assert!(
                dial.help.len() > 20 && dial.help.ends_with('.'),
                "{method:?}: {name}"
            );
            assert!(
                dial.accepts(&dial.default_value()),
                "{method:?}: the default of {name} is not accepted"
            );
            if let DialKind::Word { words, .. } = dial.kind {
                assert!(words.len() > 1, "{method:?}: {name}");
                assert!(words.iter().all(|word| word.help.len() > 5));
            }
        }
        for shared in method.shared_dials {
            assert!(quality.get(shared).is_some(), "{method:?}: {shared}");
        }
    }
}

#[test]
fn dials_are_read_from_the_scene_or_have_their_defaults() {
    let set = quality(&json!({ "kind": "planes", "planes": 7.0, "slicing": "smart" }));
    assert_eq!(PLANES.integer(&set), 7);
    assert_eq!(PLANES.number(&set), 7.0);
    assert_eq!(SLICING.word(&set), SMART);
    let unset = Quality::default();
    assert_eq!(PLANES.integer(&unset), 51);
    assert_eq!(SLICING.word(&unset), "uniform");
    // What a check refuses never reaches a shader.
    for planes in [
        json!(1),
        json!(1025),
        json!(2.5),
        json!(1e300),
        json!("many"),
    ] {
        let refused = quality(&json!({ "kind": "planes", "planes": planes }));
        assert_eq!(PLANES.integer(&refused), 51, "{planes}");
    }
    let refused = quality(&json!({ "kind": "planes", "slicing": 3 }));
    assert_eq!(SLICING.word(&refused), "uniform");
}

#[test]
fn numbers_are_checked_against_their_range() {
    static SHARE: Dial = Dial {
        name: "share",
        help: "A share.",
        kind: DialKind::Number {
            least: 0.0,
            most: 1.0,
            default: 0.25,
        },
    };
    assert!(SHARE.accepts(&0.5.into()) && !SHARE.accepts(&1.5.into()));
    assert!(!SHARE.accepts(&f64::NAN.into()) && !SHARE.accepts(&"half".into()));
    assert_eq!(SHARE.accepted(), "a number, 0 … 1");
    assert_eq!(SHARE.documentation(), "A share. 0 … 1. Default 0.25.");
    let quality = Quality {
        method: MethodChoice::default().with(&SHARE, 0.5),
        ..Quality::default()
    };
    assert_eq!(SHARE.number(&quality), 0.5);
    assert_eq!(SHARE.number(&Quality::default()), 0.25);
}

#[test]
fn errors_of_a_method_are_reported_at_their_place() {
    let cases = [
        (json!("magic"), "/quality/method", "unknown method `magic`"),
        (
            json!("level-map"),
            "/quality/method",
            "did you mean `level_map`?",
        ),
        (
            json!({ "kind": "plains", "planes": 3 }),
            "/quality/method/kind",
            "did you mean `planes`?",
        ),
        (
            json!({ "kind": "planes", "plane": 3 }),
            "/quality/method/plane",
            "method planes has no dial `plane`; did you mean `planes`?",
        ),
        (
            json!({ "planes": 3 }),
            "/quality/method/planes",
            "method level_map has no dial `planes`; it belongs to `planes` or `volumetric`",
        ),
        (
            json!({ "kind": "volumetric", "slicing": "smart" }),
            "/quality/method/slicing",
            "method volumetric has no dial `slicing`; it belongs to `planes`",
        ),
        (
            json!({ "kind": "planes", "planes": 1 }),
            "/quality/method/planes",
            "1 is out of range",
        ),
        (
            json!({ "kind": "planes", "planes": 2.5 }),
            "/quality/method/planes",
            "the number 2.5 is not whole",
        ),
        (
            json!({ "kind": "planes", "planes": "few" }),
            "/quality/method/planes",
            "the string \"few\" is of the wrong type",
        ),
        (
            json!({ "kind": "planes", "slicing": 3 }),
            "/quality/method/slicing",
            "the number 3 is of the wrong type",
        ),
        (
            json!({ "kind": "planes", "slicing": "smarte" }),
            "/quality/method/slicing",
            "did you mean `smart`?",
        ),
        (
            json!({ "kind": "planes", "a/b~": 3 }),
            "/quality/method/a~1b~0",
            "method planes has no dial `a/b~`",
        ),
    ];
    for (method, pointer, detail) in cases {
        let issues = methods::check(&quality(&method));
        assert_eq!(pointers(&issues), [pointer], "{method}");
        assert!(issues[0].detail.contains(detail), "{method}: {}", issues[0]);
        assert!(!issues[0].accepted.is_empty(), "{method}");
    }
    let mut many = json!({ "kind": "planes" });
    for k in 0..1000 {
        many[format!("x{k}")] = json!(k);
    }
    let issues = methods::check(&quality(&many));
    assert_eq!(issues.len(), 21);
    assert!(issues[20].detail.starts_with("980 more findings"));
}

#[test]
fn values_that_are_not_a_choice_are_refused_on_reading() {
    for (method, pointer) in [
        (json!(3), "/quality/method"),
        (json!(null), "/quality/method"),
        (json!(["planes"]), "/quality/method"),
        (json!({ "kind": 3 }), "/quality/method/kind"),
        (json!({ "kind": null }), "/quality/method/kind"),
        (
            json!({ "kind": "planes", "planes": [3] }),
            "/quality/method/planes",
        ),
        (
            json!({ "kind": "planes", "planes": true }),
            "/quality/method/planes",
        ),
        (
            json!({ "kind": "planes", "planes": null }),
            "/quality/method/planes",
        ),
    ] {
        let scene = json!({ "quality": { "method": method } });
        let error = Scene::from_value(scene).unwrap_err();
        assert_eq!(pointers(&error.issues), [pointer], "{method}: {error}");
        assert!(!error.issues[0].accepted.is_empty(), "{error}");
    }
}

/// The fields that were in `quality` before methods had dials of their own.
#[test]
fn removed_fields_report_what_to_write_instead() {
    for (field, value, instead) in [
        (
            "placement",
            json!("planes"),
            "`method` with the value that `placement` had",
        ),
        (
            "planes",
            json!(25),
            r#"`"method": { "kind": "…", "planes": … }`"#,
        ),
        (
            "slicing",
            json!("smart"),
            r#"`"method": { "kind": "…", "slicing": … }`"#,
        ),
    ] {
        let scene = json!({ "quality": { field: value } });
        let error = Scene::from_value(scene).unwrap_err();
        assert_eq!(error.issues.len(), 1);
        let issue = &error.issues[0];
        assert_eq!(issue.pointer, format!("/quality/{field}"));
        assert!(issue.accepted.starts_with(instead), "{issue}");
    }
    // A misspelt name is reported as such, there and elsewhere.
    for scene in [
        json!({ "quality": { "water_cell": 3 } }),
        json!({ "floor": { "placement": 3 } }),
    ] {
        let issue = Scene::from_value(scene).unwrap_err().issues.remove(0);
        assert!(issue.accepted.starts_with("the fields "), "{issue}");
    }
}

#[test]
fn all_findings_come_together() {
    let scene = json!({
        "time_s": 1e99,
        "objects": [{ "mesh": "blake3:00" }],
        "quality": { "method": { "kind": "planes", "planes": 1 }, "target_error": 0.1 },
        "output": { "kind": "irradiance_map", "receiver": 0 }
    });
    let scene = Scene::from_value(scene).unwrap();
    let error = methods::resolve(scene.clone(), &Limits::default(), |_: &str| None).unwrap_err();
    let of_method = ["/quality/method", "/quality/method/planes"];
    assert_eq!(
        pointers(&error.issues),
        ["/time_s", "/objects/0/mesh", of_method[0], of_method[1]]
    );
    let error = methods::validate(&scene, &Limits::default()).unwrap_err();
    assert_eq!(
        pointers(&error.issues),
        ["/time_s", of_method[0], of_method[1]]
    );
}

fn resolved(method: &Value) -> caustica::scene::ResolvedScene {
    let scene = json!({
        "quality": { "method": method },
        "floor": { "depth_m": 1, "size_m": [1, 1] },
        "output": { "kind": "irradiance_map", "receiver": "floor" }
    });
    let scene = Scene::from_value(scene).unwrap();
    methods::resolve(scene, &Limits::default(), |_: &str| None).unwrap()
}

#[test]
fn equal_choices_are_written_alike_and_hash_alike() {
    let default = methods::ALL[0].name;
    let alike = [
        vec![json!(default), json!({}), json!({ "kind": default })],
        vec![
            json!("planes"),
            json!({ "kind": "planes" }),
            json!({ "kind": "planes", "planes": 51 }),
            json!({ "kind": "planes", "slicing": "uniform", "planes": 51.0 }),
        ],
        vec![
            json!({ "kind": "planes", "planes": 7 }),
            json!({ "slicing": "uniform", "planes": 7.0, "kind": "planes" }),
        ],
        vec![json!({ "kind": "planes", "planes": 8 })],
        vec![json!("volumetric")],
    ];
    let mut hashes = BTreeSet::new();
    for same in alike {
        let each: BTreeSet<String> = same.iter().map(|method| resolved(method).hash()).collect();
        assert_eq!(each.len(), 1, "{same:?}");
        hashes.extend(each);
    }
    assert_eq!(hashes.len(), 5);
    let written = |method: Value| json!(resolved(&method).scene)["quality"]["method"].clone();
    assert_eq!(written(json!(default)), Value::Null, "left out");
    assert_eq!(written(json!({ "kind": "planes" })), json!("planes"));
    let dials = json!({ "kind": "planes", "planes": 7 });
    assert_eq!(written(dials.clone()), dials);
}

#[test]
fn choices_read_as_they_were_written() {
    for (method, text) in [
        (json!("planes"), r#""planes""#),
        (json!({ "kind": "a", "n": 3.0 }), r#"{"kind":"a","n":3}"#),
        (json!({ "n": 0.1, "w": "x" }), r#"{"n":0.1,"w":"x"}"#),
        (
            json!({ "kind": "a", "n": 1e300 }),
            r#"{"kind":"a","n":1e+300}"#,
        ),
    ] {
        let read = quality(&method).method;
        let written = serde_json::to_string(&read).unwrap();
        assert_eq!(written, text);
        let again = quality(&serde_json::from_str(&written).unwrap()).method;
        assert_eq!(again, read);
    }
    assert!(quality(&json!({})).method.is_default());
    assert_eq!(DialValue::from(3_u32), DialValue::from(3.0));
}

#[test]
fn facts_of_unchecked_scenes_are_safe() {
    let mut scene = resolved(&json!("planes"));
    for (method, pointer) in [
        (json!("magic"), "/quality/method"),
        (
            json!({ "kind": "planes", "planes": 4000 }),
            "/quality/method/planes",
        ),
    ] {
        scene.scene.quality = quality(&method);
        let error = methods::facts(&scene).unwrap_err();
        assert_eq!(pointers(&error.issues), [pointer]);
    }
}

#[test]
fn a_method_that_refuses_a_scene_is_reported_with_its_reason() {
    const REASON: &str = "it needs a floor of sand";
    let refusing = Method {
        name: "refusing",
        supports: |_| Err(REASON.to_owned()),
        conformance: Conformance {
            sine_pool_error_at_256: 0.0,
            skips: &[],
        },
        ..*methods::ALL[0]
    };
    let facts = methods::facts(&resolved(&json!({}))).unwrap();
    let error = refusing.accepts(&facts).unwrap_err();
    assert_eq!(pointers(&error.issues), ["/quality/method"]);
    assert!(error.issues[0].detail.contains(REASON), "{error}");
    for other in methods::ALL {
        assert!(error.issues[0].accepted.contains(other.name), "{error}");
    }
}

#[test]
fn every_dial_is_a_field_that_says_whose_it_is() {
    let fields = methods::fields();
    let mut flags = BTreeSet::new();
    for field in &fields {
        assert!(flags.insert(&field.flag), "--{} is there twice", field.flag);
    }
    for method in methods::ALL {
        for dial in method.dials {
            let pointer = format!("/quality/method/{}", dial.name);
            let found: Vec<_> = fields.iter().filter(|f| f.pointer == pointer).collect();
            assert_eq!(found.len(), 1, "{pointer}");
            assert!(found[0].help.contains(method.name), "{}", found[0].help);
        }
    }
    let words = |name: &str| {
        let field = fields.iter().find(|field| field.name == name);
        field.unwrap().words.clone()
    };
    assert_eq!(words("method"), methods::ALL.map(|method| method.name));
    assert_eq!(words("slicing"), ["uniform", SMART]);
    let planes = fields.iter().find(|field| field.name == "planes").unwrap();
    assert!(
        planes.help.starts_with("Methods planes, volumetric: "),
        "{}",
        planes.help
    );
    assert!(planes.help.contains("2 … 1024. Default 51."));
}

// What is said of methods in the readme.

const START: &str =
    "<!-- made from methods::ALL by BLESS=1 cargo test --test cpu methods; a test compares -->\n";
const END: &str = "<!-- end of what is made -->\n";

fn order(method: &Method) -> String {
    match method.expected_order {
        0.0 => "stays above 0".to_owned(),
        order => format!("falls with the cells' size to the power {order}"),
    }
}

fn tables() -> String {
    let mut text = String::from(
        "| method | does | source | error | conserves energy | state |\n|---|---|---|---|---|---|\n",
    );
    for (k, method) in methods::ALL.iter().enumerate() {
        let facts = method.facts_of_default();
        writeln!(
            text,
            "| `{}` | {} | {} | {} | {} | works{} |",
            method.name,
            method.summary,
            method.paper,
            order(method),
            if facts.conserves_energy { "yes" } else { "no" },
            if k == 0 { ", the default" } else { "" },
        )
        .unwrap();
    }
    text.push_str("\n| dial of a method | does |\n|---|---|\n");
    for field in methods::fields() {
        if field.pointer.starts_with("/quality/method/") {
            writeln!(text, "| `{}` | {} |", field.name, field.help).unwrap();
        }
    }
    text
}

#[test]
fn the_readme_has_the_table_of_methods() {
    let path = root().join("README.md");
    let readme = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = readme.split_once(START).expect("the start of the tables");
    let (found, after) = rest.split_once(END).expect("the end of the tables");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, [before, START, &tables(), END, after].concat()).unwrap();
        return;
    }
    assert!(
        found == tables(),
        "the tables of methods in README.md are not what the code says; BLESS=1 rewrites them"
    );
}

#[test]
fn choices_that_the_papers_show_are_accepted() {
    let mut shown = 0;
    for name in ["README.md", "CHANGELOG.md"] {
        let text = std::fs::read_to_string(root().join(name)).unwrap();
        for part in text.split("\"method\": ").skip(1) {
            let mut values = serde_json::Deserializer::from_str(part).into_iter::<Value>();
            let Some(Ok(method)) = values.next() else {
                continue;
            };
            shown += 1;
            // A list is the dial of a study.
            if let Value::Array(values) = &method {
                let names: Vec<String> = values
                    .iter()
                    .map(|value| value.as_str().unwrap().to_owned())
                    .collect();
                contenders(&names, &resolved(&json!({})), 2)
                    .unwrap_or_else(|error| panic!("{name}: {method}: {error}"));
                continue;
            }
            let issues = methods::check(&quality(&method));
            assert!(issues.is_empty(), "{name}: {method}: {issues:?}");
        }
    }
    assert!(shown >= 3, "{shown}");
}

// Who may name a method.

/// Lines that have the name of a method and mean something else: file, text of the line, and what it means.
const OTHER_MEANINGS: [(&str, &str, &str); 5] = [
    ("src/stages/level_map.rs", "name: \"level_map\"", "a pass"),
    (
        "src/image/metadata.rs",
        "CACHED_PASS_PREFIX: &str = \"level_map\"",
        "the start of names of passes",
    ),
    (
        "src/stages/reference_planes.rs",
        "(\"planes\", planes_uniform(",
        "a variable of shaders",
    ),
    (
        "src/methods/reference_planes.rs",
        "name: \"planes\"",
        "a dial",
    ),
    (
        "src/methods/volumetric/slice_deposit.rs",
        "(\"planes\", Planes::LAYOUT)",
        "a variable of shaders",
    ),
];

/// Names of methods that mean nothing else, so that they count within any identifier. Other names are words of other things too (the
/// level map of a mesh, more than one plane) and count in quotes and in paths.
const DISTINCTIVE: [&str; 3] = ["volumetric", "caustic_volume", "sub_volume"];

/// Places that may name any method: the list of them, and the thesis's own experiment, which compares just these. The folder of a method
/// may name that method.
const MAY_NAME: [&str; 2] = ["src/methods/mod.rs", "src/lab/experiment/"];

/// Names of every method's own files, without extension.
static OWN_FILES: LazyLock<Vec<(&Method, BTreeSet<String>)>> =
    LazyLock::new(|| Vec::from(methods::ALL.map(|method| (method, own_files(method)))));

fn own_files(method: &Method) -> BTreeSet<String> {
    let mut found = Vec::new();
    for (folder, extension) in [("src/methods", "rs"), ("shaders/methods", "wgsl")] {
        let folder = root().join(folder).join(method.name);
        if folder.is_dir() {
            sources(&folder, extension, &mut found);
        }
    }
    let names = found.iter().filter_map(|path| path.file_stem()?.to_str());
    names
        // Names of one word may be words of other things.
        .filter(|name| name.contains('_'))
        .map(str::to_owned)
        .collect()
}

fn sources(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, extension, found);
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
}

/// Code without comments.
fn code(text: &str) -> String {
    let lines = text.lines().map(|line| match line.trim_start() {
        comment if comment.starts_with("//") => "",
        _ => line.split_once(" // ").map_or(line, |(code, _)| code),
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// A word as it is in snake case, in camel case and in capitals alike.
fn folded(word: &str) -> String {
    word.replace('_', "").to_lowercase()
}

/// What paths through `module` (such as `methods::`) name: the word behind it, or all words of the braces there.
fn words_behind<'a>(module: &str, code: &'a str) -> Vec<&'a str> {
    code.split(module)
        .skip(1)
        .flat_map(|rest| {
            let list = match rest.strip_prefix('{') {
                Some(braces) => braces.split(';').next().unwrap_or_default(),
                None => rest.split(|c| !is_word(c)).next().unwrap_or_default(),
            };
            list.split(|c| !is_word(c))
        })
        .collect()
}

/// Whether a line of code names a method in quotes, as a folder or within a word, or has the name of one of its own files as a word.
fn names_it(line: &str, name: &str, files: &BTreeSet<String>) -> bool {
    let texts = [format!("\"{name}\""), format!("methods/{name}/")];
    if texts.iter().any(|text| line.contains(text.as_str())) {
        return true;
    }
    let is_distinctive = DISTINCTIVE.contains(&name);
    let mut words = line.split(|c| !is_word(c)).map(folded);
    words.any(|word| {
        let has_name = is_distinctive && word.contains(&folded(name));
        has_name || files.iter().any(|file| word == folded(file))
    })
}

/// Where the code of the file at `place` names a method other than its own. It does not see common words without quotes or path, modules
/// under another name (`use crate::methods as m`), what stands behind ` // ` in a string, and texts put together; block comments it takes
/// for code.
fn names_of_methods(code: &str, place: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut paths = words_behind("methods::", code);
    if place.starts_with("src/methods/") {
        paths.extend(words_behind("super::", code));
    }
    for (method, files) in OWN_FILES.iter() {
        let name = method.name;
        let own = [
            format!("src/methods/{name}/"),
            format!("shaders/methods/{name}/"),
        ];
        if own.iter().any(|folder| place.starts_with(folder.as_str())) {
            continue;
        }
        let lines = code.lines().filter(|line| names_it(line, name, files));
        found.extend(lines.map(|line| line.trim().to_owned()));
        if paths.contains(&name) {
            found.push(format!("methods::{name}"));
        }
    }
    found
}

#[test]
fn no_other_source_file_names_a_method() {
    let mut files = Vec::new();
    sources(&root().join("src"), "rs", &mut files);
    assert!(files.len() > 100, "{}", files.len());
    let rust = files.len();
    sources(&root().join("shaders"), "wgsl", &mut files);
    assert!(files.len() > rust + 40, "{}", files.len());
    files.sort();
    let mut unused: Vec<_> = OTHER_MEANINGS.to_vec();
    let mut offences = Vec::new();
    for path in files {
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        if MAY_NAME.iter().any(|place| name.starts_with(place)) {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for line in names_of_methods(&code(&text), &name) {
            let is_other =
                |(file, text, _): &(&str, &str, &str)| *file == name && line.contains(text);
            if OTHER_MEANINGS.iter().any(is_other) {
                unused.retain(|other| !is_other(other));
            } else {
                offences.push(format!("{name}: {line}"));
            }
        }
    }
    assert!(offences.is_empty(), "{offences:#?}");
    assert!(unused.is_empty(), "no longer there: {unused:?}");
}

#[test]
fn names_of_methods_are_found() {
    let found = |text: &str, place: &str| !names_of_methods(&code(text), place).is_empty();
    for text in [
        "let a = \"planes\";",
        "use crate::methods::planes;",
        "use crate::methods::{self, planes::SLICING};",
        "methods::level_map::METHOD.name",
        "let a = is_volumetric(facts);",
        "enum Kind { Volumetric, Other }",
        "#import \"methods/planes/anything.wgsl\"",
        "\"slice_deposit\" => 3,",
        "struct PlaneDeposit;",
    ] {
        assert!(found(text, "src/plan/mod.rs"), "{text}");
    }
    for text in [
        "// as \"planes\" does",
        "    /// See `methods::planes`.",
        "call(); // methods::planes",
        "    plane: u32,     // the current plane (volumetric)",
        "use crate::methods::planes_of;",
        "use crate::stages::level_map;",
        "use super::level_map;",
        "let a = \"planes_main\";",
        "let planes = stats.planes;",
    ] {
        assert!(!found(text, "src/stages/mod.rs"), "{text}");
    }
    // A method may name itself, and no other.
    for (text, own, other) in [
        ("use super::planes::SMART;", "planes", "volumetric"),
        ("fn volumetric_main() {}", "volumetric", "planes"),
        ("\"level_map\"", "level_map", "planes"),
    ] {
        for top in ["src", "shaders"] {
            let place = |folder: &str| format!("{top}/methods/{folder}/file");
            assert!(!found(text, &place(own)), "{text}");
            let is_path_in_wgsl = top == "shaders" && text.contains("super::");
            assert_eq!(found(text, &place(other)), !is_path_in_wgsl, "{text}");
        }
    }
}
