//! Where the texels of the map on an object lie. This is part of the output's definition, so the renderer and the reference must agree;
//! the reference computes it independently.
//!
//! The map is a square seen along one axis: the direction of the light under flat water towards the middle of the part of the object
//! that lies under the water at rest. In the mesh's own space that direction is rounded to steps of 2⁻²⁰, u and v are two unit vectors
//! across it, and the square is as wide as the larger side of the mesh's bounding box seen along the axis, with two texels to
//! spare on each side. The object's placement transforms all of it, so a texel may be a parallelogram.

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, DVec4};

use super::light::Source;
use super::place::Place;
use crate::mesh::Mesh;
use crate::scene::{Object, ResolvedScene};

/// Steps per unit that the axis is rounded to.
const AXIS_STEPS: f64 = (1_u32 << 20) as f64;
/// Least width of the square as a share of the largest coordinate, for a mesh that is a line along the axis.
const LEAST_WIDTH: f64 = 1e-9;

/// The texels, in local coordinates.
pub(super) struct TexelGrid {
    /// Texels along each side.
    pub(super) side: u32,
    /// Unit direction that the map is seen along.
    pub(super) axis: DVec3,
    /// The first texel's corner, m.
    pub(super) corner_m: DVec3,
    /// From a texel to the next along u and v, m.
    pub(super) edges_m: [DVec3; 2],
    /// 1 / (area that a texel shows to the axis), 1/m².
    pub(super) per_m2: f64,
    /// Rows that take a local point (x, y, z, 1) to u and v, in texels.
    rows: [DVec4; 2],
}

impl TexelGrid {
    /// The texels of the object with this index in light from `source`; `None` for an object that no light under water can reach.
    pub(super) fn of(
        resolved: &ResolvedScene,
        index: usize,
        place: &Place,
        source: &Source,
    ) -> Option<Self> {
        let mesh = resolved.meshes.get(index)?;
        let local_from_mesh = placement(resolved.scene.objects.get(index)?, mesh, place.origin_m);
        let placed = corners(mesh).map(|corner| local_from_mesh.transform_point3(corner));
        let (min_m, max_m) = bounds(placed);
        if min_m.y >= place.surface.max_height_m() {
            return None;
        }
        let top_m = max_m.y.min(0.0).max(min_m.y);
        let middle_m = ((min_m + max_m) * 0.5).with_y(0.5 * (min_m.y + top_m));
        let flat = source.flat_direction(middle_m, place.ior)?;
        let side = resolved.scene.quality.level_map_texels;
        Some(Self::along(flat, mesh, &local_from_mesh, side))
    }

    /// For light along the local unit direction `flat`.
    fn along(flat: DVec3, mesh: &Mesh, local_from_mesh: &DAffine3, side: u32) -> Self {
        let mesh_from_local = local_from_mesh.inverse();
        // 1. The axis and the square across it, in the mesh's own space.
        let exact = (mesh_from_local.matrix3 * flat).normalize();
        // Adding 0 turns −0 into 0: the vectors across depend on the sign.
        let along = (((exact * AXIS_STEPS).round() + DVec3::ZERO) / AXIS_STEPS).normalize();
        let (u, v) = along.any_orthonormal_pair();
        let seen = |p: DVec3| DVec3::new(u.dot(p), v.dot(p), along.dot(p));
        let (low, high) = bounds(corners(mesh).map(seen));
        let n = f64::from(side);
        let least = LEAST_WIDTH * high.abs().max_element().max(1e-6);
        let width = (high - low).truncate().max_element().max(least) * n / (n - 4.0);
        let middle = (low + high) * 0.5;
        let per_unit = n / width;
        // 2. Rows that take local points to u, v and the distance along the axis.
        let row = |across: DVec3, offset: f64| {
            let local = mesh_from_local.matrix3.transpose() * across;
            local.extend(offset + across.dot(mesh_from_local.translation))
        };
        let row_u = row(u * per_unit, 0.5 * n - middle.x * per_unit);
        let row_v = row(v * per_unit, 0.5 * n - middle.y * per_unit);
        let row_s = row(along, 0.0);
        // 3. The texels' edges: columns of the inverse of the rows.
        let axis = (local_from_mesh.matrix3 * along).normalize();
        let [a, b, c] = [row_u, row_v, row_s].map(DVec4::truncate);
        let u_m = b.cross(c) / a.dot(b.cross(c));
        let v_m = c.cross(a) / b.dot(c.cross(a));
        let s_m = axis / c.dot(axis);
        let [shown_u, shown_v] = [u, v].map(|across| local_from_mesh.matrix3 * (across / per_unit));
        Self {
            side,
            axis,
            corner_m: u_m * -row_u.w + v_m * -row_v.w + s_m * -row_s.w,
            edges_m: [u_m, v_m],
            per_m2: 1.0 / shown_u.cross(shown_v).dot(axis).abs(),
            rows: [row_u, row_v],
        }
    }

    /// A local place that is seen at (u, v), m.
    pub(super) fn place_m(&self, uv: DVec2) -> DVec3 {
        self.corner_m + self.edges_m[0] * uv.x + self.edges_m[1] * uv.y
    }

    /// Index of the texel that shows a local point; `None` outside the map.
    pub(super) fn texel_at(&self, p_m: DVec3) -> Option<usize> {
        let [u, v] = self.rows.map(|row| row.dot(p_m.extend(1.0)));
        let side = f64::from(self.side);
        let inside = u.min(v) >= 0.0 && u.max(v) < side;
        inside.then(|| v as usize * self.side as usize + u as usize)
    }
}

/// From the mesh's own coordinates, relative to its origin, to local ones.
fn placement(object: &Object, mesh: &Mesh, origin_m: DVec3) -> DAffine3 {
    let rotation = DQuat::from_array(object.rotation).normalize();
    let scale = DVec3::from(object.scale.per_axis());
    let linear = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
    let translation_m = linear * mesh.origin_m + DVec3::from(object.translation_m) - origin_m;
    DAffine3::from_mat3_translation(linear, translation_m)
}

/// The corners of the mesh's bounding box, relative to its origin.
fn corners(mesh: &Mesh) -> [DVec3; 8] {
    let ends = [mesh.min_m.as_dvec3(), mesh.max_m.as_dvec3()];
    std::array::from_fn(|i| DVec3::new(ends[i & 1].x, ends[(i >> 1) & 1].y, ends[i >> 2].z))
}

/// The smallest box around some points.
fn bounds(points: [DVec3; 8]) -> (DVec3, DVec3) {
    let low = points.into_iter().fold(DVec3::INFINITY, DVec3::min);
    let high = points.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max);
    (low, high)
}
