// Point in sub-volume — light at points from the sub-volumes around them (Iwasaki, Dobashi & Nishita 2002, §4.2, §4.3). One invocation per
// point of a band.
#import "lib/attenuation.wgsl"
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/octahedral.wgsl"
#import "lib/interpolated_flux.wgsl"
#import "shared/light.wgsl"
#import "shared/grid.wgsl"
#import "shared/entry.wgsl"
#import "shared/points.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/volumes.wgsl"
#import "shared/volume_cut.wgsl"
#import "shared/volume_search.wgsl"
#import "shared/blocked_way.wgsl"

struct SubVolumes {
    eye: vec4f,        // where points are seen from, local m; with parallel rays the unit direction to there
    count: u32,        // sub-volumes of each volume, of equal height
    is_parallel: u32,
    shades_faces: u32, // whether a point has the intensity of the front face before it, instead of its own
    is_scaled: u32,    // whether intensities are scaled so that each sub-volume carries its flux
}

@group(0) @binding(2) var<uniform> sub_volumes: SubVolumes;
@group(0) @binding(20) var<storage, read_write> point_irradiance: array<vec4f>; // W/m²
@group(0) @binding(21) var<storage, read> flat_shadows: array<u32>;

// Least weight of a triangle's area in the interpolation, as a share of the largest.
const LEAST_SHARE: f32 = 1e-6;

// A place in a sub-volume: weights of its three rays, and how far it is down from the upper of its planes, 0 … 1.
struct Place {
    weights: vec3f,
    share: f32,
}

// Whether an object blocks the way from the point to where its light enters the water.
fn is_blocked(entry_m: vec3f, path_m: f32) -> bool {
    return is_way_blocked(seen, entry_m, path_m, select(0u, volumes.instance_count, volumes.has_shadows == 1u));
}

// Depths of the planes around the point. The floor is a plane of its own (§4.2).
fn planes_around() -> vec2f {
    if seen.receiver == 0.0 { return vec2f(depth_m); }
    let height_m = (volumes.bottom_m - volumes.top_m) / f32(sub_volumes.count);
    let number = clamp(floor((depth_m - volumes.top_m) / height_m), 0.0, f32(sub_volumes.count) - 1.0);
    return volumes.top_m + vec2f(number, number + 1.0) * height_m;
}

