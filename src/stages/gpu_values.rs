//! Conversion of f64 vectors to the f32 arrays that the GPU reads.

/// Three f64 values and a fourth.
pub fn vec4(v: impl Into<[f64; 3]>, w: f64) -> [f32; 4] {
    let [x, y, z] = v.into();
    [x as f32, y as f32, z as f32, w as f32]
}

/// Two f64 values.
pub fn vec2(v: glam::DVec2) -> [f32; 2] {
    [v.x as f32, v.y as f32]
}
