//! Finds the first triangle on a ray.

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use glam::{DQuat, DVec2, DVec3};

use super::ReferenceError;
use super::window::Target;
use crate::scene::ResolvedScene;

/// A triangle in local coordinates, m.
#[derive(Clone, Copy, Debug)]
struct WorldTriangle {
    corner_m: DVec3,
    edge_1_m: DVec3,
    edge_2_m: DVec3,
    /// Shading normals at the corners, of any length.
    normals: [DVec3; 3],
    /// Diffuse reflectance.
    albedo: [f64; 3],
    object: usize,
    node: usize,
}

impl Bounded<f64, 3> for WorldTriangle {
    fn aabb(&self) -> Aabb<f64, 3> {
        let (a, b, c) = (
            self.corner_m,
            self.corner_m + self.edge_1_m,
            self.corner_m + self.edge_2_m,
        );
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        Aabb::with_bounds(min.to_array().into(), max.to_array().into())
    }
}

impl BHShape<f64, 3> for WorldTriangle {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// What blocks a ray before the floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Fraction of the distance to the floor, 0 … 1.
    pub(super) fraction: f64,
    /// Index into the scene's objects.
    pub(super) object: usize,
}

/// The surface that a ray hits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Distance to it, m.
    pub(super) distance_m: f64,
    /// Index into the scene's objects.
    pub(super) object: usize,
    /// Unit shading normal on the side of the ray.
    pub(super) normal: DVec3,
    /// Diffuse reflectance.
    pub(super) albedo: [f64; 3],
}

/// All triangles of a scene.
pub(super) struct Occluders {
    triangles: Vec<WorldTriangle>,
    tree: Bvh<f64, 3>,
    /// Bounds of each object.
    pub(super) bounds: Vec<Target>,
    all: Target,
}

