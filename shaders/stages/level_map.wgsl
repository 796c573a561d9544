// Level map — the mesh's surface visible from a light through flat water. Drawn from the light: nearest (front) and farthest (back) depth,
// then for each further layer the nearest surface behind the previous one (depth peeling: Everitt 2001).
#import "shared/level_map_view.wgsl"
#import "shared/normals.wgsl"

@group(0) @binding(14) var<storage, read> geometry: array<vec4u>;
@group(0) @binding(23) var previous_depth: texture_2d<f32>;

// Least distance between successive layers, as a share of the map's depth; a nearer surface is the same one with rounding.
const SAME_SURFACE: f32 = 1e-5;

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) s: f32,
    @location(1) normal: vec3f,
}

@vertex
fn level_map_vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let at = level_map_view.first_triangle + 4u * (index / 3u) + index % 3u;
    let word = geometry[at];
    let p = vec4f(bitcast<vec3f>(word.xyz), 1.0);
    let u = dot(level_map_view.u_row, p);
    let v = dot(level_map_view.v_row, p);
    let s = dot(level_map_view.s_row, p);
    let size = f32(level_map_view.texels);
    let depth = (s - level_map_view.s_min) / (level_map_view.s_max - level_map_view.s_min);
    var out: Vertex;
    out.clip = vec4f(2.0 * u / size - 1.0, 1.0 - 2.0 * v / size, depth, 1.0);
    out.s = s;
    out.normal = unpack_normal(word.w);
    return out;
}

struct Texel {
    @location(0) s: f32,
    @location(1) normal: u32,
}

fn pack_normal(n: vec3f) -> u32 {
    let m = n / (abs(n.x) + abs(n.y) + abs(n.z));
    var f = m.xy;
    if m.z < 0.0 {
        f = (1.0 - abs(m.yx)) * vec2f(select(-1.0, 1.0, m.x >= 0.0), select(-1.0, 1.0, m.y >= 0.0));
    }
    return pack2x16snorm(f);
}

@fragment
fn level_map_fragment(in: Vertex) -> Texel {
    return Texel(in.s, pack_normal(in.normal));
}

@fragment
fn level_map_behind(in: Vertex) -> Texel {
    let previous = textureLoad(previous_depth, vec2i(in.clip.xy), 0).x;
    if in.s <= previous + SAME_SURFACE * (level_map_view.s_max - level_map_view.s_min) { discard; }
    return Texel(in.s, pack_normal(in.normal));
}
