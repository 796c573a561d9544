// The places at which the estimate compares maps, spread over them; each workgroup takes several. Two passes process the same places.

struct Comparison {
    fine_width: u32,
    fine_height: u32,
    coarse_width: u32,
    coarse_height: u32,
    first_fine: u32,   // first texel in `irradiance`
    first_coarse: u32, // first texel in the flux sums of the coarse beam set
    receiver: u32,     // receiver of the coarse map
    blocks: u32,       // 1: whole blocks of fine texels are compared with coarse texels; 0: fine texels with the interpolated coarse map
    first_group: u32,  // first workgroup
    places: u32,       // number of blocks or texels that are compared
    one_in: u32,       // one of each `one_in` consecutive blocks or texels is compared, chosen at random
    pad: u32,
}

// In the order of their workgroups.
@group(0) @binding(14) var<storage, read> comparisons: array<Comparison>;

const PLACES_EACH: u32 = 2u;

// The comparison that a workgroup belongs to, of `count`.
fn comparison_of(number: u32, count: u32) -> Comparison {
    var low = 0u;
    var high = count - 1u;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if comparisons[middle].first_group <= number { low = middle; } else { high = middle - 1u; }
    }
    return comparisons[low];
}

// Index of place `i` of an invocation among the places of all workgroups.
fn rank_of(number: u32, i: u32, invocation: u32) -> u32 {
    return (number * PLACES_EACH + i) * 64u + invocation;
}

// A hash of `i`, so that the compared places do not align with waves: PCG as in Jarzynski and Olano, "Hash Functions for GPU Rendering",
// 2020.
fn scattered(i: u32) -> u32 {
    let state = i * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// The (x, y) of place number `nth` of a comparison: a coarse texel, or a fine one where `blocks` is 0.
fn place_of(c: Comparison, nth: u32) -> vec2u {
    let size = select(vec2u(c.fine_width, c.fine_height), vec2u(c.coarse_width, c.coarse_height), c.blocks == 1u);
    let place = min(nth * c.one_in + scattered(nth) % c.one_in, size.x * size.y - 1u);
    return vec2u(place % size.x, place / size.x);
}
