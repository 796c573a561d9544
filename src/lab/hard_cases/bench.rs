//! Rendering with the checks that hold for every picture.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::Value;
use tokio_util::sync::CancellationToken;

use super::Settings;
use super::case::{Case, Failure, Outcome, Verdict};
use super::truths::Truths;
use crate::assets::MeshStore;
use crate::config::Limits;
use crate::fields::{self, Field};
use crate::frame::Frame;
use crate::mesh::Mesh;
use crate::methods;
use crate::render::{RenderError, Renderer};
use crate::scene::{Assets, Issue, LayerName, ResolvedScene, Scene, SceneError};
use crate::stats::{Stats, Warning};

/// Largest allowed closure of an energy account.
const MOST_CLOSURE: f64 = 1e-5;

/// A renderer, and what was observed while a case ran.
#[derive(Debug)]
pub struct Bench<'a> {
    /// `None` where only the case's scene is requested.
    renderer: Option<&'a mut Renderer>,
    pub(super) truths: &'a mut Truths,
    scene: Option<Value>,
    settings: Settings,
    meshes: MeshStore,
    closure: f64,
    warnings: BTreeMap<String, Option<f64>>,
    picture: Option<Frame>,
}

/// The files that a scene has in itself.
struct Files {
    meshes: Vec<Arc<Mesh>>,
    fields: Vec<Arc<Field>>,
}

impl Assets for &Files {
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>> {
        self.meshes.iter().find(|mesh| mesh.id == id).cloned()
    }

    fn field(&self, id: &str) -> Option<Arc<Field>> {
        self.fields.iter().find(|field| field.id == id).cloned()
    }
}

/// An NPY file of shape (rows, columns), float64, from rows of numbers; `null` is NaN.
fn npy_of(rows: &Value) -> Vec<u8> {
    let rows: Vec<&Vec<Value>> = rows
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_array)
        .collect();
    let columns = rows.first().map_or(0, |row| row.len());
    let header = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {columns}), }}",
        rows.len()
    );
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    // Length of the header, padded to a multiple of 64 with its own 10 bytes, and a line end.
    let length = (header.len() + 1 + 10).next_multiple_of(64) - 10;
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    let numbers = rows.into_iter().flatten();
    bytes.extend(numbers.flat_map(|number| number.as_f64().unwrap_or(f64::NAN).to_le_bytes()));
    bytes
}

/// The height fields of a scene whose frames are rows of numbers; they are replaced by the ids of their files.
fn fields_in(value: &mut Value) -> Result<Vec<Arc<Field>>, Failure> {
    let mut fields = Vec::new();
    let waves = value
        .pointer_mut("/water/waves")
        .and_then(Value::as_array_mut);
    for (wave, waves) in waves.into_iter().flatten().enumerate() {
        let frames = waves.get_mut("frames").and_then(Value::as_array_mut);
        for (index, frame) in frames.into_iter().flatten().enumerate() {
            let field = fields::read(&npy_of(frame)).map_err(|error| SceneError {
                issues: vec![Issue::invalid(
                    format!("/water/waves/{wave}/frames/{index}"),
                    error.to_string(),
                    "a file of heights",
                )],
            })?;
            *frame = Value::from(field.id.clone());
            fields.push(Arc::new(field));
        }
    }
    Ok(fields)
}

/// A scene with its files: `objects[i].mesh` are texts of OBJ files, and frames of height fields are rows of numbers.
pub(super) fn resolved(store: &mut MeshStore, mut value: Value) -> Result<ResolvedScene, Failure> {
    let fields = fields_in(&mut value)?;
    let mut meshes: Vec<Arc<Mesh>> = Vec::new();
    let objects = value.get_mut("objects").and_then(Value::as_array_mut);
    for object in objects.into_iter().flatten() {
        let text = object["mesh"].as_str().unwrap_or_default().to_owned();
        let mesh = store
            .insert_obj(text.as_bytes(), &[])
            .map_err(|error| Failure::Check(format!("the mesh is refused: {error}")))?
            .mesh;
        object["mesh"] = Value::from(mesh.id.clone());
        meshes.push(mesh);
    }
    let scene = Scene::from_value(value)?;
    let files = Files { meshes, fields };
    Ok(methods::resolve(scene, &Limits::default(), &files)?)
}

