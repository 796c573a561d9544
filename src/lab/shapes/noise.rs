//! Noise from integers: the same on every machine.

use glam::DVec3;

/// A hash of 32 bits: `pcg_hash` of Jarzynski and Olano, *Hash Functions for GPU Rendering*, JCGT 9(3), 2020.
pub(super) fn hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// A number from 0 up to, not including, 1 for each `index` of a row of them, named by its `seed`.
pub(super) fn unit(seed: u32, index: u32) -> f64 {
    f64::from(hash(hash(seed).wrapping_add(index))) / 4_294_967_296.0
}

/// Value noise: −1 … 1 at whole coordinates, smooth between them.
pub(super) fn value(seed: u32, p: DVec3) -> f64 {
    let floor = p.floor();
    let corner = floor.to_array().map(|x| x as i32 as u32);
    // Perlin's quintic (Improving Noise, 2002): its first two derivatives vanish at both ends.
    let fade = |x: f64| x * x * x * (x * (6.0 * x - 15.0) + 10.0);
    let [u, v, w] = (p - floor).to_array().map(fade);
    let at = |dx: u32, dy: u32, dz: u32| {
        let [x, y, z] = corner;
        let row = hash(x.wrapping_add(dx).wrapping_add(hash(seed)));
        let layer = hash(y.wrapping_add(dy).wrapping_add(row));
        2.0 * unit(layer, z.wrapping_add(dz)) - 1.0
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let along_x = |dy: u32, dz: u32| mix(at(0, dy, dz), at(1, dy, dz), u);
    let along_y = |dz: u32| mix(along_x(0, dz), along_x(1, dz), v);
    mix(along_y(0), along_y(1), w)
}

/// Sum of the given number of octaves of [`value`], each at twice the frequency and half the height of the one before.
pub(super) fn octaves(seed: u32, p: DVec3, count: u32) -> f64 {
    let (mut sum, mut scale, mut height) = (0.0, 1.0, 1.0);
    for octave in 0..count {
        sum += height * value(seed.wrapping_add(octave), scale * p);
        scale *= 2.0;
        height *= 0.5;
    }
    sum
}
