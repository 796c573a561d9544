// Attenuation of a beam in water. Twin of src/physics/attenuation.rs.

// Fraction left after `length_m` with extinction `c_per_m` (both 0 … 10⁶): e^(−c d).
fn transmission(c_per_m: f32, length_m: f32) -> f32 {
    return exp(-c_per_m * length_m);
}

// Fraction lost, 1 − e^(−c d), precise also for tiny c d (WGSL has no expm1, so a series is used there).
fn extinction(c_per_m: f32, length_m: f32) -> f32 {
    let x = c_per_m * length_m;
    if x < 0.06 {
        return x * (1.0 - x * (0.5 - x * (0.16666667 - x * (0.041666668 - x * 0.008333334))));
    }
    return 1.0 - exp(-x);
}
