// Unfollowed — flux on paths that are not simulated. One invocation per water cell. Slopes that face away from the light cast shadows on
// water that is lit all the same; rays through steep waves leave the water and enter it again; troughs bare the floor. No map depends on
// this pass: it only counts the flux for the energy account.
#import "lib/turns.wgsl"
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/attenuation.wgsl"
#import "lib/octahedral.wgsl"
#import "lib/solid_angle.wgsl"
#import "shared/light.wgsl"
#import "shared/entry.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/flux.wgsl"
#import "shared/beam.wgsl"
#import "shared/unit_flux.wgsl"
#import "shared/grid.wgsl"
#import "shared/grid_rays.wgsl"
#import "shared/grid_beam.wgsl"

struct Unfollowed {
    max_height_m: f32,
    max_slope: f32,
    least_step_m: f32, // a small part of the shortest wave; 0 if neither rays nor troughs are searched for
    floor_y_m: f32,    // far below where there is no floor
}

@group(0) @binding(13) var<uniform> unfollowed: Unfollowed;

// Steps are as long as the water's steepest slope allows, so rays are soon below its deepest trough. A ray that is not below it after these
// steps runs along the water, and counts as leaving it.
const MOST_STEPS: u32 = 512u;

// Whether a ray that entered the water at `origin` leaves it before `t_end`.
fn meets_water_again(origin: vec3f, direction: vec3f, t_end: f32) -> bool {
    let rate = abs(direction.y) + unfollowed.max_slope * length(direction.xz);
    var t = unfollowed.least_step_m;
    for (var i = 0u; i < MOST_STEPS; i++) {
        let p = origin + direction * t;
        if t >= t_end || p.y <= -unfollowed.max_height_m { return false; }
        let gap = water_surface_at(p.xz).x - p.y;
        if gap < 0.0 { return true; }
        t += max(gap / rate, unfollowed.least_step_m);
    }
    return true;
}

fn note_unfollowed(term: u32, unit_flux: f32) {
    if unit_flux > 0.0 { add_energy(term, unit_flux * light.energy_scale); }
}

@compute @workgroup_size(64)
fn unfollowed_main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let cell = group.xy * 8u + vec2u(invocation & 7u, invocation >> 3u);
    if any(cell >= vec2u(light.cells)) { return; }
    var transmitted = 0.0;
    var t_end = 0.0;
    for (var half = 0u; half < 2u; half++) {
        let b = grid_beam(cell, half);
        note_unfollowed(TERM_FACING_AWAY, -signed_unit_flux(b.origin, b.direction));
        transmitted += b.transmitted;
        t_end = max(t_end, max(b.t.x, max(b.t.y, b.t.z)));
    }
    if transmitted == 0.0 || unfollowed.least_step_m == 0.0 { return; }
    // The cell's centre represents the whole cell.
    let place = vec2f(cell) + 0.5;
    let entry = entry_at(place, water_surface_at(vertex_m(place)));
    if entry.transmittance == 0.0 { return; }
    if entry.origin.y < unfollowed.floor_y_m {
        note_unfollowed(TERM_BARED_FLOOR, transmitted);
    } else if meets_water_again(entry.origin, entry.direction, t_end) {
        note_unfollowed(TERM_LEAVING_AGAIN, transmitted);
    }
}
