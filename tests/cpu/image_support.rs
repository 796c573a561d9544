//! Hand-made frames for the tests of image files.

use std::collections::BTreeMap;

use caustica::frame::{Frame, FrameKind, Layer};
use caustica::scene::{Encoding, ExrPixel, ImageFormat, LayerName, ToneCurve};
use caustica::stats::{AdapterStats, ExposureStats, PassStats, Stats, Warning};

/// A view of one layer.
pub(crate) fn frame(width: u32, height: u32, name: LayerName, layer: Layer) -> Frame {
    Frame {
        kind: FrameKind::View,
        width,
        height,
        layers: BTreeMap::from([(name, layer)]),
        projection: None,
        stats: stats(1.0),
        scene: None,
    }
}

/// An irradiance map.
pub(crate) fn map(width: u32, height: u32, layer: Layer) -> Frame {
    Frame {
        kind: FrameKind::IrradianceMap,
        ..frame(width, height, LayerName::Irradiance, layer)
    }
}

/// A layer from a function of column, row and channel.
pub(crate) fn layer(
    width: u32,
    height: u32,
    channels: usize,
    value: impl Fn(u32, u32, usize) -> f32,
) -> Layer {
    let mut data = Vec::new();
    for y in 0..height {
        for x in 0..width {
            data.extend((0..channels).map(|c| value(x, y, c)));
        }
    }
    Layer { channels, data }
}

/// Statistics with something in every field that a file may or may not carry.
pub(crate) fn stats(scale: f64) -> Stats {
    let mut stats = Stats {
        version: "9.8.7".to_owned(),
        scene_hash: "blake3:0123".to_owned(),
        adapter: AdapterStats {
            name: "Übersichtskarte 水".to_owned(),
            backend: "vulkan".to_owned(),
            driver: "d 1".to_owned(),
            software: true,
        },
        passes: vec![PassStats {
            name: "surface".to_owned(),
            reason: "needed by beams".to_owned(),
            runs: 3,
            gpu_ms: Some(1.25),
        }],
        exposure: ExposureStats {
            white_radiance: 1.0,
            ev: 0.0,
            scale,
        },
        warnings: vec![Warning::new("scattering", "not simulated: 5 % of the flux")],
        ..Stats::default()
    };
    stats.memory.planned_peak_bytes = 4096;
    stats.time_ms.total = 17.5;
    stats
}

/// PNG without surprises: 8 bits, clip.
pub(crate) fn png(bits: u32, tone_curve: ToneCurve) -> Encoding {
    Encoding {
        format: ImageFormat::Png,
        png_bits: bits,
        exposure_ev: 0.0,
        tone_curve,
        exr_pixel: ExrPixel::Half,
        embed_scene: true,
    }
}

/// EXR of a number type.
pub(crate) fn exr(exr_pixel: ExrPixel) -> Encoding {
    Encoding {
        format: ImageFormat::Exr,
        exr_pixel,
        ..png(8, ToneCurve::Clip)
    }
}
