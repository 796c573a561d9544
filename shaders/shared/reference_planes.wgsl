// Reference planes (Tipprasert 2006, §4.2.1, §4.4): the plane of each texel of a level map, and the hits of rays on planes.

fn plane_s(r: Receiver, plane: u32) -> f32 {
    return plane_depth(r.s_min, r.s_max, f32(r.planes), f32(plane));
}

// The plane that accepts a texel: the only one within half a plane distance of the texel's depth; −1 for an empty texel.
fn plane_of_texel(r: Receiver, texel: vec2i) -> i32 {
    let depth = level_map_depths(r.level_map_offset, r.map_width, 0u, texel).x;
    if depth >= EMPTY_DEPTH { return -1; }
    return i32(plane_of_depth(r.s_min, r.s_max, f32(r.planes), depth));
}

// Whether a direction (map space) goes down through the planes.
fn goes_down(r: Receiver, direction: vec3f) -> bool {
    return direction.z > 1e-6 * r.s_per_m;
}

// The first hit of a ray (map space, t in m) on a plane that accepts the texel there, nearer than t_max; else NO_RECEIVER.
fn trace_planes(r: Receiver, number: u32, origin: vec3f, direction: vec3f, t_max: f32) -> Hit {
    let nothing = Hit(vec2f(0.0), t_max, NO_RECEIVER);
    if !goes_down(r, direction) { return nothing; }
    // Only planes that the ray crosses within the map are tested.
    var t_in = 0.0;
    var t_out = t_max;
    for (var a = 0; a < 2; a++) {
        let o = origin[a];
        let d = direction[a];
        if abs(d) < 1e-20 {
            if o < 0.0 || o > f32(r.map_width) { return nothing; }
        } else {
            let t0 = -o / d;
            let t1 = (f32(r.map_width) - o) / d;
            t_in = max(t_in, min(t0, t1));
            t_out = min(t_out, max(t0, t1));
        }
    }
    if t_in > t_out { return nothing; }
    let last = f32(r.planes) - 1.0;
    let per_s = last / (r.s_max - r.s_min);
    let first_plane = clamp(floor((origin.z + t_in * direction.z - r.s_min) * per_s), 0.0, last);
    let last_plane = clamp(ceil((origin.z + t_out * direction.z - r.s_min) * per_s), 0.0, last);
    for (var plane = u32(first_plane); plane <= u32(last_plane); plane++) {
        let t = (plane_s(r, plane) - origin.z) / direction.z;
        if t < 0.0 { continue; }
        if t >= t_max { break; }
        let uv = (origin + direction * t).xy;
        if plane_of_texel(r, vec2i(floor(uv))) == i32(plane) { return Hit(uv, t, i32(number)); }
    }
    return nothing;
}
