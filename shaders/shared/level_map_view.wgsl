// The box a level map is drawn in; rows map mesh coordinates to (u, v) in texels and s in units of the mesh.

struct LevelMapView {
    u_row: vec4f,
    v_row: vec4f,
    s_row: vec4f,
    s_min: f32,
    s_max: f32,
    texels: u32,
    first_triangle: u32, // in vec4 units of `geometry`
    arena_offset: u32,   // first word of the map in the arena
    level: u32,          // level that is computed from the previous one (pyramid)
    source_offset: u32,  // of the previous level
    target_offset: u32,  // of this level
}

@group(0) @binding(0) var<uniform> level_map_view: LevelMapView;
