// The energy account of a workgroup, gathered before it goes to the global sums.

var<workgroup> account: array<atomic<u32>, 9>;

fn note_term(term: u32, value_m2: f32) {
    let counts = u32(value_m2 * light.triangle_scale + 0.5);
    if counts > 0u { atomicAdd(&account[term], counts); }
}

fn note_losses(losses: Losses) {
    note_term(TERM_MISSED, losses.missed);
    for (var channel = 0u; channel < light.channels; channel++) {
        note_term(TERM_EXTINGUISHED + channel, losses.extinguished[channel]);
        note_term(TERM_LEFT + channel, losses.left[channel]);
    }
}

// To be called by all invocations after a workgroupBarrier().
fn flush_account(invocation: u32) {
    if invocation < 9u {
        let counts = atomicLoad(&account[invocation]);
        if counts > 0u { add_energy(invocation, f32(counts) * (light.energy_scale / light.triangle_scale)); }
    }
}
