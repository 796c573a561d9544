//! Reads OBJ and MTL bytes into a [`Mesh`].
//!
//! Only the given bytes are read: the path in a `mtllib` line is never opened.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};

use super::mtl::FileMaterial;
use super::repair::{self, RawTriangle};
use super::scan::Scan;
use super::text::{names_in, shorten};
use super::{Material, Mesh, MeshError, Triangle, hierarchy, mtl, scan};
use crate::config::Limits;
use crate::stats::Warning;

/// Largest number of triangles: their indices share a word with [`hierarchy::LEAF`], and there are two nodes for each triangle.
const MAX_TRIANGLES: usize = 1 << 30;

/// The id of a mesh: `blake3:` and the hash of the OBJ's bytes, as `b3sum` prints it. With MTL files, the hash has a derivation key
/// of its own and covers all texts, each after its length, so that no two uploads share an id.
pub fn id(obj: &[u8], mtls: &[&[u8]]) -> String {
    let hash = if mtls.is_empty() {
        blake3::hash(obj)
    } else {
        let mut hasher = blake3::Hasher::new_derive_key("caustica mesh 2025: OBJ and MTL");
        for bytes in [obj].iter().chain(mtls) {
            hasher.update(&(bytes.len() as u64).to_le_bytes());
            hasher.update(bytes);
        }
        hasher.finalize()
    };
    format!("blake3:{}", hash.to_hex())
}

/// What stands after each `mtllib` of an OBJ: the name of a material library, or several names. Text of any encoding.
pub fn material_libraries(obj: &[u8]) -> Vec<String> {
    scan::libraries(obj)
}

/// Reads a mesh, in metres, with the materials of any number of MTL files. Polygons become triangles. Degenerate and duplicate
/// triangles are left out; holes and edges with more than two faces are kept. `warnings` states both, and everything in the files that
/// is not used.
///
/// Faces without material, or whose material has no `Kd`, get a reflectance of 0.8.
///
/// # Errors
/// See [`MeshError`]; only what the geometry cannot do without is an error. A mesh with more than `limits.max_triangles` triangles is
/// refused before the rest of the file is read.
pub fn read(obj: &[u8], mtls: &[&[u8]], limits: &Limits) -> Result<Mesh, MeshError> {
    let mut scan = scan::scan(obj, limits.max_triangles.min(MAX_TRIANGLES))?;
    let mtl_scan = mtl::scan(mtls, &names_to_find(&scan.used_materials));
    let text = scan.rewritten(|name| place_of(&mtl_scan, name))?;
    let mut warnings = std::mem::take(&mut scan.warnings);
    material_warnings(
        &scan,
        (!mtls.is_empty()).then_some(&mtl_scan),
        &mut warnings,
    );
    drop(scan);

    let mut models = load(&text, mtl_scan.materials.len())?;
    drop(text);
    // The library adds a last model without faces if the last line is a `usemtl`.
    models.retain(|model| !model.mesh.indices.is_empty());
    let (materials, material_of) = used_materials(&models, &mtl_scan.materials, &mut warnings);
    let raw: Vec<RawTriangle> = models
        .iter()
        .flat_map(|model| triangles(&model.mesh, material_of[&model.mesh.material_id]))
        .collect();
    drop(models);

    let repaired = repair::repair(&raw)?;
    warnings.extend(repaired.warnings);
    warnings.sort_by(|a, b| (&a.code, &a.message).cmp(&(&b.code, &b.message)));
    let (min_m, max_m) = bounds(&repaired.triangles);
    Ok(Mesh {
        id: id(obj, mtls),
        origin_m: repaired.origin_m,
        min_m,
        max_m,
        hierarchy: hierarchy::build(&repaired.triangles),
        triangles: repaired.triangles,
        materials,
        warnings,
    })
}

/// The names of the materials that an OBJ uses, also without what may be a comment after them.
fn names_to_find(used: &[String]) -> BTreeSet<&str> {
    used.iter()
        .flat_map(|name| {
            let (whole, before_comment) = names_in(name);
            [Some(whole), before_comment].into_iter().flatten()
        })
        .collect()
}

/// The place of a material that an OBJ uses under `name`.
fn place_of(mtl: &mtl::MtlScan, name: &str) -> Option<usize> {
    let (whole, before_comment) = names_in(name);
    mtl.place_of(whole)
        .or_else(|| mtl.place_of(before_comment?))
}

