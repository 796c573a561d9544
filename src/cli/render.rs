//! `caustica render`: one scene, one file.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::error::CliError;
use super::files::{self, Destination};
use super::notes::say;
use super::scene_flags::SceneArgs;
use super::{picture, scene_file, summary};
use crate::config::{Limits, RenderConfig};
use crate::output_files;
use crate::render::{Prepared, RenderError, Renderer};

/// What to render, and where to write it.
#[derive(Clone, Debug, Args)]
pub struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// File to write; .png or .exr decides the format. `-` is stdout, with the format of `--format` or of the scene.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// File to write the statistics to (JSON); `-` is stdout.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
}

/// Renders a scene to a file, and prints its cost to stderr.
///
/// # Errors
///
/// Anything from a bad scene to a full disk. An existing file is then unchanged, unless it has to be written in place
/// ([`crate::output_files`]).
pub fn run(args: &RenderArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let start = Instant::now();
    let output = Destination::of(&args.output);
    let stats = args.stats.as_deref().map(Destination::of);
    if output == Destination::Stdout && stats == Some(Destination::Stdout) {
        return Err(CliError::Usage(
            "--output and --stats are both stdout; accepted: stdout for one of them".to_owned(),
        ));
    }
    let scene = &args.scene.scene;
    files::refuse_scene_file("--output", &args.output, scene)?;
    if let Some(stats) = &args.stats {
        files::refuse_scene_file("--stats", stats, scene)?;
        if output_files::is_same_file(&args.output, stats) {
            return Err(CliError::Usage(format!(
                "--output and --stats both lead to {}; accepted: a file for each",
                stats.display()
            )));
        }
    }
    let format = output.format()?;
    for place in std::iter::once(&output).chain(&stats) {
        place.check()?;
    }
    let scene = scene_file::load(&args.scene, format, limits)?;
    let prepared = Prepared::new(scene.resolved).map_err(RenderError::from)?;
    let mut renderer = Renderer::new(config)?;
    let picture = picture::make(&mut renderer, &prepared, start)?;
    output.write(&picture.bytes)?;
    if let Some(stats) = stats {
        stats.write(files::json(&picture.stats).as_bytes())?;
    }
    say(summary::of_picture(&picture, &output.name(), &scene.notes));
    Ok(())
}
