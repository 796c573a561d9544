// Deposits a triangle's flux on a receiver map: flux × covered share of each texel, in closed form. The importing pass supplies
// `deposit_share`, which adds a share to a texel.

// Longest side (texels) below which a footprint is a point, and area / side² below which it is a segment. There f32 rounding of the
// coverage would exceed 10⁻³ of the triangle's flux, while moving the flux by less than 10⁻³ texel is invisible.
const POINT_SIDE: f32 = 1e-3;
const SEGMENT_SHAPE: f32 = 4e-4;
// Area (texel²) below which a row of a footprint counts as empty. Its share is only rounding and goes to the row's first texel.
const FLAT_ROW: f32 = 1e-30;

struct Target {
    offset: u32,
    width: i32,
    height: i32,
    channels: u32,
    scale: f32, // counts per unit of flux
}

// The edges of a triangle (corners relative to `base`), clipped to a row from `y_0` to `y_1`; they give the signed area in any column of
// the row. Edges run corner to corner; see src/physics/coverage.rs.
struct RowEdges {
    x_a: vec3f,
    x_b: vec3f,
    dy: vec3f,
}

// x of an edge at height y, always computed from its lower end: neighbours that share the edge get the same number, so flux that one
// loses to rounding goes to the other.
fn edge_x(a: vec2f, b: vec2f, y: f32) -> f32 {
    let swapped = b.y < a.y || (b.y == a.y && b.x < a.x);
    let p = select(a, b, swapped);
    let q = select(b, a, swapped);
    let x = select(p.x, p.x + (y - p.y) * ((q.x - p.x) / (q.y - p.y)), q.y != p.y);
    return clamp(x, min(p.x, q.x), max(p.x, q.x));
}

fn clip_to_row(a: vec2f, b: vec2f, c: vec2f, y_0: f32, y_1: f32) -> RowEdges {
    let y_start = clamp(vec3f(a.y, b.y, c.y), vec3f(y_0), vec3f(y_1));
    let y_end = y_start.yzx;
    let x_a = vec3f(edge_x(a, b, y_start.x), edge_x(b, c, y_start.y), edge_x(c, a, y_start.z));
    let x_b = vec3f(edge_x(a, b, y_end.x), edge_x(b, c, y_end.y), edge_x(c, a, y_end.z));
    return RowEdges(x_a, x_b, y_end - y_start);
}

// The same edges with x relative to `x`: coverage is more precise when computed from a nearby origin.
fn moved(edges: RowEdges, x: f32) -> RowEdges {
    return RowEdges(edges.x_a - x, edges.x_b - x, edges.dy);
}

fn row_low(edges: RowEdges) -> f32 {
    let low = min(edges.x_a, edges.x_b);
    return min(low.x, min(low.y, low.z));
}

fn row_high(edges: RowEdges) -> f32 {
    let high = max(edges.x_a, edges.x_b);
    return max(high.x, max(high.y, high.z));
}

// Signed area of the triangle's row to the right of `x`.
fn area_right_of(edges: RowEdges, x: f32) -> f32 {
    return edges.dy.x * mean_positive(edges.x_a.x - x, edges.x_b.x - x)
        + edges.dy.y * mean_positive(edges.x_a.y - x, edges.x_b.y - x)
        + edges.dy.z * mean_positive(edges.x_a.z - x, edges.x_b.z - x);
}

// Signed area of the row between 0 and `width`.
fn area_within(edges: RowEdges, width: f32) -> f32 {
    return edges.dy.x * mean_clamped(edges.x_a.x, edges.x_b.x, width)
        + edges.dy.y * mean_clamped(edges.x_a.y, edges.x_b.y, width)
        + edges.dy.z * mean_clamped(edges.x_a.z, edges.x_b.z, width);
}

// Bounds of texel `i` of `count` along one axis; the border cells −1 and `count` extend to the footprint's end.
fn cell_bounds(i: i32, count: i32, base: f32, low: f32, high: f32) -> vec2f {
    return vec2f(
        select(f32(i) - base, low, i < 0),
        select(f32(i + 1) - base, high, i >= count));
}

