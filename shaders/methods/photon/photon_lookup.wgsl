// Photon look-up — irradiance at points, from a beam set's map. One invocation per point of a band. A point that the view from the light
// does not show gets none (Mihálik 2008, §9.2: shadow mapping).
#import "shared/points.wgsl"
#import "shared/light_view.wgsl"

@group(0) @binding(9) var<storage, read> photon_map: array<vec4f>;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m², w: 1 where the floor lies beside the map
@group(0) @binding(23) var light_depth: texture_2d<f32>;

// Texels of the view by which a point may lie below the surface shown there: for rounding and curved surfaces, and at most.
const LEAST_BIAS: f32 = 0.25;
const MOST_BIAS: f32 = 8.0;

// Whether the view shows a point, rather than a surface nearer to the light.
fn is_shown(p: vec3f, normal: vec3f) -> bool {
    let uv = view_place(p);
    if !is_within(uv) { return true; }
    // How much a plane with this normal rises over a texel, along the light.
    let texel_m = light_view.view_texel_m;
    let facing = max(abs(dot(normal, light_view.to_light.xyz)) / light_view.to_light.y, 1e-6);
    let rise_m = (texel_m.x * abs(normal.x) + texel_m.y * abs(normal.z)) / facing;
    let side_m = max(texel_m.x, texel_m.y);
    let bias_m = min(LEAST_BIAS * side_m + rise_m, MOST_BIAS * side_m);
    return textureLoad(light_depth, vec2i(uv), 0).x <= p.y + bias_m;
}

fn texel_value(texel: vec2u) -> vec3f {
    return photon_map[light_view.first_texel + texel.y * light_view.texels + texel.x].xyz;
}

fn map_at(uv: vec2f) -> vec3f {
    let last = f32(light_view.texels) - 1.0;
    if light_view.interpolates == 0u { return texel_value(vec2u(clamp(floor(uv), vec2f(0.0), vec2f(last)))); }
    let q = clamp(uv - 0.5, vec2f(0.0), vec2f(last));
    let low = vec2u(q);
    let high = min(low + 1u, vec2u(light_view.texels - 1u));
    let f = q - floor(q);
    let near = mix(texel_value(low), texel_value(vec2u(high.x, low.y)), f.x);
    let far = mix(texel_value(vec2u(low.x, high.y)), texel_value(high), f.x);
    return mix(near, far, f.y);
}

@compute @workgroup_size(8, 8)
fn photon_lookup_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= light_view.width || id.y >= light_view.row_count { return; }
    let index = id.y * light_view.width + id.x;
    let point = points[index];
    if point.receiver < 0.0 { return; }
    // Normals of pixels face the viewer, so one that looks away from the light is on the dark side. Those of a mesh may face either side.
    let cosine = dot(point.normal, light_view.to_light.xyz);
    let facing = select(max(cosine, 0.0), abs(cosine), light_view.are_texels == 1u);
    if facing <= 0.0 || !is_shown(point.position_m, point.normal) { return; }
    let uv = map_place(point.position_m);
    let side = f32(light_view.texels);
    // Half a texel more, for rounding at the map's edge.
    let is_beside = point.receiver == 0.0 && (any(uv < vec2f(-0.5)) || any(uv > vec2f(side + 0.5)));
    let before = point_irradiance[index];
    point_irradiance[index] = vec4f(before.xyz + map_at(uv) * facing, max(before.w, select(0.0, 1.0, is_beside)));
}
