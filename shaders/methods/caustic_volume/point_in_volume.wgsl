// Point in volume — light at points from the caustic volumes around them (Sandberg & Falemo 2005, §3.3, §3.4). One invocation per point of a
// band. It descends through the blocks of volumes that may hold the point, in the order of their numbers, so that sums are always the same.
// A CPU driver runs both sides of every branch, but leaves a loop that no invocation needs. So what is expensive and rare is in loops of its
// own, also where it runs once.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "shared/points.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/volumes.wgsl"
#import "shared/blocked_way.wgsl"

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m²
@group(0) @binding(22) var<storage, read> volume_rays: array<vec4f>;
@group(0) @binding(23) var<storage, read> volume_flux: array<f32>;
@group(0) @binding(24) var<storage, read> volume_bounds: array<vec4f>;

// Rounding of positions in f32, as a share of the coordinates they come from, with a wide margin.
const ROUNDING: f32 = 1e-6;
// Twice the area (m²) below which a cut counts as empty: it holds no point, and its density would leave the range of f32.
const LEAST_DOUBLE_AREA_M2: f32 = 1e-30;
const VOLUMES_OF_BLOCK: u32 = 2u * BLOCK_CELLS * BLOCK_CELLS;

// The point of this invocation.
var<private> seen: Point;
var<private> depth_m: f32;

// (x, z) of a vertex's ray at the point's depth, relative to the point.
fn aside_m(vertex: u32) -> vec2f {
    let ray = volume_rays[vertex];
    return (ray.xy - seen.position_m.xz) + ray.zw * depth_m;
}

// Whether rays of a block may pass the point.
fn may_hold(block: u32) -> bool {
    let low = volume_bounds[2u * block];
    let high = volume_bounds[2u * block + 1u];
    let share = (depth_m - volumes.top_m) / (volumes.bottom_m - volumes.top_m);
    let margin = vec2f(ROUNDING * (max(max(abs(low.x), abs(low.y)), max(abs(low.z), abs(low.w))) + abs(depth_m)));
    let p = seen.position_m.xz;
    return all(p >= mix(low.xy, low.zw, share) - margin) && all(p <= mix(high.xy, high.zw, share) + margin);
}

// Twice the signed area of the point and the edge from a to b (both relative to the point), and on which side of the edge the point lies, 1
// or −1. Both are computed from the vertex with the smaller number to the other, so the two triangles at an edge get the same number with
// opposite signs. A point on the edge counts as moved by (ε, ε²), so that exactly one of them has it.
fn edge_side(a: vec2f, b: vec2f, is_forward: bool) -> vec2f {
    let from_m = select(b, a, is_forward);
    let to_m = select(a, b, is_forward);
    let double_area = from_m.x * to_m.y - from_m.y * to_m.x;
    let along = to_m - from_m;
    var side = select(-1.0, 1.0, double_area > 0.0);
    if double_area == 0.0 {
        side = select(1.0, -1.0, along.y > 0.0);
        if along.y == 0.0 { side = select(-1.0, 1.0, along.x >= 0.0); }
    }
    return vec2f(double_area, side) * select(-1.0, 1.0, is_forward);
}

// The three edges of a cut, each against the corner that it leaves out, see edge_side().
struct Cut {
    double_areas: vec3f,
    sides: vec3f,
}

fn cut_between(vertices: vec3u, p0: vec2f, p1: vec2f, p2: vec2f) -> Cut {
    let e0 = edge_side(p1, p2, vertices.y < vertices.z);
    let e1 = edge_side(p2, p0, vertices.z < vertices.x);
    let e2 = edge_side(p0, p1, vertices.x < vertices.y);
    return Cut(vec3f(e0.x, e1.x, e2.x), vec3f(e0.y, e1.y, e2.y));
}

// Twice the signed area of a cut.
fn double_area_of(cut: Cut) -> f32 {
    return cut.double_areas.x + cut.double_areas.y + cut.double_areas.z;
}

// Whether the point lies in the cut, whichever way round that is.
fn is_in(cut: Cut) -> bool {
    return cut.sides.x == cut.sides.y && cut.sides.x == cut.sides.z && abs(double_area_of(cut)) >= LEAST_DOUBLE_AREA_M2;
}

fn vertices_of(cell: vec2u, half: u32) -> vec3u {
    let side = light.cells + 1u;
    let corners = beam_corners(cell, half);
    var vertices = vec3u(0u);
    for (var k = 0u; k < 3u; k++) {
        let ij = cell + corner_of(corners, k);
        vertices[k] = ij.y * side + ij.x;
    }
    return vertices;
}

// Density at a vertex: the flux of the volumes around it over the sum of their cuts. Taken linearly between the corners of each cut, it gives
// the same flux in all as the volumes carry.
fn density_at(vertex: u32) -> f32 {
    let side = light.cells + 1u;
    let ij = vec2u(vertex % side, vertex / side);
    var flux = 0.0;
    var double_area = 0.0;
    for (var i = 0u; i < 4u; i++) {
        // Unsigned numbers below 0 wrap, and are beyond the grid like those above it.
        let cell = ij - vec2u(i & 1u, i >> 1u);
        if any(cell >= vec2u(light.cells)) { continue; }
        for (var half = 0u; half < 2u; half++) {
            let vertices = vertices_of(cell, half);
            let own = volume_flux[2u * (cell.y * light.cells + cell.x) + half];
            if own == 0.0 || !any(vertices == vec3u(vertex)) { continue; }
            let a = aside_m(vertices.x);
            let ab = aside_m(vertices.y) - a;
            let ac = aside_m(vertices.z) - a;
            flux += own;
            double_area += abs(ab.x * ac.y - ab.y * ac.x);
        }
    }
    if double_area < LEAST_DOUBLE_AREA_M2 { return 0.0; }
    return 2.0 * flux / double_area;
}

