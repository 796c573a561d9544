//! Tone curves in f64: from exposed, linear Rec. 709 light to sRGB codes.

use crate::scene::ToneCurve;

/// How far above 1 a value may be before it counts as clipped: the rounding error of a white of 1.
pub const CLIP_TOLERANCE: f64 = 1e-6;

/// A pixel ready for the screen, still linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// Linear light, 0 … 1 per channel.
    pub rgb: [f64; 3],
    /// Whether a channel was above 1 and was clipped ([`ToneCurve::Clip`] only).
    pub clipped: bool,
    /// Whether a channel was negative and was set to 0.
    pub negative: bool,
}

/// Applies a tone curve to exposed light (finite, 1 = white).
pub fn display(curve: ToneCurve, exposed: [f64; 3]) -> Display {
    let negative = exposed.iter().any(|v| *v < 0.0);
    let light = exposed.map(|v| v.max(0.0));
    let (rgb, clipped) = match curve {
        ToneCurve::Clip => (light, light.iter().any(|v| *v > 1.0 + CLIP_TOLERANCE)),
        ToneCurve::PbrNeutral => (pbr_neutral(light), false),
    };
    Display {
        rgb: rgb.map(|v| v.clamp(0.0, 1.0)),
        clipped,
        negative,
    }
}

/// Khronos PBR Neutral tone mapper.
///
/// Source: Khronos Group, "Khronos PBR Neutral Tone Mapper" specification (2024), with F90 = 0.04, K_s = 0.8 − F90, K_d = 0.15.
/// The Fresnel offset is subtracted; values up to K_s are otherwise unchanged; values above are compressed and desaturated
/// towards white. Domain: finite, not negative; range 0 … 1.
pub fn pbr_neutral(light: [f64; 3]) -> [f64; 3] {
    const F90: f64 = 0.04;
    const START_COMPRESSION: f64 = 0.8 - F90;
    const DESATURATION: f64 = 0.15;

    // Subtract the reflection that a dielectric adds at normal incidence; a parabola joins 0 smoothly.
    let lowest = light.iter().copied().fold(f64::INFINITY, f64::min);
    let offset = if lowest < 2.0 * F90 {
        lowest - lowest * lowest / (4.0 * F90)
    } else {
        F90
    };
    let moved = light.map(|v| v - offset);

    let peak = moved.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if peak < START_COMPRESSION {
        return moved;
    }
    // Compress the brightest channel below 1 and scale the others with it, which keeps the hue.
    let room = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - room * room / (peak + room - START_COMPRESSION);
    // Desaturate more where more was compressed.
    let kept = 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    moved.map(|v| v * (new_peak / peak) * kept + new_peak * (1.0 - kept))
}

/// Linear light to the sRGB signal. Source: IEC 61966-2-1:1999, 5.2. Domain and range 0 … 1.
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The sRGB signal to linear light. Source: IEC 61966-2-1:1999, 5.3. Domain and range 0 … 1.
pub fn linear_from_srgb(signal: f64) -> f64 {
    if signal <= 0.040_45 {
        signal / 12.92
    } else {
        ((signal + 0.055) / 1.055).powf(2.4)
    }
}

/// Nearest of the codes 0 … `max` for a signal within 0 … 1; halves go up.
pub fn code(signal: f64, max: u16) -> u16 {
    (signal * f64::from(max) + 0.5).floor() as u16
}
