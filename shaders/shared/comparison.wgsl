// What the estimate compares: places of the maps, spread over them, some to a workgroup. Two passes go over the same places.

struct Comparison {
    fine_width: u32,
    fine_height: u32,
    coarse_width: u32,
    coarse_height: u32,
    first_fine: u32,   // first texel in `irradiance`
    first_coarse: u32, // first texel in the flux sums of the coarse light
    receiver: u32,     // that the coarse map is of
    blocks: u32,       // 1: whole blocks of fine texels against coarse ones; 0: fine texels against the coarse map between its texels
    first_group: u32,  // first workgroup
    places: u32,       // how many of those blocks or texels are looked at
    one_in: u32,       // one in so many of them, anywhere among these
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

// Where place `i` of an invocation stands among those of all workgroups.
fn rank_of(number: u32, i: u32, invocation: u32) -> u32 {
    return (number * PLACES_EACH + i) * 64u + invocation;
}

// A number without pattern for each `i`, so that what is looked at does not keep step with waves: PCG as in Jarzynski and Olano,
// "Hash Functions for GPU Rendering", 2020.
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
