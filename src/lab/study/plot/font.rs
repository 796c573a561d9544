//! The one font of all pictures, built in, so that they look the same everywhere.

use std::sync::OnceLock;

use epaint_default_fonts::UBUNTU_LIGHT;
use plotters::style::{FontStyle, register_font};

use super::error::PlotError;

/// Family name in SVG files: a viewer without Ubuntu takes what it has. PNG files hold Ubuntu Light.
pub(in crate::lab::study) const FAMILY: &str = "Ubuntu, Helvetica, Arial, sans-serif";

/// Makes the font known to the drawing library, once.
pub(in crate::lab::study) fn register() -> Result<(), PlotError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered =
        *REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, UBUNTU_LIGHT).is_ok());
    if registered {
        Ok(())
    } else {
        Err(PlotError::Draw("the built-in font is damaged".to_owned()))
    }
}
