//! The study as a page.

use std::fmt::Write as _;

use super::measure::FLASH_DEPTH_M;
use super::published::{
    self, CV_RATIO, FLASH_MS, FLASHES_PER_MINUTE, PEAK_AT_1_M, PEAK_WINDS_M_S, cox_munk,
};
use super::scene::{
    LONG_TILE_M, SHORT_TILE_M, SHORTEST_M, SPLIT_M, SUN_ELEVATION_DEG, WIND_DIRECTION_DEG,
};
use super::study::{Check, Checks, Estimate, FlashFigures, PlaceResult, SeaStudy, SlopeResult};
use super::write::{CV, FLASHES, PEAKS};
use crate::lab::study::words::significant;

/// The page; `folder` is the folder of the plots relative to the page, with `/` at its end, or empty.
pub fn to_markdown(study: &SeaStudy, folder: &str) -> String {
    let mut text = String::new();
    head(&mut text, study);
    variation(&mut text, study, folder);
    peaks(&mut text, study, folder);
    flashes(&mut text, study, folder);
    compared(&mut text, study);
    account(&mut text, study);
    for checks in &study.checks {
        with_other_settings(&mut text, checks);
    }
    text
}

fn head(text: &mut String, s: &SeaStudy) {
    let _ = write!(
        text,
        "# Sunlight under the sea\n\n\
        How irradiance on a horizontal floor fluctuates with depth and wind, beside what others measured. `caustica experiment sea -o \
        FOLDER` makes this page.\n\n\
        The sea is the sum of two Elfouhaily spectra with random phases: waves of {SPLIT_M} … {LONG_TILE_M} m on a tile of {LONG_TILE_M} m, \
        and of {SHORTEST_M} … {SPLIT_M} m on a tile of {SHORT_TILE_M} m. The water is clear, the sun is {SUN_ELEVATION_DEG}° high, and the \
        wind blows at {WIND_DIRECTION_DEG}° to the sun's azimuth. Detectors are the texels of irradiance maps: {}² for each of {} maps, \
        each map of a sea of its own; all depths and winds share their seeds, so their figures are not independent. Time series are {} s long in all, from {} seas, with a frame every {} ms and {}² detectors. \
        Rendered on {} ({}) with ten water cells per shortest wave, where {} along each side of the light's window are enough for that.\n\n\
        Scenes have suns without a size. The sun's disc (radius 16 minutes of arc) is put in afterwards: each map is averaged over \
        the disc's image under flat water, which is 7 mm wide per metre of depth. Where a table says *point sun*, it is not. After \
        ± stands one standard error: the spread from sea to sea.\n",
        s.texels,
        s.moments,
        significant(s.seconds, 3),
        s.series,
        significant(1e3 * s.step_s, 3),
        s.series_texels,
        s.adapter.name,
        s.adapter.driver,
        s.water_cells,
    );
}

/// A value with its standard error, both to the second digit of the error, at least one decimal digit of the value's three.
fn with_error(estimate: Estimate) -> String {
    let value = significant(estimate.value, 3);
    match estimate.error {
        Some(error) => format!("{value} ± {}", significant(error, 2)),
        None => value,
    }
}

/// A table: a row for each depth, a column for each wind.
fn table(text: &mut String, s: &SeaStudy, cell: &dyn Fn(&PlaceResult) -> String) {
    let winds = s.winds();
    text.push_str("\n| depth | detector |");
    for wind in &winds {
        let _ = write!(text, " {wind} m/s |");
    }
    let _ = writeln!(text, "\n|---:|---:|{}", "---:|".repeat(winds.len()));
    for depth in s.depths() {
        let texel_mm = s.places.iter().find(|p| p.place.depth_m == depth);
        let texel_mm = texel_mm.map_or(0.0, |p| p.texel_mm);
        let _ = write!(text, "| {depth} m | {} mm |", significant(texel_mm, 3));
        for &wind in &winds {
            let found = s.at(wind, depth).map(cell).unwrap_or_default();
            let _ = write!(text, " {found} |");
        }
        text.push('\n');
    }
}

fn variation(text: &mut String, s: &SeaStudy, folder: &str) {
    text.push_str("\n## Coefficient of variation\n\nStandard deviation over mean.\n");
    table(text, s, &|p| {
        with_error(p.sun.cv) + if p.undersampled { " *" } else { "" }
    });
    if s.places.iter().any(|p| p.undersampled) {
        text.push_str(
            "\n\\* The water cells were coarse for the shortest waves (warning `waves_undersampled`).\n",
        );
    }
    text.push_str("\nThe same for a point sun:\n");
    table(text, s, &|p| with_error(p.point_sun.cv));
    let _ = write!(
        text,
        "\n![Coefficient of variation against depth]({folder}{CV}.svg)\n"
    );
}

