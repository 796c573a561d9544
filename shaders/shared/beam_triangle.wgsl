// Where a beam lands: its receiver, and its contribution to the energy account.
#import "shared/losses.wgsl"

fn target_of(r: Receiver) -> Target {
    return Target(r.map_offset, i32(r.map_width), i32(r.map_height), light.channels, light.flux_scale);
}

// Whether the three rays end on one smooth part of one receiver.
fn is_whole(b: Beam) -> bool {
    // Some beams of a light under water go partly up and partly to the far floor; splitting them gains nothing.
    if light.kind == SUBMERGED && all(b.receiver <= vec3i(FLOOR)) { return true; }
    if PLANES {
        // All meshes count as one receiver: it only matters whether a ray ends on a mesh or on the floor.
        let ends = min(b.receiver, vec3i(FLOOR + 1));
        return ends.x == ends.y && ends.x == ends.z;
    }
    if b.receiver.x != b.receiver.y || b.receiver.x != b.receiver.z { return false; }
    if b.receiver.x <= FLOOR { return true; }
    // On a mesh, a jump in depth that is too large for the footprint is a step between two parts of the mesh.
    let low = min(b.uv[0], min(b.uv[1], b.uv[2]));
    let high = max(b.uv[0], max(b.uv[1], b.uv[2]));
    let texel_m = inverseSqrt(receivers[b.receiver.x].density_per_flux);
    let reach_m = 3.0 * texel_m * (max(high.x - low.x, high.y - low.y) + 1.0);
    let jump_m = max(b.t.x, max(b.t.y, b.t.z)) - min(b.t.x, min(b.t.y, b.t.z));
    return jump_m <= reach_m;
}

// Whether a whole beam hits no receiver.
fn hits_nothing(b: Beam) -> bool {
    return any(b.receiver == vec3i(NO_RECEIVER));
}
