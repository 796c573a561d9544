// The first receiver a light ray strikes under water: the floor exactly, meshes by their level maps, and by their triangles where
// the level map has an edge. Silhouettes are then as sharp as the mesh, whatever the level map's texels.

const FAR_M: f32 = 1e6;

// First hit over all `count` receivers; `has_floor` tells whether receiver 0 is there.
fn trace_light(origin: vec3f, direction: vec3f, count: u32, has_floor: bool) -> Hit {
    var best = Hit(vec2f(0.0), FAR_M, NO_RECEIVER);
    var beside = Hit(vec2f(0.0), FAR_M, NO_RECEIVER); // on the floor's plane, beside its rectangle
    if has_floor {
        let r = receivers[FLOOR];
        let t = floor_distance(r, origin, direction);
        if t >= 0.0 {
            let p = origin + direction * t;
            let hit = Hit(to_map(r, p).xy, t, FLOOR);
            if all(p.xz >= r.floor_min_m) && all(p.xz <= r.floor_max_m) { best = hit; } else { beside = hit; }
        }
    }
    for (var i = 1u; i < count; i++) {
        let r = receivers[i];
        if r.level_count == 0u { continue; }
        let o = to_map(r, origin);
        let d = direction_to_map(r, direction);
        let t = march_level_map(r, o, d, 0.0, best.t);
        if t == AT_EDGE {
            let met = trace_instance(instances[i - 1u], origin, direction, 0.0, best.t);
            if met.t < best.t { best = Hit((o + d * met.t).xy, met.t, i32(i)); }
            continue;
        }
        if t < 0.0 || t >= best.t { continue; }
        // The march ends on a flat texel; once more with the depth between texels.
        var t_fine = t;
        if d.z > 1e-6 {
            let uv = (o + d * t).xy;
            let slope_gap = 4.0 * (r.s_max - r.s_min) / f32(r.map_width);
            let s = smooth_front(r, uv, slope_gap);
            let candidate = (s - o.z) / d.z;
            // Only where the ray came through the front, not through a side.
            if abs(candidate - t) * d.z < slope_gap && candidate > 0.0 { t_fine = candidate; }
        }
        best = Hit((o + d * t_fine).xy, t_fine, i32(i));
    }
    if best.receiver == NO_RECEIVER { return beside; }
    return best;
}
