//! `caustica render`: one scene, one file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use super::error::CliError;
use super::scene_flags::SceneArgs;
use super::{files, picture, scene_file, summary};
use crate::config::{Limits, RenderConfig};
use crate::render::{Prepared, RenderError, Renderer};
use crate::stats::Stats;

/// What to render, and where to write it.
#[derive(Clone, Debug, Args)]
pub struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// File to write; .png or .exr decides the format.
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
/// Anything from a bad scene to a full disk. An existing file is then unchanged.
pub fn run(args: &RenderArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let start = Instant::now();
    let format = files::format_of(&args.output)?;
    files::check_place(&args.output)?;
    if let Some(path) = stats_file(args) {
        files::check_place(path)?;
    }
    let scene = scene_file::load(&args.scene, Some(format), limits)?;
    let prepared = Prepared::new(scene.resolved).map_err(RenderError::from)?;
    let mut renderer = Renderer::new(config)?;
    let picture = picture::make(&mut renderer, &prepared, start)?;
    files::write_whole(&args.output, &picture.bytes)?;
    if args.stats.is_some() {
        write_stats(stats_file(args), &picture.stats)?;
    }
    eprint!(
        "{}",
        summary::of_picture(&picture, &args.output, &scene.notes)
    );
    Ok(())
}

/// The file for the statistics, unless they go to stdout.
fn stats_file(args: &RenderArgs) -> Option<&Path> {
    args.stats.as_deref().filter(|path| *path != Path::new("-"))
}

fn write_stats(path: Option<&Path>, stats: &Stats) -> Result<(), CliError> {
    let json = files::json(stats);
    match path {
        Some(path) => files::write_whole(path, json.as_bytes()),
        None => files::print(&json),
    }
}
