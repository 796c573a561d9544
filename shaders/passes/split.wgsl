// Split — beams whose corners end on different receivers are halved `split_levels` times along each side, with rays of their
// own. Workgroups stride over the straddling beams of the grid.
#import "lib/turns.wgsl"
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/attenuation.wgsl"
#import "lib/coverage.wgsl"
#import "shared/light.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/trace_light.wgsl"
#import "shared/flux.wgsl"
#import "shared/footprint.wgsl"
#import "shared/beam_triangle.wgsl"
#import "shared/grid.wgsl"
#import "shared/account.wgsl"
#import "shared/queue.wgsl"

@group(0) @binding(6) var<storage, read> split_queue: array<u32>;

// Corner `k` of the beam, in cells.
fn beam_corner(cell: vec2u, half: u32, k: u32) -> vec2f {
    return vec2f(cell + corner_of(beam_corners(cell, half), k));
}

fn split_beam(corners: mat3x2f) -> Beam {
    var b: Beam;
    var transmittance = 0.0;
    for (var k = 0; k < 3; k++) {
        let xz = vertex_m(corners[k]);
        let water = water_surface_at(xz, light.wave_count);
        let normal = normal_from_slope(water.y, water.z);
        b.origin[k] = vec3f(xz.x, water.x, xz.y);
        b.direction[k] = refract_direction(-light.to_light.xyz, normal, light.ior).xyz;
        transmittance += fresnel_transmittance(dot(normal, light.to_light.xyz), light.ior);
        let hit = trace_light(b.origin[k], b.direction[k], light.receiver_count, light.has_floor == 1u);
        b.uv[k] = hit.uv;
        b.t[k] = hit.t;
        b.receiver[k] = hit.receiver;
    }
    b.flux_m2 = triangle_flux_m2(b.origin[0], b.origin[1], b.origin[2]);
    b.transmitted_m2 = b.flux_m2 * (transmittance / 3.0);
    return b;
}

// One of the small triangles of a beam.
fn split_part(cell: vec2u, half: u32, n: u32) -> Losses {
    let side = 1u << light.split_levels;
    let c0 = beam_corner(cell, half, 0u);
    let e1 = (beam_corner(cell, half, 1u) - c0) / f32(side);
    let e2 = (beam_corner(cell, half, 2u) - c0) / f32(side);
    // Row r of the divided triangle holds 2 (side − r) − 1 small ones; n counts them through: n = r (2 side − r) + k.
    let row = side - 1u - u32(floor(sqrt(f32(side * side - 1u - n) + 0.5)));
    let k = n - row * (2u * side - row);
    let base = c0 + e1 * f32(k >> 1u) + e2 * f32(row);
    var corners = mat3x2f(base, base + e1, base + e2);
    if (k & 1u) == 1u { corners = mat3x2f(base + e1, base + e1 + e2, base + e2); }
    let b = split_beam(corners);
    if b.transmitted_m2 == 0.0 { return Losses(0.0, vec3f(0.0), vec3f(0.0)); }
    if !is_whole(b) { return deposit_torn(b); }
    if b.receiver.x == NO_RECEIVER { return Losses(b.transmitted_m2, vec3f(0.0), vec3f(0.0)); }
    return deposit_whole(b);
}

@compute @workgroup_size(64)
fn split_main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let count = split_queue[QUEUE_COUNT];
    for (var item = group.x; item < count; item += groups.x) {
        let beam_index = split_queue[QUEUE_HEAD + item];
        let cell_index = beam_index >> 1u;
        let cell = vec2u(cell_index % light.cells, cell_index / light.cells);
        for (var n = invocation; n < (1u << (2u * light.split_levels)); n += 64u) {
            // Noted one by one: floats added up over several beams would depend on the queue's order.
            note_losses(split_part(cell, beam_index & 1u, n));
        }
    }
    workgroupBarrier();
    flush_account(invocation);
}
