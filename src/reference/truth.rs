//! The entry point for all kinds of output: the correct result for a scene.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::checks::check_water;
use super::sky::Sky;
use super::{ReferenceError, TruthSettings, disk, map, object_map, view};
use crate::scene::{Output, Receiver, ResolvedScene};

/// Shares of shadow between which a value is inside the soft edge.
const HALF_DARK: (f64, f64) = (0.02, 0.98);

/// What the values of a [`Truth`] are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TruthKind {
    /// Texels of a map on the floor.
    FloorMap,
    /// Texels of a map on an object.
    ObjectMap,
    /// Pixels of a view.
    View,
}

/// The truth for the output that `resolved.scene.output` requests.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// What the values are.
    pub kind: TruthKind,
    /// Values along x.
    pub width: u32,
    /// Values along y (of the floor: z).
    pub height: u32,
    /// For a view: the pixel of the first value; otherwise (0, 0).
    pub first_pixel: [u32; 2],
    /// For a view: pixels from one value to the next along both axes; otherwise 1.
    pub pixel_step: u32,
    /// Irradiance, W/m², row by row; 0 where `compared` is false.
    pub irradiance: Vec<[f64; 3]>,
    /// Whether there is something to compare: false where a pixel shows nothing or a texel of an object's map has no surface.
    pub compared: Vec<bool>,
    /// Estimated relative L1 error of `irradiance`, from two independent halves.
    pub relative_error: f64,
    /// Rays counted, both halves and all suns.
    pub rays: u64,
    /// Share of the light to a value that meshes block, 0 … 1; `None` when there are no meshes.
    pub shadow: Option<Vec<f64>>,
    /// Time to compute it, s.
    pub seconds: f64,
    /// Whether it was read from the disk.
    pub from_disk: bool,
}

impl Truth {
    /// Whether each value lies at most `reach` values (along x and y alike) from the edge of a shadow; `None` when no mesh casts
    /// any. For a view with a `pixel_step` above 1, values are several pixels apart: see
    /// [`shadow_edge`](super::shadow_edge). The edge runs between neighbours on both sides of a share of one half, and where the share is
    /// neither 0 nor 1.
    pub fn shadow_edge(&self, reach: u32) -> Option<Vec<bool>> {
        let shadow = self.shadow.as_ref()?;
        let size = [self.width as usize, self.height as usize];
        Some(edge_of(shadow, &self.compared, size, reach))
    }
}

/// [`Truth::shadow_edge`] of shares of shadow, where `compared` is true.
pub(super) fn edge_of(
    shadow: &[f64],
    compared: &[bool],
    [width, height]: [usize; 2],
    reach: u32,
) -> Vec<bool> {
    let mut edge = vec![false; shadow.len()];
    for y in 0..height {
        for x in 0..width {
            let at = y * width + x;
            if !compared[at] {
                continue;
            }
            let (low, high) = HALF_DARK;
            edge[at] |= shadow[at] > low && shadow[at] < high;
            let right = (x + 1 < width).then_some(at + 1);
            let below = (y + 1 < height).then_some(at + width);
            for next in [right, below].into_iter().flatten() {
                if compared[next] && (shadow[at] > 0.5) != (shadow[next] > 0.5) {
                    edge[at] = true;
                    edge[next] = true;
                }
            }
        }
    }
    let reach = reach as usize;
    // First along x, then along y: a square around each value of the edge.
    let wide = widen(&edge, reach, |at| (at % width, width), 1);
    widen(&wide, reach, |at| (at / width, height), width)
}

/// True up to `reach` steps of `stride` around every true value; `place_of` returns a value's position along the axis and the
/// axis's length.
fn widen(
    values: &[bool],
    reach: usize,
    place_of: impl Fn(usize) -> (usize, usize),
    stride: usize,
) -> Vec<bool> {
    (0..values.len())
        .map(|at| {
            let (place, count) = place_of(at);
            let before = reach.min(place);
            let after = reach.min(count - 1 - place);
            let first = at - before * stride;
            (0..=before + after).any(|i| values[first + i * stride])
        })
        .collect()
}

