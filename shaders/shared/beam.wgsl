// A beam: a triangle of the water surface and the refracted rays at its corners.

struct Beam {
    unit_flux: f32,      // flux on the triangle from a light of unit power, see triangle_unit_flux()
    transmitted: f32,    // part of it that enters the water
    origin: mat3x3f,     // starts of the rays, local m
    direction: mat3x3f,  // unit directions of the rays
    uv: mat3x2f,         // ends of the rays, texels of the receiver's map
    t: vec3f,            // path lengths, m
    receiver: vec3i,
}
