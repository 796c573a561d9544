// Water map — height and slope of the water. One invocation per texel of a band.
#import "lib/turns.wgsl"
#import "shared/water_surface.wgsl"

struct WaterGrid {
    min_m: vec2f,    // lower corner of the map, local (x, z)
    texel_m: vec2f,  // size of a texel
    width: u32,
    first_row: u32,  // of this band
    row_count: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> water_grid: WaterGrid;
// Per texel: height above the water at rest (m), ∂h/∂x, ∂h/∂z, 0.
@group(0) @binding(8) var<storage, read_write> water_map: array<vec4f>;

@compute @workgroup_size(8, 8)
fn water_map_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= water_grid.width || id.y >= water_grid.row_count { return; }
    let texel = vec2f(f32(id.x), f32(id.y + water_grid.first_row)) + 0.5;
    let p_m = water_grid.min_m + texel * water_grid.texel_m;
    water_map[id.y * water_grid.width + id.x] = vec4f(water_surface_at(p_m), 0.0);
}
