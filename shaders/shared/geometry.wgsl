// Intersection of rays with meshes: a hierarchy over the instances, and for each instance the hierarchy over its mesh's triangles. Both
// have skip pointers, so that they are traversed without a stack.

struct Instance {
    mesh_x: vec4f, // rows of mesh_from_local
    mesh_y: vec4f,
    mesh_z: vec4f,
    albedo: vec4f, // w = 1: overrides the mesh's materials
    nodes: array<vec4u, 4>, // two nodes of the hierarchy over the instances: instance i holds nodes 2 i and 2 i + 1
    first_node: u32,     // in vec4 units of `geometry`
    node_count: u32,
    first_triangle: u32, // in vec4 units of `geometry`
    pad: u32,
}

// Per mesh its nodes (2 vec4 each: corner and link), then its triangles (4 vec4 each: three corners with packed normal, albedo).
@group(0) @binding(14) var<storage, read> geometry: array<vec4u>;
@group(0) @binding(15) var<storage, read> instances: array<Instance>;

const LEAF: u32 = 0x80000000u;
const VERY_FAR_M: f32 = 1e9;

struct Seen {
    t: f32,
    receiver: i32, // −1 nothing, 0 floor, k object k − 1
    normal: vec3f,
    albedo: vec3f,
}

fn box_met(low: vec3f, high: vec3f, origin: vec3f, inverse: vec3f, t_max: f32) -> bool {
    let t0 = (low - origin) * inverse;
    let t1 = (high - origin) * inverse;
    let near = min(t0, t1);
    let far = max(t0, t1);
    let t_in = max(max(near.x, near.y), max(near.z, 0.0));
    let t_out = min(min(far.x, far.y), min(far.z, t_max));
    return t_in <= t_out * 1.0000005;
}

fn safe_inverse(d: vec3f) -> vec3f {
    return 1.0 / select(d, vec3f(1e-20), abs(d) < vec3f(1e-20));
}

// (t, u, v) of a ray and a triangle (Möller & Trumbore 1997), t < 0 where they miss.
fn triangle_met(a: vec3f, b: vec3f, c: vec3f, origin: vec3f, direction: vec3f) -> vec3f {
    let e1 = b - a;
    let e2 = c - a;
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    if determinant == 0.0 { return vec3f(-1.0); }
    let s = origin - a;
    let u = dot(s, p) / determinant;
    let q = cross(s, e1);
    let v = dot(direction, q) / determinant;
    if u < 0.0 || v < 0.0 || u + v > 1.0 { return vec3f(-1.0); }
    return vec3f(dot(e2, q) / determinant, u, v);
}

struct MeshHit {
    t: f32,
    triangle: u32, // first vec4 of the triangle
    u: f32,
    v: f32,
}

// Nearest hit with one instance between t_min and t_max; t = t_max: none. The direction keeps its local length, so t is in metres.
fn trace_instance(index: u32, origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> MeshHit {
    var best = MeshHit(t_max, 0u, 0.0, 0.0);
    let mesh_x = instances[index].mesh_x;
    let mesh_y = instances[index].mesh_y;
    let mesh_z = instances[index].mesh_z;
    let first_node = instances[index].first_node;
    let node_count = instances[index].node_count;
    let first_triangle = instances[index].first_triangle;
    let o4 = vec4f(origin, 1.0);
    let o = vec3f(dot(mesh_x, o4), dot(mesh_y, o4), dot(mesh_z, o4));
    let d = vec3f(dot(mesh_x.xyz, direction), dot(mesh_y.xyz, direction), dot(mesh_z.xyz, direction));
    let inverse = safe_inverse(d);
    var node = 0u;
    while node < node_count {
        let low = geometry[first_node + 2u * node];
        let high = geometry[first_node + 2u * node + 1u];
        if !box_met(bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz), o, inverse, best.t) {
            node = high.w;
            continue;
        }
        if (low.w & LEAF) == 0u {
            node = low.w;
            continue;
        }
        let at = first_triangle + 4u * (low.w & ~LEAF);
        let met = triangle_met(
            bitcast<vec3f>(geometry[at].xyz), bitcast<vec3f>(geometry[at + 1u].xyz), bitcast<vec3f>(geometry[at + 2u].xyz), o, d);
        if met.x > t_min && met.x < best.t { best = MeshHit(met.x, at, met.y, met.z); }
        node = high.w;
    }
    return best;
}

// Number of nodes in the hierarchy of `count` instances, where its traversal ends.
fn instance_nodes(count: u32) -> u32 {
    return select(2u * count - 1u, 0u, count == 0u);
}

// One step of the traversal: an instance that the ray may hit before t_max, or NO_INSTANCE, and the next node.
struct InstanceStep {
    index: u32,
    next: u32,
}

const NO_INSTANCE: u32 = 0xffffffffu;

fn step_instances(node: u32, origin: vec3f, inverse: vec3f, t_max: f32) -> InstanceStep {
    let at = 2u * (node & 1u);
    let low = instances[node >> 1u].nodes[at];
    let high = instances[node >> 1u].nodes[at + 1u];
    if !box_met(bitcast<vec3f>(low.xyz), bitcast<vec3f>(high.xyz), origin, inverse, t_max) { return InstanceStep(NO_INSTANCE, high.w); }
    if (low.w & LEAF) == 0u { return InstanceStep(NO_INSTANCE, low.w); }
    return InstanceStep(low.w & ~LEAF, high.w);
}

// A normal of the mesh in local space, of any length: it goes with the transposed inverse of local_from_mesh, which is the transpose of
// mesh_from_local.
fn turned_normal(instance: u32, n_mesh: vec3f) -> vec3f {
    return n_mesh.x * instances[instance].mesh_x.xyz + n_mesh.y * instances[instance].mesh_y.xyz + n_mesh.z * instances[instance].mesh_z.xyz;
}

// Nearest object between t_min and t_max.
fn trace_objects(count: u32, origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> Seen {
    var seen = Seen(t_max, -1, vec3f(0.0), vec3f(0.0));
    let inverse = safe_inverse(direction);
    let end = instance_nodes(count);
    var node = 0u;
    while node < end {
        let step = step_instances(node, origin, inverse, seen.t);
        node = step.next;
        if step.index == NO_INSTANCE { continue; }
        let i = step.index;
        let hit = trace_instance(i, origin, direction, t_min, seen.t);
        if hit.t >= seen.t { continue; }
        let w = 1.0 - hit.u - hit.v;
        let n_mesh = w * unpack_normal(geometry[hit.triangle].w) + hit.u * unpack_normal(geometry[hit.triangle + 1u].w)
            + hit.v * unpack_normal(geometry[hit.triangle + 2u].w);
        let n = turned_normal(i, n_mesh);
        let facing = normalize(n);
        // The triangle itself decides which side is seen: its shading normal may face away at silhouettes.
        let corner = bitcast<vec3f>(geometry[hit.triangle].xyz);
        let flat_mesh = cross(bitcast<vec3f>(geometry[hit.triangle + 1u].xyz) - corner, bitcast<vec3f>(geometry[hit.triangle + 2u].xyz) - corner);
        let flat = turned_normal(i, flat_mesh);
        let outward = select(flat, -flat, dot(flat, n) < 0.0);
        seen.t = hit.t;
        seen.receiver = i32(i) + 1;
        seen.normal = select(facing, -facing, dot(outward, direction) > 0.0);
        let albedo = instances[i].albedo;
        seen.albedo = select(bitcast<vec3f>(geometry[hit.triangle + 3u].xyz), albedo.xyz, albedo.w > 0.5);
    }
    return seen;
}
