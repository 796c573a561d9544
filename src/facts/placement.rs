//! Objects in local coordinates, and the boxes their level maps are drawn in.

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, DVec4};

use crate::mesh::Mesh;
use crate::scene::ResolvedScene;

/// An object in local coordinates.
#[derive(Clone, Debug)]
pub struct ObjectFacts {
    /// From the mesh's own coordinates (relative to its origin) to local ones.
    pub local_from_mesh: DAffine3,
    /// Lower corner of the bounds.
    pub min: DVec3,
    /// Upper corner of the bounds.
    pub max: DVec3,
    /// Albedo instead of the materials'.
    pub albedo: Option<[f64; 3]>,
    /// Id of the mesh.
    pub mesh: String,
    /// Whether light under water can hit it.
    pub wet: bool,
    /// Texels along each side of its level maps and irradiance maps.
    pub map_texels: u32,
    /// Triangles of the mesh.
    pub triangles: u32,
}

impl ObjectFacts {
    /// Centre of the part of its bounds under the water at rest; of their lower side where no part is under water.
    pub fn wet_middle(&self) -> DVec3 {
        let top_m = self.max.y.min(0.0).max(self.min.y);
        let mut middle = (self.min + self.max) * 0.5;
        middle.y = 0.5 * (self.min.y + top_m);
        middle
    }
}

/// Projection of an object's bounding box along an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// Its least width, m.
    pub(super) width_m: f64,
    /// Its area, m².
    pub(super) area_m2: f64,
    /// Area of its largest face, m².
    pub(super) largest_m2: f64,
}

impl ObjectFacts {
    /// Projection of the mesh's bounding box, rotated with the object, along the unit vector `axis`.
    pub(super) fn across(&self, mesh: &Mesh, axis: DVec3) -> Across {
        let size = (mesh.max_m - mesh.min_m).as_dvec3();
        let matrix = self.local_from_mesh.matrix3;
        let edges = [
            matrix.x_axis * size.x,
            matrix.y_axis * size.y,
            matrix.z_axis * size.z,
        ];
        let (u, v) = axis.any_orthonormal_pair();
        let width_along = |axis: DVec3| edges.iter().map(|edge| edge.dot(axis).abs()).sum::<f64>();
        // The width, a sum of |cosines|, is least perpendicular to the projection of one of the edges.
        let width_m = edges
            .iter()
            .map(|edge| DVec2::new(edge.dot(u), edge.dot(v)))
            .filter_map(|projection| projection.perp().try_normalize())
            .map(|across| width_along(u * across.x + v * across.y))
            .fold(f64::INFINITY, f64::min);
        let [a, b, c] = edges;
        let faces = [a.cross(b), b.cross(c), c.cross(a)];
        Across {
            width_m: if width_m.is_finite() { width_m } else { 0.0 },
            area_m2: faces.iter().map(|face| face.dot(axis).abs()).sum(),
            largest_m2: faces.iter().map(|face| face.length()).fold(0.0, f64::max),
        }
    }
}

impl ResolvedScene {
    /// The objects around the local origin `origin_m`, under waves of at most `max_height_m`.
    pub fn placed_objects(&self, origin_m: DVec3, max_height_m: f64) -> Vec<ObjectFacts> {
        self.scene
            .objects
            .iter()
            .zip(&self.meshes)
            .map(|(object, mesh)| {
                let [x, y, z, w] = object.rotation;
                let linear = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize())
                    * DMat3::from_diagonal(DVec3::from(object.scale.per_axis()));
                let translation =
                    linear * mesh.origin_m + DVec3::from(object.translation_m) - origin_m;
                let local_from_mesh = DAffine3::from_mat3_translation(linear, translation);
                let (min, max) = bounds(&local_from_mesh, mesh);
                ObjectFacts {
                    local_from_mesh,
                    min,
                    max,
                    albedo: object.albedo,
                    mesh: mesh.id.clone(),
                    wet: min.y < max_height_m,
                    map_texels: self.scene.quality.level_map_texels,
                    triangles: u32::try_from(mesh.triangles.len()).unwrap_or(u32::MAX),
                }
            })
            .collect()
    }
}

/// The corners of a box.
pub(super) fn corners(min: DVec3, max: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        DVec3::new(
            if i & 1 == 0 { min.x } else { max.x },
            if i & 2 == 0 { min.y } else { max.y },
            if i & 4 == 0 { min.z } else { max.z },
        )
    })
}

fn bounds(local_from_mesh: &DAffine3, mesh: &Mesh) -> (DVec3, DVec3) {
    let mut min = DVec3::INFINITY;
    let mut max = DVec3::NEG_INFINITY;
    for corner in corners(mesh.min_m.as_dvec3(), mesh.max_m.as_dvec3()) {
        let p = local_from_mesh.transform_point3(corner);
        min = min.min(p);
        max = max.max(p);
    }
    (min, max)
}

