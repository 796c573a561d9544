// Points: the places that pixels see, or where the texels of a map lie.

struct Point {
    position_m: vec3f,  // local
    receiver: f32,      // −1 nothing; under water 0 the floor, k object k − 1; above it −2 − k
    normal: vec3f,      // unit; for a pixel towards the viewer, for a texel out of the surface
    footprint_m: f32,   // side of a square with the area of the pixel or texel, perpendicular to the ray or the map's axis
}