impl<'a> Bench<'a> {
    pub(super) fn new(
        renderer: Option<&'a mut Renderer>,
        truths: &'a mut Truths,
        settings: Settings,
    ) -> Self {
        Self {
            renderer,
            truths,
            scene: None,
            settings,
            meshes: MeshStore::default(),
            closure: 0.0,
            warnings: BTreeMap::new(),
            picture: None,
        }
    }

    /// The case's first scene.
    pub(super) fn into_scene(self) -> Option<Value> {
        self.scene
    }

    pub(super) fn settings(&self) -> Settings {
        self.settings
    }

    /// The renderer, for cases that do more than render a scene.
    pub(super) fn renderer(&mut self) -> Result<&mut Renderer, Failure> {
        self.renderer.as_deref_mut().ok_or_else(nothing_renders)
    }

    /// A scene; `objects[i].mesh` is the text of an OBJ.
    pub(super) fn scene(&mut self, value: Value) -> Result<ResolvedScene, Failure> {
        if self.renderer.is_none() {
            self.scene.get_or_insert(value);
            return Err(nothing_renders());
        }
        resolved(&mut self.meshes, value)
    }

    /// Renders a scene twice, and checks that both have the same bits, that all values are finite, and that every account closes.
    pub(super) fn render(&mut self, value: Value) -> Result<Frame, Failure> {
        let resolved = self.scene(value)?;
        self.render_resolved(&resolved)
    }

    pub(super) fn render_resolved(&mut self, resolved: &ResolvedScene) -> Result<Frame, Failure> {
        let Some(renderer) = self.renderer.as_deref_mut() else {
            return Err(nothing_renders());
        };
        let never = CancellationToken::new();
        let frame = renderer.render(resolved, &never)?;
        let again = renderer.render(resolved, &never)?;
        for (name, layer) in &frame.layers {
            if let Some(at) = layer.data.iter().position(|v| !v.is_finite()) {
                return Err(Failure::Check(format!(
                    "{name:?} is not finite at value {at}"
                )));
            }
            let bits = |frame: &Frame| -> Vec<u32> {
                frame.layers[name]
                    .data
                    .iter()
                    .map(|v| v.to_bits())
                    .collect()
            };
            if bits(&frame) != bits(&again) {
                return Err(Failure::Check(format!(
                    "{name:?} differs between two renders"
                )));
            }
        }
        if let Some(unsaid) = unsaid(&frame.stats) {
            return Err(Failure::Check(unsaid));
        }
        // Some methods do not conserve energy, and say so; that they say how much was checked above.
        let warnings = &frame.stats.warnings;
        let conserves = warnings
            .iter()
            .all(|w| w.code != "method_does_not_conserve");
        for account in frame.stats.energy.iter().filter(|_| conserves) {
            self.closure = self.closure.max(account.closure);
            let is_closed = account.closure <= MOST_CLOSURE;
            if !is_closed {
                return Err(Failure::Check(format!(
                    "the energy account of light {} is open by {:e}",
                    account.light, account.closure
                )));
            }
        }
        for warning in &frame.stats.warnings {
            let flux_w = warning
                .flux_w
                .map(|flux| flux.iter().copied().fold(0.0, f64::max));
            let known = self.warnings.entry(warning.code.clone()).or_default();
            *known = match (*known, flux_w) {
                (Some(a), Some(b)) => Some(a.max(b)),
                (a, b) => a.or(b),
            };
        }
        let shows = |name| frame.layers.contains_key(&name) && frame.width.min(frame.height) > 1;
        if shows(LayerName::Radiance) || shows(LayerName::Irradiance) {
            self.picture = Some(frame.clone());
        }
        Ok(frame)
    }

    /// The map of a scene, channel by channel, W/m².
    pub(super) fn map(&mut self, value: Value) -> Result<Vec<[f64; 3]>, Failure> {
        let frame = self.render(value)?;
        Ok(texels(&frame, LayerName::Irradiance))
    }

