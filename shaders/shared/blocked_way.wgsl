// Shadows of objects on the point of an invocation, by a ray to where its light enters the water.

// Start of the search for shadows, off the surface: as shares of the coordinates, and of the point's footprint, since the depth of a texel is
// only as fine as the grid on which its map was drawn.
const OFF_SHARE: f32 = 2e-5;
const OFF_FOOTPRINT: f32 = 0.02;

// Whether an object blocks the way from the point to where its light enters the water.
fn is_blocked(entry_m: vec3f, path_m: f32) -> bool {
    let far_m = max(max(abs(seen.position_m.x), abs(seen.position_m.z)), abs(seen.position_m.y)) + path_m;
    let from_m = seen.position_m + seen.normal * (OFF_SHARE * far_m + OFF_FOOTPRINT * seen.footprint_m);
    let way = entry_m - from_m;
    let reach_m = length(way);
    let direction = way / max(reach_m, 1e-12);
    let inverse = safe_inverse(direction);
    let end = select(0u, instance_nodes(volumes.instance_count), volumes.has_shadows == 1u);
    var node = 0u;
    while node < end {
        let step = step_instances(node, from_m, inverse, reach_m);
        node = step.next;
        if step.index == NO_INSTANCE { continue; }
        if trace_instance(step.index, from_m, direction, 0.0, reach_m).t < reach_m { return true; }
    }
    return false;
}
