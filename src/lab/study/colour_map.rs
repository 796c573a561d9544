//! Colours for errors: signed ones from blue over white to red, unsigned ones as magma.

/// Ends and quarter points of a diverging map that is safe for colour-blind people, sRGB. Source: C. Brewer, ColorBrewer 2.0,
/// "RdBu" of 5 classes, with a pure white middle.
const DIVERGING: [[f64; 3]; 5] = [
    [5.0, 113.0, 176.0],
    [146.0, 197.0, 222.0],
    [255.0, 255.0, 255.0],
    [244.0, 165.0, 130.0],
    [202.0, 0.0, 32.0],
];

/// Nine stops of the map "magma", sRGB. Source: N. Smith, S. van der Walt, matplotlib (2015), CC0.
const MAGMA: [[f64; 3]; 9] = [
    [0.0, 0.0, 4.0],
    [28.0, 16.0, 68.0],
    [79.0, 18.0, 123.0],
    [129.0, 37.0, 129.0],
    [181.0, 54.0, 122.0],
    [229.0, 80.0, 100.0],
    [251.0, 135.0, 97.0],
    [254.0, 194.0, 135.0],
    [252.0, 253.0, 191.0],
];

/// Colour of a signed error: −1 blue, 0 white, 1 red; beyond is cut.
pub(super) fn diverging(value: f64) -> [u8; 3] {
    between(&DIVERGING, 0.5 + 0.5 * value)
}

/// Colour of an error of 0 (black) … 1 (pale yellow); beyond is cut.
pub(super) fn magma(value: f64) -> [u8; 3] {
    between(&MAGMA, value)
}

fn between(stops: &[[f64; 3]], share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let low = (place.floor() as usize).min(stops.len() - 2);
    let t = place - low as f64;
    let mut colour = [0; 3];
    for (channel, out) in colour.iter_mut().enumerate() {
        let value = (1.0 - t) * stops[low][channel] + t * stops[low + 1][channel];
        *out = value.round() as u8;
    }
    colour
}