// Whether a footprint has a negligible area and must be deposited as a segment.
fn is_segment(a: vec2f, b: vec2f, c: vec2f) -> bool {
    let p = b - a;
    let q = c - a;
    let side2 = max(dot(p, p), max(dot(q, q), dot(q - p, q - p)));
    return side2 >= POINT_SIDE * POINT_SIDE && abs(p.x * q.y - p.y * q.x) < SEGMENT_SHAPE * side2;
}

// Texels (border cells included) that a footprint touches: first, then last.
struct TexelBox {
    first: vec2i,
    last: vec2i,
}

// Huge coordinates stay in the range of i32: everything beyond the border falls into the border cell.
fn texel_box(target_map: Target, a: vec2f, b: vec2f, c: vec2f) -> TexelBox {
    let size = vec2f(f32(target_map.width), f32(target_map.height));
    let first = vec2i(floor(clamp(min(a, min(b, c)), vec2f(-1.0), size)));
    let last = vec2i(floor(clamp(max(a, max(b, c)), vec2f(-1.0), size)));
    return TexelBox(first, last);
}

// A triangle that is no segment, prepared to be deposited row by row.
struct Footprint {
    base: vec2f,        // a nearby texel corner, the origin of the coordinates below, for precision
    corners: mat3x2f,   // relative to `base`, as the next three
    low: vec2f,
    middle_y: f32,      // height of the corner between the lowest and the highest
    high: vec2f,
    turn: f32,          // sign of the area: −1 if the triangle is inverted
    box: TexelBox,      // texels that get a share
    is_whole: bool,     // whether one texel gets all of it
}

