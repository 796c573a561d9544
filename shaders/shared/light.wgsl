// The light of one frame step and the water it falls on; the uniform of all passes that follow a light.

struct Light {
    source: vec4f,             // of a sun the unit direction to it, of a point light its place, local m
    extinction_per_m: vec4f,   // c per channel
    window_min: vec2f,         // lower corner of the grid, in units of grid_place()
    cell: vec2f,               // size of a grid cell, in the same
    cells: u32,                // cells along each side of the window
    wave_count: u32,
    object_count: u32,
    has_floor: u32,
    ior: f32,
    flux_scale: f32,           // counts per unit flux (a sun's m², a point light's sr)
    energy_scale: f32,         // counts per unit flux in the energy account
    channels: u32,             // 1 when all channels fade alike, else 3
    split_levels: u32,
    layers: u32,               // receivers of an object: its surfaces along the light, nearest first
    wide_texels: u32,          // footprints with more texels than this go to a workgroup of their own
    triangle_scale: f32,       // workgroup counts per unit flux in the energy account
    foot_m: vec2f,             // of a point light over the water: the local (x, z) around which the grid is finer; of a sun 0
    bend_per_m2: f32,          // how much coarser the grid gets with the distance from there
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

// Where grid vertex (i, j), which need not be whole, lies in the window: of a sun local (x, z) in m, of a point light over the water
// the same before it is spread out, of one under water a place for octahedral_direction().
fn grid_place(ij: vec2f) -> vec2f {
    return light.window_min + ij * light.cell;
}

// Local (x, z) of a grid vertex on the water.
fn vertex_m(ij: vec2f) -> vec2f {
    let s = grid_place(ij);
    return light.foot_m + s * (1.0 + light.bend_per_m2 * s * s);
}

// Where the ray of a grid vertex starts, under water of this height there.
fn origin_at(ij: vec2f, height_m: f32) -> vec3f {
    if light.kind == SUBMERGED { return light.source.xyz; }
    let xz = vertex_m(ij);
    return vec3f(xz.x, height_m, xz.y);
}

// Whether any light is lost on its way; without it no exponential is computed.
override ATTENUATES: bool = true;

// Whether meshes get their light by reference planes instead of by hits: rays then only tell what is left for the floor.
override PLANES: bool = false;

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
