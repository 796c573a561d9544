//! Consistency of files that refer to each other: Makefile, Dockerfile, scripts, manifest, README.

use std::path::{Path, PathBuf};
use std::process::Command;

const INSTALLER: &str = "deploy/install-deps.sh";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The value of a `key = "value"` line of the manifest.
fn manifest(key: &str) -> String {
    let manifest = text("Cargo.toml");
    manifest
        .lines()
        .find_map(|line| line.strip_prefix(key)?.trim().strip_prefix('='))
        .map(|value| value.trim().trim_matches('"').to_owned())
        .unwrap_or_else(|| panic!("Cargo.toml has no {key}"))
}

/// The words of a Dockerfile instruction in JSON form, such as `CMD ["a", "b"]`.
fn json_words(dockerfile: &str, instruction: &str) -> Vec<String> {
    let line = dockerfile
        .lines()
        .find(|line| line.starts_with(instruction))
        .unwrap_or_else(|| panic!("the Dockerfile has no {instruction}"));
    let start = line.find('[').expect("a list in JSON form");
    serde_json::from_str(&line[start..]).expect("a list in JSON form")
}

/// Names of the Makefile's targets.
fn targets() -> Vec<String> {
    text("Makefile")
        .lines()
        .filter(|line| !line.starts_with(['\t', '#', '.', ' ']) && !line.contains('='))
        .filter_map(|line| Some(line.split_once(':')?.0.trim().to_owned()))
        .collect()
}

#[test]
fn one_script_installs_for_make_docker_and_ci() {
    let makefile = text("Makefile");
    assert!(makefile.contains(&format!("./{INSTALLER} --build --run")));
    let dockerfile = text("Dockerfile");
    let stages: Vec<&str> = dockerfile.split("\nFROM ").skip(1).collect();
    let [build, run] = stages.as_slice() else {
        panic!("two stages are expected: {stages:?}");
    };
    assert!(build.contains(&format!("RUN {INSTALLER} --build")));
    assert!(run.contains(&format!("source={INSTALLER}")));
    assert!(run.contains("/install-deps.sh --container"));
    // Nobody keeps a second list of packages.
    for path in ["Makefile", "Dockerfile", ".ci/run"] {
        assert!(
            !text(path).contains("apt-get install"),
            "{path} installs by itself"
        );
    }
    assert!(text(".ci/run").contains(INSTALLER));
}

#[test]
fn scripts_can_be_run_and_read() {
    for path in [INSTALLER, ".ci/run"] {
        let file = root().join(path);
        assert!(is_executable(&file), "{path} is not executable");
        let shell = text(path);
        let shell = shell.lines().next().unwrap_or_default();
        let shell = if shell.ends_with("bash") {
            "bash"
        } else {
            "sh"
        };
        let status = Command::new(shell)
            .arg("-n")
            .arg(&file)
            .status()
            .expect("a shell");
        assert!(status.success(), "{path} is not valid {shell}");
    }
}

#[cfg(unix)]
fn is_executable(file: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    let metadata = std::fs::metadata(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    metadata.permissions().mode() & 0o111 == 0o111
}

#[cfg(not(unix))]
fn is_executable(file: &Path) -> bool {
    file.exists()
}

#[cfg(unix)]
#[test]
fn the_installer_explains_itself_and_refuses_typing_errors() {
    let run = |argument: &str| {
        Command::new(root().join(INSTALLER))
            .arg(argument)
            .output()
            .expect("the script")
    };
    let help = run("--help");
    assert!(help.status.success());
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    for option in ["--build", "--run", "--container", "--lint"] {
        assert!(help.contains(option), "{help}");
    }
    assert!(!help.contains("set -eu"), "only the comment: {help}");
    let wrong = run("--biuld");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("unknown option --biuld"));
}

