//! Any bytes as an OBJ, and after each separator as an MTL.

use caustica::config::Limits;
use caustica::mesh::hierarchy::LEAF;
use caustica::mesh::{Mesh, obj};

/// Maximum number of triangles: large meshes find no more errors than small ones.
const MOST_TRIANGLES: usize = 4096;
/// How far the length of a normal may be from 1.
const NORMAL_TOLERANCE: f32 = 1e-5;

/// Reads `bytes`. An accepted mesh must be valid; a refusal must state its reason.
pub(crate) fn check(bytes: &[u8]) {
    let (text, mtls) = parts(bytes);
    let limits = Limits {
        max_triangles: MOST_TRIANGLES,
        ..Limits::default()
    };
    match obj::read(text, &mtls, &limits) {
        Ok(mesh) => sound(&mesh),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The files in `bytes`, which begin after two zero bytes each. (One zero byte alone is half a character of UTF-16.)
fn parts(bytes: &[u8]) -> (&[u8], Vec<&[u8]>) {
    let mut files = Vec::new();
    let mut rest = bytes;
    while let Some(end) = rest.windows(2).position(|pair| pair == [0, 0]) {
        files.push(&rest[..end]);
        rest = &rest[end + 2..];
    }
    files.push(rest);
    let obj = files.remove(0);
    (obj, files)
}

/// The properties that the renderer relies on.
fn sound(mesh: &Mesh) {
    assert!(!mesh.triangles.is_empty() && mesh.triangles.len() <= MOST_TRIANGLES);
    assert!(!mesh.materials.is_empty());
    assert!(mesh.origin_m.is_finite() && mesh.min_m.is_finite() && mesh.max_m.is_finite());
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.positions_m;
        for p in [a, b, c] {
            assert!(p.is_finite());
            assert!(
                p.cmpge(mesh.min_m).all() && p.cmple(mesh.max_m).all(),
                "{p} is out of bounds"
            );
        }
        let area = (b - a).as_dvec3().cross((c - a).as_dvec3()).length();
        assert!(area > 0.0, "a degenerate triangle was kept");
        for normal in triangle.normals {
            let off = (normal.length() - 1.0).abs();
            assert!(
                off <= NORMAL_TOLERANCE,
                "the normal {normal} is off by {off}"
            );
        }
        assert!((triangle.material as usize) < mesh.materials.len());
    }
    for material in &mesh.materials {
        assert!(
            material.albedo.iter().all(|v| (0.0..=1.0).contains(v)),
            "{material:?}"
        );
    }
    for warning in &mesh.warnings {
        assert!(!warning.code.is_empty() && !warning.message.is_empty());
    }
    every_triangle_has_its_leaf(mesh);
}

/// A traversal that hits every box ends, and visits every triangle once.
fn every_triangle_has_its_leaf(mesh: &Mesh) {
    let mut met = vec![0_u32; mesh.triangles.len()];
    let mut at = 0;
    while let Some(node) = mesh.hierarchy.get(at) {
        let next = if node.entry & LEAF == 0 {
            node.entry
        } else {
            met[(node.entry & !LEAF) as usize] += 1;
            node.exit
        };
        assert!(next as usize > at, "node {at} goes on at {next}");
        at = next as usize;
    }
    assert_eq!(at, mesh.hierarchy.len());
    assert!(met.iter().all(|count| *count == 1), "{met:?}");
}
