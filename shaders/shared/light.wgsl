// The current beam set and the water it falls on; the uniform of all passes that trace a beam set.

struct Light {
    source: vec4f,             // sun: unit direction to it; point light: its position, local m
    extinction_per_m: vec4f,   // c per channel
    window_min: vec2f,         // lower corner of the grid, in units of grid_place()
    cell: vec2f,               // size of a grid cell, in the same units
    cells: u32,                // cells along each side of the window
    object_count: u32,
    has_floor: u32,
    ior: f32,
    flux_scale: f32,           // counts per unit flux (a sun's m², a point light's sr)
    energy_scale: f32,         // counts per unit flux in the energy account
    channels: u32,             // 1 if all channels have the same extinction, else 3
    split_levels: u32,
    layers: u32,               // receivers of an object: its surfaces along the light, nearest first
    wide_texels: u32,          // footprints with more texels than this are shared by several workgroups
    triangle_scale: f32,       // workgroup counts per unit flux in the energy account
    pad: u32,
    foot_m: vec2f,             // point light over the water: the local (x, z) around which the grid is finer; sun: 0
    bend_per_m2: f32,          // β of the grid's mapping: how fast cells grow with the distance from there, see vertex_m()
    kind: u32,                 // SUN, POINT or SUBMERGED
    objects_min_m: vec2f,      // lower corner of the water whose light can reach an object, local (x, z)
    objects_max_m: vec2f,      // its upper corner, below the lower one where no object is under water
}

const SUN: u32 = 0u;
const POINT: u32 = 1u;     // a point light over the water
const SUBMERGED: u32 = 2u; // a point light under it

@group(0) @binding(0) var<uniform> light: Light;

// The first of an object's receivers.
fn first_receiver_of(object: u32) -> u32 {
    return 1u + object * light.layers;
}

// Place of grid vertex (i, j), which need not be an integer, in the window. For a sun local (x, z) in m; for a point light over the water s,
// from which vertex_m() computes (x, z); for a light under water the argument of octahedral_direction().
fn grid_place(ij: vec2f) -> vec2f {
    return light.window_min + ij * light.cell;
}

// Local (x, z) of a grid vertex on the water.
fn vertex_m(ij: vec2f) -> vec2f {
    let s = grid_place(ij);
    return light.foot_m + s * (1.0 + light.bend_per_m2 * s * s);
}

// Start of the ray of a grid vertex, where the water has height `height_m`.
fn origin_at(ij: vec2f, height_m: f32) -> vec3f {
    if light.kind == SUBMERGED { return light.source.xyz; }
    let xz = vertex_m(ij);
    return vec3f(xz.x, height_m, xz.y);
}

// Whether the water absorbs or scatters any light; if false no exponential is computed.
override ATTENUATES: bool = true;

// Whether meshes are lit by reference planes instead of by hits; hits then only decide which light is left for the floor.
override PLANES: bool = false;

// Transmission per channel along the path lengths of a triangle's corners, as their mean.
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
