//! `caustica animate`: renders frames of one scene at different times, one file each.
//!
//! Frames are independent: any set of them may be rendered by any process in any order, and a file that exists is complete. So
//! the same command with `--skip-existing` finishes a range that was interrupted.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use super::batch::Batch;
use super::error::CliError;
use super::frame_pattern::FramePattern;
use super::frames::FrameSet;
use super::notes::{say, say_notes};
use super::scene_flags::SceneArgs;
use super::{files, picture, scene_file, summary};
use crate::config::{Limits, RenderConfig};
use crate::methods;
use crate::output_files;
use crate::render::{Prepared, RenderError, Renderer};
use crate::scene::ResolvedScene;
use crate::stats::Warning;

/// Which frames to render, and where to write them.
#[derive(Clone, Debug, Args)]
pub struct AnimateArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Frames: `0-59`, `-10--1`, `1-20x4` or `1-20:4` (every 4th), `30`, or several joined by commas.
    #[arg(long, value_name = "RANGES", allow_hyphen_values = true)]
    pub frames: FrameSet,
    /// Frames per second: frame f is rendered at time_s + f / fps.
    #[arg(long, default_value_t = 30.0, value_parser = frame_rate)]
    pub fps: f64,
    /// Files to write, with a place for the frame number in the file name: `frame.%04d.png` or `frame.####.png`; .png or .exr decides
    /// the format. A % in the name is written %%.
    #[arg(short, long, value_name = "PATTERN")]
    pub output: FramePattern,
    /// Skip frames whose file exists.
    #[arg(long)]
    pub skip_existing: bool,
}

/// Reads `--fps`.
fn frame_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (1e-6..=1e6).contains(&fps) => Ok(fps),
        _ => Err("accepted: a number, 0.000001 … 1000000".to_owned()),
    }
}

/// The time of a frame, s.
pub fn time_of(scene_time_s: f64, frame: i64, fps: f64) -> f64 {
    scene_time_s + frame as f64 / fps
}

/// Renders frames one after the other until all are done or one fails.
///
/// # Errors
///
/// Those of `render`. The frames before the failing one have been written.
pub fn run(args: &AnimateArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let start = Instant::now();
    let paths: Vec<PathBuf> = frame_paths(args);
    let format = files::format_of(&paths[0])?;
    let mut scene = scene_file::load(&args.scene, Some(format), limits)?;
    for path in &paths {
        files::refuse_scene_file("a frame", path, &args.scene.scene)?;
    }
    let times_s = frame_times(args, &scene.resolved, limits)?;
    output_files::clear_leftovers(paths.iter().map(PathBuf::as_path));
    let mut missing = Vec::new();
    for ((path, time_s), frame) in paths.iter().zip(times_s).zip(args.frames.frames()) {
        scene.resolved.scene.time_s = time_s;
        if !(args.skip_existing && is_rendered(path, &scene.resolved.hash())) {
            missing.push((*frame, time_s, path));
        }
    }
    say_notes(&scene.notes);
    if let Some((_, _, path)) = missing.first() {
        // Frames that are all there need no place that can be written to.
        files::check_place(path)?;
        let mut renderer = Renderer::new(config)?;
        let mut batch = Batch::new(missing.len());
        let mut last = None;
        for &(frame, time_s, path) in &missing {
            batch.begin(frame, path);
            match one(&mut renderer, &scene.resolved, &mut last, time_s, path) {
                Ok(warnings) => batch.end(frame, path, &warnings),
                Err(error) => {
                    batch.finish();
                    batch.failed(frame);
                    return Err(error);
                }
            }
        }
        batch.finish();
    }
    let skipped = paths.len() - missing.len();
    let (rendered, elapsed) = (missing.len(), start.elapsed());
    say(summary::of_animation(rendered, skipped, elapsed));
    Ok(())
}

/// The file of every frame.
fn frame_paths(args: &AnimateArgs) -> Vec<PathBuf> {
    let frames = args.frames.frames().iter();
    frames.map(|frame| args.output.path(*frame)).collect()
}

/// The time of every frame, checked before the first is rendered.
fn frame_times(
    args: &AnimateArgs,
    resolved: &ResolvedScene,
    limits: &Limits,
) -> Result<Vec<f64>, CliError> {
    let time_of = |frame: &i64| time_of(resolved.scene.time_s, *frame, args.fps);
    let frames = args.frames.frames();
    // Frames differ only in time, so checking the earliest and the latest is enough.
    for frame in frames.first().into_iter().chain(frames.last()) {
        let mut scene = resolved.scene.clone();
        scene.time_s = time_of(frame);
        methods::validate(&scene, limits).map_err(|error| CliError::Scene {
            file: format!("{}, frame {frame}", args.scene.scene.display()),
            error,
        })?;
    }
    Ok(frames.iter().map(time_of).collect())
}

/// Whether `path` is a complete picture of this scene at this time, by the scene's hash in its metadata.
pub fn is_rendered(path: &Path, scene_hash: &str) -> bool {
    // Reading a pipe or a device may wait for ever.
    if !std::fs::metadata(path).is_ok_and(|about| about.is_file()) {
        return false;
    }
    let Ok(bytes) = std::fs::read(path) else {
        return false;
    };
    let texts = match crate::image::decode_png(&bytes) {
        Ok(picture) => picture.texts,
        Err(_) => match crate::image::decode_exr(&bytes) {
            Ok(picture) => picture.texts,
            Err(_) => return false,
        },
    };
    texts
        .get(crate::image::metadata::SCENE_HASH_KEY)
        .is_some_and(|hash| hash == scene_hash)
}

/// Renders the frame at `time_s` to a file, and returns its warnings. What does not depend on time is reused from the previous frame, if there is one.
fn one(
    renderer: &mut Renderer,
    resolved: &ResolvedScene,
    last: &mut Option<Prepared>,
    time_s: f64,
    path: &Path,
) -> Result<Vec<Warning>, CliError> {
    let start = Instant::now();
    let prepared = match last.take() {
        Some(last) => last.at(time_s),
        None => {
            let mut first = resolved.clone();
            first.scene.time_s = time_s;
            Prepared::new(first)
        }
    };
    let prepared = last.insert(prepared.map_err(RenderError::from)?);
    let picture = picture::make(renderer, prepared, start)?;
    files::write_whole(path, &picture.bytes)?;
    Ok(picture.stats.warnings)
}
