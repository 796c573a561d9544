//! The suite's results as a page: a table for each family, with a thumbnail of each case.

use std::fmt::Write as _;

use super::case::{Family, Outcome, Verdict};
use crate::image::{EncodeError, Metadata, encode};
use crate::scene::{Encoding, ExrPixel, ImageFormat, ToneCurve};

/// Longest side of a thumbnail, pixels; smaller pictures are enlarged by whole numbers.
const THUMBNAIL: u32 = 96;

/// The page, in Markdown; thumbnails are `FOLDER/NAME.png` where `has_picture` says so.
pub fn markdown(outcomes: &[Outcome], adapter: &str, folder: &str) -> String {
    let mut text = String::from("# Hard cases\n\n");
    let held = outcomes
        .iter()
        .filter(|o| o.verdict == Verdict::Holds)
        .count();
    let _ = writeln!(
        text,
        "{held} of {} cases hold, on {adapter}. Written by `caustica hard-cases`.\n\n\
         Every picture of every case is finite, has the same bits when rendered twice, and its energy account closes to 10⁻⁵. The \
         figure is the result of the case's own check. Warnings are those of the case's pictures.",
        outcomes.len()
    );
    for family in Family::ALL {
        let of_family: Vec<&Outcome> = outcomes
            .iter()
            .filter(|o| o.case.family == family)
            .collect();
        if of_family.is_empty() {
            continue;
        }
        let _ = writeln!(
            text,
            "\n## {}\n\n| case | what could break | check | figure | at most | closure | warnings | |\n|---|---|---|--:|--:|--:|---|---|",
            family.name()
        );
        for outcome in of_family {
            let _ = writeln!(text, "{}", row(outcome, folder));
        }
    }
    text
}

fn row(outcome: &Outcome, folder: &str) -> String {
    let figure = match (outcome.figure, &outcome.failure) {
        (Some(figure), None) => format!("{figure:.1e}"),
        (_, Some(failure)) => format!("**{failure}**"),
        (None, None) => String::new(),
    };
    let note = match outcome.case.known_failure {
        Some(why) => format!(" (known: {why})"),
        None => String::new(),
    };
    let warnings: Vec<String> = outcome
        .warnings
        .iter()
        .map(|(code, flux)| match flux {
            Some(flux) => format!("`{code}` {flux:.1e} W"),
            None => format!("`{code}`"),
        })
        .collect();
    let picture = match outcome.picture {
        Some(_) => format!("![]({folder}/{}.png)", outcome.case.name),
        None => String::new(),
    };
    format!(
        "| {} | {} | {} | {figure}{note} | {:e} | {:.0e} | {} | {picture} |",
        outcome.case.name.replace('_', " "),
        outcome.case.breaks,
        outcome.case.check,
        outcome.case.bound,
        outcome.closure,
        warnings.join(", "),
    )
}

/// The thumbnail of a case as PNG, with the usual exposure; `None` where the case has no picture.
///
/// # Errors
/// Errors of the encoder.
pub fn thumbnail(outcome: &Outcome) -> Option<Result<Vec<u8>, EncodeError>> {
    let frame = outcome.picture.as_ref()?;
    let encoding = Encoding {
        embed_scene: false,
        format: ImageFormat::Png,
        png_bits: 8,
        exposure_ev: 0.0,
        tone_curve: ToneCurve::PbrNeutral,
        exr_pixel: ExrPixel::Half,
    };
    let mut small = frame.clone();
    let step = frame.width.max(frame.height).div_ceil(THUMBNAIL);
    let times = if step == 1 {
        (THUMBNAIL / frame.width.max(frame.height)).max(1)
    } else {
        1
    };
    let (width, height) = (frame.width.div_ceil(step), frame.height.div_ceil(step));
    (small.width, small.height) = (width * times, height * times);
    for layer in small.layers.values_mut() {
        let n = layer.channels;
        let mut data = Vec::with_capacity(n * (small.width * small.height) as usize);
        for y in 0..small.height {
            for x in 0..small.width {
                let at = ((y / times * step) * frame.width + x / times * step) as usize * n;
                data.extend_from_slice(&layer.data[at..at + n]);
            }
        }
        layer.data = data;
    }
    Some(encode(&small, &encoding, &Metadata::of(&frame.stats)).map(|encoded| encoded.bytes))
}
