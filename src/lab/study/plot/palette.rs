//! Colours. Sweeps: Okabe and Ito, "Color Universal Design" (2008), which people with any kind of colour vision can distinguish;
//! without its black (used for the front) and yellow (too pale for lines on white); a violet and a brown of other lightness follow.

use plotters::style::RGBColor;

/// One per sweep, again from the start when there are more.
pub(super) const SWEEPS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(91, 44, 131),
    RGBColor(122, 92, 46),
];

/// Text and axes.
pub(in crate::lab::study) const INK: RGBColor = RGBColor(32, 32, 32);
/// Text of less weight.
pub(in crate::lab::study) const SOFT_INK: RGBColor = RGBColor(96, 96, 96);
/// Lines of the grid that have a label.
pub(super) const GRID: RGBColor = RGBColor(214, 214, 214);
/// Lines of the grid between them.
pub(super) const FAINT_GRID: RGBColor = RGBColor(240, 240, 240);
/// Reference slopes.
pub(super) const REFERENCE: RGBColor = RGBColor(168, 168, 168);
/// The truth's own error.
pub(super) const FLOOR: RGBColor = RGBColor(120, 60, 60);
/// Paper.
pub(in crate::lab::study) const WHITE: RGBColor = RGBColor(255, 255, 255);

/// Colour of the sweep (in a comparison, the method) of that index.
pub(super) fn sweep(index: usize) -> RGBColor {
    SWEEPS[index % SWEEPS.len()]
}

/// Colour of texts of the sweep of that index: the same, darker, so that thin letters can be read.
pub(super) fn sweep_ink(index: usize) -> RGBColor {
    let RGBColor(r, g, b) = sweep(index);
    let darker = |v: u8| (u16::from(v) * 7 / 10) as u8;
    RGBColor(darker(r), darker(g), darker(b))
}
