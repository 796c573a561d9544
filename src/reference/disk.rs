//! Keeps truths on disk between runs, one file each.
//!
//! A file is `MAGIC`, the length of a JSON text as u32, that text (everything but the values), the values as f64 and flags as
//! bytes, all little-endian, and a blake3 hash of what comes before. Its name is a hash of what the truth depends on. A file
//! that is damaged, truncated or of another program version is ignored.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use super::{Truth, TruthKind, TruthSettings};
use crate::output_files;
use crate::scene::{ImageFormat, Output, Quality, Receiver, ResolvedScene, ToneCurve, ViewOutput};

/// First bytes of a file; the digit is the format's number.
const MAGIC: &[u8; 16] = b"caustica truth 1";
/// Must change when the reference gives another result for the same scene.
const ENGINE: u32 = 2;
/// Bytes of the hash at the end.
const HASH_BYTES: usize = 32;
/// Ending of the files.
const EXTENSION: &str = "truth";
/// Most bytes that a folder of truths holds.
const FOLDER_BYTES: u64 = 1 << 30;

/// A [`Truth`] without its values.
#[derive(Serialize, Deserialize)]
struct Head {
    key: String,
    kind: TruthKind,
    width: u32,
    height: u32,
    first_pixel: [u32; 2],
    pixel_step: u32,
    relative_error: f64,
    rays: u64,
    seconds: f64,
    has_shadow: bool,
    /// The limit of rays at which the search ended; 0 when it ended because the target was met.
    limit_rays: u64,
}

/// Where one truth is kept.
pub(super) struct Shelf {
    folder: PathBuf,
    key: String,
    /// Target and limit of the caller.
    limits: (Option<f64>, u64),
}

impl Shelf {
    /// For `resolved` with `settings`.
    pub(super) fn of(resolved: &ResolvedScene, settings: &TruthSettings, folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            key: key(resolved, settings),
            limits: (settings.target_error, settings.max_rays),
        }
    }

    pub(super) fn file(&self) -> PathBuf {
        self.folder.join(format!("{}.{EXTENSION}", self.key))
    }

    /// The stored truth, if it is complete and as accurate as `settings` require.
    pub(super) fn read(&self, settings: &TruthSettings) -> Option<Truth> {
        let (head, truth) = decode(&std::fs::read(self.file()).ok()?, &self.key)?;
        let reached = settings
            .target_error
            .is_some_and(|target| truth.relative_error <= target);
        // A truth that ended at its limit of rays is enough for callers that allow no more rays.
        (reached || head.limit_rays >= settings.max_rays).then_some(truth)
    }

    /// Writes the file; nobody sees half of one.
    pub(super) fn write(&self, truth: &Truth) -> std::io::Result<()> {
        std::fs::create_dir_all(&self.folder)?;
        let file = self.file();
        output_files::clear_leftovers([file.as_path()]);
        output_files::write(&file, &self.encode(truth)?)?;
        self.make_room()
    }

    /// Removes the oldest truths until the folder is within [`FOLDER_BYTES`]; the one just written stays.
    fn make_room(&self) -> std::io::Result<()> {
        let own = self.file();
        let mut kept: Vec<(SystemTime, u64, PathBuf)> = Vec::new();
        for entry in std::fs::read_dir(&self.folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == EXTENSION)
                && path != own
                && let Ok(about) = path.metadata()
            {
                let written = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                kept.push((written, about.len(), path));
            }
        }
        kept.sort();
        let mut bytes = own.metadata()?.len() + kept.iter().map(|(_, bytes, _)| bytes).sum::<u64>();
        for (_, size, path) in kept {
            if bytes <= FOLDER_BYTES {
                break;
            }
            // Another process may have removed it already.
            std::fs::remove_file(path).ok();
            bytes -= size;
        }
        Ok(())
    }

    fn encode(&self, truth: &Truth) -> std::io::Result<Vec<u8>> {
        let head = serde_json::to_vec(&Head {
            key: self.key.clone(),
            kind: truth.kind,
            width: truth.width,
            height: truth.height,
            first_pixel: truth.first_pixel,
            pixel_step: truth.pixel_step,
            relative_error: truth.relative_error,
            rays: truth.rays,
            seconds: truth.seconds,
            has_shadow: truth.shadow.is_some(),
            limit_rays: match self.limits {
                (Some(target), _) if truth.relative_error <= target => 0,
                (_, max_rays) => max_rays,
            },
        })?;
        let length = u32::try_from(head.len()).map_err(std::io::Error::other)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(length.to_le_bytes());
        bytes.extend(head);
        for value in truth.irradiance.as_flattened() {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend(truth.compared.iter().map(|&compared| u8::from(compared)));
        for value in truth.shadow.iter().flatten() {
            bytes.extend(value.to_le_bytes());
        }
        let hash = blake3::hash(&bytes);
        bytes.extend(hash.as_bytes());
        Ok(bytes)
    }
}

