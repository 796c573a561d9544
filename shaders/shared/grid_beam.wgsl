// The beams of the water grid, loaded from the results of earlier passes.

@group(0) @binding(10) var<storage, read> hits: array<vec4f>;

fn grid_beam(cell: vec2u, half: u32) -> Beam {
    let side = light.cells + 1u;
    let corners = beam_corners(cell, half);
    var b = grid_rays(cell, half);
    for (var k = 0u; k < 3u; k++) {
        let ij = cell + corner_of(corners, k);
        let hit = hits[ij.y * side + ij.x];
        b.uv[k] = hit.xy;
        b.t[k] = hit.z;
        b.receiver[k] = i32(hit.w);
    }
    return b;
}
