// The scale of a workgroup's account of whole cells.

// The largest emitted flux of the workgroup's cells, as the bits of an f32, which order like the numbers.
var<workgroup> largest: atomic<u32>;
// Counts of the largest cell's flux at the workgroup's own scale: all 64 cells fit u32 together.
const CELL_COUNTS: f32 = 16777216.0;

// Factor by which a workgroup may count finer if each of its cells emits at most `most`; a power of two.
fn finer_for(most: f32) -> f32 {
    if most <= 0.0 { return 1.0; }
    let room = min(CELL_COUNTS / (most * light.triangle_scale), light.energy_scale / light.triangle_scale);
    return max(bitcast<f32>(bitcast<u32>(room) & 0x7f800000u), 1.0);
}
