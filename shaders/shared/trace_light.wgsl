// The first receiver that a light ray hits under water. The floor is intersected exactly; meshes by their level maps, and by their
// triangles where the level map has an edge. Silhouettes are therefore as sharp as the mesh, whatever the level map's resolution.
//
// With further layers the mesh itself is also intersected if a ray does not enter through the front, because there the march would stop at
// the texel's side and take it for the first surface.

const FAR_M: f32 = 1e6;
// Penalty, in texels of depth, when a layer's normal differs from that of the hit triangle: once for a right angle, twice for opposite
// normals, and once more if only one of the two faces the light's axis.
const TURNED_TEXELS: f32 = 8.0;

// The layer that a hit at `q` (map space) belongs to: the surface at its texel that is nearest in depth and faces like the triangle. At a
// rim two surfaces meet, and depth alone would assign a stripe of one to the other.
fn layer_of(r: Receiver, index: u32, q: vec3f, met: MeshHit) -> u32 {
    let texel = clamp(vec2i(floor(q.xy)), vec2i(0), vec2i(i32(r.map_width) - 1));
    let normal = (1.0 - met.u - met.v) * unpack_normal(geometry[met.triangle].w) + met.u * unpack_normal(geometry[met.triangle + 1u].w)
        + met.v * unpack_normal(geometry[met.triangle + 2u].w);
    let axis = r.axis.xyz;
    let along = vec3f(dot(instances[index].mesh_x.xyz, axis), dot(instances[index].mesh_y.xyz, axis), dot(instances[index].mesh_z.xyz, axis));
    let faces = dot(normal, along) < 0.0;
    let texels_per_s = sqrt(r.density_per_flux) / r.s_per_m;
    var best = 0u;
    var least = EMPTY_DEPTH;
    for (var layer = 0u; layer < light.layers; layer++) {
        let depth = layer_depth(r, layer, texel);
        if depth >= EMPTY_DEPTH { break; }
        let own = unpack_normal(level_maps[layer_word(r, layer, texel)]);
        let turned = 1.0 - dot(own, normalize(normal)) + select(1.0, 0.0, (dot(own, along) < 0.0) == faces);
        let distance = abs(depth - q.z) * texels_per_s + TURNED_TEXELS * turned;
        if distance < least {
            least = distance;
            best = layer;
        }
    }
    return best;
}

// The hit of a ray on object `index` nearer than t_max, or NO_RECEIVER.
fn trace_level_map(index: u32, origin: vec3f, direction: vec3f, t_max: f32) -> Hit {
    let nothing = Hit(vec2f(0.0), t_max, NO_RECEIVER);
    let number = first_receiver_of(index);
    let r = receivers[number];
    if r.level_count == 0u { return nothing; }
    let o = to_map(r, origin);
    let d = direction_to_map(r, direction);
    if PLANES { return trace_planes(r, number, o, d, t_max); }
    let t = march_level_map(r, o, d, 0.0, t_max);
    if t == AT_EDGE || (light.layers > 1u && t >= 0.0 && entered_through_side) {
        let met = trace_instance(index, origin, direction, 0.0, t_max);
        if met.t >= t_max { return nothing; }
        let q = o + d * met.t;
        var layer = 0u;
        if light.layers > 1u { layer = layer_of(r, index, q, met); }
        return Hit(q.xy, met.t, i32(number + layer));
    }
    if t < 0.0 || t >= t_max { return nothing; }
    // The march ends on a flat texel; refine the hit with the interpolated depth.
    var t_fine = t;
    if d.z > 1e-6 {
        let uv = (o + d * t).xy;
        let slope_gap = 4.0 * (r.s_max - r.s_min) / f32(r.map_width);
        let s = smooth_front(r, uv, slope_gap);
        let candidate = (s - o.z) / d.z;
        // Only if the ray entered through the front, not through a side.
        if abs(candidate - t) * d.z < slope_gap && candidate > 0.0 { t_fine = candidate; }
    }
    return Hit((o + d * t_fine).xy, t_fine, i32(number));
}

// First hit on the floor, if there is one, and on `count` objects.
fn trace_light(origin: vec3f, direction: vec3f, count: u32, has_floor: bool) -> Hit {
    // Rays that go up from a light under water end at the level of the water at rest.
    var reach = FAR_M;
    if light.kind == SUBMERGED && direction.y > 0.0 { reach = clamp(-origin.y / direction.y, 0.0, FAR_M); }
    var best = Hit(vec2f(0.0), reach, NO_RECEIVER);
    var beside = Hit(vec2f(0.0), FAR_M, NO_RECEIVER); // on the floor's plane, outside its rectangle
    if has_floor {
        let r = receivers[FLOOR];
        let t = floor_distance(r, origin, direction);
        if t >= 0.0 {
            let p = origin + direction * t;
            let hit = Hit(to_map(r, p).xy, t, FLOOR);
            if all(p.xz >= r.floor_min_m) && all(p.xz <= r.floor_max_m) { best = hit; } else { beside = hit; }
        }
    }
    let inverse = safe_inverse(direction);
    // Light that enters outside this rectangle misses all objects, whatever the slope of the waves.
    let may_meet = all(origin.xz >= light.objects_min_m) && all(origin.xz <= light.objects_max_m);
    let end = select(0u, instance_nodes(count), may_meet);
    var node = 0u;
    while node < end {
        let step = step_instances(node, origin, inverse, best.t);
        node = step.next;
        if step.index == NO_INSTANCE { continue; }
        let hit = trace_level_map(step.index, origin, direction, best.t);
        if hit.receiver != NO_RECEIVER { best = hit; }
    }
    if best.receiver == NO_RECEIVER { return beside; }
    return best;
}
