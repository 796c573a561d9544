//! Random numbers of seas: a fixed function of the seed and the wave, so that a wave keeps its height and phase whatever other waves there are.

/// Increment of SplitMix64: 2⁶⁴ divided by the golden ratio, odd.
const INCREMENT: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of SplitMix64. Source: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014; constants of
/// Stafford's variant 13.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Two random numbers of the wave (i, j): the first two of SplitMix64 from the state mix(mix(seed) + cell · increment), where the cell
/// has i in its upper and j in its lower 32 bits.
pub(super) fn pair(seed: u32, i: i32, j: i32) -> [u64; 2] {
    let cell = (u64::from(i.cast_unsigned()) << 32) | u64::from(j.cast_unsigned());
    let state = mix(mix(u64::from(seed)).wrapping_add(cell.wrapping_mul(INCREMENT)));
    [1, 2].map(|step| mix(state.wrapping_add(INCREMENT.wrapping_mul(step))))
}

/// A number evenly distributed over 2⁻⁵³ … 1.
pub(super) fn above_zero(random: u64) -> f64 {
    ((random >> 11) + 1) as f64 / (1_u64 << 53) as f64
}
