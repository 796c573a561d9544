// The current object and planes; the uniform of the passes that place light by planes.

struct Planes {
    receiver: u32,  // the object's first receiver
    object: u32,
    planes: u32,    // number of requested planes
    list: u32,      // first word of the object's planes in `plane_lists`
    plane: u32,     // the current plane (volumetric)
    scratch: u32,   // first texel of that plane's caustics map in `flux` (volumetric)
    capacity: u32,  // capacity of the queue: the number of all beams
    smart: u32,     // 1: planes without a surface near them are skipped
}

@group(0) @binding(16) var<uniform> planes: Planes;