#[cfg(unix)]
#[test]
fn the_installer_adds_what_linting_needs_or_says_what_is_missing() {
    // Programs are functions of the shell that reads the installer, and there are no others.
    let lint = |programs: &str| {
        let installer = root().join(INSTALLER);
        let script = format!("{programs}\nset -- --lint\n. '{}'", installer.display());
        let output = Command::new("/bin/sh")
            .args(["-c", &script])
            .env("PATH", "/nowhere")
            .output()
            .expect("a shell");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let [out, err] = [text(&output.stdout), text(&output.stderr)];
        (output.status.code(), out, err)
    };
    let complete = "cargo() { :; }\nrustup() { echo \"rustup $*\" >&2; }";
    assert_eq!(lint(complete), (Some(0), String::new(), String::new()));

    let minimal = "cargo() { [ -n \"${added-}\" ]; }";
    let with_rustup = format!("{minimal}\nrustup() {{ echo \"rustup $*\" >&2; added=yes; }}");
    let (code, _, told) = lint(&with_rustup);
    assert_eq!(code, Some(0), "{told}");
    assert!(
        told.contains("rustup component add rustfmt clippy\n"),
        "{told}"
    );

    // Without rustup, or where it cannot help.
    let helpless = format!("{minimal}\nrustup() {{ :; }}");
    for programs in [minimal, helpless.as_str()] {
        let (code, _, told) = lint(programs);
        assert_eq!(code, Some(1), "{told}");
        assert!(told.contains("please install rustfmt and clippy"), "{told}");
    }
    let makefile = text("Makefile");
    let (_, recipe) = makefile.split_once("\nlint: ").expect("a target");
    let asks = format!("./{INSTALLER} --lint\n");
    assert!(recipe.find(&asks) < recipe.find("fmt --check"), "{recipe}");
    assert!(recipe.contains(&asks), "{recipe}");
}

#[test]
fn the_program_has_one_name() {
    let name = manifest("default-run");
    assert_eq!(name, manifest("name"));
    let dockerfile = text("Dockerfile");
    assert_eq!(json_words(&dockerfile, "ENTRYPOINT"), [name.as_str()]);
    assert_eq!(json_words(&dockerfile, "HEALTHCHECK")[0], name);
    assert!(dockerfile.contains(&format!("target/release/{name} ")));
    assert!(text("Makefile").contains(&format!("/release/{name}\n")));
}

#[test]
fn the_image_is_built_with_the_rust_of_the_manifest() {
    let wanted = format!(
        "FROM rust:{}-slim-bookworm AS build",
        manifest("rust-version")
    );
    let dockerfile = text("Dockerfile");
    assert!(
        dockerfile.lines().any(|line| line == wanted),
        "no line {wanted:?}"
    );
}

#[test]
fn the_image_listens_where_it_says() {
    let dockerfile = text("Dockerfile");
    assert!(dockerfile.contains("CAUSTICA_LISTEN=0.0.0.0:8080\n"));
    assert!(dockerfile.contains("\nEXPOSE 8080\n"));
    assert!(dockerfile.contains("NVIDIA_DRIVER_CAPABILITIES=compute,utility,graphics"));
    assert!(dockerfile.contains("\nUSER caustica\n"), "not as root");
    // The setting exists under that name.
    assert!(text("src/config.rs").contains("env = \"CAUSTICA_LISTEN\""));
}

/// What the container's health check runs is a command of the program.
#[test]
fn the_health_check_is_a_command() {
    let dockerfile = text("Dockerfile");
    let words = json_words(&dockerfile, "HEALTHCHECK");
    let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(&words[1..])
        .arg("--help")
        .output()
        .expect("the program");
    let help = String::from_utf8_lossy(&output.stdout);
    assert!(!help.is_empty(), "the program has no command line");
    assert!(
        output.status.success() && help.contains(&words[1]),
        "{words:?}: {help}"
    );
}

#[test]
fn every_make_command_that_the_readme_names_exists() {
    let targets = targets();
    let readme = text("README.md");
    let named: Vec<&str> = readme
        .lines()
        .map(|line| line.trim_start_matches([' ', '$', '`']))
        .filter_map(|line| line.strip_prefix("make "))
        .filter_map(|rest| rest.split([' ', '`']).next())
        .collect();
    for wanted in ["demo", "test"] {
        assert!(
            named.contains(&wanted),
            "README.md does not name make {wanted}"
        );
    }
    for name in named {
        assert!(
            targets.iter().any(|target| target == name),
            "README.md: make {name}; the Makefile has {targets:?}"
        );
    }
}

#[test]
fn the_ci_lints_and_ends_with_the_tests() {
    let ci = text(".ci/run");
    assert!(ci.contains("\nset -euo pipefail\n"));
    let makes: Vec<&str> = ci.lines().filter(|line| line.contains("make ")).collect();
    assert_eq!(
        makes,
        [
            "make --no-print-directory lint",
            "make --no-print-directory test"
        ]
    );
    assert_eq!(
        ci.lines().last(),
        makes.last().copied(),
        "the output has to end in the summary of the tests"
    );
}

#[test]
fn licences_are_those_of_the_manifest() {
    assert_eq!(manifest("license"), "MIT OR Apache-2.0");
    assert!(text("LICENSE").contains("SPDX-License-Identifier: MIT OR Apache-2.0"));
    assert!(text("LICENSE-MIT").starts_with("MIT License"));
    assert!(text("LICENSE-APACHE").contains("END OF TERMS AND CONDITIONS"));
}
