// Footprints of very many texels, distributed over lanes.

// Deposits texels `first`, `first + stride` … of a wide footprint's box by their areas; returns the share outside the map.
//
// Coordinates are relative to the texel: neighbouring beams then round in the same way and leave no seam, and rounding errors are small
// relative to the texel, not to the footprint.
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

// Share of the footprint's area that lies in a texel.
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
