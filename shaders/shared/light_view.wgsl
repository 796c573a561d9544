// A view from a sun: along its rays in the air, so that all points on one ray share a place. A point's place is where its ray crosses the
// water at rest, local (x, z). The view shows what lies under the water, and where light lands is summed by place.

struct LightView {
    to_light: vec4f,          // unit direction to the sun
    extinction_per_m: vec4f,
    power: vec4f,             // irradiance of a plane facing the sun, W/m²
    lean: vec2f,              // sideways shift of a ray per metre of height
    view_min_m: vec2f,        // lower corner of the view
    view_texel_m: vec2f,
    map_min_m: vec2f,         // lower corner of the map in which light is summed; within the view
    map_texel_m: vec2f,
    water_min_m: vec2f,       // lower corner of the water that light is followed from
    water_cell_m: vec2f,
    cells: u32,               // along each side of that water
    texels: u32,              // along each side of the view, and of the map
    iterations: u32,          // of the search in image space
    has_floor: u32,
    object_count: u32,
    channels: u32,            // 1 if all channels have the same extinction, else 3
    bottom_y_m: f32,          // height of the floor; without one just below all objects
    ior: f32,
    sum_scale: f32,           // counts per unit flux (m² under 1 W/m²) in the sums of a texel
    term_scale: f32,          // the same in a workgroup's account
    energy_scale: f32,        // the same in the frame's account
    first_texel: u32,         // of this beam set in the maps of all
    first_object: u32,        // of a draw
    width: u32,               // points in a row of a band
    row_count: u32,
    are_texels: u32,          // 1: the points are texels of a map, whose normals may face either side
    interpolates: u32,        // 1: the map is interpolated between texel centres
    pad: u32,
}

@group(0) @binding(0) var<uniform> light_view: LightView;

fn place_of_point(p: vec3f) -> vec2f {
    return p.xz - light_view.lean * p.y;
}

// The point at height `y` on the ray through a place.
fn point_at(place: vec2f, y: f32) -> vec3f {
    let xz = place + light_view.lean * y;
    return vec3f(xz.x, y, xz.y);
}

fn view_place(p: vec3f) -> vec2f {
    return (place_of_point(p) - light_view.view_min_m) / light_view.view_texel_m;
}

fn map_place(p: vec3f) -> vec2f {
    return (place_of_point(p) - light_view.map_min_m) / light_view.map_texel_m;
}

fn is_within(uv: vec2f) -> bool {
    return all(uv >= vec2f(0.0)) && all(uv < vec2f(f32(light_view.texels)));
}
