// Where the kept field of each beam set lies: its box and its resolution.

struct LightField {
    power: vec4f,          // sun: irradiance of a plane facing it, W/m²; point light: intensity, W/sr
    min_m: vec2f,          // lower corner of the box, local (x, z)
    texels_per_m: vec2f,   // along x and z
    bottom_m: f32,         // height of slice 0
    spacing_m: f32,        // distance of slices
    width: u32,            // texels of a slice along x
    height: u32,           // along z
    slices: u32,
    channels: u32,         // 1 if all channels are the same, else 3
    first_word: u32,       // place in `light_field`
    most_drift: f32,       // no ray drifts more, metres sideways per metre down
}

@group(0) @binding(26) var<storage, read> light_fields: array<LightField>;
