//! Comparisons of methods: which methods take part, and the settings of each.
//!
//! The settings of a method are a ladder. From one to the next all its numbers that trade accuracy for time grow together: its own dials in
//! proportion, the fields of `quality` as [`ladder::rung`] sets them. So every method shows what it can do for a given time, and not what
//! it does with dials that fit another method. Words (of a dial such as `density`) make further series of the same method.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::methods::{self, Method};
use crate::scene::overrides::METHOD;
use crate::scene::{
    self, DialKind, DialValue, Issue, MethodChoice, Output, Quality, ResolvedScene, SceneError,
};
use crate::tuning::ladder;

/// The dial whose values are methods.
pub const METHOD_DIAL: &str = "method";
/// Stands for every method, or after a method's name for every word of it.
pub const ALL: &str = "all";
/// Accepted numbers of settings per series.
pub const RUNGS: std::ops::RangeInclusive<u32> = 2..=6;
/// Settings per series if nobody says otherwise: 64, 128, 256 and 512 water cells.
pub const DEFAULT_RUNGS: u32 = 4;

/// Water cells of the first setting.
const FIRST_CELLS: u32 = 64;
/// How far the first number of a method is ahead of its other numbers on its second ladder.
const AHEAD: u32 = 4;
/// Whole numbers with a smaller default count steps: fewer than by default are too few, so they only grow.
const COUNTS_STEPS_BELOW: u32 = 8;

/// A setting: dials with their values as text, the method first.
pub(super) type DialTexts = Vec<(String, String)>;

/// A series of a comparison: a method with some words, and its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Contender {
    /// The method.
    pub method: &'static str,
    /// What distinguishes the series from others of the method: `method`, or `method, dial word`.
    pub name: String,
    /// The dial whose value names a setting: the first number that grows.
    pub chief: String,
    /// Scale (1 where the numbers are those of 256 water cells) and dials of each setting.
    pub settings: Vec<(f64, DialTexts)>,
}

/// A method with some of its dials fixed, and whether its first number runs ahead.
struct Variant {
    method: &'static Method,
    fixed: Vec<(&'static str, DialValue)>,
    ahead: bool,
}

/// The series that `names` stand for, in the order of the names; the same series twice counts once.
///
/// `all` is every method with each of its words; `planes:all` is one method with each of its words; `planes` is the method with
/// the words that are its defaults; `planes:slicing=smart` fixes dials of the method. A method with several numbers of its own has a second
/// ladder, on which the first is four times as large: nothing says that its numbers have to be equal. Series with fixed dials run on that. A
/// ladder ends early where its chief dial is at the end of its range.
///
/// # Errors
/// Unknown methods, dials and words, at their places under `/quality/method`; a fixed dial that leaves nothing to grow.
pub fn contenders(
    names: &[String],
    resolved: &ResolvedScene,
    rungs: u32,
) -> Result<Vec<Contender>, SceneError> {
    let mut variants = Vec::new();
    for name in names {
        match name.trim() {
            ALL => {
                for method in methods::ALL {
                    variants.extend(all_of(method));
                }
            }
            text => match text.strip_suffix(":all") {
                Some(name) => variants.extend(all_of(method_of(&choice(name)?))),
                None => variants.extend(chosen(&choice(text)?)),
            },
        }
    }
    let mut found: Vec<Contender> = Vec::new();
    for variant in variants {
        let contender = contender(&variant, resolved, rungs)?;
        if !found.contains(&contender) {
            found.push(contender);
        }
    }
    Ok(found)
}

/// Reads `name` or `name:dial=value,dial=value`.
///
/// # Errors
/// What [`methods::check`] finds about it.
pub(super) fn choice(text: &str) -> Result<MethodChoice, SceneError> {
    let (kind, dials) = text.split_once(':').unwrap_or((text, ""));
    let mut choice = MethodChoice::named(kind.trim());
    for part in dials.split(',').filter(|part| !part.trim().is_empty()) {
        let (name, value) = part.split_once('=').ok_or_else(|| {
            let detail = format!("`{part}` does not set a dial of method {kind}");
            Issue::invalid(
                METHOD,
                detail,
                "`method`, or `method:dial=value,dial=value`",
            )
        })?;
        let value = value.trim();
        let value = match value.parse::<f64>() {
            Ok(number) if number.is_finite() => DialValue::Number(number),
            _ => DialValue::Word(value.to_owned()),
        };
        choice.dials.insert(name.trim().replace('-', "_"), value);
    }
    let quality = Quality {
        method: choice.clone(),
        ..Quality::default()
    };
    match methods::check(&quality) {
        issues if issues.is_empty() => Ok(choice),
        issues => Err(SceneError { issues }),
    }
}

/// Splits a list of methods at its commas, but not at those between the dials of one method.
pub fn split_list(text: &str) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    for part in text.split(',').map(str::trim).filter(|p| !p.is_empty()) {
        match parts.last_mut() {
            Some(before) if part.contains('=') && !part.contains(':') => {
                before.push(',');
                before.push_str(part);
            }
            _ => parts.push(part.to_owned()),
        }
    }
    parts
}

fn method_of(choice: &MethodChoice) -> &'static Method {
    methods::of(&Quality {
        method: choice.clone(),
        ..Quality::default()
    })
}

/// A method with the words that are its defaults and both its ladders, then with each other word.
fn all_of(method: &'static Method) -> Vec<Variant> {
    let mut all = chosen(&MethodChoice::named(method.name));
    for dial in method.dials {
        let default = dial.default_value();
        let others = dial.words().into_iter().map(DialValue::from);
        all.extend(others.filter(|word| *word != default).map(|word| Variant {
            method,
            fixed: vec![(dial.name, word)],
            ahead: has_second_ladder(method, &[]),
        }));
    }
    all
}

