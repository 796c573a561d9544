// Fixed-point sums of flux: integer additions commute, so the same request gives the same bytes.
//
// One u32 per texel and channel holds 1024 times the flux of an evenly lit texel. If a focus exceeds that, the sum wraps and the landed
// flux is short by 2³² counts. The host detects that in the energy account and runs the beam set again with WIDE_SUMS: 64 bits in two
// words, which cannot overflow (at most 2⁴⁰ counts per beam). If u32 would be too coarse, the host starts with wide sums.

#import "shared/terms.wgsl"

override WIDE_SUMS: bool = false;

@group(0) @binding(4) var<storage, read_write> flux: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> energy: array<atomic<u32>>;

fn add_flux(texel: u32, channel: u32, channels: u32, counts: f32) {
    let place = texel * channels + channel;
    if !WIDE_SUMS {
        atomicAdd(&flux[place], u32(counts + 0.5));
        return;
    }
    // 4294967040 is the largest f32 below 2³².
    let high = u32(floor(counts / 4294967296.0));
    let low = u32(clamp(counts - f32(high) * 4294967296.0 + 0.5, 0.0, 4294967040.0));
    let before = atomicAdd(&flux[2u * place], low);
    let carry = select(0u, 1u, before + low < before);
    if high + carry > 0u { atomicAdd(&flux[2u * place + 1u], high + carry); }
}

// The sum of a texel and channel, in counts: low and high word.
fn flux_words(texel: u32, channel: u32, channels: u32) -> vec2u {
    let place = texel * channels + channel;
    if !WIDE_SUMS { return vec2u(atomicLoad(&flux[place]), 0u); }
    return vec2u(atomicLoad(&flux[2u * place]), atomicLoad(&flux[2u * place + 1u]));
}

fn flux_counts(texel: u32, channel: u32, channels: u32) -> f32 {
    let words = flux_words(texel, channel, channels);
    return f32(words.y) * 4294967296.0 + f32(words.x);
}

// The counts of a texel's three channels; with one channel all three are equal.
fn flux_colour(texel: u32, channels: u32) -> vec3f {
    var counts = vec3f(flux_counts(texel, 0u, channels));
    if channels == 3u {
        counts.y = flux_counts(texel, 1u, 3u);
        counts.z = flux_counts(texel, 2u, 3u);
    }
    return counts;
}

// Adds `counts` (0 … 2⁶²) to a term.
fn add_energy(term: u32, counts: f32) {
    let high = u32(floor(counts / 4294967296.0));
    let low = u32(clamp(counts - f32(high) * 4294967296.0, 0.0, 4294967040.0));
    let before = atomicAdd(&energy[2u * term], low);
    let carry = select(0u, 1u, before + low < before);
    if high + carry > 0u { atomicAdd(&energy[2u * term + 1u], high + carry); }
}
