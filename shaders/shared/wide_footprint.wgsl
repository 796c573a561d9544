// Footprints of very many texels, shared out over lanes.

// Twice the area / longest side² under which a footprint is thin: from there on f32 rounding in areas, about 10⁻⁷ side², is more than
// 10⁻⁶ of the whole.
const THIN_SHAPE: f32 = 0.05;

// Deposits texels `first`, `first + stride` … of a wide footprint's box; returns the share beside the map.
fn deposit_texels(target_map: Target, uv: mat3x2f, arriving: vec3f, first: u32, stride: u32) -> f32 {
    let size = vec2i(target_map.width, target_map.height);
    let box = texel_box(target_map, uv[0], uv[1], uv[2]);
    let extent = box.last - box.first + 1;
    let count = u32(extent.x) * u32(extent.y);
    let e1 = uv[1] - uv[0];
    let e2 = uv[2] - uv[0];
    let twice_area = e1.x * e2.y - e1.y * e2.x;
    let is_thin = abs(twice_area) < THIN_SHAPE * max(dot(e1, e1), max(dot(e2, e2), dot(e2 - e1, e2 - e1)));
    var beside = 0.0;
    for (var i = first; i < count; i += stride) {
        let texel = box.first + vec2i(i32(i) % extent.x, i32(i) / extent.x);
        var share = 0.0;
        if is_thin {
            share = thin_share(uv, box, size, texel, sign(twice_area));
        } else {
            share = full_share(uv, size, texel, 2.0 / twice_area);
        }
        beside += deposit_share(target_map, texel.x, texel.y, share, arriving);
    }
    return beside;
}

// Share of a texel by its area. Everything is counted from the texel: neighbouring beams then round alike and leave no seam.
fn full_share(uv: mat3x2f, size: vec2i, texel: vec2i, per_area: f32) -> f32 {
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

// Share of a texel of a thin footprint. As in `deposit_area` its row's share comes from the corners' heights, and what lies right of
// a column's borders deals it out: neighbours count the same border with the same numbers, so that all shares together are 1.
fn thin_share(uv: mat3x2f, box: TexelBox, size: vec2i, texel: vec2i, turn: f32) -> f32 {
    let low = min(uv[0], min(uv[1], uv[2]));
    let high = max(uv[0], max(uv[1], uv[2]));
    let middle_y = max(min(uv[0].y, uv[1].y), min(max(uv[0].y, uv[1].y), uv[2].y));
    let row = cell_bounds(texel.y, size.y, 0.0, low.y, high.y);
    let column = cell_bounds(texel.x, size.x, 0.0, low.x, high.x);
    let edges = clip_to_row(uv[0], uv[1], uv[2], row.x, row.y);
    let start = row_low(edges);
    let end = row_high(edges);
    let row_share = tent_share_between(row.x, row.y, low.y, middle_y, high.y);
    let near = moved(edges, start);
    let row_area = turn * area_right_of(near, 0.0);
    if row_area < FLAT_ROW {
        return select(0.0, row_share, texel.x == clamp(i32(floor(start)), box.first.x, box.last.x));
    }
    let left = select(clamp(turn * area_right_of(near, column.x - start), 0.0, row_area), row_area, column.x <= start);
    let right = select(clamp(turn * area_right_of(near, column.y - start), 0.0, row_area), 0.0, column.y >= end);
    return row_share * (max(left - right, 0.0) / row_area);
}
