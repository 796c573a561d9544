// A beam: the triangle of water it comes through and the rays under its corners.

struct Beam {
    unit_flux: f32,      // what falls on the triangle from a light of unit power, see triangle_unit_flux()
    transmitted: f32,    // what of it goes under water
    origin: mat3x3f,     // where the rays start, local m
    direction: mat3x3f,  // unit directions under them
    uv: mat3x2f,         // where they end, texels of the receiver's map
    t: vec3f,            // path lengths, m
    receiver: vec3i,
}
