// Volume bounds — the rays that bound the caustic volumes, the flux of each volume, and bounds over blocks of volumes, level by level.
#import "lib/solid_angle.wgsl"
#import "lib/octahedral.wgsl"
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "shared/beam.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid_rays.wgsl"
#import "shared/volumes.wgsl"

// Per vertex: foot (m) and drift (m per m of depth) along x and z. Unused, and 0, for a ray that does not fall.
@group(0) @binding(22) var<storage, read_write> volume_rays: array<vec4f>;
// Per volume: flux under the surface from a light of unit power; 0 where one of its rays does not fall.
@group(0) @binding(23) var<storage, read_write> volume_flux: array<f32>;
// Per block: least (x, z) of its rays at the top and at the bottom, then the largest. Rays are straight, so between the two depths their
// bounds are those on the straight line between these.
@group(0) @binding(24) var<storage, read_write> volume_bounds: array<vec4f>;

// Bounds of nothing; far outside any scene, but finite.
const NOTHING_LOW: vec4f = vec4f(1e30);
const NOTHING_HIGH: vec4f = vec4f(-1e30);

@compute @workgroup_size(64)
fn volume_rays_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let side = light.cells + 1u;
    let id = vertex_of(group, groups, invocation, side);
    if id.y >= side { return; }
    let vertex = id.y * side + id.x;
    let direction = beams[vertex].xyz;
    var ray = vec4f(0.0);
    if direction.y < -LEAST_FALL {
        let drift = direction.xz / -direction.y;
        ray = vec4f(vertex_m(vec2f(id)) + drift * surface[vertex].x, drift);
    }
    volume_rays[vertex] = ray;
}

// One invocation per block of level 0.
@compute @workgroup_size(8, 8)
fn volume_blocks_main(@builtin(global_invocation_id) id: vec3u) {
    let blocks = side_of(0u);
    if id.x >= blocks || id.y >= blocks { return; }
    let side = light.cells + 1u;
    var low = NOTHING_LOW;
    var high = NOTHING_HIGH;
    for (var i = 0u; i < BLOCK_CELLS * BLOCK_CELLS; i++) {
        let cell = BLOCK_CELLS * id.xy + vec2u(i % BLOCK_CELLS, i / BLOCK_CELLS);
        if any(cell >= vec2u(light.cells)) { continue; }
        for (var half = 0u; half < 2u; half++) {
            let b = grid_rays(cell, half);
            let falls = max(b.direction[0].y, max(b.direction[1].y, b.direction[2].y)) < -LEAST_FALL;
            let flux = select(0.0, b.transmitted, falls);
            volume_flux[2u * (cell.y * light.cells + cell.x) + half] = flux;
            if flux == 0.0 { continue; }
            let corners = beam_corners(cell, half);
            for (var k = 0u; k < 3u; k++) {
                let ij = cell + corner_of(corners, k);
                let ray = volume_rays[ij.y * side + ij.x];
                let ends = vec4f(ray.xy + ray.zw * volumes.top_m, ray.xy + ray.zw * volumes.bottom_m);
                low = min(low, ends);
                high = max(high, ends);
            }
        }
    }
    let at = 2u * (first_of(0u) + id.y * blocks + id.x);
    volume_bounds[at] = low;
    volume_bounds[at + 1u] = high;
}

// One invocation per block of a further level: joins four blocks of the level before.
@compute @workgroup_size(8, 8)
fn volume_levels_main(@builtin(global_invocation_id) id: vec3u) {
    let blocks = side_of(volumes.level);
    if id.x >= blocks || id.y >= blocks { return; }
    let finer = side_of(volumes.level - 1u);
    var low = NOTHING_LOW;
    var high = NOTHING_HIGH;
    for (var i = 0u; i < 4u; i++) {
        let child = 2u * id.xy + vec2u(i & 1u, i >> 1u);
        if any(child >= vec2u(finer)) { continue; }
        let source = 2u * (first_of(volumes.level - 1u) + child.y * finer + child.x);
        low = min(low, volume_bounds[source]);
        high = max(high, volume_bounds[source + 1u]);
    }
    let at = 2u * (first_of(volumes.level) + id.y * blocks + id.x);
    volume_bounds[at] = low;
    volume_bounds[at + 1u] = high;
}
