// The beams of the water grid: two per cell. The diagonal alternates like a chessboard, so that turning the scene by a quarter
// turns the triangles with it (for an even number of cells).

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
@group(0) @binding(9) var<storage, read> beams: array<vec4f>;
@group(0) @binding(10) var<storage, read> hits: array<vec4f>;

fn corner_offset(odd: bool, half: u32, corner: u32) -> vec2u {
    // even: (00, 10, 11) (00, 11, 01); odd: (00, 10, 01) (10, 11, 01); packed as x + 2 z per corner.
    let even_corners = array<vec3u, 2>(vec3u(0u, 1u, 3u), vec3u(0u, 3u, 2u));
    let odd_corners = array<vec3u, 2>(vec3u(0u, 1u, 2u), vec3u(1u, 3u, 2u));
    var triple = even_corners[half];
    if odd { triple = odd_corners[half]; }
    let code = triple[corner];
    return vec2u(code & 1u, code >> 1u);
}

fn grid_beam(cell: vec2u, half: u32) -> Beam {
    let side = light.cells + 1u;
    let odd = ((cell.x + cell.y) & 1u) == 1u;
    var b: Beam;
    var transmittance = 0.0;
    for (var k = 0u; k < 3u; k++) {
        let ij = cell + corner_offset(odd, half, k);
        let vertex = ij.y * side + ij.x;
        let xz = vertex_m(vec2f(ij));
        b.origin[k] = vec3f(xz.x, surface[vertex].x, xz.y);
        let ray = beams[vertex];
        b.direction[k] = ray.xyz;
        transmittance += ray.w;
        let hit = hits[vertex];
        b.uv[k] = hit.xy;
        b.t[k] = hit.z;
        b.receiver[k] = i32(hit.w);
    }
    b.flux_m2 = triangle_flux_m2(b.origin[0], b.origin[1], b.origin[2]);
    b.transmitted_m2 = b.flux_m2 * (transmittance / 3.0);
    return b;
}
