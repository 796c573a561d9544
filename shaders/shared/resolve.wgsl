// From flux sums to W/m²: what the passes that finish a sun's maps share.

struct Resolve {
    power: vec4f,          // of a sun the irradiance of a plane facing it, W/m²; of a point light its intensity, W/sr
    first_texel: u32,      // piece of the flux sums
    texel_count: u32,
    first_output: u32,     // first texel in the irradiance array
    adds: u32,             // 1: add to what is there
    density_per_flux: f32, // 1/m²
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(13) var<uniform> resolve: Resolve;

// Irradiance that texel `index` of the piece got from the light, W/m².
fn resolved_w_m2(index: u32, channel: u32) -> f32 {
    let carried = select(0u, channel, light.channels == 3u);
    let counts = flux_counts(resolve.first_texel + index, carried, light.channels);
    return counts * (resolve.density_per_flux / light.flux_scale) * resolve.power[channel];
}
