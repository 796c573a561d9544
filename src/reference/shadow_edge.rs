//! Finds the values near the edge of a mesh's shadow, in texels or pixels.

use super::truth::edge_of;
use super::view::shadows;
use super::{ReferenceError, Truth};
use crate::scene::{Output, ResolvedScene};

/// Pixels that are processed between two calls of `go_on`.
const PIXELS_AT_ONCE: usize = 16_384;

/// Whether each value of a truth lies at most `reach` texels (for a view, pixels), along x and y alike, from the edge of a shadow;
/// `None` when no mesh casts any.
///
/// If a view's truth skips pixels, all pixels around the truth's own are traced as well.
///
/// `go_on` is called now and then; false cancels.
///
/// # Errors
/// Scenes that cannot be traced; [`ReferenceError::Cancelled`].
pub fn shadow_edge(
    resolved: &ResolvedScene,
    truth: &Truth,
    reach: u32,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Vec<bool>>, ReferenceError> {
    let Output::View(output) = &resolved.scene.output else {
        return Ok(truth.shadow_edge(reach));
    };
    if truth.shadow.is_none() || truth.pixel_step == 1 {
        return Ok(truth.shadow_edge(reach));
    }
    let [width, height] = [output.width, output.height];
    let middles: Vec<[u32; 2]> = (0..truth.height)
        .flat_map(|j| (0..truth.width).map(move |i| [i, j]))
        .map(|at| [0, 1].map(|axis| truth.first_pixel[axis] + at[axis] * truth.pixel_step))
        .collect();
    // 1. All pixels around them, each once: an edge runs between neighbours, so one more than the reach.
    let mut near = vec![false; width as usize * height as usize];
    let place_of = |[x, y]: [u32; 2]| y as usize * width as usize + x as usize;
    for (&[x, y], _) in middles.iter().zip(&truth.compared).filter(|(_, c)| **c) {
        let around = |middle: u32, count: u32| {
            middle.saturating_sub(reach + 1)..=(middle + reach + 1).min(count - 1)
        };
        for y in around(y, height) {
            for x in around(x, width) {
                near[place_of([x, y])] = true;
            }
        }
    }
    let pixels: Vec<[u32; 2]> = (0..height)
        .flat_map(|y| (0..width).map(move |x| [x, y]))
        .filter(|&pixel| near[place_of(pixel)])
        .collect();
    // 2. Their shadow. Pixels that show nothing have no edge.
    let mut shadow = vec![0.0; near.len()];
    for some in pixels.chunks(PIXELS_AT_ONCE) {
        if !go_on() {
            return Err(ReferenceError::Cancelled);
        }
        for (&pixel, share) in some.iter().zip(shadows(resolved, some)?) {
            near[place_of(pixel)] = share.is_some();
            shadow[place_of(pixel)] = share.unwrap_or(0.0);
        }
    }
    // 3. The edge, restricted to the pixels of the truth.
    let edge = edge_of(&shadow, &near, [width as usize, height as usize], reach);
    Ok(Some(
        middles.into_iter().map(|at| edge[place_of(at)]).collect(),
    ))
}
