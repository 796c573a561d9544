//! Meshes on the GPU: hierarchies and triangles of all meshes of a scene, one behind the other in one buffer. The buffer is kept for the
//! next scene with the same meshes.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;

use crate::facts::SceneFacts;
use crate::facts::placement::ObjectFacts;
use crate::gpu::GpuContext;
use crate::mesh::{HierarchyNode, Mesh, hierarchy};
use crate::stages::gpu_values::vec4;
use crate::stages::objects::Instance;

/// Where a mesh lies in the buffer, in 16-byte units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) first_node: u32,
    pub(super) nodes: u32,
    pub(super) first_triangle: u32,
    pub(super) triangles: u32,
}

/// Largest total of bytes that are kept for scenes with other meshes than those of the current frame.
const KEPT_BYTES: u64 = 256 << 20;

/// Geometry of the scenes that were rendered last.
#[derive(Debug, Default)]
pub(super) struct GeometryCache {
    /// One entry for each set of meshes; the most recently used comes last.
    kept: Vec<Geometry>,
    /// Whether the last entry is the geometry of the current frame.
    in_use: bool,
    uploaded_bytes: u64,
}

impl GeometryCache {
    /// Starts a frame that needs the geometry of `meshes`, if any. Keeps the most recently used other geometry within `free_budget_bytes`
    /// and drops the rest. Returns the bytes of other geometry that stay, and whether any was dropped.
    pub(super) fn begin_frame(
        &mut self,
        meshes: Option<&[Arc<Mesh>]>,
        free_budget_bytes: u64,
    ) -> (u64, bool) {
        self.in_use = false;
        let own = meshes.and_then(|meshes| self.kept.iter().position(|kept| kept.is_of(meshes)));
        let own = own.map(|index| self.kept.remove(index));
        let before = self.kept.len();
        let budget_bytes = free_budget_bytes.min(KEPT_BYTES);
        while self.bytes() > budget_bytes {
            self.kept.remove(0);
        }
        let made_room = self.kept.len() < before;
        let others_bytes = self.bytes();
        self.kept.extend(own);
        (others_bytes, made_room)
    }

    /// The geometry of `meshes` for the current frame; uploaded if it is not cached.
    pub(super) fn hold(&mut self, gpu: &GpuContext, meshes: &[Arc<Mesh>]) -> &Geometry {
        let kept = self.kept.iter().position(|kept| kept.is_of(meshes));
        let geometry = match kept {
            Some(index) => self.kept.remove(index),
            None => {
                let uploaded = Geometry::upload(gpu, meshes);
                self.uploaded_bytes += uploaded.bytes();
                uploaded
            }
        };
        self.kept.push(geometry);
        self.in_use = true;
        &self.kept[self.kept.len() - 1]
    }

    /// The geometry of the current frame, if it has any.
    pub(super) fn in_use(&self) -> Option<&Geometry> {
        self.kept.last().filter(|_| self.in_use)
    }

    /// Drops all geometry that contains this mesh.
    pub(super) fn forget_mesh(&mut self, id: &str) {
        self.in_use = false;
        self.kept.retain(|kept| !kept.places.contains_key(id));
    }

    /// Drops all.
    pub(super) fn clear(&mut self) {
        self.in_use = false;
        self.kept.clear();
    }

    /// Size of all that is kept.
    pub(super) fn bytes(&self) -> u64 {
        self.kept.iter().map(Geometry::bytes).sum()
    }

    /// Bytes that were uploaded since the start.
    pub(super) fn uploaded_bytes(&self) -> u64 {
        self.uploaded_bytes
    }
}

/// The meshes of one scene on the GPU.
#[derive(Debug)]
pub(super) struct Geometry {
    pub(super) buffer: wgpu::Buffer,
    places: BTreeMap<String, Place>,
}

