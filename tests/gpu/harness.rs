//! One renderer for all tests, and helpers to render maps.

use std::ops::Deref;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use caustica::config::RenderConfig;
use caustica::frame::Frame;
use caustica::reference::ReferenceSettings;
use caustica::render::{RenderError, Renderer};
use caustica::scene::{LayerName, ResolvedScene};
use serde_json::Value;
use tokio_util::sync::CancellationToken;

use super::scene_files;

/// The renderer that all tests share: pipelines are built once.
pub(crate) fn renderer() -> MutexGuard<'static, Renderer> {
    static SHARED: OnceLock<Mutex<Renderer>> = OnceLock::new();
    let shared = SHARED.get_or_init(|| {
        let renderer = new_renderer(&RenderConfig::default());
        println!("adapter: {:?}", renderer.adapter());
        Mutex::new(renderer)
    });
    // A test that failed has not harmed the renderer; if it has, the next one says so.
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A renderer of one's own.
pub(crate) fn new_renderer(config: &RenderConfig) -> Renderer {
    Renderer::new(config).unwrap_or_else(|error| panic!("these tests need an adapter: {error}"))
}

/// Renders with the shared renderer; any error of the GPU fails the test.
pub(crate) fn render(resolved: &ResolvedScene) -> Frame {
    render_with(&mut renderer(), resolved)
}

/// Renders with a renderer of one's own.
pub(crate) fn render_with(renderer: &mut Renderer, resolved: &ResolvedScene) -> Frame {
    let frame = try_render(renderer, resolved).unwrap_or_else(|error| panic!("{error}"));
    renderer.gpu().check().unwrap();
    frame
}

/// The same for scenes that may be refused.
pub(crate) fn try_render(
    renderer: &mut Renderer,
    resolved: &ResolvedScene,
) -> Result<Frame, RenderError> {
    renderer.render(resolved, &CancellationToken::new())
}

/// An irradiance map with the frame it came in.
pub(crate) struct Map {
    pub(crate) frame: Frame,
    pub(crate) texels: Vec<[f64; 3]>,
}

impl Deref for Map {
    type Target = Frame;

    fn deref(&self) -> &Frame {
        &self.frame
    }
}

impl Map {
    /// The map of a scene from JSON.
    pub(crate) fn of(scene: Value) -> Self {
        Self::from(&scene_files::scene(scene))
    }

    /// The map of a scene.
    pub(crate) fn from(resolved: &ResolvedScene) -> Self {
        Self::with(&mut renderer(), resolved)
    }

    /// The map of a scene from a renderer that is held for longer.
    pub(crate) fn with(renderer: &mut Renderer, resolved: &ResolvedScene) -> Self {
        let frame = render_with(renderer, resolved);
        let texels = layer(&frame, LayerName::Irradiance);
        Self { frame, texels }
    }

    /// All values, one behind the other.
    pub(crate) fn values(&self) -> &[f64] {
        self.texels.as_flattened()
    }

    /// Mean of a channel.
    pub(crate) fn mean(&self, channel: usize) -> f64 {
        self.texels.iter().map(|t| t[channel]).sum::<f64>() / self.texels.len() as f64
    }

    /// Largest closure of the frame's energy accounts; there has to be one.
    pub(crate) fn closure(&self) -> f64 {
        let accounts = &self.frame.stats.energy;
        assert!(!accounts.is_empty(), "the frame has no energy account");
        let closures = accounts.iter().map(|account| account.closure);
        closures.fold(0.0, nan_fails)
    }
}

/// The pixels of a layer of three or four channels (the fourth is left out).
pub(crate) fn layer(frame: &Frame, name: LayerName) -> Vec<[f64; 3]> {
    let layer = &frame.layers[&name];
    let pixels = layer.data.chunks_exact(layer.channels);
    pixels
        .map(|p| std::array::from_fn(|c| f64::from(p[c.min(layer.channels - 1)])))
        .collect()
}

/// Settings of a reference map of the floor, to a relative error.
pub(crate) fn truth_settings(target_error: f64) -> ReferenceSettings {
    ReferenceSettings {
        target_error: Some(target_error),
        ..ReferenceSettings::default()
    }
}

/// Largest |a − b| / |b| over two lists.
pub(crate) fn largest_relative(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(!a.is_empty(), "there is nothing to compare");
    let errors = a.iter().zip(b).map(|(a, b)| ((a - b) / b).abs());
    errors.fold(0.0, nan_fails)
}

/// Largest |a − b| as a share of the mean of b.
pub(crate) fn largest_to_mean(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(!a.is_empty(), "there is nothing to compare");
    let mean = b.iter().sum::<f64>() / b.len() as f64;
    let errors = a.iter().zip(b).map(|(a, b)| ((a - b) / mean).abs());
    errors.fold(0.0, nan_fails)
}

/// `f64::max`, but NaN becomes infinity instead of getting lost.
pub(crate) fn nan_fails(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}
