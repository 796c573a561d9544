//! MTL: the diffuse reflectance `Kd` is read. All else that would change the look is named in warnings.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Material;
use super::text::{Lines, Skipped, keyword_of, number, shorten, words};
use crate::stats::Warning;

/// Diffuse reflectance if the files have none.
pub const DEFAULT_ALBEDO: f32 = 0.8;
/// Code of the warning that a reflectance was out of range.
pub(crate) const CLAMPED: &str = "mesh_material_clamped";

/// Most materials that a warning names.
const MOST_NAMED: usize = 5;

/// The result of reading one or more MTL files.
#[derive(Debug, Default)]
pub(super) struct MtlScan {
    /// Materials in the order of the files; each name once.
    pub(super) materials: Vec<FileMaterial>,
    /// What was left out.
    pub(super) warnings: Vec<Warning>,
    place_of: BTreeMap<String, usize>,
}

/// A material of a file.
#[derive(Debug)]
pub(super) struct FileMaterial {
    /// Its name.
    pub(super) name: String,
    /// `Kd`, not yet clamped.
    pub(super) diffuse: Option<[f64; 3]>,
    /// Statements that are not used, by what they would change.
    unused: BTreeMap<Look, String>,
}

/// What a statement that is not used would change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Look {
    Transparency,
    Texture,
    Gloss,
    Emission,
}

impl Look {
    /// Code and text of the warning; the text goes on with the materials.
    fn warning(self) -> (&'static str, &'static str) {
        match self {
            Self::Transparency => (
                "mesh_transparency_ignored",
                "materials are transparent in the MTL and drawn opaque",
            ),
            Self::Texture => (
                "mesh_textures_ignored",
                "materials have textures in the MTL, which are not used",
            ),
            Self::Gloss => (
                "mesh_gloss_ignored",
                "materials have highlights or mirror reflections in the MTL and are drawn diffuse",
            ),
            Self::Emission => (
                "mesh_emission_ignored",
                "materials emit light in the MTL, which is not simulated",
            ),
        }
    }
}

impl MtlScan {
    /// Place of a material in `materials`.
    pub(super) fn place_of(&self, name: &str) -> Option<usize> {
        self.place_of.get(name).copied()
    }
}

/// Reads MTL files. Of several materials with the same name, the last one of the first file that has it counts. Nothing in an MTL is
/// an error: what cannot be read is left out with a warning.
pub(super) fn scan(files: &[&[u8]]) -> MtlScan {
    let mut scan = MtlScan::default();
    let mut unreadable = Skipped::default();
    let mut spectra = Skipped::default();
    let mut repeated = Skipped::default();
    for file in files {
        let of_earlier_files = scan.materials.len();
        let mut current: Option<usize> = None;
        let mut is_repeated = false;
        let lines = Lines::of(file);
        for (line, text) in lines.numbered() {
            let (keyword, rest) = keyword_of(&text);
            if keyword == "newmtl" {
                current = begin(&mut scan, rest, of_earlier_files);
                is_repeated = current.is_none();
                if is_repeated {
                    repeated.add(|| format!("`{}` on line {line}", shorten(rest)));
                }
                continue;
            }
            let material = current.map(|place| &mut scan.materials[place]);
            if keyword == "Kd" {
                match (diffuse(rest), material) {
                    _ if rest.starts_with("spectral") || rest.starts_with("xyz") => {
                        spectra.add(|| format!("on line {line}"));
                    }
                    (Some(values), Some(material)) => material.diffuse = Some(values),
                    (Some(_), None) if is_repeated => {}
                    _ => unreadable.add(|| format!("line {line} (`Kd {}`)", shorten(rest))),
                }
            } else if let (Some(look), Some(material)) = (look_of(keyword, rest), material) {
                let statements = material.unused.entry(look).or_default();
                let separator = if statements.is_empty() { "" } else { ", " };
                // Writing to a string cannot fail.
                let _ = write!(statements, "{separator}`{} {}`", keyword, shorten(rest));
            }
        }
    }
    scan.warnings.extend(unreadable.warning(
        "mesh_material_unreadable",
        "lines of the MTL are not used; expected `newmtl name`, then `Kd r g b` or `Kd grey` with reflectances 0 … 1.",
    ));
    scan.warnings.extend(spectra.warning(
        "mesh_spectra_ignored",
        "spectral colours (`Kd spectral`, `Kd xyz`) of the MTL are not used; only `Kd r g b` is.",
    ));
    scan.warnings.extend(repeated.warning(
        "mesh_material_repeated",
        "materials are in several MTL files; the first file that has one counts.",
    ));
    scan
}

