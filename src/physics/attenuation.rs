//! Attenuation of a beam along its path through water.

/// Fraction transmitted over `length_m` (0 …) with extinction `c_per_m` (0 …): e^(−c d). Beer–Lambert–Bouguer.
pub fn transmission(c_per_m: f64, length_m: f64) -> f64 {
    (-c_per_m * length_m).exp()
}

/// Fraction lost along the path, 1 − e^(−c d), accurate also for tiny c d.
pub fn extinction(c_per_m: f64, length_m: f64) -> f64 {
    -(-c_per_m * length_m).exp_m1()
}
