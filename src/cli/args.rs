//! The command line's syntax.

use std::io::{self, IsTerminal};
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use super::error::{CliError, EXIT_REFUSED};
use super::{
    accuracy, animate, calibrate, device_select, experiment, hard_cases, health, notes, plan,
    render, selfcheck, serve,
};
use crate::config::{Limits, RenderConfig, ServeConfig};

/// Renders water caustics, from the command line or as an HTTP service.
///
/// Exit codes: 0 done; 1 failed, a retry may succeed (GPU, files, network); 2 refused, the scene or the command has to be changed
/// first.
#[derive(Debug, Parser)]
#[command(name = "caustica", version)]
pub struct Cli {
    /// Settings of the renderer.
    #[command(flatten, next_help_heading = "Renderer")]
    pub render: RenderConfig,
    /// Limits of a scene.
    #[command(flatten, next_help_heading = "Limits")]
    pub limits: Limits,
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// The command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Renders a scene file to a PNG or EXR file.
    Render(render::RenderArgs),
    /// Renders frames of a scene file, each at its own time.
    Animate(animate::AnimateArgs),
    /// Plots error against time: renders a scene with each setting of its dials and compares it with the float64 reference.
    Accuracy(accuracy::AccuracyArgs),
    /// Compares methods by error and time: renders a scene with each method at several settings of its own and compares with the float64
    /// reference.
    Compare(accuracy::CompareArgs),
    /// Repeats a published experiment.
    Experiment(experiment::ExperimentArgs),
    /// Measures this machine for predictions of time and error.
    Calibrate(calibrate::CalibrateArgs),
    /// Runs hard cases (scenes that break caustics renderers) and reports which pass on this machine.
    HardCases(hard_cases::HardCasesArgs),
    /// Reports which passes a scene needs, why, and the memory they hold; renders nothing.
    Plan(plan::PlanArgs),
    /// Serves HTTP.
    Serve(ServeConfig),
    /// Compares the GPU of this machine with float64 physics.
    Selfcheck(selfcheck::SelfcheckArgs),
    /// Asks a running service whether it accepts work.
    Health(health::HealthArgs),
}

/// The program: reads the command line, runs it, and prints errors to stderr.
pub fn main() -> ExitCode {
    device_select::without_device_select();
    let done = match Cli::try_parse() {
        Ok(cli) => run(cli),
        Err(answer) if answer.use_stderr() => {
            notes::say_coloured(in_colours(&answer));
            notes::flush();
            return ExitCode::from(EXIT_REFUSED);
        }
        Err(help) => print_help(&help),
    };
    let code = match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            notes::say(format!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
    };
    notes::flush();
    code
}

/// An error of the command line, in colours if stderr shows them.
fn in_colours(answer: &clap::Error) -> String {
    let is_plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let text = answer.render();
    if io::stderr().is_terminal() && !is_plain {
        text.ansi().to_string()
    } else {
        text.to_string()
    }
}

/// Prints a help text or the version, a result like any other.
fn print_help(help: &clap::Error) -> Result<(), CliError> {
    match help.print() {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::write(Path::new("stdout"), error))
        }
        _ => Ok(()),
    }
}

/// Runs a command line.
///
/// # Errors
///
/// Any failure of the command; see [`CliError::exit_code`].
pub fn run(cli: Cli) -> Result<(), CliError> {
    let Cli {
        render,
        limits,
        command,
    } = cli;
    match command {
        Command::Render(args) => render::run(&args, &render, &limits),
        Command::Animate(args) => animate::run(&args, &render, &limits),
        Command::Accuracy(args) => accuracy::run(&args, &render, &limits),
        Command::Compare(args) => accuracy::compare(&args, &render, &limits),
        Command::Experiment(args) => experiment::run(&args, &render),
        Command::Calibrate(args) => calibrate::run(&args, &render),
        Command::HardCases(args) => hard_cases::run(&args, &render),
        Command::Plan(args) => plan::run(&args, &render, &limits),
        Command::Serve(args) => serve::run(render, limits, args),
        Command::Selfcheck(args) => selfcheck::run(&args, &render),
        Command::Health(args) => health::run(&args),
    }
}
