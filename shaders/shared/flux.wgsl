// Sums of flux as 64-bit fixed point in pairs of u32 (low, high): integer additions commute, so the same request gives the
// same bytes, and the high word cannot run over (2³¹ counts at most per deposit, fewer than 2³² deposits).

@group(0) @binding(4) var<storage, read_write> flux: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> energy: array<atomic<u32>>;

// Terms of the energy account; one (low, high) pair per term and channel, see Slot::Energy.
const TERM_EMITTED: u32 = 0u;
const TERM_REFLECTED: u32 = 1u;
const TERM_MISSED: u32 = 2u;
const TERM_EXTINGUISHED: u32 = 3u;
const TERM_LEFT: u32 = 6u;
const TERM_LANDED: u32 = 9u;
const TERM_OVERFLOWS: u32 = 12u; // deposits too large for the fixed point: an error if it ever counts
const TERM_TORN: u32 = 13u;      // flux of beams that straddle receivers to the end
const TERM_TORN_COUNT: u32 = 14u; // how many those are

const MAX_DEPOSIT: f32 = 2147483000.0;

fn add_flux(texel: u32, channel: u32, channels: u32, counts: f32) {
    let whole = u32(min(counts + 0.5, MAX_DEPOSIT));
    if whole == 0u { return; }
    if counts > MAX_DEPOSIT { atomicAdd(&energy[2u * TERM_OVERFLOWS], 1u); }
    let word = 2u * (texel * channels + channel);
    let before = atomicAdd(&flux[word], whole);
    if before + whole < before { atomicAdd(&flux[word + 1u], 1u); }
}

// Adds `counts` (0 … 2⁶²) to a term.
fn add_energy(term: u32, counts: f32) {
    let high = u32(floor(counts / 4294967296.0));
    let low = u32(clamp(counts - f32(high) * 4294967296.0, 0.0, 4294967040.0));
    let before = atomicAdd(&energy[2u * term], low);
    let carry = select(0u, 1u, before + low < before);
    if high + carry > 0u { atomicAdd(&energy[2u * term + 1u], high + carry); }
}
