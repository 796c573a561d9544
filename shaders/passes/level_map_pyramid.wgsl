// Level map pyramid — the drawn map goes into the arena, and each level above holds the least front and the largest back of four.
#import "shared/level_map_view.wgsl"

const EMPTY_DEPTH: f32 = 1e30;

@group(0) @binding(2) var<storage, read_write> level_maps: array<u32>;
@group(0) @binding(23) var front_depth: texture_2d<f32>;
@group(0) @binding(24) var back_depth: texture_2d<f32>;
@group(0) @binding(25) var front_normal: texture_2d<u32>;

// Steepest step between neighbouring texels, in texels, that still counts as one surface.
const CONNECTED_STEP: f32 = 8.0;

// How deep what the texel holds reaches: the back that was drawn, and down to connected neighbours. A single sheet is a stair of
// flat texels without thickness; a ray that leaves one step above it and enters the next below it would slip through.
fn closed_back(texel: vec2i, front: f32, back: f32) -> f32 {
    let reach = CONNECTED_STEP / length(level_map_view.u_row.xyz);
    var deepest = max(back, front);
    for (var i = 0; i < 4; i++) {
        let step = select(vec2i(0, 1 - 2 * (i & 1)), vec2i(1 - 2 * (i & 1), 0), i < 2);
        let neighbour = texel + step;
        if any(neighbour < vec2i(0)) || any(neighbour >= vec2i(i32(level_map_view.texels))) { continue; }
        let depths = vec2f(textureLoad(front_depth, neighbour, 0).x, textureLoad(back_depth, neighbour, 0).x);
        // Its nearer or its farther sheet may be the continuation of either of ours.
        for (var k = 0; k < 2; k++) {
            if min(abs(depths[k] - front), abs(depths[k] - back)) <= reach { deepest = max(deepest, depths[k]); }
        }
    }
    return deepest;
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
    level_maps[word + 1u] = bitcast<u32>(select(closed_back(vec2i(id.xy), front, back), -EMPTY_DEPTH, front >= EMPTY_DEPTH));
    level_maps[level_map_view.source_offset + at] = textureLoad(front_normal, vec2i(id.xy), 0).x;
}

@compute @workgroup_size(8, 8)
fn pyramid_halve(@builtin(global_invocation_id) id: vec3u) {
    let side = level_map_view.texels >> level_map_view.level;
    if id.x >= side || id.y >= side { return; }
    var front = EMPTY_DEPTH;
    var back = -EMPTY_DEPTH;
    for (var i = 0u; i < 4u; i++) {
        let child = 2u * id.xy + vec2u(i & 1u, i >> 1u);
        let word = level_map_view.source_offset + 2u * (child.y * side * 2u + child.x);
        front = min(front, bitcast<f32>(level_maps[word]));
        back = max(back, bitcast<f32>(level_maps[word + 1u]));
    }
    let word = level_map_view.target_offset + 2u * (id.y * side + id.x);
    level_maps[word] = bitcast<u32>(front);
    level_maps[word + 1u] = bitcast<u32>(back);
}