/// Computes the truth, or reads it from `settings.disk`.
///
/// This is the correct result for the scene, found by counting plain rays in f64. A texel of a map holds the mean over the texel;
/// a point of a view holds the mean over its pixel's footprint. Dials have no effect, except that
/// `quality.level_map_texels` is the size of an object's map. The bits do not depend on the number of threads. `progress` is called
/// with the finished part, 0 … 1, from any thread; `cancelled` is called often, from any thread.
///
/// # Errors
///
/// Scenes that cannot be traced, invalid settings, and [`ReferenceError::Cancelled`].
pub fn truth(
    resolved: &ResolvedScene,
    settings: &TruthSettings,
    progress: &(dyn Fn(f64) + Sync),
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Truth, ReferenceError> {
    settings.check()?;
    if resolved.scene.output.is_water_map() {
        return Err(ReferenceError::WaterMap);
    }
    let kept = settings
        .disk
        .as_ref()
        .map(|folder| disk::Shelf::of(resolved, settings, folder));
    if let Some(truth) = kept.as_ref().and_then(|shelf| shelf.read(settings)) {
        progress(1.0);
        return Ok(truth);
    }
    let started = Instant::now();
    let mut truth = match &resolved.scene.output {
        Output::WaterMap(_) => Err(ReferenceError::WaterMap),
        Output::View(_) => view::view(resolved, settings, progress, cancelled),
        Output::IrradianceMap(output) => match output.receiver {
            Receiver::Floor(_) => floor(resolved, settings, progress, cancelled),
            Receiver::Object(index) => {
                let which = (index, output.layer);
                object_map::object_map(resolved, which, settings, progress, cancelled)
            }
        },
    }?;
    truth.seconds = started.elapsed().as_secs_f64();
    if let Some(shelf) = kept
        && let Err(error) = shelf.write(&truth)
    {
        // A truth that cannot be stored is still valid; the next run has to compute it again.
        tracing::warn!(
            "the truth could not be kept in {}: {error}",
            shelf.file().display()
        );
    }
    Ok(truth)
}

/// The map on the floor: lights by rays, and the skies as under flat water.
fn floor(
    resolved: &ResolvedScene,
    settings: &TruthSettings,
    progress: &(dyn Fn(f64) + Sync),
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Truth, ReferenceError> {
    let mut suns_only = resolved.clone();
    let mut sky_w_m2 = [0.0; 3];
    if let Output::IrradianceMap(output) = &mut suns_only.scene.output
        && output.include_sky
    {
        output.include_sky = false;
        let scene = &resolved.scene;
        let floor = scene.floor.as_ref().ok_or(ReferenceError::NoFloor)?;
        let sky = Sky::of(scene, check_water(&scene.water)?);
        sky_w_m2 = sky.under_water_w_m2(floor.depth_m, 1.0);
    }
    let map::CountedMap { map, shadow } =
        map::count(&suns_only, &settings.counting(), progress, cancelled)?;
    let mut irradiance = map.irradiance;
    let total = |values: &[[f64; 3]]| values.as_flattened().iter().sum::<f64>();
    let suns = total(&irradiance);
    for texel in &mut irradiance {
        for (value, sky) in texel.iter_mut().zip(sky_w_m2) {
            *value += sky;
        }
    }
    let all = total(&irradiance);
    Ok(Truth {
        kind: TruthKind::FloorMap,
        width: map.width,
        height: map.height,
        first_pixel: [0, 0],
        pixel_step: 1,
        compared: vec![true; irradiance.len()],
        irradiance,
        relative_error: if all > 0.0 {
            map.relative_error * suns / all
        } else {
            0.0
        },
        rays: map.rays,
        shadow,
        seconds: 0.0,
        from_disk: false,
    })
}
