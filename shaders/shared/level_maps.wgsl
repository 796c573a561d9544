// Level maps in their arena. Each map holds its min–max pyramid (front, back) from level 0 on, then one packed normal per texel of level
// 0, then for each further layer a depth and a packed normal per texel.

@group(0) @binding(2) var<storage, read> level_maps: array<u32>;

fn level_offset(size: u32, level: u32) -> u32 {
    // Levels halve a power of two: 2 words per texel, size² (1 + ¼ + … ) texels before this level.
    var offset = 0u;
    var s = size;
    for (var l = 0u; l < level; l++) {
        offset += 2u * s * s;
        s = s >> 1u;
    }
    return offset;
}

// Last bit of a back depth of level 0: the mesh ends or steps in depth here, see shaders/stages/level_map_pyramid.wgsl.
const EDGE_MARK: u32 = 1u;
// Result of the march at an edge texel, where the mesh itself must be intersected.
const AT_EDGE: f32 = -2.0;

// (front, back) depth s of a texel of a level; front = EMPTY_DEPTH where it is empty.
fn level_map_depths(map_offset: u32, size: u32, level: u32, texel: vec2i) -> vec2f {
    let side = i32(size >> level);
    if any(texel < vec2i(0)) || any(texel >= vec2i(side)) { return vec2f(EMPTY_DEPTH, -EMPTY_DEPTH); }
    let word = map_offset + level_offset(size, level) + 2u * u32(texel.y * side + texel.x);
    return vec2f(bitcast<f32>(level_maps[word]), bitcast<f32>(level_maps[word + 1u]));
}

// Word of a layer's packed normal at a texel inside the map; of a further layer the depth lies texels² words before it.
fn layer_word(r: Receiver, layer: u32, texel: vec2i) -> u32 {
    let texels = r.map_width * r.map_width;
    return r.level_map_offset + level_offset(r.map_width, r.level_count) + 2u * layer * texels + u32(texel.y) * r.map_width + u32(texel.x);
}

// Depth s of a layer at a texel; EMPTY_DEPTH where it is empty.
fn layer_depth(r: Receiver, layer: u32, texel: vec2i) -> f32 {
    if layer == 0u { return level_map_depths(r.level_map_offset, r.map_width, 0u, texel).x; }
    if any(texel < vec2i(0)) || any(texel >= vec2i(i32(r.map_width))) { return EMPTY_DEPTH; }
    return bitcast<f32>(level_maps[layer_word(r, layer, texel) - r.map_width * r.map_width]);
}

// Front depth interpolated between texel centres, or the nearest texel's if a neighbour is empty or more than `gap` away in depth.
fn smooth_front(r: Receiver, uv: vec2f, gap: f32) -> f32 {
    let base = floor(uv - 0.5);
    let f = uv - 0.5 - base;
    let texel = vec2i(base);
    let nearest = level_map_depths(r.level_map_offset, r.map_width, 0u, vec2i(floor(uv))).x;
    var sum = 0.0;
    for (var i = 0; i < 4; i++) {
        let corner = vec2i(i & 1, i >> 1);
        let depth = level_map_depths(r.level_map_offset, r.map_width, 0u, texel + corner).x;
        if abs(depth - nearest) > gap { return nearest; }
        sum += depth * select(1.0 - f.x, f.x, corner.x == 1) * select(1.0 - f.y, f.y, corner.y == 1);
    }
    return sum;
}

fn is_edge_texel(map_offset: u32, size: u32, texel: vec2i) -> bool {
    let word = map_offset + 2u * (u32(texel.y) * size + u32(texel.x));
    return (level_maps[word + 1u] & EDGE_MARK) != 0u;
}

// Whether the last march ended more than a texel below the front of its texel: the ray entered through a side or from behind. This happens
// where a solid becomes thin towards its silhouette and a tilted ray hits its far side.
var<private> entered_through_side: bool = false;

