// The triangles of the water grid: two per cell. The diagonal alternates like a chessboard, so that turning the scene by a quarter
// turns the triangles with it (for an even number of cells).

// The vertex of an invocation in workgroups of 64: row by row, `side` vertices per row. Rows from `side` on do not exist.
fn vertex_of(group: vec3u, groups: vec3u, invocation: u32, side: u32) -> vec2u {
    let vertex = (group.y * groups.x + group.x) * 64u + invocation;
    return vec2u(vertex % side, vertex / side);
}

// The corners of a cell's half, two bits each: x + 2 z. Even cells: (00, 10, 11), (00, 11, 01); odd: (00, 10, 01), (10, 11, 01).
fn beam_corners(cell: vec2u, half: u32) -> u32 {
    let odd = ((cell.x + cell.y) & 1u) == 1u;
    return select(select(52u, 44u, half == 1u), select(36u, 45u, half == 1u), odd);
}

// Offset of corner `k` within the cell.
fn corner_of(corners: u32, k: u32) -> vec2u {
    let code = (corners >> (2u * k)) & 3u;
    return vec2u(code & 1u, code >> 1u);
}
