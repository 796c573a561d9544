// Texel points — positions and normals of the texels of the requested map. One invocation per texel of a band.
#import "shared/points.wgsl"
#import "shared/receivers.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"

struct TexelPoints {
    receiver: u32,   // in `all_receivers`
    object: u32,     // of that receiver; unused for the floor
    is_object: u32,
    layer: u32,      // of the object's level map
    width: u32,
    first_row: u32,  // of this band
    row_count: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> texel_points: TexelPoints;
@group(0) @binding(3) var<storage, read> all_receivers: array<Receiver>;
@group(0) @binding(16) var<storage, read_write> points: array<Point>;

// Local position of a point in map space: the inverse of to_map().
fn from_map(r: Receiver, m: vec3f) -> vec3f {
    let rhs = m - vec3f(r.u_row.w, r.v_row.w, r.s_row.w);
    let u = r.u_row.xyz;
    let v = r.v_row.xyz;
    let s = r.s_row.xyz;
    let determinant = dot(u, cross(v, s));
    return (cross(v, s) * rhs.x + cross(s, u) * rhs.y + cross(u, v) * rhs.z) / determinant;
}

@compute @workgroup_size(8, 8)
fn texel_points_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= texel_points.width || id.y >= texel_points.row_count { return; }
    let texel = vec2u(id.x, id.y + texel_points.first_row);
    let r = all_receivers[texel_points.receiver];
    let footprint_m = inverseSqrt(r.density_per_flux);
    var point = Point(vec3f(0.0), -1.0, vec3f(0.0), footprint_m);
    let uv = vec2f(texel) + 0.5;
    if texel_points.is_object == 0u {
        point.position_m = from_map(r, vec3f(uv, 0.0));
        point.receiver = 0.0;
        point.normal = vec3f(0.0, 1.0, 0.0);
    } else {
        let depth = layer_depth(r, texel_points.layer, vec2i(texel));
        if depth < EMPTY_DEPTH {
            let packed = level_maps[layer_word(r, texel_points.layer, vec2i(texel))];
            point.position_m = from_map(r, vec3f(uv, depth));
            point.receiver = 1.0 + f32(texel_points.object);
            point.normal = normalize(turned_normal(texel_points.object, unpack_normal(packed)));
        }
    }
    points[id.y * texel_points.width + id.x] = point;
}