fn footprint_of(target_map: Target, a: vec2f, b: vec2f, c: vec2f) -> Footprint {
    let size = vec2i(target_map.width, target_map.height);
    var f: Footprint;
    f.box = texel_box(target_map, a, b, c);
    f.base = vec2f(f.box.first);
    let p = a - f.base;
    let q = b - f.base;
    let r = c - f.base;
    f.corners = mat3x2f(p, q, r);
    f.low = min(p, min(q, r));
    f.high = max(p, max(q, r));
    f.middle_y = max(min(p.y, q.y), min(max(p.y, q.y), r.y));
    f.turn = sign((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
    let side2 = max(dot(q - p, q - p), max(dot(r - q, r - q), dot(p - r, p - r)));
    if side2 < POINT_SIDE * POINT_SIDE {
        let middle = clamp(vec2i(floor((a + b + c) / 3.0)), f.box.first, f.box.last);
        f.box = TexelBox(middle, middle);
    }
    // In one texel, or entirely beyond one side of the map.
    f.is_whole = all(f.box.first == f.box.last) || any(f.box.last < vec2i(0)) || any(f.box.first >= size);
    if f.is_whole { f.box.last = f.box.first; }
    return f;
}

// Deposits row `y` of a footprint; returns the share outside the map. There is only one call that writes per row: a CPU driver runs both
// sides of every branch, and atomics dominate the cost.
//
// The row's share of the flux depends only on the corners' heights. It is distributed over columns in proportion to the row's area in
// each. Column shares are never negative and add up to the row's share, so all shares add up to 1, however thin the footprint and however
// large the rounding of its areas.
fn deposit_row(target_map: Target, f: Footprint, y: i32, triangle_flux: vec3f) -> f32 {
    let row = cell_bounds(y, target_map.height, f.base.y, f.low.y, f.high.y);
    let row_share = select(tent_share_between(row.x, row.y, f.low.y, f.middle_y, f.high.y), 1.0, f.is_whole);
    let is_beside = y < 0 || y >= target_map.height;
    let edges = clip_to_row(f.corners[0], f.corners[1], f.corners[2], row.x, row.y);
    let column_first = clamp(i32(floor(row_low(edges) + f.base.x)), f.box.first.x, f.box.last.x);
    let column_last = select(clamp(i32(floor(row_high(edges) + f.base.x)), f.box.first.x, f.box.last.x), column_first - 1, is_beside);
    let start = cell_bounds(column_first, target_map.width, f.base.x, f.low.x, f.high.x).x;
    let near = moved(edges, start);
    var right = f.turn * area_right_of(near, 0.0);
    right = select(right, 1.0, right < FLAT_ROW);
    let per_area = row_share / right;
    var beside = select(0.0, row_share, is_beside);
    for (var x = column_first; x <= column_last; x++) {
        let beyond = f.turn * area_right_of(near, cell_bounds(x, target_map.width, f.base.x, f.low.x, f.high.x).y - start);
        let next = select(clamp(beyond, 0.0, right), 0.0, x == column_last);
        beside += deposit_share(target_map, x, y, select((right - next) * per_area, row_share, f.is_whole), triangle_flux);
        right = next;
    }
    return beside;
}

// Deposits a triangle that is no segment; returns the share outside the map.
fn deposit_area(target_map: Target, a: vec2f, b: vec2f, c: vec2f, triangle_flux: vec3f) -> f32 {
    let f = footprint_of(target_map, a, b, c);
    var beside = 0.0;
    for (var y = f.box.first.y; y <= f.box.last.y; y++) { beside += deposit_row(target_map, f, y, triangle_flux); }
    return beside;
}

// Deposits a triangle of any shape; returns the share outside the map.
fn deposit_triangle(target_map: Target, a: vec2f, b: vec2f, c: vec2f, triangle_flux: vec3f) -> f32 {
    if is_segment(a, b, c) { return deposit_segment(target_map, a, b, c, triangle_flux); }
    return deposit_area(target_map, a, b, c, triangle_flux);
}

// Deposits a footprint without area: its flux lies on its longest side, with a tent density that peaks at the third corner.
fn deposit_segment(target_map: Target, corner_a: vec2f, corner_b: vec2f, corner_c: vec2f, triangle_flux: vec3f) -> f32 {
    let base = vec2f(texel_box(target_map, corner_a, corner_b, corner_c).first);
    let a = corner_a - base;
    let b = corner_b - base;
    let c = corner_c - base;
    // Order the corners along the longest side.
    let ab = dot(b - a, b - a);
    let bc = dot(c - b, c - b);
    let ca = dot(a - c, a - c);
    var start = a;
    var end = b;
    var peak = c;
    if bc >= ab && bc >= ca { start = b; end = c; peak = a; }
    else if ca >= ab && ca >= bc { start = c; end = a; peak = b; }
    let along = end - start;
    let t_peak = clamp(dot(peak - start, along) / dot(along, along), 0.0, 1.0);
    let size = vec2i(target_map.width, target_map.height);
    let at_start = start + base;
    let at_end = end + base;
    // Walk from texel to texel; each texel takes the tent's share between the two crossings.
    let steps = select(vec2f(-1.0), vec2f(1.0), along > vec2f(0.0));
    let inverse = vec2f(
        select(1e30, 1.0 / along.x, abs(along.x) > 1e-12),
        select(1e30, 1.0 / along.y, abs(along.y) > 1e-12));
    let limit_low = vec2f(-1.0);
    let limit_high = vec2f(size);
    var cell = vec2i(floor(clamp(at_start, limit_low, limit_high)));
    let cell_end = vec2i(floor(clamp(at_end, limit_low, limit_high)));
    let crossings = abs(cell_end.x - cell.x) + abs(cell_end.y - cell.y);
    var before = 0.0;
    var beside = 0.0;
    for (var i = 0; i <= crossings; i++) {
        let edge = vec2f(cell) + select(vec2f(0.0), vec2f(1.0), steps > vec2f(0.0)) - base;
        let t_edge = (edge - start) * inverse;
        let x_open = cell.x != cell_end.x;
        let y_open = cell.y != cell_end.y;
        let by_x = x_open && (!y_open || t_edge.x <= t_edge.y);
        var t = 1.0;
        if i < crossings { t = clamp(select(t_edge.y, t_edge.x, by_x), 0.0, 1.0); }
        let below = max(tent_share_below(t, 0.0, t_peak, 1.0), before);
        beside += deposit_share(target_map, cell.x, cell.y, below - before, triangle_flux);
        before = below;
        if by_x { cell.x += i32(steps.x); } else { cell.y += i32(steps.y); }
    }
    return beside;
}
