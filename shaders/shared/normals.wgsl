// Octahedral unit normal from two 16-bit halves.
fn unpack_normal(word: u32) -> vec3f {
    let f = unpack2x16snorm(word);
    var n = vec3f(f.x, f.y, 1.0 - abs(f.x) - abs(f.y));
    let fold = max(-n.z, 0.0);
    n.x += select(fold, -fold, n.x >= 0.0);
    n.y += select(fold, -fold, n.y >= 0.0);
    return normalize(n);
}
