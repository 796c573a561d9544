// Flat-water shadows — which points an object hides from the sun if the water were flat (Iwasaki, Dobashi & Nishita 2002, §5). The shadow maps
// are the level maps: depth images of the objects along the sun's refracted rays. One invocation per point of a band.
#import "shared/points.wgsl"
#import "shared/receivers.wgsl"
#import "shared/floor_distance.wgsl"
#import "shared/level_maps.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"

struct FlatWater {
    to_light: vec4f, // unit direction against the refracted rays
    width: u32,      // points in a row
    row_count: u32,  // rows of the band
    instance_count: u32,
    layers: u32,     // receivers of an object
}

@group(0) @binding(0) var<uniform> flat_water: FlatWater;
@group(0) @binding(16) var<storage, read> points: array<Point>;
@group(0) @binding(21) var<storage, read_write> flat_shadows: array<u32>; // 1: hidden

// Texels of depth by which a point may lie behind the surface in the map: for the map's grid, the more the more a surface is along the light,
// and at most.
const LEAST_BIAS: f32 = 0.5;
const MOST_BIAS: f32 = 8.0;

fn is_hidden(point: Point) -> bool {
    let facing = max(abs(dot(point.normal, flat_water.to_light.xyz)), 1e-6);
    let steepness = sqrt(max(1.0 - facing * facing, 0.0)) / facing;
    let bias_texels = min(LEAST_BIAS + steepness, MOST_BIAS);
    let inverse = safe_inverse(flat_water.to_light.xyz);
    let end = instance_nodes(flat_water.instance_count);
    var node = 0u;
    while node < end {
        let step = step_instances(node, point.position_m, inverse, VERY_FAR_M);
        node = step.next;
        if step.index == NO_INSTANCE { continue; }
        let r = receivers[1u + step.index * flat_water.layers];
        // Dry objects have no map.
        if r.level_count == 0u { continue; }
        let q = to_map(r, point.position_m);
        let front = level_map_depths(r.level_map_offset, r.map_width, 0u, vec2i(floor(q.xy))).x;
        if front + bias_texels * r.s_per_m * inverseSqrt(r.density_per_flux) < q.z { return true; }
    }
    return false;
}

@compute @workgroup_size(8, 8)
fn flat_water_shadows_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= flat_water.width || id.y >= flat_water.row_count { return; }
    let index = id.y * flat_water.width + id.x;
    let point = points[index];
    var hidden = 0u;
    if point.receiver >= 0.0 { hidden = select(0u, 1u, is_hidden(point)); }
    flat_shadows[index] = hidden;
}
