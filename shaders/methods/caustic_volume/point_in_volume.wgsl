// Point in volume — light at points from the caustic volumes around them (Sandberg & Falemo 2005, §3.3, §3.4). One invocation per point of a
// band.
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "shared/points.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/volumes.wgsl"
#import "shared/volume_cut.wgsl"
#import "shared/volume_search.wgsl"
#import "shared/blocked_way.wgsl"

struct VolumeDensity {
    is_linear: u32, // whether it is taken linearly between the corners of a cut
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(2) var<uniform> volume_density: VolumeDensity;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m²

// Density at a vertex: the flux of the volumes around it over the sum of their cuts. Taken linearly between the corners of each cut, it gives
// the same flux in all as the volumes carry.
fn density_at(vertex: u32) -> f32 {
    let side = light.cells + 1u;
    let ij = vec2u(vertex % side, vertex / side);
    var flux = 0.0;
    var double_area = 0.0;
    for (var i = 0u; i < 4u; i++) {
        // Unsigned numbers below 0 wrap, and are beyond the grid like those above it.
        let cell = ij - vec2u(i & 1u, i >> 1u);
        if any(cell >= vec2u(light.cells)) { continue; }
        for (var half = 0u; half < 2u; half++) {
            let vertices = vertices_of(cell, half);
            let own = volume_flux[2u * (cell.y * light.cells + cell.x) + half];
            if own == 0.0 || !any(vertices == vec3u(vertex)) { continue; }
            let a = aside_m(vertices.x);
            let ab = aside_m(vertices.y) - a;
            let ac = aside_m(vertices.z) - a;
            flux += own;
            double_area += abs(ab.x * ac.y - ab.y * ac.x);
        }
    }
    if double_area < LEAST_DOUBLE_AREA_M2 { return 0.0; }
    return 2.0 * flux / double_area;
}

// Whether an object blocks the way from the point to where its light enters the water.
fn is_blocked(entry_m: vec3f, path_m: f32) -> bool {
    return is_way_blocked(seen, entry_m, path_m, select(0u, volumes.instance_count, volumes.has_shadows == 1u));
}

// Light of volume `k` of a block, in whose cut the point lies, W/m².
fn light_of(block: vec2u, k: u32) -> vec3f {
    let cell = cell_in(block, k);
    let vertices = vertices_of(cell, k & 1u);
    let cut = cut_of(vertices);
    // Computed again, so it may differ in the last digit from what holds() has found.
    let double_area = double_area_of(cut);
    if abs(double_area) < LEAST_DOUBLE_AREA_M2 { return vec3f(0.0); }
    let weights = cut.double_areas / double_area;
    let arrival = arrival_of(vertices, weights);
    let path_m = max(arrival.path_m, 0.0);
    let cosine = turned_to(arrival);
    if cosine <= 0.0 || is_blocked(arrival.entry_m, path_m) { return vec3f(0.0); }
    var density = 2.0 * flux_of(cell, k & 1u) / abs(double_area);
    if volume_density.is_linear == 1u { density = 0.0; }
    for (var i = 0u; i < 3u * volume_density.is_linear; i++) { density += weights[i] * density_at(vertices[i]); }
    var left = vec3f(1.0);
    if ATTENUATES {
        for (var c = 0; c < 3; c++) { left[c] = transmission(light.extinction_per_m[c], path_m); }
    }
    return volumes.power.xyz * left * (density * cosine);
}

@compute @workgroup_size(8, 8)
fn point_in_volume_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= volumes.width || id.y >= volumes.row_count { return; }
    let index = id.y * volumes.width + id.x;
    if !begin_search(index) { return; }
    var sum = vec3f(0.0);
    while search.is_open {
        var held = held_in_next_block();
        while held != 0u {
            sum += light_of(search.block, firstTrailingBit(held));
            held &= held - 1u;
        }
    }
    point_irradiance[index] += vec4f(sum, 0.0);
}