/// Passes the checked text to the OBJ library, with `material_count` materials named by their numbers.
fn load(obj: &str, material_count: usize) -> Result<Vec<tobj::Model>, MeshError> {
    let unreadable = |error: tobj::LoadError| MeshError::Unreadable {
        reason: error.to_string(),
    };
    let mtl: String = (0..material_count)
        .map(|number| format!("newmtl {}\n", scan::name_of_material(number)))
        .collect();
    // The library reads materials where the text names a file.
    let mut text = std::io::Read::chain("mtllib given\n".as_bytes(), obj.as_bytes());
    let (models, materials) = tobj::load_obj_buf(&mut text, &tobj::LoadOptions::default(), |_| {
        tobj::load_mtl_buf(&mut mtl.as_bytes())
    })
    .map_err(unreadable)?;
    materials.map_err(unreadable)?;
    Ok(models)
}

/// The materials that faces use, in the order of the files, followed by the default one if it is needed; and the index of each in
/// that list.
fn used_materials(
    models: &[tobj::Model],
    file_materials: &[FileMaterial],
    warnings: &mut Vec<Warning>,
) -> (Vec<Material>, BTreeMap<Option<usize>, u32>) {
    let mut place_of: BTreeMap<Option<usize>, u32> = models
        .iter()
        .map(|model| (model.mesh.material_id, 0))
        .collect();
    let default = place_of.remove(&None);
    let mut materials = Vec::with_capacity(place_of.len() + 1);
    let mut used = Vec::with_capacity(place_of.len());
    for (index, place) in &mut place_of {
        if let Some(file) = index.and_then(|i| file_materials.get(i)) {
            *place = materials.len() as u32;
            materials.push(mtl::material(&file.name, file.diffuse, warnings));
            used.push(file);
        }
    }
    warnings.extend(mtl::look_warnings(used.into_iter()));
    if default.is_some() {
        place_of.insert(None, materials.len() as u32);
        materials.push(mtl::default_material());
    }
    (materials, place_of)
}

/// Warnings about material names that are in only one kind of file. `mtl` is `None` if there is no MTL.
fn material_warnings(scan: &Scan, mtl: Option<&mtl::MtlScan>, warnings: &mut Vec<Warning>) {
    let used: BTreeSet<&String> = scan.used_materials.iter().collect();
    let Some(mtl) = mtl else {
        if let (Some(library), false) = (scan.libraries.first(), used.is_empty()) {
            warnings.push(Warning::new(
                "mesh_missing_material",
                format!(
                    "The OBJ names the material library `{}`, but there is no MTL; its faces get a reflectance of {}.",
                    shorten(library),
                    mtl::DEFAULT_ALBEDO
                ),
            ));
        } else if !used.is_empty() {
            warnings.push(missing(used.into_iter(), "but there is no MTL"));
        }
        return;
    };
    warnings.extend(mtl.warnings.iter().cloned());
    let (known, absent): (Vec<&String>, Vec<&String>) = used
        .into_iter()
        .partition(|name| place_of(mtl, name).is_some());
    if known.is_empty() {
        warnings.push(Warning::new(
            "mesh_mtl_ignored",
            format!(
                "The MTL has no effect: none of its {} materials is named by a `usemtl` line of the OBJ.",
                mtl.count
            ),
        ));
    }
    if !absent.is_empty() {
        warnings.push(missing(absent.into_iter(), "which the MTL does not have"));
    }
}

fn missing<'a>(names: impl Iterator<Item = &'a String>, why: &str) -> Warning {
    let names: Vec<String> = names.map(|name| format!("`{}`", shorten(name))).collect();
    let shown = names[..names.len().min(5)].join(", ");
    Warning::new(
        "mesh_missing_material",
        format!(
            "The OBJ uses {} materials, {why}: {shown}{}; their faces get a reflectance of {}.",
            names.len(),
            if names.len() > 5 { ", …" } else { "" },
            mtl::DEFAULT_ALBEDO
        ),
    )
}

/// The triangles of one model of the library, in file coordinates.
fn triangles(mesh: &tobj::Mesh, material: u32) -> impl Iterator<Item = RawTriangle> + '_ {
    let pick = |values: &[_], index: u32| vector(&values[3 * index as usize..][..3]);
    mesh.indices
        .chunks_exact(3)
        .zip(mesh.normal_indices.chunks_exact(3))
        .map(move |(corners, normals)| RawTriangle {
            positions_m: [0, 1, 2].map(|k| pick(&mesh.positions, corners[k])),
            normals: [0, 1, 2].map(|k| pick(&mesh.normals, normals[k])),
            material,
        })
}

/// Three of the library's numbers, whether it was built with f32 or f64.
fn vector<T: Copy + Into<f64>>(values: &[T]) -> DVec3 {
    DVec3::new(values[0].into(), values[1].into(), values[2].into())
}

fn bounds(triangles: &[Triangle]) -> (Vec3, Vec3) {
    triangles
        .iter()
        .flat_map(|t| t.positions_m)
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| {
            (min.min(p), max.max(p))
        })
}
