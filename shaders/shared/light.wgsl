// The light of one frame step and the water it falls on; the uniform of all passes that follow a light.

struct Light {
    to_light: vec4f,           // unit direction to the sun
    extinction_per_m: vec4f,   // c per channel
    window_min_m: vec2f,       // lower corner of the simulated water, local (x, z)
    cell_m: vec2f,             // size of a water cell
    cells: u32,                // cells along each side of the window
    wave_count: u32,
    object_count: u32,
    has_floor: u32,
    ior: f32,
    flux_scale: f32,           // counts per m² of flux at unit irradiance
    energy_scale: f32,         // counts per m² in the energy account
    channels: u32,             // 1 when all channels fade alike, else 3
    split_levels: u32,
    layers: u32,               // receivers of an object: its surfaces along the light, nearest first
    wide_texels: u32,          // footprints with more texels than this go to a workgroup of their own
    triangle_scale: f32,       // workgroup counts per m² in the energy account
}

@group(0) @binding(0) var<uniform> light: Light;

// The first of an object's receivers.
fn first_receiver_of(object: u32) -> u32 {
    return 1u + object * light.layers;
}

// Local (x, z) of grid vertex (i, j), which need not be whole.
fn vertex_m(ij: vec2f) -> vec2f {
    return light.window_min_m + ij * light.cell_m;
}

// Whether any light is lost on its way; without it no exponential is computed.
override ATTENUATES: bool = true;

// Whether meshes get their light by reference planes instead of by hits: rays then only tell what is left for the floor.
override PLANES: bool = false;

// Flux into a triangle of water under unit irradiance, m²: its area as the sun sees it; 0 where it looks away.
fn triangle_flux_m2(a: vec3f, b: vec3f, c: vec3f) -> f32 {
    return max(0.5 * dot(cross(c - a, b - a), light.to_light.xyz), 0.0);
}

// Mean over a triangle's corners of what is left, per channel, after the corners' path lengths.
fn mean_transmission(lengths_m: vec3f) -> vec3f {
    if !ATTENUATES { return vec3f(1.0); }
    var left = vec3f(0.0);
    for (var i = 0; i < 3; i++) {
        let c = light.extinction_per_m[i];
        left[i] = (transmission(c, lengths_m.x) + transmission(c, lengths_m.y) + transmission(c, lengths_m.z)) / 3.0;
    }
    return left;
}

fn mean_extinction(lengths_m: vec3f) -> vec3f {
    if !ATTENUATES { return vec3f(0.0); }
    var lost = vec3f(0.0);
    for (var i = 0; i < 3; i++) {
        let c = light.extinction_per_m[i];
        lost[i] = (extinction(c, lengths_m.x) + extinction(c, lengths_m.y) + extinction(c, lengths_m.z)) / 3.0;
    }
    return lost;
}