impl Occluders {
    /// Places the meshes; local coordinates start at `origin_m` (x, z) and at the water at rest.
    pub(super) fn of(resolved: &ResolvedScene, origin_m: DVec2) -> Result<Self, ReferenceError> {
        let scene = &resolved.scene;
        if scene.objects.len() != resolved.meshes.len() {
            return Err(ReferenceError::Meshes {
                objects: scene.objects.len(),
                meshes: resolved.meshes.len(),
            });
        }
        let local_m = DVec3::new(origin_m.x, scene.water.level_m, origin_m.y);
        let mut triangles = Vec::new();
        let mut bounds = Vec::new();
        let nothing = Target {
            min_m: DVec3::INFINITY,
            max_m: DVec3::NEG_INFINITY,
        };
        for (index, (object, mesh)) in scene.objects.iter().zip(&resolved.meshes).enumerate() {
            let scale = DVec3::from(object.scale.per_axis());
            let rotation = DQuat::from_array(object.rotation).normalize();
            let translation_m = DVec3::from(object.translation_m) - local_m;
            let mut bound = nothing;
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.positions_m.map(|p| {
                    let p_local =
                        translation_m + rotation * (scale * (mesh.origin_m + p.as_dvec3()));
                    bound.min_m = bound.min_m.min(p_local);
                    bound.max_m = bound.max_m.max(p_local);
                    p_local
                });
                if !(a.is_finite() && b.is_finite() && c.is_finite()) {
                    return Err(ReferenceError::Figure {
                        what: "a corner of a placed mesh",
                        value: f64::NAN,
                        accepted: "finite positions, translation, rotation and scale are accepted",
                    });
                }
                triangles.push(WorldTriangle {
                    corner_m: a,
                    edge_1_m: b - a,
                    edge_2_m: c - a,
                    // Normals go with the transposed inverse of the placement.
                    normals: triangle.normals.map(|n| rotation * (n.as_dvec3() / scale)),
                    albedo: object.albedo.unwrap_or_else(|| {
                        mesh.materials[triangle.material as usize]
                            .albedo
                            .map(f64::from)
                    }),
                    object: index,
                    node: 0,
                });
            }
            bounds.push(bound);
        }
        let all = bounds.iter().fold(nothing, |all, b| Target {
            min_m: all.min_m.min(b.min_m),
            max_m: all.max_m.max(b.max_m),
        });
        let tree = Bvh::build(&mut triangles);
        Ok(Self {
            triangles,
            tree,
            bounds,
            all,
        })
    }

    /// Whether there are no triangles.
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The first triangle between `from_m` and `to_m`, either side of it. `stack` is scratch space.
    pub(super) fn first_hit(
        &self,
        from_m: DVec3,
        to_m: DVec3,
        stack: &mut Vec<usize>,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk(
            from_m,
            to_m - from_m,
            1.0,
            stack,
            |triangle, [t, ..], until| {
                if t < until {
                    best = Some(Hit {
                        fraction: t,
                        object: triangle.object,
                    });
                    return t;
                }
                until
            },
        );
        best
    }

    /// The first triangle that the ray from `from_m` along unit `direction` meets before `until_m`, with its shading normal
    /// on the side of the ray.
    pub(super) fn first_seen(
        &self,
        from_m: DVec3,
        direction: DVec3,
        until_m: f64,
        stack: &mut Vec<usize>,
    ) -> Option<Seen> {
        self.first_of(None, from_m, direction, until_m, stack)
    }

    /// Like the above, for one object and without a limit of distance.
    pub(super) fn first_seen_of(
        &self,
        object: usize,
        from_m: DVec3,
        direction: DVec3,
        stack: &mut Vec<usize>,
    ) -> Option<Seen> {
        self.first_of(Some(object), from_m, direction, f64::MAX, stack)
    }

    fn first_of(
        &self,
        only: Option<usize>,
        from_m: DVec3,
        direction: DVec3,
        until_m: f64,
        stack: &mut Vec<usize>,
    ) -> Option<Seen> {
        let mut best: Option<Seen> = None;
        self.walk(
            from_m,
            direction,
            until_m,
            stack,
            |triangle, [t, u, v], until| {
                if t < until && only.is_none_or(|only| only == triangle.object) {
                    best = Some(Seen {
                        distance_m: t,
                        object: triangle.object,
                        normal: triangle.normal_towards(direction, u, v),
                        albedo: triangle.albedo,
                    });
                    return t;
                }
                until
            },
        );
        best
    }

    /// Whether a triangle is between `from_m` and `to_m`. Triangles of object `own` count only up to the fraction `own_until` of
    /// the distance.
    pub(super) fn blocks(
        &self,
        from_m: DVec3,
        to_m: DVec3,
        own: Option<usize>,
        own_until: f64,
        stack: &mut Vec<usize>,
    ) -> bool {
        let mut blocked = false;
        self.walk(
            from_m,
            to_m - from_m,
            1.0,
            stack,
            |triangle, [t, ..], until| {
                if Some(triangle.object) != own || t < own_until {
                    blocked = true;
                    return -1.0; // ends the search
                }
                until
            },
        );
        blocked
    }

    /// Fills `fractions` with the fractions of the distance from `from_m` to `to_m` at which the segment crosses `object`, in order.
    pub(super) fn crossings(
        &self,
        object: usize,
        from_m: DVec3,
        to_m: DVec3,
        stack: &mut Vec<usize>,
        fractions: &mut Vec<f64>,
    ) {
        fractions.clear();
        self.walk(
            from_m,
            to_m - from_m,
            1.0,
            stack,
            |triangle, [t, ..], until| {
                if triangle.object == object {
                    fractions.push(t);
                }
                until
            },
        );
        fractions.sort_by(f64::total_cmp);
    }

    /// Whether the ray from `from_m` along unit `direction` hits `object` farther away than `beyond_m`.
    pub(super) fn meets_object(
        &self,
        object: usize,
        from_m: DVec3,
        direction: DVec3,
        beyond_m: f64,
        stack: &mut Vec<usize>,
    ) -> bool {
        let mut met = false;
        self.walk(
            from_m,
            direction,
            f64::MAX,
            stack,
            |triangle, [t, ..], until| {
                if triangle.object == object && t > beyond_m {
                    met = true;
                    return -1.0;
                }
                until
            },
        );
        met
    }

    /// The number of surfaces of `object` that the ray from a point along a unit direction crosses farther away than `apart_m`.
    /// Surfaces closer to each other than `apart_m` count as one. `distances_m` is scratch space.
    pub(super) fn surfaces_beyond(
        &self,
        object: usize,
        (from_m, direction): (DVec3, DVec3),
        apart_m: f64,
        stack: &mut Vec<usize>,
        distances_m: &mut Vec<f64>,
    ) -> usize {
        distances_m.clear();
        self.walk(
            from_m,
            direction,
            f64::MAX,
            stack,
            |triangle, [t, ..], until| {
                if triangle.object == object && t > apart_m {
                    distances_m.push(t);
                }
                until
            },
        );
        distances_m.sort_by(f64::total_cmp);
        let again = distances_m.windows(2).filter(|w| w[1] - w[0] <= apart_m);
        distances_m.len() - again.count()
    }

    /// Calls `visit` for every triangle that the line `from_m` + t `ray` crosses at 0 ≤ t ≤ `until`, in no particular order, with
    /// the (t, u, v) of the crossing and `until`; `visit` returns the new `until`.
    fn walk(
        &self,
        from_m: DVec3,
        ray: DVec3,
        mut until: f64,
        stack: &mut Vec<usize>,
        mut visit: impl FnMut(&WorldTriangle, [f64; 3], f64) -> f64,
    ) {
        let inverse = ray.recip();
        let meets = |min_m: DVec3, max_m: DVec3, until: f64| -> bool {
            // f64::min and max drop the NaN of 0 · ∞: a ray within a face's plane counts as hitting the box.
            let (t_a, t_b) = ((min_m - from_m) * inverse, (max_m - from_m) * inverse);
            let enter = (t_a.x.min(t_b.x))
                .max(t_a.y.min(t_b.y))
                .max(t_a.z.min(t_b.z));
            let leave = (t_a.x.max(t_b.x))
                .min(t_a.y.max(t_b.y))
                .min(t_a.z.max(t_b.z));
            // Slack for rounding: boxes of level triangles have no thickness.
            enter.max(0.0) <= leave.min(until) + 1e-12
        };
        if self.tree.nodes.is_empty() || !meets(self.all.min_m, self.all.max_m, until) {
            return;
        }
        stack.clear();
        stack.push(0);
        while let Some(index) = stack.pop() {
            match &self.tree.nodes[index] {
                BvhNode::Node {
                    child_l_index,
                    child_l_aabb,
                    child_r_index,
                    child_r_aabb,
                    ..
                } => {
                    for (child, aabb) in
                        [(child_l_index, child_l_aabb), (child_r_index, child_r_aabb)]
                    {
                        let min_m = DVec3::new(aabb.min[0], aabb.min[1], aabb.min[2]);
                        let max_m = DVec3::new(aabb.max[0], aabb.max[1], aabb.max[2]);
                        if meets(min_m, max_m, until) {
                            stack.push(*child);
                        }
                    }
                }
                BvhNode::Leaf { shape_index, .. } => {
                    let triangle = &self.triangles[*shape_index];
                    if let Some(met) = triangle.crossing(from_m, ray)
                        && (0.0..=until).contains(&met[0])
                    {
                        until = visit(triangle, met, until);
                        if until < 0.0 {
                            return;
                        }
                    }
                }
            }
        }
    }
}

