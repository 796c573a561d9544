//! `caustica animate`: renders frames of one scene at different times, one file each.
//!
//! Frames are independent: any set of them may be rendered by any process in any order, and a file that exists is complete. So
//! the same command with `--skip-existing` finishes a range that was interrupted.

use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::error::CliError;
use super::frames::{FramePattern, FrameSet};
use super::scene_flags::SceneArgs;
use super::{files, picture, scene_file, summary};
use crate::config::{Limits, RenderConfig};
use crate::methods;
use crate::render::{Prepared, RenderError, Renderer};
use crate::scene::ResolvedScene;

/// Which frames to render, and where to write them.
#[derive(Clone, Debug, Args)]
pub struct AnimateArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Frames: `0-59`, `1-20:4` (every 4th), `30`, or several joined by commas.
    #[arg(long, value_name = "RANGES")]
    pub frames: FrameSet,
    /// Frames per second: frame f is rendered at time_s + f / fps.
    #[arg(long, default_value_t = 30.0, value_parser = frame_rate)]
    pub fps: f64,
    /// Files to write, with a place for the frame number: `frame.%04d.png`; .png or .exr decides the format.
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
pub fn time_of(scene_time_s: f64, frame: u32, fps: f64) -> f64 {
    scene_time_s + f64::from(frame) / fps
}

/// Renders frames one after the other until all are done or one fails.
///
/// # Errors
///
/// Those of `render`. The frames before the failing one have been written.
pub fn run(args: &AnimateArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let start = Instant::now();
    let frames = args.frames.frames();
    let any_path = args.output.path(0);
    let format = files::format_of(&any_path)?;
    files::check_place(&any_path)?;
    let mut scene = scene_file::load(&args.scene, Some(format), limits)?;
    let frame_times = frame_times(args, &scene.resolved, limits)?;
    let mut missing: Vec<&(u32, f64)> = Vec::new();
    for moment in &frame_times {
        let (frame, time_s) = *moment;
        scene.resolved.scene.time_s = time_s;
        let path = args.output.path(frame);
        if !(args.skip_existing && is_rendered(&path, &scene.resolved.hash())) {
            missing.push(moment);
        }
    }
    for note in &scene.notes {
        eprintln!("note: {note}");
    }
    if !missing.is_empty() {
        let mut renderer = Renderer::new(config)?;
        let progress = progress(missing.len());
        let mut last = None;
        for (frame, time_s) in &missing {
            let path = args.output.path(*frame);
            let result = one(&mut renderer, &scene.resolved, &mut last, *time_s, &path);
            if result.is_err() {
                progress.abandon();
                eprintln!("frame {frame} failed");
            }
            result?;
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    let skipped = frames.len() - missing.len();
    let (rendered, elapsed) = (missing.len(), start.elapsed());
    eprint!("{}", summary::of_animation(rendered, skipped, elapsed));
    Ok(())
}

/// Every frame with its time, checked before the first is rendered.
fn frame_times(
    args: &AnimateArgs,
    resolved: &ResolvedScene,
    limits: &Limits,
) -> Result<Vec<(u32, f64)>, CliError> {
    let frame_times: Vec<(u32, f64)> = args
        .frames
        .frames()
        .iter()
        .map(|&frame| (frame, time_of(resolved.scene.time_s, frame, args.fps)))
        .collect();
    // Checking the last frame is enough: it is the latest, and frames differ only in time.
    if let Some((_, time_s)) = frame_times.last() {
        let mut last = resolved.scene.clone();
        last.time_s = *time_s;
        methods::validate(&last, limits).map_err(|error| CliError::Scene {
            file: args.scene.scene.display().to_string(),
            error,
        })?;
    }
    Ok(frame_times)
}

/// Whether `path` is a complete picture of this scene at this time, by the scene's hash in its metadata.
fn is_rendered(path: &Path, scene_hash: &str) -> bool {
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

/// Renders the frame at `time_s` to a file. What does not depend on time is reused from the previous frame, if there is one.
fn one(
    renderer: &mut Renderer,
    resolved: &ResolvedScene,
    last: &mut Option<Prepared>,
    time_s: f64,
    path: &Path,
) -> Result<(), CliError> {
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
    files::write_whole(path, &picture.bytes)
}

/// A progress bar on stderr if that is a terminal.
fn progress(count: usize) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new(count as u64).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}
