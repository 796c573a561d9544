// What becomes of a beam on its receiver.

fn target_of(r: Receiver) -> Target {
    return Target(r.map_offset, i32(r.map_width), i32(r.map_height), light.channels, light.flux_scale);
}

// Whether the three rays end on one smooth piece of one receiver.
fn is_whole(b: Beam) -> bool {
    // Of a light under water some beams go half up and half to the far floor; there is nothing to be halved for.
    if light.kind == SUBMERGED && all(b.receiver <= vec3i(FLOOR)) { return true; }
    if PLANES {
        // All meshes are one: what stops there is no longer the floor's, and that is all.
        let ends = min(b.receiver, vec3i(FLOOR + 1));
        return ends.x == ends.y && ends.x == ends.z;
    }
    if b.receiver.x != b.receiver.y || b.receiver.x != b.receiver.z { return false; }
    if b.receiver.x <= FLOOR { return true; }
    // On a mesh a jump in depth that the footprint does not explain is a step from one part to another.
    let low = min(b.uv[0], min(b.uv[1], b.uv[2]));
    let high = max(b.uv[0], max(b.uv[1], b.uv[2]));
    let texel_m = inverseSqrt(receivers[b.receiver.x].density_per_flux);
    let reach_m = 3.0 * texel_m * (max(high.x - low.x, high.y - low.y) + 1.0);
    let jump_m = max(b.t.x, max(b.t.y, b.t.z)) - min(b.t.x, min(b.t.y, b.t.z));
    return jump_m <= reach_m;
}

// Whether a beam that is whole meets no receiver.
fn ends_nowhere(b: Beam) -> bool {
    return any(b.receiver == vec3i(NO_RECEIVER));
}

// What a beam leaves behind in the energy account.
struct Losses {
    missed: f32,
    extinguished: vec3f,
    left: vec3f,
    landed: vec3f, // on maps that nobody asks for
}

const NO_LOSSES: Losses = Losses(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
