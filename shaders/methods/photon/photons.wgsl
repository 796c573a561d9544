// Photons — light from each cell of the water to where it ends (Mihálik 2008, §8.1). One invocation per photon.
#import "lib/turns.wgsl"
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/attenuation.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/flux.wgsl"
#import "shared/light_view.wgsl"
#import "shared/image_space_search.wgsl"

// Per photon: its place on the map (texels), the flux that enters the water (m² under 1 W/m²; 0 if the photon ends on no texel), its path
// under water (m).
@group(0) @binding(7) var<storage, read_write> photons: array<vec4f>;

// Texels of the view by which an end may lie off the surface shown there.
const SHOWN_TEXELS: f32 = 3.0;

// The workgroup's account, by the terms' numbers.
var<workgroup> terms: array<atomic<u32>, 14>;

struct Start {
    u: vec3f,         // on the water
    r: vec3f,         // unit direction under it
    unit_flux: f32,   // on the cell, m² under 1 W/m²
    entering: f32,    // part of it that enters the water
}

fn start_of(index: u32) -> Start {
    let cell = vec2f(f32(index % light_view.cells), f32(index / light_view.cells)) + 0.5;
    let xz = light_view.water_min_m + cell * light_view.water_cell_m;
    let water = water_surface_at(xz);
    let to_light = light_view.to_light.xyz;
    let normal = normal_from_slope(water.y, water.z);
    let refracted = refract_direction(-to_light, normal, light_view.ior);
    let unit_flux = light_view.water_cell_m.x * light_view.water_cell_m.y * max(to_light.y - dot(water.yz, to_light.xz), 0.0);
    let entering = unit_flux * fresnel_transmittance(dot(normal, to_light), light_view.ior);
    return Start(vec3f(xz.x, water.x, xz.y), refracted.xyz, unit_flux, entering);
}

// The first receiver in the scene itself.
fn true_end(u: vec3f, r: vec3f) -> End {
    var t_floor = VERY_FAR_M;
    if light_view.has_floor == 1u && r.y < 0.0 { t_floor = max((light_view.bottom_y_m - u.y) / r.y, 0.0); }
    let t = trace_objects(light_view.object_count, u, r, 0.0, t_floor).t;
    let w = u + r * t;
    return End(t, length(shown_at(w) - w), t >= VERY_FAR_M);
}

fn note(term: u32, unit_flux: f32) {
    let counts = u32(unit_flux * light_view.term_scale + 0.5);
    if counts > 0u { atomicAdd(&terms[term], counts); }
}

// Notes what becomes of a photon's flux, and returns its record.
fn record(s: Start, end: End) -> vec4f {
    note(TERM_EMITTED, s.unit_flux);
    note(TERM_REFLECTED, s.unit_flux - s.entering);
    if end.is_empty {
        note(TERM_MISSED, s.entering);
        return vec4f(0.0);
    }
    // Water whose surface lies below the floor has no depth.
    let path_m = max(end.t, 0.0);
    let w = s.u + s.r * end.t;
    let uv = map_place(w);
    let is_on_map = is_within(uv);
    let texel = light_view.view_texel_m;
    let is_shown = end.gap_m <= SHOWN_TEXELS * max(texel.x, texel.y);
    for (var c = 0u; c < light_view.channels; c++) {
        let extinction_per_m = light_view.extinction_per_m[c];
        note(TERM_EXTINGUISHED + c, s.entering * extinction(extinction_per_m, path_m));
        let left = s.entering * transmission(extinction_per_m, path_m);
        if !is_on_map { note(TERM_LEFT + c, left); } else if is_shown { note(TERM_LANDED + c, left); }
    }
    if !is_on_map { return vec4f(0.0); }
    if !is_shown {
        note(TERM_UNRESOLVED, s.entering);
        atomicAdd(&terms[TERM_UNRESOLVED_COUNT], 1u);
    }
    return vec4f(uv, s.entering, path_m);
}

fn flush(term: u32) {
    let counts = atomicLoad(&terms[term]);
    if term == TERM_UNRESOLVED_COUNT {
        if counts > 0u { add_energy(term, f32(counts)); }
        return;
    }
    // Both scales are powers of two and each half fits f32: nothing is rounded.
    let scale = light_view.energy_scale / light_view.term_scale;
    if counts >= 65536u { add_energy(term, f32(counts & 0xffff0000u) * scale); }
    if counts > 0u { add_energy(term, f32(counts & 0xffffu) * scale); }
}

fn number_of(group: vec3u, groups: vec3u, invocation: u32) -> u32 {
    return (group.y * groups.x + group.x) * 64u + invocation;
}

@compute @workgroup_size(64)
fn photons_in_image_space(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let index = number_of(group, groups, invocation);
    if index < light_view.cells * light_view.cells {
        let s = start_of(index);
        var photon = vec4f(0.0);
        if s.unit_flux > 0.0 { photon = record(s, search(s.u, s.r)); }
        photons[index] = photon;
    }
    workgroupBarrier();
    if invocation < 14u { flush(invocation); }
}

@compute @workgroup_size(64)
fn photons_exact(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) invocation: u32) {
    let index = number_of(group, groups, invocation);
    if index < light_view.cells * light_view.cells {
        let s = start_of(index);
        var photon = vec4f(0.0);
        if s.unit_flux > 0.0 { photon = record(s, true_end(s.u, s.r)); }
        photons[index] = photon;
    }
    workgroupBarrier();
    if invocation < 14u { flush(invocation); }
}
