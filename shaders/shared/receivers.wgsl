// Receivers of light, and hits of rays on them.
//
// Receiver 0 is the floor plane. The others are objects, represented by their level maps, with one receiver per layer: object k has
// receivers 1 + k·layers … Map space of a receiver: (u, v) in texels of its irradiance map, s along the map's axis (floor: metres, s > 0 is
// below the plane; objects: units of the mesh).

const NO_RECEIVER: i32 = -1;
const FLOOR: i32 = 0;
// Offset of a map that is not requested: light that lands there is only added to the energy account.
const NOWHERE: u32 = 0xffffffffu;
const EMPTY_DEPTH: f32 = 1e30;
const MARCH_STEPS: u32 = 1024u;

struct Receiver {
    u_row: vec4f,
    v_row: vec4f,
    s_row: vec4f,
    map_width: u32,
    map_height: u32,
    map_offset: u32,        // first texel in the flux sums; NOWHERE: the map is not requested
    level_map_offset: u32,  // first word of the level map in the arena
    s_min: f32,
    s_max: f32,
    level_count: u32,       // mip levels of the level map; 0 for the floor
    density_per_flux: f32,  // 1 / (area of a texel projected along the map's axis, m²)
    axis: vec4f,            // unit direction of the map's axis in local space
    irradiance_offset: u32, // first texel in the irradiance array; NOWHERE as above
    s_per_m: f32,           // units of s per metre along the axis
    layer: u32,             // of the level map: 0 is the nearest
    planes: u32,            // reference planes of the box; 0 where light is placed by hits
    floor_min_m: vec2f,     // floor: the rectangle in local (x, z)
    floor_max_m: vec2f,
}

struct Hit {
    uv: vec2f,
    t: f32,
    receiver: i32,
}

fn to_map(r: Receiver, p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return vec3f(dot(r.u_row, q), dot(r.v_row, q), dot(r.s_row, q));
}

fn direction_to_map(r: Receiver, d: vec3f) -> vec3f {
    return vec3f(dot(r.u_row.xyz, d), dot(r.v_row.xyz, d), dot(r.s_row.xyz, d));
}
