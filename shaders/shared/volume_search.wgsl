// The search for the caustic volumes that a point lies in: down through the blocks of volumes that may hold it, in the order of their
// numbers, so that sums are always the same. And what the rays of a volume bring to the point.
// A CPU driver runs both sides of every branch, but leaves a loop that no invocation needs. So what is expensive and rare is in loops of its
// own, also where it runs once.

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(22) var<storage, read> volume_rays: array<vec4f>;
@group(0) @binding(23) var<storage, read> volume_flux: array<f32>;
@group(0) @binding(24) var<storage, read> volume_bounds: array<vec4f>;

// Rounding of positions in f32, as a share of the coordinates they come from, with a wide margin.
const ROUNDING: f32 = 1e-6;

const VOLUMES_OF_BLOCK: u32 = 2u * BLOCK_CELLS * BLOCK_CELLS;

// The point of this invocation.
var<private> seen: Point;
var<private> depth_m: f32;

// Where the search is.
struct Search {
    level: u32,
    number: u32,   // of the next block on that level
    block: vec2u,  // the last one that was looked at
    is_open: bool, // whether there are more
}

var<private> search: Search;

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

// Column and row of a block from its number along the curve that visits four blocks, then the next four (Morton 1966).
fn block_at(number: u32) -> vec2u {
    var bits = vec2u(number, number >> 1u) & vec2u(0x55555555u);
    bits = (bits | (bits >> vec2u(1u))) & vec2u(0x33333333u);
    bits = (bits | (bits >> vec2u(2u))) & vec2u(0x0f0f0f0fu);
    bits = (bits | (bits >> vec2u(4u))) & vec2u(0x00ff00ffu);
    return (bits | (bits >> vec2u(8u))) & vec2u(0x0000ffffu);
}

// Takes up a point. False where nothing has to be searched: dry places have their light already, and above the crests there is no light
// under water, nor are blocks bounded there.
fn begin_search(index: u32) -> bool {
    seen = points[index];
    depth_m = -seen.position_m.y;
    search = Search(volumes.level, 0u, vec2u(0u), true);
    return seen.receiver >= 0.0 && depth_m >= volumes.top_m;
}

// Goes on to the next block of level 0 that may hold the point, `search.block`: which of its volumes do, a bit each. Each block is visited
// once at most, so the search ends.
fn held_in_next_block() -> u32 {
    var is_found = false;
    while search.is_open && !is_found {
        let side = side_of(search.level);
        search.block = block_at(search.number);
        let may = all(search.block < vec2u(side)) && may_hold(first_of(search.level) + search.block.y * side + search.block.x);
        is_found = may && search.level == 0u;
        if may && search.level > 0u {
            search.level -= 1u;
            search.number = search.number << 2u;
        } else {
            search.number += 1u;
            let up = min(firstTrailingBit(search.number) / 2u, volumes.level - search.level);
            search.number = search.number >> (2u * up);
            search.level += up;
            search.is_open = search.level != volumes.level;
        }
    }
    var held = 0u;
    for (var k = 0u; k < select(0u, VOLUMES_OF_BLOCK, is_found); k++) {
        held |= select(0u, 1u << k, holds(search.block, k));
    }
    return held;
}

// How the light of a volume comes to the point.
struct Arrival {
    direction: vec3f,
    entry_m: vec3f, // where it enters the water
    path_m: f32,    // under water; negative above the water where it enters
}

// The mean over a volume's rays.
fn arrival_of(vertices: vec3u, weights: vec3f) -> Arrival {
    var arrival = Arrival(vec3f(0.0), vec3f(0.0), 0.0);
    for (var i = 0u; i < 3u; i++) {
        let ray = volume_rays[vertices[i]];
        let height_m = surface[vertices[i]].x;
        let per_depth = sqrt(1.0 + dot(ray.zw, ray.zw));
        arrival.direction += weights[i] * vec3f(ray.z, -1.0, ray.w) / per_depth;
        arrival.entry_m += weights[i] * vec3f(ray.x - ray.z * height_m, height_m, ray.y - ray.w * height_m);
        arrival.path_m += weights[i] * (height_m + depth_m) * per_depth;
    }
    return arrival;
}

// Flux through a square metre of the receiver over flux through a horizontal one; 0 or less where the light does not fall on its front.
// Above the water where its light enters a point gets none. A bared floor is lit all the same, by a path of no length, as with other methods.
fn turned_to(arrival: Arrival) -> f32 {
    if arrival.path_m < 0.0 && seen.receiver != 0.0 { return 0.0; }
    // Rays of volumes fall, so this is finite.
    return -dot(seen.normal, arrival.direction) / -arrival.direction.y;
}
