//! Normal maps: the slopes of a surface as the codes of a PNG, in the layout that [`crate::scene::WaterMapOutput`] describes.

use crate::frame::Layer;

use super::tone::code;

/// RGB codes of `bits` (8 or 16) bits in PNG's byte order, of a layer with height and slopes along x and z.
pub(super) fn codes(layer: &Layer, bits: u32) -> Vec<u8> {
    let texels = layer.data.chunks_exact(layer.channels);
    let signals = texels.flat_map(|texel| {
        let [slope_x, slope_z] = [texel[1], texel[2]].map(f64::from);
        tangent_normal(slope_x, slope_z).map(|component| 0.5 * (component + 1.0))
    });
    if bits == 16 {
        let codes = signals.flat_map(|signal| code(signal, u16::MAX).to_be_bytes());
        codes.collect()
    } else {
        signals.map(|signal| code(signal, 255) as u8).collect()
    }
}

/// The unit normal of a surface with these slopes: its components along x, along −z (up a picture whose first row is at min z), and
/// upwards. Slopes: any finite numbers.
fn tangent_normal(slope_x: f64, slope_z: f64) -> [f64; 3] {
    let scale = 1.0 / slope_x.hypot(slope_z).hypot(1.0);
    [-slope_x * scale, slope_z * scale, scale]
}
