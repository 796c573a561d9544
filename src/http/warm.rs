//! The query of an upload: the suns for which level maps of the mesh are built.

use axum::extract::{FromRequestParts, Query};
use axum::http::request::Parts;
use utoipa::IntoParams;

use super::error::ApiError;
use super::state::AppState;
use crate::cache::{WarmSun, WarmUp};
use crate::scene::ranges::{ELEVATION, IOR, Integer, Layers, LevelMapTexels, TURNING_ANGLE};
use crate::scene::{Issue, Quality, Water};

/// The names of [`WarmParameters`].
const NAMES: [&str; 4] = ["warm", "warm_texels", "warm_layers", "warm_ior"];

/// Level maps to build during an upload, so that the first frame finds them in the cache.
#[derive(IntoParams)]
#[into_params(parameter_in = Query)]
#[expect(
    dead_code,
    reason = "the shape of a query, for the contract; parameters are read one by one"
)]
pub struct WarmParameters {
    /// `ELEVATION,AZIMUTH` of a sun, degrees, as in a scene: above 0 … 90, −10⁶ … 10⁶. Repeat it for each sun. The level map
    /// built is the one that an unrotated, uniformly scaled instance of the mesh needs under this sun.
    #[param(style = Form, explode, example = json!(["60,30"]))]
    warm: Option<Vec<String>>,
    /// `quality.level_map_texels` of the later frames, a power of two, 16 … 2048. Default 256.
    #[param(minimum = 16, maximum = 2048)]
    warm_texels: Option<u32>,
    /// `quality.layers` of the later frames, 1 … 4. Default 1.
    #[param(minimum = 1, maximum = 4)]
    warm_layers: Option<u32>,
    /// `water.ior` of the later frames, 1 … 4. Default 1.333.
    #[param(minimum = 1, maximum = 4)]
    warm_ior: Option<f64>,
}

/// The requested warm-up, if any.
#[derive(Clone, Debug)]
pub struct WarmQuery(pub Option<WarmUp>);

impl FromRequestParts<AppState> for WarmQuery {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let pairs = Query::<Vec<(String, String)>>::try_from_uri(&parts.uri)
            .map_err(|rejection| invalid(rejection.body_text(), "NAME=VALUE&NAME=VALUE …"))?;
        Reader::default().read(&pairs.0, state.limits().max_lights)
    }
}

/// The parameters read so far, and the findings.
#[derive(Default)]
struct Reader {
    suns: Vec<WarmSun>,
    texels: Option<u32>,
    layers: Option<u32>,
    ior: Option<f64>,
    issues: Vec<Issue>,
}

impl Reader {
    fn read(mut self, pairs: &[(String, String)], max_suns: usize) -> Result<WarmQuery, ApiError> {
        for (name, text) in pairs {
            match name.as_str() {
                "warm" => {
                    let sun = self.note(name, text, sun(text));
                    self.suns.extend(sun);
                }
                "warm_texels" => {
                    let texels = integer::<LevelMapTexels>(text);
                    let texels = self.note(name, text, texels);
                    self.once(name, self.texels.is_some());
                    self.texels = texels;
                }
                "warm_layers" => {
                    let layers = integer::<Layers>(text);
                    let layers = self.note(name, text, layers);
                    self.once(name, self.layers.is_some());
                    self.layers = layers;
                }
                "warm_ior" => {
                    let ior = number(text).filter(|&ior| IOR.contains(ior));
                    let ior = self.note(name, text, ior.ok_or_else(|| IOR.to_string()));
                    self.once(name, self.ior.is_some());
                    self.ior = ior;
                }
                _ => self.refuse(format!("there is no parameter `{name}`"), NAMES.join(", ")),
            }
        }
        if self.suns.len() > max_suns {
            let found = self.suns.len();
            self.refuse(
                format!("there are {found} of the parameter `warm`"),
                format!("at most {max_suns}"),
            );
        }
        if self.suns.is_empty() && !pairs.is_empty() {
            self.refuse(
                "the parameter `warm` is missing".to_owned(),
                format!("{} beside `warm`", NAMES[1..].join(", ")),
            );
        }
        if !self.issues.is_empty() {
            return Err(ApiError::InvalidQuery(self.issues));
        }
        Ok(WarmQuery((!self.suns.is_empty()).then(|| WarmUp {
            suns: self.suns,
            texels: self.texels.unwrap_or(Quality::default().level_map_texels),
            layers: self.layers.unwrap_or(Quality::default().layers),
            ior: self.ior.unwrap_or(Water::default().ior),
        })))
    }

    /// The value, or none and a finding.
    fn note<T>(&mut self, name: &str, text: &str, value: Result<T, String>) -> Option<T> {
        let shown: String = text.chars().take(60).collect();
        value
            .map_err(|accepted| {
                self.refuse(format!("the parameter `{name}` is `{shown}`"), accepted);
            })
            .ok()
    }

    /// Refuses a parameter that is given twice.
    fn once(&mut self, name: &str, was_there: bool) {
        if was_there {
            self.refuse(
                format!("the parameter `{name}` is given twice"),
                "once".to_owned(),
            );
        }
    }

    fn refuse(&mut self, detail: String, accepted: String) {
        self.issues.push(Issue::invalid("", detail, accepted));
    }
}

/// The error for a query that cannot be parsed.
fn invalid(detail: String, accepted: &str) -> ApiError {
    ApiError::InvalidQuery(vec![Issue::invalid("", detail, accepted)])
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok()
}

/// An integer, or what is accepted.
fn integer<R: Integer>(text: &str) -> Result<u32, String> {
    let value = text.parse().ok().filter(|&value| R::accepts(value));
    value.ok_or_else(R::accepted)
}

/// `ELEVATION,AZIMUTH`, or what is accepted.
fn sun(text: &str) -> Result<WarmSun, String> {
    let read = || {
        let (elevation, azimuth) = text.split_once(',')?;
        let sun = WarmSun {
            elevation_deg: number(elevation).filter(|&e| ELEVATION.contains(e) && e > 0.0)?,
            azimuth_deg: number(azimuth).filter(|&a| TURNING_ANGLE.contains(a))?,
        };
        Some(sun)
    };
    read().ok_or_else(|| {
        format!(
            "ELEVATION,AZIMUTH of a sun above the horizon: a number above 0, at most {} degrees; {TURNING_ANGLE}",
            ELEVATION.max
        )
    })
}
