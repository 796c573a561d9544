//! What may be typed.

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use super::error::CliError;
use super::{
    accuracy, animate, calibrate, experiment, hard_cases, health, plan, render, selfcheck, serve,
};
use crate::config::{Limits, RenderConfig, ServeConfig};

/// Renders water caustics, from the command line or as an HTTP service.
///
/// Exit codes: 0 done; 1 failed in a way that is worth a retry (GPU, files, network); 2 refused: the scene or the command
/// has to be changed first.
#[derive(Debug, Parser)]
#[command(name = "caustica", version)]
pub struct Cli {
    /// Settings of the renderer.
    #[command(flatten, next_help_heading = "Renderer")]
    pub render: RenderConfig,
    /// What a scene may ask for at most.
    #[command(flatten, next_help_heading = "Limits")]
    pub limits: Limits,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Renders a scene file to a PNG or EXR file.
    Render(render::RenderArgs),
    /// Renders frames of a scene file, each at its own moment.
    Animate(animate::AnimateArgs),
    /// Draws error against time: renders a scene with each setting of its dials, compared with the float64 truth.
    Accuracy(accuracy::AccuracyArgs),
    /// Does a published experiment again.
    Experiment(experiment::ExperimentArgs),
    /// Measures what predictions of time and error rest on, on this machine.
    Calibrate(calibrate::CalibrateArgs),
    /// Runs the scenes that break caustics renderers, and says whether each holds on this machine.
    HardCases(hard_cases::HardCasesArgs),
    /// Says which passes a scene needs, why, and how much memory they hold; renders nothing.
    Plan(plan::PlanArgs),
    /// Serves HTTP.
    Serve(ServeConfig),
    /// Compares the GPU of this machine with float64 physics.
    Selfcheck(selfcheck::SelfcheckArgs),
    /// Asks a running service whether it would accept work.
    Health(health::HealthArgs),
}

/// The program: reads the command line, runs it, and says on stderr what went wrong.
pub fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// Runs a command line.
///
/// # Errors
///
/// Whatever keeps the command from being done; see [`CliError::exit_code`].
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
        Command::Experiment(args) => experiment::run(&args, &render),
        Command::Calibrate(args) => calibrate::run(&args, &render),
        Command::HardCases(args) => hard_cases::run(&args, &render),
        Command::Plan(args) => plan::run(&args, &render, &limits),
        Command::Serve(args) => serve::run(render, limits, args),
        Command::Selfcheck(args) => selfcheck::run(&args, &render),
        Command::Health(args) => health::run(&args),
    }
}
