//! MTL: only the diffuse reflectance `Kd` is read.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::text::{name, shorten, words};
use super::{Material, MeshError};
use crate::stats::Warning;

/// Diffuse reflectance if the files have none.
pub const DEFAULT_ALBEDO: f32 = 0.8;
/// Code of the warning that a reflectance was out of range.
pub(crate) const CLAMPED: &str = "mesh_material_clamped";

const MTL: &str = "MTL";

/// The result of checking an MTL.
#[derive(Debug, Default)]
pub(super) struct MtlScan {
    /// The rewritten MTL: `newmtl` and `Kd` with three values each.
    pub(super) text: String,
    /// Names after `newmtl`.
    pub(super) names: BTreeSet<String>,
    /// What was left out.
    pub(super) warnings: Vec<Warning>,
}

/// Checks an MTL text line by line and keeps what is used. This is needed because the library panics on a `Kd` with fewer than
/// three values.
pub(super) fn scan(text: &str) -> Result<MtlScan, MeshError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut scan = MtlScan::default();
    let (mut textures, mut spectra) = (0_usize, 0_usize);
    for (index, raw) in text.lines().enumerate() {
        let line = index + 1;
        let raw = raw.trim();
        let (keyword, rest) = raw.split_once(char::is_whitespace).unwrap_or((raw, ""));
        match keyword {
            "newmtl" => {
                let name = name(MTL, line, keyword, rest)?;
                scan.names.insert(name.to_owned());
                let _ = writeln!(scan.text, "newmtl {name}");
            }
            "Kd" if rest.starts_with("spectral") || rest.starts_with("xyz") => spectra += 1,
            "Kd" if scan.names.is_empty() => {
                return Err(syntax(
                    line,
                    "`Kd` comes before any material; expected `newmtl name` first".to_owned(),
                ));
            }
            "Kd" => {
                let [r, g, b] = diffuse(line, rest)?;
                let _ = writeln!(scan.text, "Kd {r} {g} {b}");
            }
            "map_Kd" => textures += 1,
            _ => {}
        }
    }
    for (count, code, what) in [
        (textures, "mesh_textures_ignored", "textures (`map_Kd`)"),
        (
            spectra,
            "mesh_spectra_ignored",
            "spectral colours (`Kd spectral`, `Kd xyz`)",
        ),
    ] {
        if count > 0 {
            scan.warnings.push(Warning::new(
                code,
                format!("{count} {what} of the MTL are not used; only `Kd r g b` is."),
            ));
        }
    }
    Ok(scan)
}

/// `Kd r g b`, or `Kd r` for a grey.
fn diffuse(line: usize, rest: &str) -> Result<[f64; 3], MeshError> {
    let mut values = Vec::with_capacity(3);
    for word in words(rest) {
        values.push(word.parse::<f64>().map_err(|_| {
            syntax(
                line,
                format!(
                    "`{}` is not a number; expected `Kd r g b` with reflectances 0 … 1",
                    shorten(word)
                ),
            )
        })?);
    }
    match values[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(syntax(
            line,
            format!(
                "`Kd` has {} values; expected `Kd r g b` or `Kd grey` with reflectances 0 … 1",
                values.len()
            ),
        )),
    }
}

fn syntax(line: usize, message: String) -> MeshError {
    MeshError::Syntax {
        file: MTL,
        line,
        message,
    }
}

/// The default material.
pub(super) fn default_material() -> Material {
    Material {
        name: String::new(),
        albedo: [DEFAULT_ALBEDO; 3],
    }
}

/// A material for the renderer: reflectances clamped to 0 … 1, with a warning if they were outside.
pub(super) fn material(
    name: &str,
    diffuse: Option<[f64; 3]>,
    warnings: &mut Vec<Warning>,
) -> Material {
    let Some(diffuse) = diffuse else {
        return Material {
            name: name.to_owned(),
            ..default_material()
        };
    };
    let albedo = diffuse.map(|value| {
        if value.is_nan() {
            DEFAULT_ALBEDO
        } else {
            value.clamp(0.0, 1.0) as f32
        }
    });
    if !diffuse.iter().all(|value| (0.0..=1.0).contains(value)) {
        warnings.push(Warning::new(
            CLAMPED,
            format!(
                "Material `{name}` has Kd {} {} {}, outside 0 … 1; {} {} {} is used.",
                diffuse[0], diffuse[1], diffuse[2], albedo[0], albedo[1], albedo[2]
            ),
        ));
    }
    Material {
        name: name.to_owned(),
        albedo,
    }
}
