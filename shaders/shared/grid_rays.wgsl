// The beams of the water grid without their hits.

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
@group(0) @binding(9) var<storage, read> beams: array<vec4f>;

fn grid_rays(cell: vec2u, half: u32) -> Beam {
    let side = light.cells + 1u;
    let corners = beam_corners(cell, half);
    var b: Beam;
    var transmittance = 0.0;
    for (var k = 0u; k < 3u; k++) {
        let ij = cell + corner_of(corners, k);
        let vertex = ij.y * side + ij.x;
        b.origin[k] = origin_at(vec2f(ij), surface[vertex].x);
        let ray = beams[vertex];
        b.direction[k] = ray.xyz;
        transmittance += ray.w;
    }
    b.unit_flux = triangle_unit_flux(b.origin, b.direction);
    b.transmitted = b.unit_flux * (transmittance / 3.0);
    return b;
}

// The same by beam index: two beams per cell, row by row.
fn numbered_rays(beam_index: u32) -> Beam {
    let cell = beam_index >> 1u;
    return grid_rays(vec2u(cell % light.cells, cell / light.cells), beam_index & 1u);
}