/// The ladders of one choice: both of a method by name, and one with fixed dials.
fn chosen(choice: &MethodChoice) -> Vec<Variant> {
    let method = method_of(choice);
    let set = method
        .dials
        .iter()
        .filter_map(|dial| Some((dial.name, choice.dials.get(dial.name)?.clone())));
    let fixed: Vec<(&str, DialValue)> = set.collect();
    let names: Vec<&str> = fixed.iter().map(|(name, _)| *name).collect();
    let variant = |ahead| Variant {
        method,
        fixed: fixed.clone(),
        ahead,
    };
    match (has_second_ladder(method, &names), fixed.is_empty()) {
        (true, true) => vec![variant(false), variant(true)],
        (ahead, _) => vec![variant(ahead)],
    }
}

/// The method's own numbers that are not fixed.
fn own_numbers<'a>(
    method: &'static Method,
    fixed: &'a [&str],
) -> impl Iterator<Item = &'static scene::Dial> + 'a {
    let dials = method.dials.iter().copied();
    dials.filter(|dial| dial.words().is_empty() && !fixed.contains(&dial.name))
}

fn has_second_ladder(method: &'static Method, fixed: &[&str]) -> bool {
    own_numbers(method, fixed).count() > 1
}

fn contender(
    variant: &Variant,
    resolved: &ResolvedScene,
    rungs: u32,
) -> Result<Contender, SceneError> {
    let method = variant.method;
    let fixed: Vec<&str> = variant.fixed.iter().map(|(name, _)| *name).collect();
    let numbers: Vec<&scene::Dial> = own_numbers(method, &fixed).collect();
    let shared: Vec<&str> = method
        .shared_dials
        .iter()
        .copied()
        .filter(|name| matters(name, resolved))
        .collect();
    let Some(chief) = shared.first().copied().or(numbers.first().map(|d| d.name)) else {
        let detail = format!(
            "nothing of method {} is left to grow",
            variant_name(variant)
        );
        return Err(Issue::invalid(METHOD, detail, "fewer fixed dials").into());
    };
    let ahead = numbers.first().map(|dial| dial.name);
    let mut settings: Vec<(f64, DialTexts)> = Vec::new();
    for cells in (0..rungs).map(|rung| FIRST_CELLS << rung) {
        let scale = f64::from(cells) / f64::from(Quality::default().water_cells);
        let mut dials = vec![(METHOD_DIAL.to_owned(), method.name.to_owned())];
        let fixed = variant.fixed.iter();
        dials.extend(fixed.map(|(name, value)| ((*name).to_owned(), value.to_string())));
        for dial in &numbers {
            let lead = match variant.ahead && ahead == Some(dial.name) {
                true => f64::from(AHEAD),
                false => 1.0,
            };
            dials.push((dial.name.to_owned(), grown(dial, scale * lead)));
        }
        let quality = &resolved.scene.quality;
        let rung = ladder::rung(quality, &resolved.scene.output, cells);
        let rung = serde_json::to_value(rung).unwrap_or_default();
        dials.extend(
            shared
                .iter()
                .map(|name| ((*name).to_owned(), rung[*name].to_string())),
        );
        // The ladder ends with the range of its chief dial: a setting beyond would not be where its scale says.
        let number = |dials: &DialTexts| {
            let value = dials.iter().find(|(name, _)| name == chief);
            value.and_then(|(_, value)| value.parse::<f64>().ok())
        };
        let before = settings
            .last()
            .map(|(before, dials)| (*before, number(dials)));
        if let Some((before, Some(value))) = before
            && number(&dials).is_none_or(|now| now * before < 0.9 * value * scale)
        {
            break;
        }
        settings.push((scale, dials));
    }
    Ok(Contender {
        method: method.name,
        name: variant_name(variant),
        chief: chief.to_owned(),
        settings,
    })
}

/// `method`, `method, dial word`, `method, 4 × photons`.
fn variant_name(variant: &Variant) -> String {
    let mut name = variant.method.name.to_owned();
    for (dial, value) in &variant.fixed {
        name.push_str(&format!(", {dial} {value}"));
    }
    // With fixed dials there is one ladder only.
    if let (true, true, Some(dial)) = (
        variant.ahead,
        variant.fixed.is_empty(),
        own_numbers(variant.method, &[]).next(),
    ) {
        name.push_str(&format!(", {AHEAD}× {}", dial.name));
    }
    name
}

/// The value of a number at a scale, within its range.
fn grown(dial: &scene::Dial, scale: f64) -> String {
    match dial.kind {
        DialKind::Integer {
            least,
            most,
            default,
        } => {
            let from = match default < COUNTS_STEPS_BELOW {
                true => default,
                false => least,
            };
            let value = (f64::from(default) * scale).ceil();
            (value.min(f64::from(most)) as u32).max(from).to_string()
        }
        DialKind::Number {
            least,
            most,
            default,
        } => Value::from((default * scale).clamp(least, most)).to_string(),
        DialKind::Word { default, .. } => default.to_owned(),
    }
}

/// Whether the ladder sets this field of `quality`, and the scene's output depends on it.
fn matters(dial: &str, resolved: &ResolvedScene) -> bool {
    let scene = &resolved.scene;
    let of_objects = BTreeSet::from(["level_map_texels", "split_levels"]);
    ladder::sets(dial, &scene.output)
        && (!of_objects.contains(dial) || !scene.objects.is_empty())
        && (dial != "map_texels" || matches!(scene.output, Output::View(_)))
}
