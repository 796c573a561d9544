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
    sample_index: u32,    // number of samples that the picture already holds
    pad: u32,
    sample_offset: vec2f, // offset of the ray from the pixel's centre, pixels
}

@group(0) @binding(0) var<uniform> view: View;

// Added to a pixel's notes by a sample whose march along the water ran out of steps; a sample that sees the floor outside its map adds 1.
const MARCH_UNFINISHED: f32 = 128.0;

// Index of the invocation's pixel within the band, or the pixel count where there is none.
fn band_pixel(id: vec3u) -> u32 {
    if id.x >= view.width || id.y >= view.row_count { return view.width * view.row_count; }
    return id.y * view.width + id.x;
}
