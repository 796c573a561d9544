// Footprints of very many texels, shared out over lanes.

// Twice the area / longest side² under which a footprint is thin: from there on f32 rounding in areas, about 10⁻⁷ side², is more than
// 10⁻⁶ of the whole.
const THIN_SHAPE: f32 = 0.05;

// Whether a footprint is too thin for its texels' areas to be told from rounding.
fn is_thin(uv: mat3x2f) -> bool {
    let e1 = uv[1] - uv[0];
    let e2 = uv[2] - uv[0];
    return abs(e1.x * e2.y - e1.y * e2.x) < THIN_SHAPE * max(dot(e1, e1), max(dot(e2, e2), dot(e2 - e1, e2 - e1)));
}

// One lane's part of a wide footprint that is no segment: rows `lane`, `lane + lanes` … of a thin one, else texels. Returns the share
// beside the map.
fn deposit_wide_area(target_map: Target, uv: mat3x2f, arriving: vec3f, lane: u32, lanes: u32) -> f32 {
    if is_thin(uv) { return deposit_rows(target_map, uv, arriving, lane, lanes); }
    return deposit_texels(target_map, uv, arriving, lane, lanes);
}

// Rounding makes the areas right of neighbouring columns go up and down; only who walks along the row can make them fall, and that
// all shares together are 1.
fn deposit_rows(target_map: Target, uv: mat3x2f, arriving: vec3f, first: u32, stride: u32) -> f32 {
    let f = footprint_of(target_map, uv[0], uv[1], uv[2]);
    let rows = u32(f.box.last.y - f.box.first.y + 1);
    var beside = 0.0;
    for (var row = first; row < rows; row += stride) {
        beside += deposit_row(target_map, f, f.box.first.y + i32(row), arriving);
    }
    return beside;
}

// Every texel's share by its area. Everything is counted from the texel: neighbouring beams then round alike and leave no seam.
fn deposit_texels(target_map: Target, uv: mat3x2f, arriving: vec3f, first: u32, stride: u32) -> f32 {
    let size = vec2i(target_map.width, target_map.height);
    let box = texel_box(target_map, uv[0], uv[1], uv[2]);
    let extent = box.last - box.first + 1;
    let count = u32(extent.x) * u32(extent.y);
    let e1 = uv[1] - uv[0];
    let e2 = uv[2] - uv[0];
    let per_area = 2.0 / (e1.x * e2.y - e1.y * e2.x);
    var beside = 0.0;
    for (var i = first; i < count; i += stride) {
        let texel = box.first + vec2i(i32(i) % extent.x, i32(i) / extent.x);
        beside += deposit_share(target_map, texel.x, texel.y, texel_share(uv, size, texel, per_area), arriving);
    }
    return beside;
}

fn texel_share(uv: mat3x2f, size: vec2i, texel: vec2i, per_area: f32) -> f32 {
    let base = vec2f(texel);
    let p = uv[0] - base;
    let q = uv[1] - base;
    let s = uv[2] - base;
    let low = min(p, min(q, s));
    let high = max(p, max(q, s));
    let row = cell_bounds(texel.y, size.y, base.y, low.y, high.y);
    let column = cell_bounds(texel.x, size.x, base.x, low.x, high.x);
    let edges = clip_to_row(p, q, s, row.x, row.y);
    if column.y < row_low(edges) || column.x > row_high(edges) { return 0.0; }
    return max(area_within(moved(edges, column.x), column.y - column.x) * per_area, 0.0);
}
