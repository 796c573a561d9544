// A beam: the triangle of water it comes through and the rays under its corners.

struct Beam {
    unit_flux: f32,      // what falls on the triangle from a light of unit power, see triangle_unit_flux()
    transmitted: f32,    // what of it goes under water
    origin: mat3x3f,     // where the rays start, local m
    direction: mat3x3f,  // unit directions under them
    uv: mat3x2f,         // where they end, texels of the receiver's map
    t: vec3f,            // path lengths, m
    receiver: vec3i,
}

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

// Lays a part of a beam. Where its corners end on different receivers, each carries a third of the flux to its own, over the
// footprint that the whole part has at that depth. There is one place that deposits, see `deposit_area`.
fn deposit_part(b: Beam, is_torn: bool) -> Losses {
    var losses = NO_LOSSES;
    let pieces = select(1, 3, is_torn);
    let flux = b.transmitted / f32(pieces);
    for (var k = 0; k < pieces; k++) {
        if b.receiver[k] == NO_RECEIVER || (!is_torn && ends_nowhere(b)) {
            losses.missed += flux;
            continue;
        }
        if PLANES && b.receiver[k] > FLOOR { continue; }
        let r = receivers[b.receiver[k]];
        var uv = b.uv;
        let lengths_m = select(b.t, vec3f(b.t[k]), is_torn);
        let arriving = flux * mean_transmission(lengths_m);
        losses.extinguished += flux * mean_extinction(lengths_m);
        if r.map_offset == NOWHERE {
            losses.landed += arriving;
            continue;
        }
        if is_torn {
            for (var corner = 0; corner < 3; corner++) {
                var t = b.t[k];
                if b.receiver[k] == FLOOR {
                    let own = floor_distance(r, b.origin[corner], b.direction[corner]);
                    t = select(t, own, own >= 0.0);
                }
                uv[corner] = map_uv(r, b.origin[corner], b.direction[corner], t);
            }
        }
        losses.left += arriving * deposit_triangle(target_of(r), uv[0], uv[1], uv[2], arriving);
    }
    return losses;
}
