//! MTL: the diffuse reflectance `Kd` is read. All else that would change the look is named in warnings.

use std::collections::{BTreeMap, BTreeSet};

use super::Material;
use super::text::{Lines, Skipped, Statement, keyword_of, names_in, number, shorten, words};
use crate::stats::Warning;

/// Diffuse reflectance if the files have none.
pub const DEFAULT_ALBEDO: f32 = 0.8;
/// Code of the warning that a reflectance was out of range.
pub(crate) const CLAMPED: &str = "mesh_material_clamped";

/// Most materials that a warning names.
const MOST_NAMED: usize = 5;

/// Most unused statements of a material that are kept for its warnings.
const MOST_STATEMENTS: usize = 4;

/// The result of reading one or more MTL files.
#[derive(Debug, Default)]
pub(super) struct MtlScan {
    /// Materials that the OBJ uses, in the order of the files; each name once.
    pub(super) materials: Vec<FileMaterial>,
    /// Number of materials in the files.
    pub(super) count: usize,
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
    unused: BTreeMap<Look, Vec<String>>,
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

/// Reads the materials `used` from MTL files. Of several materials with the same name, the last one of the first file that has it counts.
/// Nothing in an MTL is an error: what cannot be read is left out with a warning.
pub(super) fn scan(files: &[&[u8]], used: &BTreeSet<&str>) -> MtlScan {
    let mut scan = MtlScan::default();
    let mut unreadable = Skipped::default();
    let mut spectra = Skipped::default();
    let mut repeated = Skipped::default();
    for file in files {
        let of_earlier_files = scan.materials.len();
        let mut current = Current::None;
        let lines = Lines::of(file);
        for Statement { line, text } in lines.statements(may_go_on) {
            let (keyword, rest) = keyword_of(&text);
            if keyword.eq_ignore_ascii_case("newmtl") {
                scan.count += 1;
                current = begin(&mut scan, rest, used, of_earlier_files);
                if matches!(current, Current::Repeated) {
                    repeated.add(|| format!("`{}` on line {line}", shorten(rest)));
                }
                continue;
            }
            let is_diffuse = keyword.eq_ignore_ascii_case("kd");
            let material = match current {
                Current::Used(place) => &mut scan.materials[place],
                Current::None if is_diffuse => {
                    unreadable.add(|| format!("line {line} (`{keyword} {}`)", shorten(rest)));
                    continue;
                }
                _ => continue,
            };
            if is_diffuse {
                match diffuse(rest) {
                    _ if rest.starts_with("spectral") || rest.starts_with("xyz") => {
                        spectra.add(|| format!("on line {line}"));
                    }
                    Some(values) => material.diffuse = Some(values),
                    None => {
                        unreadable.add(|| format!("line {line} (`{keyword} {}`)", shorten(rest)));
                    }
                }
            } else if let Some(look) = look_of(&keyword.to_ascii_lowercase(), rest) {
                let statements = material.unused.entry(look).or_default();
                if statements.len() < MOST_STATEMENTS {
                    statements.push(format!("`{keyword} {}`", shorten(rest)));
                }
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

/// Whether a line may be joined with the next one: not comments and names.
fn may_go_on(line: &str) -> bool {
    let (keyword, _) = keyword_of(line);
    !keyword.starts_with('#') && !keyword.eq_ignore_ascii_case("newmtl")
}

/// The material that the lines of a file belong to.
#[derive(Clone, Copy)]
enum Current {
    /// Before the first `newmtl`.
    None,
    /// One that the OBJ uses, by its place.
    Used(usize),
    /// One that an earlier file has.
    Repeated,
    /// One that the OBJ does not use.
    Unused,
}

/// The material that `newmtl` begins. Its name ends before a comment if the OBJ knows it so.
fn begin(
    scan: &mut MtlScan,
    rest: &str,
    used: &BTreeSet<&str>,
    of_earlier_files: usize,
) -> Current {
    let (whole, before_comment) = names_in(rest);
    let Some(name) = [Some(whole), before_comment]
        .into_iter()
        .flatten()
        .find(|name| used.contains(name))
    else {
        return Current::Unused;
    };
    let place = match scan.place_of.get(name) {
        Some(place) if *place < of_earlier_files => return Current::Repeated,
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
    Current::Used(place)
}

/// `Kd r g b`, perhaps with an alpha after it, or `Kd r` for a grey.
fn diffuse(rest: &str) -> Option<[f64; 3]> {
    let values: Option<Vec<f64>> = words(rest).take(3).map(number).collect();
    match values?[..] {
        [grey] => Some([grey; 3]),
        [r, g, b] => Some([r, g, b]),
        _ => None,
    }
}

/// What a statement would change, if anything: `d 1` and `Ks 0 0 0` would not. `keyword` is in lower case.
fn look_of(keyword: &str, rest: &str) -> Option<Look> {
    let values: Vec<f64> = words(rest).filter_map(number).collect();
    let is_any = |neutral: f64| values.iter().any(|value| *value != neutral);
    match keyword {
        "d" if is_any(1.0) => Some(Look::Transparency),
        "tr" if is_any(0.0) => Some(Look::Transparency),
        "tf" if is_any(1.0) || values.is_empty() => Some(Look::Transparency),
        // Illumination models of the MTL format: 0 … 2 reflect no surroundings; 4, 6, 7 and 9 let light through.
        "illum" => match values.first().map(|model| *model as i64) {
            Some(4 | 6 | 7 | 9) => Some(Look::Transparency),
            Some(0..=2) => None,
            _ => Some(Look::Gloss),
        },
        "ks" | "pm" | "ps" | "pc" if is_any(0.0) => Some(Look::Gloss),
        "ke" if is_any(0.0) => Some(Look::Emission),
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
            let statements = statements.join(", ");
            materials.push(format!("`{}` ({statements})", shorten(&material.name)));
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
                "Material `{}` has Kd {} {} {}, outside 0 … 1; {} {} {} is used.",
                shorten(name),
                diffuse[0],
                diffuse[1],
                diffuse[2],
                albedo[0],
                albedo[1],
                albedo[2]
            ),
        ));
    }
    Material {
        name: name.to_owned(),
        albedo,
    }
}
