// Caustic volumes: the light between three neighbouring refracted rays (Sandberg & Falemo 2005, §3.2). They are cut with horizontal planes,
// on which a ray lies at `foot + drift · depth`, where `depth` is measured from the water at rest.

struct Volumes {
    power: vec4f,             // irradiance of the sun across its rays, W/m², or intensity of the point light, W/sr
    sides: array<vec4u, 3>,   // blocks along a side of the grid, per level; a block of level 0 has BLOCK_CELLS² cells, the last level one block
    firsts: array<vec4u, 3>,  // first block of each level in `volume_bounds`
    width: u32,               // points in a row
    row_count: u32,           // rows of the band
    instance_count: u32,
    level: u32,               // of the blocks to bound; for points, the last level
    has_shadows: u32,         // whether a ray looks for objects between the point and the water
    top_m: f32,               // depth of a plane above the crests, negative
    bottom_m: f32,            // depth of a plane below all receivers
    pad: u32,
}

@group(0) @binding(1) var<uniform> volumes: Volumes;

const BLOCK_CELLS: u32 = 2u;
// Rays that fall less than a metre per kilometre bound no volume: light's window leaves them out too.
const LEAST_FALL: f32 = 1e-3;

fn side_of(level: u32) -> u32 {
    return volumes.sides[level >> 2u][level & 3u];
}

fn first_of(level: u32) -> u32 {
    return volumes.firsts[level >> 2u][level & 3u];
}