/// A hash of everything that the result depends on: the scene without dials and without what affects the picture only, the number of
/// points, and the program.
fn key(resolved: &ResolvedScene, settings: &TruthSettings) -> String {
    let mut scene = resolved.scene.clone();
    let level_map_texels = scene.quality.level_map_texels;
    scene.quality = Quality::default();
    let mut most_points = 0;
    match &mut scene.output {
        // It has no truth, because it has no light.
        Output::WaterMap(_) => {}
        Output::View(output) => {
            most_points = settings.most_points;
            *output = ViewOutput {
                width: output.width,
                height: output.height,
                ..ViewOutput::default()
            };
        }
        Output::IrradianceMap(output) => {
            output.format = ImageFormat::Exr;
            output.png_bits = 8;
            output.exposure_ev = 0.0;
            output.tone_curve = ToneCurve::default();
            output.embed_scene = true;
            if matches!(output.receiver, Receiver::Object(_)) {
                scene.quality.level_map_texels = level_map_texels;
            }
        }
    }
    let scene = ResolvedScene {
        scene,
        ..resolved.clone()
    };
    let mut hasher = blake3::Hasher::new();
    // Lengths come first, so that two different inputs never give the same bytes.
    for part in [scene.hash().as_str(), env!("CARGO_PKG_VERSION")] {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    }
    hasher.update(&ENGINE.to_le_bytes());
    hasher.update(&most_points.to_le_bytes());
    hasher.finalize().to_hex().to_string()
}

/// The contents of `bytes`, if they are complete and belong to `key`.
fn decode(bytes: &[u8], key: &str) -> Option<(Head, Truth)> {
    let (body, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH_BYTES)?)?;
    if blake3::hash(body).as_bytes() != hash {
        return None;
    }
    let rest = body.strip_prefix(MAGIC)?;
    let (length, rest) = rest.split_at_checked(4)?;
    let length = u32::from_le_bytes(length.try_into().ok()?);
    let (head, rest) = rest.split_at_checked(length as usize)?;
    let head: Head = serde_json::from_slice(head).ok()?;
    if head.key != key {
        return None;
    }
    let count = (head.width as usize).checked_mul(head.height as usize)?;
    let (irradiance, rest) = rest.split_at_checked(count.checked_mul(24)?)?;
    let (compared, rest) = rest.split_at_checked(count)?;
    if rest.len()
        != if head.has_shadow {
            count.checked_mul(8)?
        } else {
            0
        }
    {
        return None;
    }
    let irradiance = numbers(irradiance);
    let shadow = head.has_shadow.then(|| numbers(rest));
    let truth = Truth {
        kind: head.kind,
        width: head.width,
        height: head.height,
        first_pixel: head.first_pixel,
        pixel_step: head.pixel_step,
        irradiance: irradiance.as_chunks().0.to_vec(),
        compared: compared.iter().map(|&byte| byte != 0).collect(),
        relative_error: head.relative_error,
        rays: head.rays,
        shadow,
        seconds: head.seconds,
        from_disk: true,
    };
    let finite = truth
        .irradiance
        .as_flattened()
        .iter()
        .all(|v| v.is_finite());
    finite.then_some((head, truth))
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    let (numbers, _) = bytes.as_chunks::<8>();
    numbers.iter().map(|&n| f64::from_le_bytes(n)).collect()
}
