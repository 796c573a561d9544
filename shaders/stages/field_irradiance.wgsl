// Field irradiance — irradiance at points, looked up in the kept field of a beam set. One invocation per point of a band.
#import "shared/points.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/light_field.wgsl"
#import "shared/blocked_way.wgsl"

struct FieldLookup {
    width: u32,          // points in a row
    row_count: u32,      // rows of the band
    field: u32,          // number of the beam set
    instance_count: u32,
}

@group(0) @binding(0) var<uniform> field_lookup: FieldLookup;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m²

@compute @workgroup_size(8, 8)
fn field_irradiance_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= field_lookup.width || id.y >= field_lookup.row_count { return; }
    let index = id.y * field_lookup.width + id.x;
    let point = points[index];
    // Dry places have their light already.
    if point.receiver < 0.0 { return; }
    let f = light_fields[field_lookup.field];
    let rise_m = field_top_m(f) - point.position_m.y;
    // Above the crests there is no light under water.
    if rise_m < 0.0 && point.receiver != 0.0 { return; }
    let light = falling_light(f, point.position_m);
    let irradiance = irradiance_of(light, point.normal);
    if irradiance.x + irradiance.y + irradiance.z <= 0.0 { return; }
    let way = vec3f(-light.drift.x, 1.0, -light.drift.y) * max(rise_m, 0.0);
    if is_way_blocked(point, point.position_m + way, length(way), field_lookup.instance_count) { return; }
    point_irradiance[index] += vec4f(irradiance, 0.0);
}