fn peaks(text: &mut String, s: &SeaStudy, folder: &str) {
    text.push_str(
        "\n## Peaks\n\nWhat one value in a thousand exceeds, over the mean; in brackets the highest value of all maps. The highest \
        value grows with the number of detectors and is no property of the sea alone.\n",
    );
    table(text, s, &|p| {
        let highest = significant(p.sun.highest, 3);
        format!("{} ({highest})", with_error(p.sun.peak))
    });
    text.push_str("\nThe same for a point sun:\n");
    table(text, s, &|p| {
        let highest = significant(p.point_sun.highest, 3);
        format!("{} ({highest})", with_error(p.point_sun.peak))
    });
    let _ = write!(text, "\n![Peaks against depth]({folder}{PEAKS}.svg)\n");
}

fn flashes(text: &mut String, s: &SeaStudy, folder: &str) {
    if !s.has_flashes() {
        return;
    }
    let _ = writeln!(
        text,
        "\n## Flashes\n\nTimes per minute that a detector begins to see more than 1.5 times the mean, down to {FLASH_DEPTH_M} m: time \
        series of greater depths would need too many cells.",
    );
    table(text, s, &|p| {
        let flashes = p.flashes.map(|f| with_error(f.per_minute));
        flashes.unwrap_or_default()
    });
    text.push_str("\nTheir mean length, ms: the share of time above the threshold over their number per time.\n");
    table(text, s, &|p| {
        let length = p.flashes.map(|f| f.length_ms.map(with_error));
        length.map_or_else(String::new, |l| l.unwrap_or_else(|| "none".to_owned()))
    });
    let _ = write!(text, "\n![Flashes against depth]({folder}{FLASHES}.svg)\n");
}

fn compared(text: &mut String, s: &SeaStudy) {
    text.push_str("\n## Beside what others found\n\n| source | how | says |\n|---|---|---|\n");
    for p in published::ALL {
        let _ = writeln!(text, "| {} | {} | {} |", p.source, p.how, p.says);
    }
    text.push('\n');
    for sentence in [
        variation_in_words(s),
        peaks_in_words(s),
        flashes_in_words(s),
    ]
    .into_iter()
    .flatten()
    {
        let _ = writeln!(text, "- {sentence}");
    }
    let _ = write!(
        text,
        "\nWhat differs from a sea, and in which direction:\n\n\
        - Light of the sky and light scattered by the water are left out. Both are even, so at sea they lower coefficients of variation and \
        peaks, by their share in the irradiance: a fifth to a third for the sky at a clear noon, and more with depth.\n\
        - Waves shorter than {SHORTEST_M} m are left out. Near the surface they would add fine, strong focusing; at depth they would \
        only blur.\n\
        - Waves longer than {LONG_TILE_M} m are left out. They focus far below the depths of this page, but they carry the short waves \
        and make them steeper on their crests; here long and short waves do not know of each other, and crests are not sharper than \
        troughs.\n\
        - Detectors grow with depth, as the tables say, and are never smaller than 5 mm. A smaller one would see higher peaks near the \
        surface: see the last table.\n\
        - Peaks that others report are the highest of records that are much longer than these maps.\n"
    );
}

