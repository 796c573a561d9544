// Converts flux sums to W/m²; shared by the passes that finish a light's maps.

struct Resolve {
    power: vec4f,          // sun: irradiance of a plane facing it, W/m²; point light: intensity, W/sr
    first_texel: u32,      // range of the flux sums
    texel_count: u32,
    first_output: u32,     // first texel in the irradiance array
    adds: u32,             // 1: add to the old value
    density_per_flux: f32, // for a range that is one map, 1/m²
    receiver_count: u32,   // for a range that holds the maps of receivers 1 … this, one behind the other; else 0
    pad_0: u32,
    pad_1: u32,
}

@group(0) @binding(13) var<uniform> resolve: Resolve;

// 1 / (area of the texel with index `texel` in the flux sums, m²).
fn density_at(texel: u32) -> f32 {
    if resolve.receiver_count == 0u { return resolve.density_per_flux; }
    // The last receiver whose map begins at or before `texel`. A dry object's map has no texels, so the next map begins at the same place.
    var low = 1u;
    var high = resolve.receiver_count;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if receivers[middle].map_offset <= texel { low = middle; } else { high = middle - 1u; }
    }
    return receivers[low].density_per_flux;
}

// Irradiance of texel `index` of the range from the light, W/m².
fn resolved_w_m2(index: u32) -> vec3f {
    let texel = resolve.first_texel + index;
    return flux_colour(texel, light.channels) * (density_at(texel) / light.flux_scale) * resolve.power.xyz;
}
