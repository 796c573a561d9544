// Level map pyramid — stores the drawn map in the arena; each higher level holds the least front and the largest back of four texels.
// Texels where the mesh ends or steps in depth are marked: there rays are intersected with the mesh itself.
#import "shared/level_map_view.wgsl"

const EMPTY_DEPTH: f32 = 1e30;
const EDGE_MARK: u32 = 1u;

@group(0) @binding(2) var<storage, read_write> level_maps: array<u32>;
@group(0) @binding(23) var front_depth: texture_2d<f32>;
@group(0) @binding(24) var back_depth: texture_2d<f32>;
@group(0) @binding(25) var front_normal: texture_2d<u32>;
@group(0) @binding(26) var layer_depth: texture_2d<f32>;
@group(0) @binding(27) var layer_normal: texture_2d<u32>;

// Steepest step between neighbouring texels, in texels, that still counts as one surface.
const CONNECTED_STEP: f32 = 8.0;

// Back depth of a texel: the drawn back, extended down to connected neighbours. Without this a single sheet would be a stair of flat texels
// without thickness, and a ray that leaves one step above it and enters the next below it would slip through.
fn closed_back(texel: vec2i, front: f32, back: f32) -> f32 {
    let reach = CONNECTED_STEP / length(level_map_view.u_row.xyz);
    var deepest = max(back, front);
    for (var i = 0; i < 4; i++) {
        let step = select(vec2i(0, 1 - 2 * (i & 1)), vec2i(1 - 2 * (i & 1), 0), i < 2);
        let neighbour = texel + step;
        if any(neighbour < vec2i(0)) || any(neighbour >= vec2i(i32(level_map_view.texels))) { continue; }
        let depths = vec2f(textureLoad(front_depth, neighbour, 0).x, textureLoad(back_depth, neighbour, 0).x);
        // Either sheet of the neighbour may continue either sheet of this texel.
        for (var k = 0; k < 2; k++) {
            if min(abs(depths[k] - front), abs(depths[k] - back)) <= reach { deepest = max(deepest, depths[k]); }
        }
    }
    return deepest;
}

// Whether the mesh ends or steps in depth at this texel or a neighbour: the hit then depends on where in the texel the ray passes.
fn is_edge(texel: vec2i, front: f32) -> bool {
    let reach = CONNECTED_STEP / length(level_map_view.u_row.xyz);
    for (var i = 0; i < 9; i++) {
        let neighbour = texel + vec2i(i % 3, i / 3) - 1;
        var other = EMPTY_DEPTH;
        if all(neighbour >= vec2i(0)) && all(neighbour < vec2i(i32(level_map_view.texels))) {
            other = textureLoad(front_depth, neighbour, 0).x;
        }
        if abs(other - front) > reach { return true; }
    }
    return false;
}

// The word of a back depth with the edge mark in its last bit. Depths without the mark are rounded away from the light, so that the back of
// a sheet does not get in front of it.
fn marked(back: f32, edge: bool) -> u32 {
    let word = bitcast<u32>(back);
    if edge { return word | EDGE_MARK; }
    return select(word & ~EDGE_MARK, word + (word & EDGE_MARK), back >= 0.0);
}

@compute @workgroup_size(8, 8)
fn pyramid_store(@builtin(global_invocation_id) id: vec3u) {
    let texels = level_map_view.texels;
    if id.x >= texels || id.y >= texels { return; }
    let at = id.y * texels + id.x;
    let front = textureLoad(front_depth, vec2i(id.xy), 0).x;
    let back = textureLoad(back_depth, vec2i(id.xy), 0).x;
    let word = level_map_view.target_offset + 2u * at;
    level_maps[word] = bitcast<u32>(front);
    let deepest = select(closed_back(vec2i(id.xy), front, back), -EMPTY_DEPTH, front >= EMPTY_DEPTH);
    level_maps[word + 1u] = marked(deepest, is_edge(vec2i(id.xy), front));
    level_maps[level_map_view.source_offset + at] = textureLoad(front_normal, vec2i(id.xy), 0).x;
}

// A further layer: its depths, then its normals.
@compute @workgroup_size(8, 8)
fn pyramid_layer(@builtin(global_invocation_id) id: vec3u) {
    let texels = level_map_view.texels;
    if id.x >= texels || id.y >= texels { return; }
    let at = id.y * texels + id.x;
    level_maps[level_map_view.target_offset + at] = bitcast<u32>(textureLoad(layer_depth, vec2i(id.xy), 0).x);
    level_maps[level_map_view.source_offset + at] = textureLoad(layer_normal, vec2i(id.xy), 0).x;
}

@compute @workgroup_size(8, 8)
fn pyramid_halve(@builtin(global_invocation_id) id: vec3u) {
    let side = level_map_view.texels >> level_map_view.level;
    if id.x >= side || id.y >= side { return; }
    var front = EMPTY_DEPTH;
    var back = -EMPTY_DEPTH;
    // The first halving includes one texel around the four, because a mesh extends beyond the texels whose centres it covers.
    let rim = select(0, 1, level_map_view.level == 1u);
    let across = 2 + 2 * rim;
    for (var i = 0; i < across * across; i++) {
        let child = 2 * vec2i(id.xy) - rim + vec2i(i % across, i / across);
        if any(child < vec2i(0)) || any(child >= vec2i(2 * i32(side))) { continue; }
        let word = level_map_view.source_offset + 2u * (u32(child.y) * side * 2u + u32(child.x));
        front = min(front, bitcast<f32>(level_maps[word]));
        back = max(back, bitcast<f32>(level_maps[word + 1u]));
    }
    let word = level_map_view.target_offset + 2u * (id.y * side + id.x);
    level_maps[word] = bitcast<u32>(front);
    level_maps[word + 1u] = bitcast<u32>(back);
}
