//! A bounding-volume hierarchy over triangles, flattened with skip pointers so that a shader walks it without a stack.

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::Triangle;

/// Marks a leaf in [`HierarchyNode::entry`]; the other bits are then the index of the triangle.
pub const LEAF: u32 = 0x8000_0000;

/// Relative margin for a few f32 roundings of 2⁻²⁴ each.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// A node in depth-first order. If the ray hits the box, the traversal continues at `entry`, otherwise at `exit`. At a leaf
/// (`entry & LEAF`) the triangle is tested, and the traversal continues at `exit`. It ends when `exit` is the number of nodes.
/// Leaves also have boxes; testing them saves time.
///
/// The first node is the root. n triangles give 2 n − 1 nodes. `entry` of an inner node is the next node. `exit` is always
/// greater than the node's own index, so every traversal ends.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct HierarchyNode {
    /// Lower corner, relative to the mesh's origin, m.
    pub min_m: [f32; 3],
    /// Next node if the box is hit, or `LEAF` | triangle index.
    pub entry: u32,
    /// Upper corner, relative to the mesh's origin, m.
    pub max_m: [f32; 3],
    /// Next node if the box is missed.
    pub exit: u32,
}

/// Where a ray hits a triangle: at origin + t · direction = (1 − u − v) A + u B + v C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance in units of the direction's length.
    pub t: f32,
    /// Index of the triangle.
    pub triangle: u32,
    /// Weight of the second corner, 0 … 1.
    pub u: f32,
    /// Weight of the third corner, 0 … 1.
    pub v: f32,
}

/// Builds the hierarchy. Boxes contain their triangles with a margin of 10⁻⁶ of the mesh's size. Empty if there are no triangles.
pub fn build(triangles: &[Triangle]) -> Vec<HierarchyNode> {
    let largest_m = triangles
        .iter()
        .flat_map(|t| t.positions_m)
        .fold(0.0, |largest: f32, p| largest.max(p.abs().max_element()));
    // The triangle test rounds corners by about 2⁻²⁴ of their distance, so a hit may lie this far outside the triangle.
    let margin_m = ROUNDING * largest_m;
    over(
        triangles
            .iter()
            .map(|t| Shape::of_triangle(t, margin_m))
            .collect(),
    )
}

/// Builds a hierarchy over boxes (lower and upper corner each). A leaf then holds the index of a box. No margin is added.
pub fn build_over_boxes(boxes: &[[Vec3; 2]]) -> Vec<HierarchyNode> {
    over(
        boxes
            .iter()
            .map(|[min, max]| Shape::new(*min, *max))
            .collect(),
    )
}

fn over(mut shapes: Vec<Shape>) -> Vec<HierarchyNode> {
    let tree: Bvh<f32, 3> = BoundingHierarchy::build_par(&mut shapes);
    let Some(root) = bounds(&shapes) else {
        return Vec::new();
    };
    // The tree is already in depth-first order. A parent node stores the boxes of its children and where they end.
    let end = tree.nodes.len() as u32;
    let mut nodes = vec![node(&root, 0, end); tree.nodes.len()];
    for (index, tree_node) in tree.nodes.iter().enumerate() {
        match *tree_node {
            BvhNode::Leaf { shape_index, .. } => nodes[index].entry = LEAF | shape_index as u32,
            BvhNode::Node {
                child_l_index,
                ref child_l_aabb,
                child_r_index,
                ref child_r_aabb,
                ..
            } => {
                nodes[index].entry = child_l_index as u32;
                nodes[child_l_index] = node(child_l_aabb, 0, child_r_index as u32);
                nodes[child_r_index] = node(child_r_aabb, 0, nodes[index].exit);
            }
        }
    }
    nodes
}

/// The nearest triangle that a ray hits at `t_min` ≤ t ≤ `t_max`, from either side; of several at the same t, the first in
/// traversal order. Computes in single precision with the same steps as the shader.
///
/// `direction` has any length from 10⁻¹⁰ to 10¹⁰; t is in units of that length.
pub fn first_hit(
    nodes: &[HierarchyNode],
    triangles: &[Triangle],
    origin: Vec3,
    direction: Vec3,
    t_min: f32,
    t_max: f32,
) -> Option<TriangleHit> {
    let ray = Ray::new(origin, direction);
    let mut best: Option<TriangleHit> = None;
    let mut farthest = t_max;
    let mut index = 0;
    while let Some(node) = nodes.get(index as usize) {
        let is_leaf = node.entry & LEAF != 0;
        if !ray.meets_box(node, t_min, farthest) {
            index = node.exit;
        } else if is_leaf {
            let triangle = node.entry & !LEAF;
            let hit = ray.hit_triangle(&triangles[triangle as usize].positions_m);
            if let Some((t, u, v)) = hit
                && t >= t_min
                && (t < farthest || (t == farthest && best.is_none()))
            {
                farthest = t;
                best = Some(TriangleHit { t, triangle, u, v });
            }
            index = node.exit;
        } else {
            index = node.entry;
        }
    }
    best
}

