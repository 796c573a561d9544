//! Loss of a beam on its way through water.

/// Fraction that is left after `length_m` (0 …) with extinction `c_per_m` (0 …): e^(−c d). Beer–Lambert–Bouguer.
pub fn transmission(c_per_m: f64, length_m: f64) -> f64 {
    (-c_per_m * length_m).exp()
}

/// Fraction lost on the way, 1 − e^(−c d), exact also where c d is tiny.
pub fn extinction(c_per_m: f64, length_m: f64) -> f64 {
    -(-c_per_m * length_m).exp_m1()
}
