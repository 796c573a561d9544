// Level map pyramid — the drawn map goes into the arena, and each level above holds the least front and the largest back of four.
#import "shared/level_map_view.wgsl"

const EMPTY_DEPTH: f32 = 1e30;

@group(0) @binding(2) var<storage, read_write> level_maps: array<u32>;
@group(0) @binding(23) var front_depth: texture_2d<f32>;
@group(0) @binding(24) var back_depth: texture_2d<f32>;
@group(0) @binding(25) var front_normal: texture_2d<u32>;

@compute @workgroup_size(8, 8)
fn pyramid_store(@builtin(global_invocation_id) id: vec3u) {
    let texels = level_map_view.texels;
    if id.x >= texels || id.y >= texels { return; }
    let at = id.y * texels + id.x;
    let front = textureLoad(front_depth, vec2i(id.xy), 0).x;
    let back = textureLoad(back_depth, vec2i(id.xy), 0).x;
    let word = level_map_view.target_offset + 2u * at;
    level_maps[word] = bitcast<u32>(front);
    level_maps[word + 1u] = bitcast<u32>(select(max(back, front), -EMPTY_DEPTH, front >= EMPTY_DEPTH));
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
