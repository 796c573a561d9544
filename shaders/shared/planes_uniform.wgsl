// The object and the planes at work, of the passes that place light by planes.

struct Planes {
    receiver: u32,  // the object's first receiver
    object: u32,
    planes: u32,    // that were asked for
    list: u32,      // first word of the object's planes in `plane_lists`
    plane: u32,     // the sample plane at work (volumetric)
    scratch: u32,   // first texel of that plane's caustics map in `flux` (volumetric)
    capacity: u32,  // beams that the queue holds: all
    smart: u32,     // 1: planes without a surface near them are left out
}

@group(0) @binding(16) var<uniform> planes: Planes;