impl Geometry {
    /// Uploads the distinct meshes, sorted by id.
    fn upload(gpu: &GpuContext, meshes: &[Arc<Mesh>]) -> Self {
        let distinct: BTreeMap<&str, &Mesh> =
            meshes.iter().map(|m| (m.id.as_str(), m.as_ref())).collect();
        let mut words: Vec<[u32; 4]> = Vec::new();
        let mut places = BTreeMap::new();
        for (id, mesh) in distinct {
            let first_node = words.len() as u32;
            words.extend(mesh.hierarchy.iter().flat_map(node_words));
            let first_triangle = words.len() as u32;
            for triangle in &mesh.triangles {
                for (p, n) in triangle.positions_m.iter().zip(triangle.normals) {
                    words.push([p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), pack_normal(n)]);
                }
                let albedo = mesh.materials[triangle.material as usize]
                    .albedo
                    .map(f32::to_bits);
                words.push([albedo[0], albedo[1], albedo[2], 0]);
            }
            let place = Place {
                first_node,
                nodes: mesh.hierarchy.len() as u32,
                first_triangle,
                triangles: mesh.triangles.len() as u32,
            };
            places.insert(id.to_owned(), place);
        }
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("geometry"),
            size: 16 * words.len().max(1) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue
            .write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
        Self { buffer, places }
    }

    /// Whether it contains exactly these meshes.
    fn is_of(&self, meshes: &[Arc<Mesh>]) -> bool {
        meshes.iter().all(|m| self.places.contains_key(&m.id))
            && self
                .places
                .keys()
                .all(|id| meshes.iter().any(|m| &m.id == id))
    }

    /// Where a mesh lies.
    pub(super) fn place(&self, id: &str) -> Place {
        self.places[id]
    }

    /// Size on the GPU.
    pub(super) fn bytes(&self) -> u64 {
        self.buffer.size()
    }
}

/// The scene's objects as instances; without the geometry of their meshes, for passes that only need to know how objects are placed.
pub(super) fn instances(geometry: Option<&Geometry>, facts: &SceneFacts) -> Vec<Instance> {
    let hierarchy = hierarchy_over(&facts.receivers.objects);
    facts
        .receivers
        .objects
        .iter()
        .enumerate()
        .map(|(index, object)| {
            let inverse = object.local_from_mesh.inverse();
            let place = geometry.map_or_else(Place::default, |all| all.place(&object.mesh));
            let row = |i: usize| vec4(inverse.matrix3.row(i), inverse.translation[i]);
            let mut nodes = [[0; 4]; 4];
            for (words, node) in nodes
                .chunks_exact_mut(2)
                .zip(hierarchy.iter().skip(2 * index))
            {
                words.copy_from_slice(&node_words(node));
            }
            Instance {
                mesh_x: row(0),
                mesh_y: row(1),
                mesh_z: row(2),
                albedo: object.albedo.map_or([0.0; 4], |a| vec4(a, 1.0)),
                nodes,
                first_node: place.first_node,
                node_count: place.nodes,
                first_triangle: place.first_triangle,
                pad: 0,
            }
        })
        .collect()
}

/// A hierarchy over the objects' bounds.
fn hierarchy_over(objects: &[ObjectFacts]) -> Vec<HierarchyNode> {
    let boxes: Vec<[Vec3; 2]> = objects
        .iter()
        .map(|object| {
            // Boxes grow by a rounding error of f32, so that rays do not miss a flat mesh.
            let grow =
                glam::DVec3::splat(1e-6 * object.min.abs().max(object.max.abs()).max_element());
            [(object.min - grow).as_vec3(), (object.max + grow).as_vec3()]
        })
        .collect();
    hierarchy::build_over_boxes(&boxes)
}

/// A node as the shaders read it.
fn node_words(node: &HierarchyNode) -> [[u32; 4]; 2] {
    let corner = |c: [f32; 3], link| [c[0].to_bits(), c[1].to_bits(), c[2].to_bits(), link];
    [
        corner(node.min_m, node.entry),
        corner(node.max_m, node.exit),
    ]
}

/// Octahedral normal in two signed 16-bit halves; the shaders' `unpack_normal` undoes it.
fn pack_normal(n: Vec3) -> u32 {
    let m = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let (mut x, mut y) = (m.x, m.y);
    if m.z < 0.0 {
        let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
        (x, y) = ((1.0 - m.y.abs()) * sign(m.x), (1.0 - m.x.abs()) * sign(m.y));
    }
    let half = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    half(x) | (half(y) << 16)
}