fn cross2(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// Twice the signed areas of the caustic triangles on the two planes (x, z), and between them half the products of the sides of one with
// those of the other: the coefficients by which the area between the planes is a quadratic.
fn double_areas(vertices: vec3u, planes_m: vec2f) -> vec3f {
    let ab = volume_rays[vertices.y] - volume_rays[vertices.x];
    let ac = volume_rays[vertices.z] - volume_rays[vertices.x];
    let upper_b = ab.xy + ab.zw * planes_m.x;
    let upper_c = ac.xy + ac.zw * planes_m.x;
    let lower_b = ab.xy + ab.zw * planes_m.y;
    let lower_c = ac.xy + ac.zw * planes_m.y;
    return vec3f(cross2(upper_b, upper_c), 0.5 * (cross2(upper_b, lower_c) + cross2(lower_b, upper_c)), cross2(lower_b, lower_c));
}

// Flux through a horizontal square metre at the two triangles, without attenuation.
fn densities_of(double_areas: vec3f, flux: f32) -> vec2f {
    let areas = abs(double_areas);
    // The flux ratio (§3.2.2). A triangle without area has none; it is kept within f32.
    if sub_volumes.is_scaled == 0u { return 2.0 * flux / max(areas.xz, vec2f(LEAST_DOUBLE_AREA_M2)); }
    // In the same ratio, but such that the flux between the triangles is that of the volume: finite also where one has no area.
    let largest = max(max(areas.x, areas.y), areas.z);
    if largest < LEAST_DOUBLE_AREA_M2 { return vec2f(0.0); }
    let shares = double_areas / largest;
    let parts = max(abs(shares.zx), vec2f(LEAST_SHARE));
    return parts * (2.0 * flux / (largest * interpolated_flux(shares.x, shares.y, shares.z, parts.x, parts.y)));
}

// The smallest distance above 0 at which c.x + c.y s + c.z s² is 0.
fn first_zero(c: vec3f) -> f32 {
    let square = c.y * c.y - 4.0 * c.x * c.z;
    if square < 0.0 { return VERY_FAR_M; }
    let far = -0.5 * (c.y + select(-sqrt(square), sqrt(square), c.y >= 0.0));
    let at = vec2f(far, c.x) / select(vec2f(c.z, far), vec2f(1e-30), abs(vec2f(c.z, far)) < vec2f(1e-30));
    let ahead = select(vec2f(VERY_FAR_M), at, at > vec2f(0.0));
    return min(ahead.x, ahead.y);
}

// Where the straight line from the point to the eye leaves the sub-volume: on the front face that is seen before the point. If the eye is in
// the sub-volume, there is no such face, and it is the place of the eye.
fn place_on_face(vertices: vec3u, own: Place, planes_m: vec2f) -> Place {
    let way = select(sub_volumes.eye.xyz - seen.position_m, sub_volumes.eye.xyz, sub_volumes.is_parallel == 1u);
    let length_m = length(way);
    let to_eye = way / max(length_m, 1e-12);
    var distance_m = select(length_m, VERY_FAR_M, sub_volumes.is_parallel == 1u);
    // Up through the upper plane, or down through the lower one.
    let rise_m = select(depth_m - planes_m.y, depth_m - planes_m.x, to_eye.y > 0.0);
    if abs(to_eye.y) > 1e-12 { distance_m = min(distance_m, rise_m / to_eye.y); }
    // Through a side. Relative to the place reached, rays move by `drift` per metre of the way.
    var corner = mat3x2f();
    var drift = mat3x2f();
    for (var i = 0u; i < 3u; i++) {
        corner[i] = aside_m(vertices[i]);
        drift[i] = -(to_eye.xz + volume_rays[vertices[i]].zw * to_eye.y);
    }
    for (var i = 0u; i < 3u; i++) {
        let j = (i + 1u) % 3u;
        let edge = vec3f(cross2(corner[i], corner[j]), cross2(corner[i], drift[j]) + cross2(drift[i], corner[j]), cross2(drift[i], drift[j]));
        distance_m = min(distance_m, first_zero(edge));
    }
    for (var i = 0u; i < 3u; i++) { corner[i] += drift[i] * distance_m; }
    let whole = cross2(corner[1] - corner[0], corner[2] - corner[0]);
    let parts = max(sign(whole) * vec3f(cross2(corner[1], corner[2]), cross2(corner[2], corner[0]), cross2(corner[0], corner[1])), vec3f(0.0));
    let sum = parts.x + parts.y + parts.z;
    // Where the rays meet in a line or a point, any weights are right.
    if sum < LEAST_DOUBLE_AREA_M2 { return own; }
    let height_m = max(planes_m.y - planes_m.x, 1e-12);
    return Place(parts / sum, clamp((depth_m - to_eye.y * distance_m - planes_m.x) / height_m, 0.0, 1.0));
}

// A volume in whose cut the point lies.
struct Found {
    vertices: vec3u,
    flux: f32,
    weights: vec3f,
    cosine: f32, // see turned_to(); 0: it has no light for the point
    arrival: Arrival,
}

fn found_in(block: vec2u, k: u32) -> Found {
    let cell = cell_in(block, k);
    let vertices = vertices_of(cell, k & 1u);
    let cut = cut_of(vertices);
    let double_area = double_area_of(cut);
    // Computed again, so it may differ in the last digit from what holds() has found.
    let is_empty = abs(double_area) < LEAST_DOUBLE_AREA_M2;
    let weights = cut.double_areas / select(double_area, 1.0, is_empty);
    let arrival = arrival_of(vertices, weights);
    return Found(vertices, flux_of(cell, k & 1u), weights, select(max(turned_to(arrival), 0.0), 0.0, is_empty), arrival);
}

// Light of a volume at the point, W/m²: the intensities of the six corners of the sub-volume around it, interpolated.
fn light_of(found: Found, planes_m: vec2f) -> vec3f {
    let areas = double_areas(found.vertices, planes_m);
    let densities = densities_of(areas, found.flux);
    let is_floor = planes_m.x == planes_m.y;
    var place = Place(found.weights, 0.0);
    if !is_floor { place.share = clamp((depth_m - planes_m.x) / (planes_m.y - planes_m.x), 0.0, 1.0); }
    for (var once = 0u; once < select(0u, sub_volumes.shades_faces, !is_floor); once++) {
        place = place_on_face(found.vertices, place, planes_m);
    }
    let side = light.cells + 1u;
    var sum = vec3f(0.0);
    var transmittance = 0.0;
    for (var i = 0u; i < 3u; i++) {
        let vertex = found.vertices[i];
        let water = surface[vertex].xyz;
        let ray = volume_rays[vertex];
        let entering = entry_at(vec2f(vec2u(vertex % side, vertex / side)), water).transmittance;
        transmittance += entering / 3.0;
        let paths_m = max((water.x + planes_m) * sqrt(1.0 + dot(ray.zw, ray.zw)), vec2f(0.0));
        let parts = place.weights[i] * entering * densities * vec2f(1.0 - place.share, place.share);
        var left = mat2x3f(vec3f(1.0), vec3f(1.0));
        if ATTENUATES {
            for (var c = 0; c < 3; c++) {
                left[0][c] = transmission(light.extinction_per_m[c], paths_m.x);
                left[1][c] = transmission(light.extinction_per_m[c], paths_m.y);
            }
        }
        sum += parts.x * left[0] + parts.y * left[1];
    }
    return volumes.power.xyz * sum * (found.cosine / max(transmittance, 1e-30));
}

fn index_of(id: vec3u) -> u32 {
    return id.y * volumes.width + id.x;
}

fn has_point(id: vec3u) -> bool {
    return id.x < volumes.width && id.y < volumes.row_count;
}

@compute @workgroup_size(8, 8)
fn point_in_sub_volume_main(@builtin(global_invocation_id) id: vec3u) {
    if !has_point(id) || !begin_search(index_of(id)) { return; }
    let planes_m = planes_around();
    var sum = vec3f(0.0);
    while search.is_open {
        var held = held_in_next_block();
        while held != 0u {
            let found = found_in(search.block, firstTrailingBit(held));
            held &= held - 1u;
            if found.cosine <= 0.0 || is_blocked(found.arrival.entry_m, max(found.arrival.path_m, 0.0)) { continue; }
            sum += light_of(found, planes_m);
        }
    }
    point_irradiance[index_of(id)] += vec4f(sum, 0.0);
}

// The same where shadows are those under flat water.
@compute @workgroup_size(8, 8)
fn point_with_flat_shadows_main(@builtin(global_invocation_id) id: vec3u) {
    if !has_point(id) || flat_shadows[index_of(id)] == 1u || !begin_search(index_of(id)) { return; }
    let planes_m = planes_around();
    var sum = vec3f(0.0);
    while search.is_open {
        var held = held_in_next_block();
        while held != 0u {
            let found = found_in(search.block, firstTrailingBit(held));
            held &= held - 1u;
            if found.cosine > 0.0 { sum += light_of(found, planes_m); }
        }
    }
    point_irradiance[index_of(id)] += vec4f(sum, 0.0);
}
