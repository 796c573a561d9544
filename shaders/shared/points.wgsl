// Points: what pixels see, or where the texels of a map lie.

struct Point {
    position_m: vec3f,  // local
    receiver: f32,      // −1 nothing; under water 0 the floor, k object k − 1; above it −2 − k
    normal: vec3f,      // unit, towards the viewer; of a texel out of the surface
    footprint_m: f32,   // side of a square as large as what the pixel or texel shows, across the ray or the map's axis
}