// Whether an object blocks the way from the point to where its light enters the water.
fn is_blocked(entry_m: vec3f, path_m: f32) -> bool {
    return is_way_blocked(seen, entry_m, path_m, select(0u, volumes.instance_count, volumes.has_shadows == 1u));
}

// Cell and half of volume `k` of a block of level 0.
fn cell_in(block: vec2u, k: u32) -> vec2u {
    let cell = k >> 1u;
    return BLOCK_CELLS * block + vec2u(cell % BLOCK_CELLS, cell / BLOCK_CELLS);
}

fn flux_of(cell: vec2u, half: u32) -> f32 {
    return volume_flux[2u * (cell.y * light.cells + cell.x) + half];
}

fn cut_of(vertices: vec3u) -> Cut {
    return cut_between(vertices, aside_m(vertices.x), aside_m(vertices.y), aside_m(vertices.z));
}

// Whether volume `k` of a block holds the point and has light; false also where there is no such volume.
fn holds(block: vec2u, k: u32) -> bool {
    let cell = cell_in(block, k);
    if any(cell >= vec2u(light.cells)) { return false; }
    return is_in(cut_of(vertices_of(cell, k & 1u))) && flux_of(cell, k & 1u) > 0.0;
}

// Light of volume `k` of a block, in whose cut the point lies, W/m².
fn light_of(block: vec2u, k: u32) -> vec3f {
    let cell = cell_in(block, k);
    let vertices = vertices_of(cell, k & 1u);
    let cut = cut_of(vertices);
    // Computed again, so it may differ in the last digit from what holds() has found.
    let double_area = double_area_of(cut);
    if abs(double_area) < LEAST_DOUBLE_AREA_M2 { return vec3f(0.0); }
    let weights = cut.double_areas / double_area;
    var direction = vec3f(0.0);
    var entry_m = vec3f(0.0);
    var path_m = 0.0;
    for (var i = 0u; i < 3u; i++) {
        let ray = volume_rays[vertices[i]];
        let height_m = surface[vertices[i]].x;
        let per_depth = sqrt(1.0 + dot(ray.zw, ray.zw));
        direction += weights[i] * vec3f(ray.z, -1.0, ray.w) / per_depth;
        entry_m += weights[i] * vec3f(ray.x - ray.z * height_m, height_m, ray.y - ray.w * height_m);
        path_m += weights[i] * (height_m + depth_m) * per_depth;
    }
    // Above the water where its light enters a point gets none. A bared floor is lit all the same, by a path of no length, as with other methods.
    if path_m < 0.0 && seen.receiver != 0.0 { return vec3f(0.0); }
    path_m = max(path_m, 0.0);
    // Flux through a horizontal square metre over flux through one of the receiver. Rays of volumes fall, so this is finite.
    let cosine = -dot(seen.normal, direction) / -direction.y;
    if cosine <= 0.0 || is_blocked(entry_m, path_m) { return vec3f(0.0); }
    var density = 2.0 * flux_of(cell, k & 1u) / abs(double_area);
    if volumes.is_linear == 1u { density = 0.0; }
    for (var i = 0u; i < 3u * volumes.is_linear; i++) { density += weights[i] * density_at(vertices[i]); }
    var left = vec3f(1.0);
    if ATTENUATES {
        for (var c = 0; c < 3; c++) { left[c] = transmission(light.extinction_per_m[c], path_m); }
    }
    return volumes.power.xyz * left * (density * cosine);
}

// Column and row of a block from its number along the curve that visits four blocks, then the next four (Morton 1966).
fn block_at(number: u32) -> vec2u {
    var bits = vec2u(number, number >> 1u) & vec2u(0x55555555u);
    bits = (bits | (bits >> vec2u(1u))) & vec2u(0x33333333u);
    bits = (bits | (bits >> vec2u(2u))) & vec2u(0x0f0f0f0fu);
    bits = (bits | (bits >> vec2u(4u))) & vec2u(0x00ff00ffu);
    return (bits | (bits >> vec2u(8u))) & vec2u(0x0000ffffu);
}

@compute @workgroup_size(8, 8)
fn point_in_volume_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= volumes.width || id.y >= volumes.row_count { return; }
    let index = id.y * volumes.width + id.x;
    seen = points[index];
    // Dry places have their light already.
    if seen.receiver < 0.0 { return; }
    depth_m = -seen.position_m.y;
    // Above the crests there is no light under water, nor are blocks bounded there.
    if depth_m < volumes.top_m { return; }
    var sum = vec3f(0.0);
    var level = volumes.level;
    var number = 0u;
    var block = vec2u(0u);
    var is_done = false;
    // Each block is visited once at most, so this ends.
    while !is_done {
        // On to the next block of level 0 that may hold the point.
        var is_found = false;
        while !is_done && !is_found {
            let side = side_of(level);
            block = block_at(number);
            let may = all(block < vec2u(side)) && may_hold(first_of(level) + block.y * side + block.x);
            is_found = may && level == 0u;
            if may && level > 0u {
                level -= 1u;
                number = number << 2u;
            } else {
                number += 1u;
                let up = min(firstTrailingBit(number) / 2u, volumes.level - level);
                number = number >> (2u * up);
                level += up;
                is_done = level == volumes.level;
            }
        }
        // Which of its volumes do.
        var held = 0u;
        for (var k = 0u; k < select(0u, VOLUMES_OF_BLOCK, is_found); k++) {
            held |= select(0u, 1u << k, holds(block, k));
        }
        while held != 0u {
            sum += light_of(block, firstTrailingBit(held));
            held &= held - 1u;
        }
    }
    point_irradiance[index] += vec4f(sum, 0.0);
}
