// Receivers of light and what a ray strikes first.
//
// Receiver 0 is the floor plane, the rest are objects behind their level maps, each with one receiver per layer: object k has
// receivers 1 + k·layers … Map space of a receiver: (u, v) in texels of
// its irradiance map, s along the map's axis (floor: metres, below the plane is s > 0; objects: units of the mesh).

const NO_RECEIVER: i32 = -1;
const FLOOR: i32 = 0;
// Where a map lies that nobody asks for: light that lands there goes straight into the account.
const NOWHERE: u32 = 0xffffffffu;
const EMPTY_DEPTH: f32 = 1e30;
const MARCH_STEPS: u32 = 1024u;

struct Receiver {
    u_row: vec4f,
    v_row: vec4f,
    s_row: vec4f,
    map_width: u32,
    map_height: u32,
    map_offset: u32,        // first texel in the flux sums; NOWHERE: nobody asks for the map
    level_map_offset: u32,  // first word of the level map in the arena
    s_min: f32,
    s_max: f32,
    level_count: u32,       // mip levels of the level map; 0 for the floor
    density_per_flux: f32,  // 1 / (area that a texel shows to the map's axis, m²)
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
