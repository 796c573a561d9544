//! Dials: fields of `quality`, and dials of methods, with the values that a sweep gives them.

use serde_json::Value;

use super::comparison::{METHOD_DIAL, choice, split_list};
use crate::config::Limits;
use crate::methods;
use crate::scene::overrides::{self, Field};
use crate::scene::{Issue, ResolvedScene, Scene, SceneError};

/// The switch of the estimate: every setting is rendered with it once and timed without it, so it is not swept.
const NO_DIAL: &str = "estimate_error";
/// Most values of one dial.
pub const MOST_VALUES: usize = 32;
/// Ranges that end at or below this increase by one; longer ones double.
const COUNTED_TO: u64 = 8;

/// A field of `quality`, or a dial of a method, and the values it takes, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Dial {
    /// Name of the field.
    pub name: String,
    /// Its values as text: numbers, `true`, `false`, or words.
    pub values: Vec<String>,
}

/// Why a dial cannot be swept.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DialError {
    /// No field of this name.
    #[error("`{name}` is no dial; accepted: {}", known.join(", "))]
    Unknown {
        /// The requested name.
        name: String,
        /// The known names.
        known: Vec<String>,
    },
    /// Not `name=values`.
    #[error("`{0}` does not say which dial takes which values; accepted: name=a..b, name=a,b,c")]
    Form(String),
    /// A range that does not go up, or holds no whole numbers.
    #[error(
        "`{0}` is no range; accepted: a..b with whole numbers, a below b (and above 0 where b is over 8), or values separated by commas"
    )]
    Range(String),
    /// None, or more than [`MOST_VALUES`].
    #[error("{name} has {count} values; accepted: 1 … {MOST_VALUES}")]
    Count {
        /// The dial.
        name: String,
        /// How many values.
        count: usize,
    },
}

/// All dials: the fields of `quality` except the switch of the estimate, and the dials of all methods.
pub fn dials() -> Vec<Field> {
    methods::fields()
        .into_iter()
        .filter(|field| field.pointer.starts_with("/quality/") && field.name != NO_DIAL)
        .collect()
}

impl Dial {
    /// A dial with its values.
    ///
    /// # Errors
    /// [`DialError::Unknown`], [`DialError::Count`]. The scene's validation checks whether the values are in range.
    pub fn new(name: &str, values: Vec<String>) -> Result<Self, DialError> {
        let known = dials();
        if !known.iter().any(|field| field.name == name) {
            return Err(DialError::Unknown {
                name: name.to_owned(),
                known: known.into_iter().map(|field| field.name).collect(),
            });
        }
        if values.is_empty() || values.len() > MOST_VALUES {
            return Err(DialError::Count {
                name: name.to_owned(),
                count: values.len(),
            });
        }
        Ok(Self {
            name: name.to_owned(),
            values,
        })
    }

    /// Reads `water_cells=64..1024` (doubling), `split_levels=0..4` (counting, up to 8) or `name=a,b,c`; `-` and `_` in names
    /// are the same. A method may have dials: `method=planes:planes=9,slicing=smart,volumetric`.
    ///
    /// # Errors
    /// [`DialError`].
    pub fn parse(text: &str) -> Result<Self, DialError> {
        let (name, values) = text
            .split_once('=')
            .ok_or_else(|| DialError::Form(text.to_owned()))?;
        let name = name.trim().replace('-', "_");
        let values = values.trim();
        let values = match values.split_once("..") {
            Some((low, high)) => {
                range(low, high).ok_or_else(|| DialError::Range(values.to_owned()))?
            }
            None if name == METHOD_DIAL => split_list(values),
            None => values
                .split(',')
                .map(|value| value.trim().to_owned())
                .filter(|value| !value.is_empty())
                .collect(),
        };
        Self::new(&name, values)
    }

    /// The dials that matter most for a scene: always the water's cells, and more if it has meshes or a camera.
    pub fn for_scene(resolved: &ResolvedScene) -> Vec<Self> {
        let mut texts = vec!["water_cells=64..1024"];
        if !resolved.scene.objects.is_empty() {
            texts.push("split_levels=0..6");
            // For a map on a mesh it is the size of the map, which the truth shares.
            if !resolved.scene.output.is_object_map() {
                texts.push("level_map_texels=64..1024");
            }
        }
        if resolved.scene.output.is_view() {
            texts.push("map_texels=128..2048");
        }
        texts
            .into_iter()
            .map(|text| Self::parse(text).expect("these are dials"))
            .collect()
    }
}

/// `low`, twice that, and so on up to `high`; or one after the other.
fn range(low: &str, high: &str) -> Option<Vec<String>> {
    let low: u64 = low.trim().parse().ok()?;
    let high: u64 = high.trim().parse().ok()?;
    if low >= high {
        return None;
    }
    if high <= COUNTED_TO {
        return Some((low..=high).map(|value| value.to_string()).collect());
    }
    if low == 0 {
        return None;
    }
    let doubled = std::iter::successors(Some(low), |value| value.checked_mul(2));
    Some(
        doubled
            .take_while(|value| *value <= high)
            .map(|value| value.to_string())
            .collect(),
    )
}

/// A scene with some dials set.
#[derive(Clone, Debug)]
pub enum Setting {
    /// It passes all checks that are possible before rendering.
    Scene(Box<ResolvedScene>),
    /// The method cannot do this, for a reason; other methods may.
    LeftOut(String),
}

/// The scene with some dials set, checked like any other.
///
/// # Errors
/// Errors in a value that do not depend on the method, at its place under `/quality`.
pub fn with_dials(
    resolved: &ResolvedScene,
    dials: &[(String, String)],
    limits: &Limits,
) -> Result<Setting, SceneError> {
    let mut value = serde_json::to_value(&resolved.scene).map_err(|error| SceneError {
        issues: vec![Issue::invalid("", error.to_string(), "a scene")],
    })?;
    let known = self::dials();
    let pointer_to = |name: &str| match known.iter().find(|field| field.name == name) {
        Some(field) => field.pointer.clone(),
        None => format!("/quality/{name}"),
    };
    let mut changes: Vec<(String, String)> = Vec::new();
    for (name, text) in dials {
        if name == METHOD_DIAL && text.contains(':') {
            let choice = choice(text)?;
            changes.push((pointer_to(name), choice.kind.unwrap_or_default()));
            let own = choice.dials.iter();
            changes.extend(own.map(|(dial, value)| (pointer_to(dial), value.to_string())));
        } else {
            changes.push((pointer_to(name), text.clone()));
        }
    }
    overrides::apply(&mut value, &changes);
    let mut scene = Scene::from_value(value)?;
    let misfits = methods::misfits(&scene.quality);
    if misfits.is_empty() {
        methods::validate(&scene, limits)?;
    } else {
        scene.validate(limits)?;
    }
    scene.quality.method = methods::shortest(&scene.quality.method);
    let scene = ResolvedScene {
        scene,
        ..resolved.clone()
    };
    Ok(match methods::reason_against(&scene)? {
        None => Setting::Scene(Box::new(scene)),
        Some(reason) => Setting::LeftOut(reason),
    })
}

/// A dial's value as JSON: a number where it is one.
pub fn as_json(text: &str) -> Value {
    serde_json::from_str(text)
        .ok()
        .filter(|value: &Value| value.is_number() || value.is_boolean())
        .unwrap_or_else(|| Value::String(text.to_owned()))
}
