// The energy account of a workgroup, summed in shared memory before it is added to the global account. The importing pass
// supplies `add_energy`, which does that.
#import "shared/terms.wgsl"
#import "shared/losses.wgsl"

var<workgroup> account: array<atomic<u32>, 12>;

// Factor by which counts are finer than for whole beams, a power of two. Passes with small parts set it before they note any.
var<private> finer: f32 = 1.0;

// Whether terms are added directly to the global sums: parts of a near point light's beams differ too much in size for one scale.
var<private> is_direct: bool = false;

fn note_term(term: u32, unit_flux: f32) {
    if is_direct {
        if unit_flux > 0.0 { add_energy(term, unit_flux * light.energy_scale); }
        return;
    }
    let counts = u32(unit_flux * (light.triangle_scale * finer) + 0.5);
    if counts > 0u { atomicAdd(&account[term], counts); }
}

fn note_losses(losses: Losses) {
    note_term(TERM_MISSED, losses.missed);
    note_term(TERM_EXTINGUISHED, losses.extinguished.x);
    note_term(TERM_LEFT, losses.left.x);
    note_term(TERM_LANDED, losses.landed.x);
    if light.channels == 3u {
        note_term(TERM_EXTINGUISHED + 1u, losses.extinguished.y);
        note_term(TERM_EXTINGUISHED + 2u, losses.extinguished.z);
        note_term(TERM_LEFT + 1u, losses.left.y);
        note_term(TERM_LEFT + 2u, losses.left.z);
        note_term(TERM_LANDED + 1u, losses.landed.y);
        note_term(TERM_LANDED + 2u, losses.landed.z);
    }
}

// To be called by all invocations after a workgroupBarrier().
fn flush_account(invocation: u32) {
    if invocation < 12u {
        let counts = atomicLoad(&account[invocation]);
        // All scales are powers of two and each half fits f32: nothing is rounded, however beams are distributed over workgroups.
        let scale = light.energy_scale / (light.triangle_scale * finer);
        if counts >= 65536u { add_energy(invocation, f32(counts & 0xffff0000u) * scale); }
        if counts > 0u { add_energy(invocation, f32(counts & 0xffffu) * scale); }
    }
}
