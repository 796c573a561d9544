// The camera and the medium it looks into; the uniform of all passes that make a picture.

struct View {
    eye: vec4f,
    right: vec4f,         // times half the picture's width at unit distance (orthographic: in metres)
    up: vec4f,            // times half the picture's height
    forward: vec4f,       // unit
    middle: vec4f,        // from the eye to the middle of the picture at unit distance along forward
    extinction_per_m: vec4f,
    sky_radiance: vec4f,
    floor_albedo: vec4f,
    floor_min_m: vec2f,
    floor_max_m: vec2f,
    floor_y_m: f32,
    has_floor: u32,
    width: u32,
    height: u32,
    first_row: u32,       // of this band
    row_count: u32,
    orthographic: u32,
    instance_count: u32,
    light_count: u32,     // lights with maps
    air_light_count: u32, // suns above the horizon and point lights above the water
    max_height_m: f32,    // |height| the waves can reach
    max_slope: f32,
    ior: f32,
    sky_transmittance: f32,
    sky_path_factor: f32,
    layers: u32,          // receivers of an object: its surfaces along the light, nearest first
    sample_index: u32,    // number of samples and legs that the picture already holds
    leg: u32,             // the way that rays take where they split at the water
    splits: u32,          // how often a ray splits
    bounces: u32,         // how often a ray may meet the water
    start_m: f32,         // way from the eye to where the rays of a perspective camera start: the radius of its dome
    pad: u32,
    sample_offset: vec2f, // offset of the ray from the pixel's centre, pixels
}

@group(0) @binding(0) var<uniform> view: View;

// Notes of a pixel, a set of bits held as a number: that it sees the floor outside its map, that a march along the water ran out of steps,
// and that a ray met the water too often.
const OUTSIDE_MAP: u32 = 1u;
const MARCH_UNFINISHED: u32 = 2u;
const CUT_OFF: u32 = 4u;

// Index of the invocation's pixel within the band, or the pixel count where there is none.
fn band_pixel(id: vec3u) -> u32 {
    if id.x >= view.width || id.y >= view.row_count { return view.width * view.row_count; }
    return id.y * view.width + id.x;
}