/// Cache key of a level map. A level map depends on the mesh and the light's direction in mesh space, but not on the waves.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LevelMapKey {
    /// Id of the mesh.
    pub mesh: String,
    /// Unit direction in mesh space, in units of 2⁻²⁰.
    pub direction: [i32; 3],
    /// Texels along each side.
    pub texels: u32,
    /// Layers, nearest first.
    pub layers: u32,
}

impl LevelMapKey {
    /// Bytes of the map in the arena: a pyramid of (front, back) pairs and one packed normal per texel, then for each further layer
    /// a depth and a packed normal per texel.
    pub fn bytes(&self) -> u64 {
        let texels = u64::from(self.texels) * u64::from(self.texels);
        self.pyramid_bytes() + 4 * texels * (1 + 2 * u64::from(self.layers - 1))
    }

    /// Bytes of the pyramid; the first layer's normals lie behind it.
    pub fn pyramid_bytes(&self) -> u64 {
        let mut words = 0;
        let mut side = u64::from(self.texels);
        while side > 0 {
            words += 2 * side * side;
            side /= 2;
        }
        4 * words
    }

    /// Words from the end of the pyramid to the packed normals of a layer; its depths lie texels² words before them.
    pub fn normals_after(&self, layer: u32) -> u32 {
        2 * layer * self.texels * self.texels
    }

    /// Levels of the pyramid, down to one texel.
    pub fn levels(&self) -> u32 {
        self.texels.ilog2() + 1
    }
}

/// The box of a level map, aligned to the light in mesh space.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelBox {
    /// Cache key of the map.
    pub key: LevelMapKey,
    /// Rows that map mesh coordinates to (u, v) in texels and s in mesh units along the light.
    pub map_from_mesh: [DVec4; 3],
    /// Range of s.
    pub s_range: [f64; 2],
    /// Rows that map local coordinates to (u, v, s).
    pub map_from_local: [DVec4; 3],
    /// Unit direction of the axis in local space.
    pub axis: DVec3,
    /// 1 / (area of a texel projected along the axis, m²).
    pub density_per_flux: f64,
    /// Units of s per metre along the axis.
    pub s_per_m: f64,
}

impl LevelBox {
    /// The box of `mesh`, placed as `object`, for light along the local unit direction `flat` (under flat water).
    pub fn new(object: &ObjectFacts, mesh: &Mesh, flat: DVec3, layers: u32) -> Self {
        let texels = object.map_texels;
        let mesh_from_local = object.local_from_mesh.inverse();
        let in_mesh = (mesh_from_local.matrix3 * flat).normalize();
        // Rounded, so that equal directions give equal keys and a rebuilt map is identical to the bit.
        let steps = f64::from(1_u32 << 20);
        let direction = in_mesh.to_array().map(|c| (c * steps).round() as i32);
        let along = (DVec3::from_array(direction.map(f64::from)) / steps).normalize();
        let (across_u, across_v) = along.any_orthonormal_pair();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in corners(mesh.min_m.as_dvec3(), mesh.max_m.as_dvec3()) {
            let p = DVec3::new(
                across_u.dot(corner),
                across_v.dot(corner),
                along.dot(corner),
            );
            low = low.min(p);
            high = high.max(p);
        }
        // Two texels of rim, so that silhouettes and bilinear look-ups stay inside.
        let n = f64::from(texels);
        let side = (high - low)
            .truncate()
            .max_element()
            .max(1e-9 * high.abs().max_element().max(1e-6))
            * n
            / (n - 4.0);
        let middle = (low + high) * 0.5;
        let per_unit = n / side;
        let s_rim = 1e-3 * (high.z - low.z) + 1e-4 * side;
        let row =
            |across: DVec3, centre: f64| (across * per_unit).extend(0.5 * n - centre * per_unit);
        let map_from_mesh = [
            row(across_u, middle.x),
            row(across_v, middle.y),
            along.extend(0.0),
        ];
        let map_from_local = map_from_mesh.map(|r| {
            let linear = mesh_from_local.matrix3.transpose() * r.truncate();
            linear.extend(r.w + r.truncate().dot(mesh_from_local.translation))
        });
        let axis = (object.local_from_mesh.matrix3 * along).normalize();
        let texel_u = object.local_from_mesh.matrix3 * (across_u / per_unit);
        let texel_v = object.local_from_mesh.matrix3 * (across_v / per_unit);
        Self {
            key: LevelMapKey {
                mesh: object.mesh.clone(),
                direction,
                texels,
                layers,
            },
            map_from_mesh,
            s_range: [low.z - s_rim, high.z + s_rim],
            map_from_local,
            axis,
            density_per_flux: 1.0 / texel_u.cross(texel_v).dot(axis).abs(),
            s_per_m: map_from_local[2].truncate().dot(axis),
        }
    }
}
