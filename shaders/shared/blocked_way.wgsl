// Whether an object blocks the light of a point: a search from the point to where its light enters the water.

// Start of the search, off the surface: as shares of the coordinates, and of the point's footprint, since the depth of a texel is only as fine
// as the grid on which its map was drawn.
const OFF_SHARE: f32 = 2e-5;
const OFF_FOOTPRINT: f32 = 0.02;

// `instance_count` 0: nothing is searched for.
fn is_way_blocked(p: Point, entry_m: vec3f, path_m: f32, instance_count: u32) -> bool {
    let far_m = max(max(abs(p.position_m.x), abs(p.position_m.z)), abs(p.position_m.y)) + path_m;
    let from_m = p.position_m + p.normal * (OFF_SHARE * far_m + OFF_FOOTPRINT * p.footprint_m);
    let way = entry_m - from_m;
    let reach_m = length(way);
    let direction = way / max(reach_m, 1e-12);
    let inverse = safe_inverse(direction);
    let end = instance_nodes(instance_count);
    var node = 0u;
    while node < end {
        let step = step_instances(node, from_m, inverse, reach_m);
        node = step.next;
        if step.index == NO_INSTANCE { continue; }
        if trace_instance(step.index, from_m, direction, 0.0, reach_m).t < reach_m { return true; }
    }
    return false;
}