    /// Whether a warning came with any picture so far.
    pub(super) fn was_warned_of(&self, code: &str) -> bool {
        self.warnings.contains_key(code)
    }

    /// 0 if the scene is refused with an error at `pointer`, otherwise 1.
    pub(super) fn refused_at(&mut self, value: Value, pointer: &str) -> Result<f64, Failure> {
        match self.render(value) {
            Err(Failure::Scene(SceneError { issues })) => {
                let found = issues
                    .iter()
                    .any(|issue| issue.pointer == pointer && !issue.accepted.is_empty());
                Ok(if found { 0.0 } else { 1.0 })
            }
            Err(Failure::Render(RenderError::OverBudget {
                needed_bytes,
                budget_bytes,
                ..
            })) if pointer.is_empty() => Ok(if needed_bytes > budget_bytes {
                0.0
            } else {
                1.0
            }),
            Err(other) => Err(other),
            Ok(_) => Err(Failure::Check("it is not refused".to_owned())),
        }
    }

    pub(super) fn outcome(self, case: &'static Case, result: Result<f64, Failure>) -> Outcome {
        let (figure, failure) = match result {
            // NaN fails the comparison.
            Ok(figure) if figure <= case.bound => (Some(figure), None),
            Ok(figure) => (
                Some(figure),
                Some(format!("{figure:.1e} is above {:e}", case.bound)),
            ),
            Err(failure) => (None, Some(failure.to_string())),
        };
        let verdict = match (failure.is_some(), case.known_failure.is_some()) {
            (false, false) => Verdict::Holds,
            (true, false) => Verdict::Fails,
            (true, true) => Verdict::FailsAsKnown,
            (false, true) => Verdict::HoldsAfterAll,
        };
        Outcome {
            case,
            verdict,
            figure,
            failure,
            closure: self.closure,
            warnings: self.warnings.into_iter().collect(),
            picture: self.picture,
        }
    }
}

fn nothing_renders() -> Failure {
    Failure::Check("there is no renderer".to_owned())
}

/// Flux of the first channel that warnings with this code report, W.
pub(super) fn reported_w(frame: &Frame, code: &str) -> f64 {
    let warnings = frame.stats.warnings.iter().filter(|w| w.code == code);
    warnings.filter_map(|w| Some(w.flux_w?[0])).sum()
}

/// Flux that the accounts list as lost or only roughly placed and that no warning reports, or a warning that lacks its flux.
fn unsaid(stats: &Stats) -> Option<String> {
    let reported = |code: &str| {
        let mut found = stats.warnings.iter().filter(|w| w.code == code);
        found.find_map(|w| w.flux_w)
    };
    for warning in &stats.warnings {
        let has_flux = warning
            .flux_w
            .is_some_and(|w| w.iter().all(|v| v.is_finite()));
        if !has_flux && !Warning::WITHOUT_FLUX.contains(&warning.code.as_str()) {
            return Some(format!("`{}` does not say how much flux", warning.code));
        }
    }
    let scattered: [f64; 3] =
        std::array::from_fn(|c| stats.energy.iter().map(|a| a.scattered_w[c]).sum());
    if scattered != [0.0; 3] && reported("scattering_not_followed") != Some(scattered) {
        return Some(format!("{scattered:?} W are scattered without a warning"));
    }
    let open = stats.energy.iter().find(|a| a.closure > MOST_CLOSURE);
    match open {
        Some(account)
            if !stats.planes.is_empty() && reported("method_does_not_conserve").is_none() =>
        {
            Some(format!(
                "planes place {:e} of the flux of light {} too much or too little, without a warning",
                account.closure, account.light
            ))
        }
        _ => None,
    }
}

/// The pixels of a layer of three or four channels (the fourth is left out).
pub(super) fn texels(frame: &Frame, name: LayerName) -> Vec<[f64; 3]> {
    let Some(layer) = frame.layers.get(&name) else {
        return Vec::new();
    };
    layer
        .data
        .chunks_exact(layer.channels)
        .map(|p| std::array::from_fn(|c| f64::from(p[c.min(layer.channels - 1)])))
        .collect()
}