impl WorldTriangle {
    /// (t, u, v) where the line `from_m + t · ray` crosses the triangle. Möller & Trumbore, Journal of Graphics Tools 2(1), 1997,
    /// without culling: water lights both sides of an open mesh.
    fn crossing(&self, from_m: DVec3, ray: DVec3) -> Option<[f64; 3]> {
        let across = ray.cross(self.edge_2_m);
        let determinant = self.edge_1_m.dot(across);
        if determinant == 0.0 {
            return None;
        }
        let to_origin = from_m - self.corner_m;
        let u = to_origin.dot(across) / determinant;
        let turned = to_origin.cross(self.edge_1_m);
        let v = ray.dot(turned) / determinant;
        if u < 0.0 || v < 0.0 || u + v > 1.0 {
            return None;
        }
        let t = self.edge_2_m.dot(turned) / determinant;
        Some([t, u, v])
    }

    /// Interpolated unit normal at (u, v), on the side that a ray along `direction` comes from. The face decides which side that is,
    /// because a shading normal can face away at silhouettes.
    fn normal_towards(&self, direction: DVec3, u: f64, v: f64) -> DVec3 {
        let [a, b, c] = self.normals;
        let shading = (a * (1.0 - u - v) + b * u + c * v).normalize();
        let face = self.edge_1_m.cross(self.edge_2_m);
        let outward = if face.dot(shading) < 0.0 { -face } else { face };
        if outward.dot(direction) > 0.0 {
            -shading
        } else {
            shading
        }
    }
}
