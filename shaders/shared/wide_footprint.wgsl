// Footprints of very many texels, shared out over lanes.

// Deposits texels `first`, `first + stride` … of a wide footprint's box; returns the share beside the map. As in `deposit_area` a row's
// share comes from the corners' heights, and columns take theirs by area. All texels of a row, and all beams, see the same crossings
// of an edge and a row, so that parts add up to the whole and neighbours leave no seam; each texel counts from itself, so that over
// a long edge no digits are lost.
fn deposit_texels(target_map: Target, uv: mat3x2f, arriving: vec3f, first: u32, stride: u32) -> f32 {
    let size = vec2i(target_map.width, target_map.height);
    let box = texel_box(target_map, uv[0], uv[1], uv[2]);
    let extent = box.last - box.first + 1;
    let count = u32(extent.x) * u32(extent.y);
    let low = min(uv[0], min(uv[1], uv[2]));
    let high = max(uv[0], max(uv[1], uv[2]));
    let middle_y = max(min(uv[0].y, uv[1].y), min(max(uv[0].y, uv[1].y), uv[2].y));
    let e1 = uv[1] - uv[0];
    let e2 = uv[2] - uv[0];
    let turn = sign(e1.x * e2.y - e1.y * e2.x);
    var beside = 0.0;
    for (var i = first; i < count; i += stride) {
        let texel = box.first + vec2i(i32(i) % extent.x, i32(i) / extent.x);
        let row = cell_bounds(texel.y, size.y, 0.0, low.y, high.y);
        let column = cell_bounds(texel.x, size.x, 0.0, low.x, high.x);
        let edges = clip_to_row(uv[0], uv[1], uv[2], row.x, row.y);
        let start = row_low(edges);
        if column.y < start || column.x > row_high(edges) { continue; }
        let row_area = turn * area_right_of(moved(edges, start), 0.0);
        let area = turn * area_within(moved(edges, column.x), column.y - column.x);
        let row_share = tent_share_between(row.x, row.y, low.y, middle_y, high.y);
        beside += deposit_share(target_map, texel.x, texel.y, row_share * clamp(area / max(row_area, FLAT_ROW), 0.0, 1.0), arriving);
    }
    return beside;
}
