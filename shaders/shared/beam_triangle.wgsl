// A beam: the triangle of water it comes through and the rays under its corners.

struct Beam {
    flux_m2: f32,        // what falls on the triangle under unit irradiance
    transmitted_m2: f32, // what goes under water
    origin: mat3x3f,     // corners on the surface, local m
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

// What a beam leaves behind in the energy account.
struct Losses {
    missed: f32,
    extinguished: vec3f,
    left: vec3f,
}

// A beam whose corners end on different receivers and that is not halved any more: each corner carries a third of the flux to
// its own receiver, over the footprint that the whole beam has at that depth.
fn deposit_torn(b: Beam) -> Losses {
    var losses = Losses(0.0, vec3f(0.0), vec3f(0.0));
    let third = b.transmitted_m2 / 3.0;
    add_energy(TERM_TORN, b.transmitted_m2 * light.energy_scale);
    atomicAdd(&energy[2u * TERM_TORN_COUNT], 1u);
    for (var k = 0; k < 3; k++) {
        if b.receiver[k] == NO_RECEIVER {
            losses.missed += third;
            continue;
        }
        let r = receivers[b.receiver[k]];
        var uv = mat3x2f();
        for (var corner = 0; corner < 3; corner++) {
            var t = b.t[k];
            if b.receiver[k] == FLOOR {
                let own = floor_distance(r, b.origin[corner], b.direction[corner]);
                t = select(t, own, own >= 0.0);
            }
            uv[corner] = map_uv(r, b.origin[corner], b.direction[corner], t);
        }
        let lengths = vec3f(b.t[k]);
        let arriving = third * mean_transmission(lengths);
        losses.extinguished += third * mean_extinction(lengths);
        losses.left += arriving * deposit_triangle(target_of(r), uv[0], uv[1], uv[2], arriving);
    }
    return losses;
}

// A beam that ends on one receiver.
fn deposit_whole(b: Beam) -> Losses {
    let arriving = b.transmitted_m2 * mean_transmission(b.t);
    var losses = Losses(0.0, b.transmitted_m2 * mean_extinction(b.t), vec3f(0.0));
    losses.left = arriving * deposit_triangle(target_of(receivers[b.receiver.x]), b.uv[0], b.uv[1], b.uv[2], arriving);
    return losses;
}