// Distance t (m) at which a ray in map space enters the solid of the level map, between t_min and t_max. t < 0: no hit, or AT_EDGE if it
// reaches an edge texel first.
// Hierarchical traversal: cells whose depth interval does not overlap the ray's interval are skipped whole.
fn march_level_map(r: Receiver, origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> f32 {
    entered_through_side = false;
    let side = f32(r.map_width);
    // Clip to the box of the map.
    var t_in = t_min;
    var t_out = t_max;
    let lo = vec3f(0.0, 0.0, r.s_min);
    let hi = vec3f(side, side, r.s_max);
    for (var a = 0; a < 3; a++) {
        let o = origin[a];
        let d = direction[a];
        if abs(d) < 1e-20 {
            if o < lo[a] || o > hi[a] { return -1.0; }
        } else {
            let t0 = (lo[a] - o) / d;
            let t1 = (hi[a] - o) / d;
            t_in = max(t_in, min(t0, t1));
            t_out = min(t_out, max(t0, t1));
        }
    }
    if t_in > t_out { return -1.0; }
    let step_sign = vec2f(select(-1.0, 1.0, direction.x >= 0.0), select(-1.0, 1.0, direction.y >= 0.0));
    let inverse = vec2f(
        select(1e30, 1.0 / direction.x, abs(direction.x) > 1e-20),
        select(1e30, 1.0 / direction.y, abs(direction.y) > 1e-20));
    var t = t_in;
    var level = r.level_count - 1u;
    var cell = vec2i(clamp(floor((origin.xy + t * direction.xy) / f32(1u << level)), vec2f(0.0), vec2f(f32((r.map_width >> level) - 1u))));
    for (var i = 0u; i < MARCH_STEPS; i++) {
        // Where the ray leaves the cell.
        let width = f32(1u << level);
        let edge = (vec2f(cell) + select(vec2f(0.0), vec2f(1.0), step_sign > vec2f(0.0))) * width;
        let t_edge = (edge - origin.xy) * inverse;
        let t_x = select(1e30, t_edge.x, abs(direction.x) > 1e-20);
        let t_y = select(1e30, t_edge.y, abs(direction.y) > 1e-20);
        let t_leave = max(min(min(t_x, t_y), t_out), t);
        let s_0 = origin.z + t * direction.z;
        let s_1 = origin.z + t_leave * direction.z;
        if level == 0u && is_edge_texel(r.level_map_offset, r.map_width, cell) { return AT_EDGE; }
        let depths = level_map_depths(r.level_map_offset, r.map_width, level, cell);
        if max(s_0, s_1) >= depths.x && min(s_0, s_1) <= depths.y {
            if level == 0u {
                entered_through_side = s_0 > depths.x + r.s_per_m * inverseSqrt(r.density_per_flux);
                if s_0 >= depths.x || abs(direction.z) < 1e-20 { return t; }
                return clamp(t + (depths.x - s_0) / direction.z, t, t_leave);
            }
            // Descend into the child that holds the entry point.
            level -= 1u;
            let child = vec2i(floor((origin.xy + t * direction.xy) / f32(1u << level)));
            cell = clamp(child, cell * 2, cell * 2 + 1);
            continue;
        }
        if t_leave >= t_out { return -1.0; }
        // Step over the nearer edge. Go up a level only if the step leaves the parent, so that a ray on an edge cannot return to a cell it
        // has left: every step is a whole cell forward.
        t = t_leave;
        let parent = cell >> vec2u(1u);
        if t_x <= t_y { cell.x += i32(step_sign.x); } else { cell.y += i32(step_sign.y); }
        let count = i32(r.map_width >> level);
        if any(cell < vec2i(0)) || any(cell >= vec2i(count)) { return -1.0; }
        if level + 1u < r.level_count && any((cell >> vec2u(1u)) != parent) {
            level += 1u;
            cell = cell >> vec2u(1u);
        }
    }
    // Out of steps: count it as a hit, so that no light leaks.
    return t;
}
