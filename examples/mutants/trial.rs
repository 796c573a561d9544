//! Builds the planted copy, and runs the tests that must catch the plants.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::tree::{self, Tree};

/// Time limit of tests: a plant may make a loop endless.
const LONGEST: Duration = Duration::from_secs(20 * 60);

/// The tests of hard cases, one test per case.
const SUITE: &str = "hard_cases::";

/// The outcome for a plant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// These tests failed.
    Caught(Vec<String>),
    /// All tests passed.
    Survived,
    /// Not exactly the listed hard cases failed: the first did not fail but had to, the second failed but must not.
    Inexact(Vec<String>, Vec<String>),
    /// The tests ended without a result, or did not end.
    NoVerdict(String),
}

impl Outcome {
    /// Whether a test caught it.
    pub(crate) fn is_caught(&self) -> bool {
        matches!(self, Self::Caught(_))
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Caught(tests) => write!(f, "caught by {}", tests.join(", ")),
            Self::Survived => write!(f, "SURVIVED"),
            Self::Inexact(missing, stray) => write!(
                f,
                "NOT EXACT: [{}] did not fail, [{}] did",
                missing.join(", "),
                stray.join(", ")
            ),
            Self::NoVerdict(why) => write!(f, "NO VERDICT: {why}"),
        }
    }
}

/// Builds and tests a copy.
pub(crate) struct Workshop {
    root: PathBuf,
    target: PathBuf,
}

impl Workshop {
    /// For this copy.
    pub(crate) fn of(tree: &Tree) -> Self {
        Self {
            root: tree.root.clone(),
            target: tree.target.clone(),
        }
    }

    /// The test program, or the compiler's message.
    pub(crate) fn build(&self, binary: &str) -> io::Result<Result<PathBuf, String>> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args([
                "test",
                "--release",
                "--locked",
                "--no-run",
                "--test",
                binary,
            ])
            .arg("--message-format=json-render-diagnostics")
            // The tests of a plant are short, the build takes longer than all of them.
            .args(["--config", "profile.release.package.caustica.opt-level=1"])
            .args([
                "--config",
                "profile.release.package.caustica.codegen-units=256",
            ])
            .args(["--config", "profile.release.package.caustica.debug=0"])
            .env("CARGO_TARGET_DIR", &self.target)
            .current_dir(&self.root)
            .output()?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let error = said.lines().find(|line| line.starts_with("error"));
            return Ok(Err(error.unwrap_or("cargo gives no reason").to_owned()));
        }
        let messages = String::from_utf8_lossy(&output.stdout);
        let program = messages
            .lines()
            .filter_map(|line| serde_json::from_str::<Value>(line).ok())
            .filter(|message| message["target"]["name"] == binary)
            .find_map(|message| Some(PathBuf::from(message["executable"].as_str()?)));
        Ok(program.ok_or_else(|| format!("error: cargo has built no tests `{binary}`")))
    }

    /// Runs tests by their full names, with one plant active. If they are hard cases, all hard cases run, and no others may fail.
    pub(crate) fn run(
        &self,
        program: &Path,
        tests: &[&str],
        awake: Option<usize>,
    ) -> io::Result<Outcome> {
        let log = self.target.join("mutants.log");
        let mut command = Command::new(program);
        if let Some(number) = awake {
            command.env(tree::AWAKE, number.to_string());
        }
        let is_suite = awake.is_some() && tests.iter().all(|test| test.starts_with(SUITE));
        if is_suite {
            command.arg(SUITE);
        } else {
            command.arg("--exact").args(tests);
        }
        let mut child = command
            .current_dir(&self.root)
            .stdout(std::fs::File::create(&log)?)
            .stderr(Stdio::null())
            .spawn()?;
        let started = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait()? {
                break status;
            }
            if started.elapsed() > LONGEST {
                child.kill()?;
                child.wait()?;
                let minutes = LONGEST.as_secs() / 60;
                return Ok(Outcome::NoVerdict(format!("not done in {minutes} min")));
            }
            std::thread::sleep(Duration::from_millis(100));
        };
        let said = std::fs::read_to_string(&log)?;
        let found = verdict(&said, status.success(), tests);
        Ok(match found {
            Outcome::Caught(_) if is_suite => exact(&said, tests),
            other => other,
        })
    }
}

/// The outcome of the whole suite, of which these had to fail.
fn exact(said: &str, tests: &[&str]) -> Outcome {
    let failed: Vec<&str> = said
        .lines()
        .filter_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"))
        .collect();
    let names = |all: &[&str], but: &[&str]| -> Vec<String> {
        let left = all.iter().filter(|name| !but.contains(name));
        left.map(|name| (*name).to_owned()).collect()
    };
    let (missing, stray) = (names(tests, &failed), names(&failed, tests));
    if missing.is_empty() && stray.is_empty() {
        Outcome::Caught(names(tests, &[]))
    } else {
        Outcome::Inexact(missing, stray)
    }
}

/// Reads the output of the test program.
fn verdict(said: &str, succeeded: bool, tests: &[&str]) -> Outcome {
    // Without capture, the output of a test comes between its name and its result. The end of the output lists the names again.
    let failed: Vec<String> = tests
        .iter()
        .filter(|test| said.contains(&format!("test {test} ... FAILED")))
        .map(|test| (*test).to_owned())
        .collect();
    let passed = tests
        .iter()
        .filter(|test| said.contains(&format!("test {test} ... ok")));
    if !failed.is_empty() {
        Outcome::Caught(failed)
    } else if succeeded && passed.count() == tests.len() {
        Outcome::Survived
    } else {
        let last = said.lines().rfind(|line| !line.is_empty());
        Outcome::NoVerdict(last.unwrap_or("the tests said nothing").to_owned())
    }
}