/// A ray, with the values that its tests share.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    origin: Vec3,
    /// direction / |direction|²: t of a point p is (p − origin) · along.
    along: Vec3,
    /// Two unit vectors that span the plane perpendicular to the ray.
    across: [Vec3; 2],
    /// 1 / direction, finite.
    inverse: Vec3,
    /// Margin added to boxes against rounding if the ray's origin is far from the mesh's.
    margin: f32,
}

impl Ray {
    /// A ray; `direction` has any length from 10⁻¹⁰ to 10¹⁰.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let length = direction.length();
        let unit = direction / length;
        let (first, second) = unit.any_orthonormal_pair();
        // Replace a component that is zero or nearly zero by a tiny one, to avoid infinities: the sign of the distance then
        // decides the slab.
        let least = 1e-18 * length;
        let finite = |d: f32| {
            1.0 / if d.abs() < least {
                least.copysign(d)
            } else {
                d
            }
        };
        Self {
            origin,
            along: unit / length,
            across: [first, second],
            inverse: Vec3::new(
                finite(direction.x),
                finite(direction.y),
                finite(direction.z),
            ),
            margin: ROUNDING * origin.abs().max_element(),
        }
    }

    /// Whether the ray passes the node's box between `t_min` and `t_max`. Conservative: never false if the ray hits something
    /// inside the box.
    pub fn meets_box(&self, node: &HierarchyNode, t_min: f32, t_max: f32) -> bool {
        let to_min = (Vec3::from_array(node.min_m) - (self.origin + self.margin)) * self.inverse;
        let to_max = (Vec3::from_array(node.max_m) - (self.origin - self.margin)) * self.inverse;
        let near = to_min.min(to_max).max_element();
        let far = to_min.max(to_max).min_element();
        near.max(t_min) <= (far + ROUNDING * far.abs()).min(t_max)
    }

    /// Where the ray's line hits a triangle, from either side: (t, u, v).
    ///
    /// Corners are projected onto the plane perpendicular to the ray (after Woop, Benthin and Wald, "Watertight Ray/Triangle
    /// Intersection", JCGT 2(1), 2013). The projection of a corner is the same for all triangles that share it, so a ray cannot
    /// slip between neighbours, however thin, and no threshold is needed. For a triangle smaller than 10⁻⁶ of its distance the
    /// result is only rounding error; call [`Ray::meets_box`] for its leaf first.
    pub fn hit_triangle(&self, corners: &[Vec3; 3]) -> Option<(f32, f32, f32)> {
        let relative = corners.map(|p| p - self.origin);
        let [a, b, c] = relative.map(|p| (p.dot(self.across[0]), p.dot(self.across[1])));
        // Twice the areas of the three parts around the ray: each is the weight of the opposite corner.
        let weight_a = c.0 * b.1 - c.1 * b.0;
        let weight_b = a.0 * c.1 - a.1 * c.0;
        let weight_c = b.0 * a.1 - b.1 * a.0;
        let outside_one_way = weight_a < 0.0 || weight_b < 0.0 || weight_c < 0.0;
        let outside_other_way = weight_a > 0.0 || weight_b > 0.0 || weight_c > 0.0;
        let whole = weight_a + weight_b + weight_c;
        if (outside_one_way && outside_other_way) || whole == 0.0 {
            return None;
        }
        let (u, v) = (weight_b / whole, weight_c / whole);
        let [t_a, t_b, t_c] = relative.map(|p| p.dot(self.along));
        let t = t_a + u * (t_b - t_a) + v * (t_c - t_a);
        Some((t, u, v))
    }
}

/// A box, in the builder's form.
#[derive(Clone, Copy, Debug)]
struct Shape {
    aabb: Aabb<f32, 3>,
    node: usize,
}

impl Shape {
    fn of_triangle(triangle: &Triangle, margin_m: f32) -> Self {
        let [a, b, c] = triangle.positions_m;
        Self::new(a.min(b).min(c) - margin_m, a.max(b).max(c) + margin_m)
    }

    fn new(min: Vec3, max: Vec3) -> Self {
        Self {
            aabb: Aabb::with_bounds(min.to_array().into(), max.to_array().into()),
            node: 0,
        }
    }
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.aabb
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

fn bounds(shapes: &[Shape]) -> Option<Aabb<f32, 3>> {
    let (first, rest) = shapes.split_first()?;
    Some(rest.iter().fold(first.aabb, |all, s| all.join(&s.aabb)))
}

fn node(aabb: &Aabb<f32, 3>, entry: u32, exit: u32) -> HierarchyNode {
    HierarchyNode {
        min_m: [aabb.min[0], aabb.min[1], aabb.min[2]],
        entry,
        max_m: [aabb.max[0], aabb.max[1], aabb.max[2]],
        exit,
    }
}