/// The mean of a figure over all places.
fn mean<'a>(
    places: impl Iterator<Item = &'a PlaceResult>,
    of: impl Fn(&PlaceResult) -> f64,
) -> Option<f64> {
    let values: Vec<f64> = places.map(of).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn variation_in_words(s: &SeaStudy) -> Option<String> {
    let cv = |p: &PlaceResult| p.sun.cv.value;
    let shallow = mean(s.places.iter().filter(|p| p.place.depth_m <= 2.0), cv)?;
    let deep = mean(s.places.iter().filter(|p| p.place.depth_m == 25.0), cv)?;
    let ratio = shallow / deep;
    let verdict = if ratio > 1.3 * CV_RATIO {
        "More than measured. One reason may be that long waves, which focus at depth, are missing here."
    } else if ratio < CV_RATIO / 1.3 {
        "Less than measured. One reason may be that scattering, which is left out here, evens out the light at sea, and the more the deeper."
    } else {
        "About the same."
    };
    Some(format!(
        "**Variation.** The mean over winds at 2 m and above is {} times that at 25 m; measured: {CV_RATIO}. {verdict}",
        significant(ratio, 2)
    ))
}

fn peaks_in_words(s: &SeaStudy) -> Option<String> {
    let at_1_m = || s.places.iter().filter(|p| p.place.depth_m == 1.0);
    let largest = |of: fn(&PlaceResult) -> f64| at_1_m().max_by(|a, b| of(a).total_cmp(&of(b)));
    let highest = largest(|p| p.sun.highest)?.sun.highest;
    let of_point = largest(|p| p.point_sun.highest)?.point_sun.highest;
    let wind_m_s = largest(|p| p.sun.peak.value)?.place.wind_m_s;
    let [low, high] = PEAK_WINDS_M_S;
    let verdict = if (low..=high).contains(&wind_m_s) {
        "as others have it"
    } else {
        "others have it otherwise"
    };
    Some(format!(
        "**Peaks.** At 1 m the highest of all values is {} times the mean ({} for a point sun); others: up to {PEAK_AT_1_M}. The peaks that \
        one value in a thousand exceeds are highest under {wind_m_s} m/s there; the most intense peaks of others come with {low} … {high} \
        m/s: {verdict}.",
        significant(highest, 3),
        significant(of_point, 3),
    ))
}

fn flashes_in_words(s: &SeaStudy) -> Option<String> {
    let all: Vec<FlashFigures> = s.places.iter().filter_map(|p| p.flashes).collect();
    let range = |values: Vec<f64>| {
        let low = values.iter().copied().reduce(f64::min)?;
        let high = values.iter().copied().reduce(f64::max)?;
        Some([low, high])
    };
    let [least, most] = range(all.iter().map(|f| f.per_minute.value).collect())?;
    let lengths = all.iter().filter_map(|f| f.length_ms);
    let [shortest, longest] = range(lengths.map(|length| length.value).collect())?;
    let [short, long] = FLASH_MS;
    let rate = if (least..=most).contains(&FLASHES_PER_MINUTE) {
        "The published number lies in this range"
    } else if least > FLASHES_PER_MINUTE {
        "Ours are more: even light of the sky and scattered light, which would raise the mean that they have to exceed, are left out"
    } else {
        "Ours are fewer"
    };
    let length = if longest > long {
        "ours last longer; one reason may be that waves shorter than the cut, which would make finer and faster flashes, are left out"
    } else if shortest < short {
        "ours are shorter"
    } else {
        "the lengths agree"
    };
    Some(format!(
        "**Flashes.** Down to {FLASH_DEPTH_M} m there are {} … {} a minute, {} … {} ms long; published: {FLASHES_PER_MINUTE}, {short} … {long} ms. {rate}; \
        {length}.",
        significant(least, 2),
        significant(most, 2),
        significant(shortest, 2),
        significant(longest, 2),
    ))
}

fn account(text: &mut String, s: &SeaStudy) {
    let _ = write!(
        text,
        "\n## Account\n\nMean irradiance over that under flat water. Waves move light about and change how much of it enters only a \
        little, so this should be near 1. The energy accounts of all frames close to {:.0e} or better.\n",
        s.closure
    );
    table(text, s, &|p| with_error(p.sun.mean));
    text.push_str(
        "\nMean square slopes of the seas, from maps of the water (`output.kind` = `water_map`), and Cox and Munk's for a clean sea \
        (Journal of the Optical Society of America 44, 1954), which include the waves that are left out here:\n\n\
        | wind | here | Cox and Munk |\n|---:|---:|---:|\n",
    );
    for slope in &s.slopes {
        let _ = writeln!(
            text,
            "| {} m/s | {} | {} ± 0.004 |",
            slope.wind_m_s,
            significant(slope.mean_square, 3),
            significant(cox_munk(slope.wind_m_s), 3)
        );
    }
    let is_steeper = |slope: &SlopeResult| slope.mean_square > cox_munk(slope.wind_m_s) + 0.004;
    if s.slopes.iter().any(is_steeper) {
        text.push_str("\nWhere ours exceed theirs, the spectrum is steeper than their fit.\n");
    }
}

fn with_other_settings(text: &mut String, checks: &Checks) {
    let place = checks.place;
    let _ = write!(
        text,
        "\n## Other settings at {} m under {} m/s\n\nWith the same seas. Other cells and texels should agree within a standard error; \
        smaller detectors see more, because they average over less.\n\n\
        | | coefficient of variation | peak | flashes per minute | ms |\n|---|---:|---:|---:|---:|\n",
        place.depth_m, place.wind_m_s
    );
    for check in &checks.rows {
        let text_of = |estimate: Option<Estimate>| estimate.map_or_else(String::new, with_error);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            check.what,
            text_of(check.cv),
            text_of(check.peak),
            text_of(check.flashes.map(|f| f.per_minute)),
            text_of(check.flashes.and_then(|f| f.length_ms)),
        );
    }
    let _ = writeln!(text, "\n{}", apart_in_words(&checks.rows));
}

/// How far the coefficients of variation of the first three rows (or two) are apart.
fn apart_in_words(checks: &[Check]) -> String {
    let base = checks.first().and_then(|check| check.cv);
    let others = checks.iter().skip(1).take(2).filter_map(|check| check.cv);
    let apart = base.and_then(|base| {
        let all: Option<Vec<f64>> = others.map(|other| base.apart(other)).collect();
        all?.into_iter().reduce(f64::max)
    });
    match apart {
        None => "Standard errors need two maps or more.".to_owned(),
        Some(apart) if apart <= 1.0 => format!(
            "Cells and texels change the coefficient of variation by {} standard errors at most.",
            significant(apart, 2)
        ),
        Some(apart) => format!(
            "Cells or texels change the coefficient of variation by {} standard errors: the settings of this run are too coarse for this \
            place.",
            significant(apart, 2)
        ),
    }
}