/// The material that `newmtl` begins; `None` if an earlier file has it. One without a name is never used by an OBJ.
fn begin(scan: &mut MtlScan, name: &str, of_earlier_files: usize) -> Option<usize> {
    let place = match scan.place_of.get(name) {
        Some(place) if *place < of_earlier_files => return None,
        Some(place) => *place,
        None => {
            scan.place_of.insert(name.to_owned(), scan.materials.len());
            scan.materials.push(FileMaterial {
                name: name.to_owned(),
                diffuse: None,
                unused: BTreeMap::new(),
            });
            scan.materials.len() - 1
        }
    };
    scan.materials[place].diffuse = None;
    scan.materials[place].unused.clear();
    Some(place)
}

/// `Kd r g b`, or `Kd r` for a grey.
fn diffuse(rest: &str) -> Option<[f64; 3]> {
    let values: Option<Vec<f64>> = words(rest).map(number).collect();
    match values?[..] {
        [grey] => Some([grey; 3]),
        [r, g, b] => Some([r, g, b]),
        _ => None,
    }
}

/// What a statement would change, if anything: `d 1` and `Ks 0 0 0` would not.
fn look_of(keyword: &str, rest: &str) -> Option<Look> {
    let values: Vec<f64> = words(rest).filter_map(number).collect();
    let is_any = |neutral: f64| values.iter().any(|value| *value != neutral);
    match keyword {
        "d" if is_any(1.0) => Some(Look::Transparency),
        "Tr" if is_any(0.0) => Some(Look::Transparency),
        "Tf" if is_any(1.0) || values.is_empty() => Some(Look::Transparency),
        // Illumination models of the MTL format: 0 … 2 reflect no surroundings; 4, 6, 7 and 9 let light through.
        "illum" => match values.first().map(|model| *model as i64) {
            Some(4 | 6 | 7 | 9) => Some(Look::Transparency),
            Some(0..=2) => None,
            _ => Some(Look::Gloss),
        },
        "Ks" | "Pm" | "Ps" | "Pc" if is_any(0.0) => Some(Look::Gloss),
        "Ke" if is_any(0.0) => Some(Look::Emission),
        "bump" | "disp" | "decal" | "refl" | "norm" => Some(Look::Texture),
        _ if keyword.starts_with("map_") => Some(Look::Texture),
        _ => None,
    }
}

/// One warning for each look that used materials lose.
pub(super) fn look_warnings<'a>(used: impl Iterator<Item = &'a FileMaterial>) -> Vec<Warning> {
    let mut lost: BTreeMap<Look, Vec<String>> = BTreeMap::new();
    for material in used {
        for (look, statements) in &material.unused {
            let materials = lost.entry(*look).or_default();
            materials.push(format!("`{}` ({statements})", material.name));
        }
    }
    let warnings = lost.iter().map(|(look, materials)| {
        let (code, text) = look.warning();
        let shown = materials[..materials.len().min(MOST_NAMED)].join(", ");
        let more = if materials.len() > MOST_NAMED {
            ", …"
        } else {
            ""
        };
        Warning::new(code, format!("{} {text}: {shown}{more}.", materials.len()))
    });
    warnings.collect()
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
