// Camera hits — the surface that each pixel sees, and the media in between. One invocation per pixel: the ray is intersected with the
// actual water surface, refracted there, and traced on to the first surface.
#import "lib/turns.wgsl"
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "shared/water_surface.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"
#import "shared/view.wgsl"
#import "shared/points.wgsl"

// The points that pixels see.
@group(0) @binding(16) var<storage, read_write> points: array<Point>;
// Distance along the viewing axis to the first surface, water included (m).
@group(0) @binding(17) var<storage, read_write> visible_depth: array<f32>;
// Diffuse reflectance, path length under water between surface seen and camera (m).
@group(0) @binding(18) var<storage, read_write> visible_albedo: array<vec4f>;
// Factor on the radiance of the surface seen, factor on the sky's, path length of the sky's light under water (m), notes.
@group(0) @binding(19) var<storage, read_write> visible_transport: array<vec4f>;

const MARCH_STEPS: u32 = 160u;
const SURFACE_TOLERANCE_M: f32 = 2e-5;
// Start of the search along a refracted or reflected ray: as far before the found point on the water as that point may lie behind the true
// surface, so that objects just under the surface are not missed.
const START_M: f32 = -2.0 * SURFACE_TOLERANCE_M;
// Depth of a pixel whose ray meets nothing (m).
const FAR_DEPTH_M: f32 = 1e10;

// MARCH_UNFINISHED if the march ran out of steps before it hit the water or was clear of it.
var<private> notes: f32;

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

fn pixel_ray(x: u32, y: u32) -> Ray {
    let sx = (2.0 * (f32(x) + 0.5 + view.sample_offset.x) / f32(view.width)) - 1.0;
    let sy = 1.0 - (2.0 * (f32(y) + 0.5 + view.sample_offset.y) / f32(view.height));
    let offset = view.right.xyz * sx + view.up.xyz * sy;
    if view.orthographic == 1u { return Ray(view.eye.xyz + offset, view.forward.xyz); }
    return Ray(view.eye.xyz, normalize(view.middle.xyz + offset));
}

// Signed height over the water: > 0 above it.
fn over_water(p: vec3f) -> f32 {
    return p.y - water_surface_at(p.xz).x;
}

// Distance at which a ray that starts on `side` (1 above, −1 below) of the surface crosses it; < 0: not before t_max. Steps are bounded by
// the steepest slope, so no crest is skipped; the last bracket is refined by false position.
fn meet_water(ray: Ray, side: f32, t_max: f32) -> f32 {
    let d = ray.direction;
    var t = 0.0;
    // Skip the part outside the slab that contains the waves.
    let gap = side * ray.origin.y - view.max_height_m;
    if gap > 0.0 {
        if side * d.y >= 0.0 { return -1.0; }
        t = gap / abs(d.y);
    }
    let rate = abs(d.y) + view.max_slope * length(d.xz);
    if rate <= 0.0 { return -1.0; }
    // A ray that starts at a wave and leaves it has not hit the water yet.
    var leaves = false;
    if t == 0.0 {
        let slope = water_surface_at(ray.origin.xz).yz;
        leaves = side * (d.y - dot(slope, d.xz)) > 0.0;
    }
    var t_before = t;
    var f_before = max(side * over_water(ray.origin + d * t), 0.0);
    for (var i = 0u; i < MARCH_STEPS; i++) {
        if t > t_max { return -1.0; }
        let p = ray.origin + d * t;
        let f = side * over_water(p);
        leaves = leaves && abs(f) <= SURFACE_TOLERANCE_M;
        if f <= SURFACE_TOLERANCE_M && !leaves {
            if f < -SURFACE_TOLERANCE_M && f_before > 0.0 { return close_bracket(ray, side, t_before, f_before, t, f); }
            return t;
        }
        if side * p.y > view.max_height_m && side * d.y > 0.0 { return -1.0; }
        t_before = t;
        f_before = f;
        t += max(f / rate, SURFACE_TOLERANCE_M);
    }
    notes = MARCH_UNFINISHED;
    // A ray that still runs along the wave it started at counts as leaving it.
    return select(t, -1.0, leaves);
}

fn close_bracket(ray: Ray, side: f32, t_0: f32, f_0: f32, t_1: f32, f_1: f32) -> f32 {
    var low = t_0;
    var f_low = f_0;
    var high = t_1;
    var f_high = f_1;
    for (var i = 0u; i < 8u; i++) {
        let t = low + (high - low) * clamp(f_low / (f_low - f_high), 0.05, 0.95);
        let f = side * over_water(ray.origin + ray.direction * t);
        if f > 0.0 { low = t; f_low = f; } else { high = t; f_high = f; }
    }
    return 0.5 * (low + high);
}

// First surface: floor or object.
fn trace_scene(ray: Ray, t_min: f32, t_max: f32) -> Seen {
    var seen = Seen(t_max, -1, vec3f(0.0), vec3f(0.0));
    if view.has_floor == 1u && ray.direction.y < 0.0 {
        let t = (view.floor_y_m - ray.origin.y) / ray.direction.y;
        let p = ray.origin + ray.direction * t;
        if t > t_min && t < t_max && all(p.xz >= view.floor_min_m) && all(p.xz <= view.floor_max_m) {
            seen = Seen(t, 0, vec3f(0.0, 1.0, 0.0), view.floor_albedo.xyz);
        }
    }
    let object = trace_objects(view.instance_count, ray.origin, ray.direction, t_min, seen.t);
    if object.receiver >= 0 { return object; }
    return seen;
}

struct Pixel {
    seen: Seen,
    position: vec3f,
    first_m: f32, // path to the first surface, water included
    reach_m: f32, // apparent path length to the surface seen, through the water
    path_m: f32,
    weight: f32,
    sky_weight: f32,
    sky_path_m: f32,
}

fn trace_from_air(ray: Ray) -> Pixel {
    let t_water = meet_water(ray, 1.0, VERY_FAR_M);
    let limit = select(VERY_FAR_M, t_water, t_water >= 0.0);
    let dry = trace_scene(ray, 0.0, limit);
    if dry.receiver >= 0 {
        notes = 0.0; // before the march's end
        return Pixel(dry, ray.origin + ray.direction * dry.t, dry.t, dry.t, 0.0, 1.0, 0.0, 0.0);
    }
    let nothing = Seen(0.0, -1, vec3f(0.0), vec3f(0.0));
    if t_water < 0.0 { return Pixel(nothing, vec3f(0.0), VERY_FAR_M, 0.0, 0.0, 0.0, 1.0, 0.0); }
    let p = ray.origin + ray.direction * t_water;
    let slope = water_surface_at(p.xz).yz;
    let normal = normal_from_slope(slope.x, slope.y);
    let cos_i = clamp(-dot(ray.direction, normal), 0.0, 1.0);
    let reflectance = fresnel_reflectance(cos_i, view.ior);
    let refracted = refract_direction(ray.direction, normal, view.ior);
    if refracted.w == 0.0 { return Pixel(nothing, vec3f(0.0), t_water, 0.0, 0.0, 0.0, 1.0, 0.0); }
    let below = Ray(p, refracted.xyz);
    let seen = trace_scene(below, START_M, VERY_FAR_M);
    let weight = select(0.0, (1.0 - reflectance) / (view.ior * view.ior), seen.receiver >= 0);
    return Pixel(seen, p + refracted.xyz * seen.t, t_water, t_water + seen.t / view.ior, max(seen.t, 0.0), weight, reflectance, 0.0);
}

fn trace_from_water(ray: Ray) -> Pixel {
    let t_water = meet_water(ray, -1.0, VERY_FAR_M);
    let limit = select(VERY_FAR_M, t_water, t_water >= 0.0);
    let wet = trace_scene(ray, 0.0, limit);
    if wet.receiver >= 0 {
        notes = 0.0; // before the march's end
        return Pixel(wet, ray.origin + ray.direction * wet.t, wet.t, wet.t, wet.t, 1.0, 0.0, 0.0);
    }
    let nothing = Seen(0.0, -1, vec3f(0.0), vec3f(0.0));
    if t_water < 0.0 { return Pixel(nothing, vec3f(0.0), VERY_FAR_M, 0.0, 0.0, 0.0, 0.0, 0.0); }
    let p = ray.origin + ray.direction * t_water;
    let slope = water_surface_at(p.xz).yz;
    let normal = -normal_from_slope(slope.x, slope.y);
    let cos_i = clamp(-dot(ray.direction, normal), 0.0, 1.0);
    let reflectance = fresnel_reflectance(cos_i, 1.0 / view.ior);
    let out_weight = (1.0 - reflectance) * view.ior * view.ior;
    // An object in the air hides the sky and outshines the mirror image of objects in the water; a pixel has only one surface.
    let leaving = refract_direction(ray.direction, normal, 1.0 / view.ior);
    if leaving.w > 0.0 {
        let above = trace_objects(view.instance_count, p, leaving.xyz, START_M, VERY_FAR_M);
        if above.receiver >= 0 {
            return Pixel(above, p + leaving.xyz * above.t, t_water, t_water + above.t * view.ior, t_water, out_weight, 0.0, 0.0);
        }
    }
    let mirrored = Ray(p, reflect_direction(ray.direction, normal));
    let seen = trace_scene(mirrored, START_M, VERY_FAR_M);
    let weight = select(0.0, reflectance, seen.receiver >= 0);
    return Pixel(seen, p + mirrored.direction * seen.t, t_water, t_water + seen.t, t_water + max(seen.t, 0.0), weight, out_weight, t_water);
}

@compute @workgroup_size(8, 8)
fn camera_hits_main(@builtin(global_invocation_id) id: vec3u) {
    let index = band_pixel(id);
    if index >= view.width * view.row_count { return; }
    let ray = pixel_ray(id.x, id.y + view.first_row);
    notes = 0.0;
    var pixel: Pixel;
    if over_water(ray.origin) >= 0.0 { pixel = trace_from_air(ray); } else { pixel = trace_from_water(ray); }
    let seen = pixel.seen.receiver >= 0;
    var receiver = f32(pixel.seen.receiver);
    if seen && over_water(pixel.position) > SURFACE_TOLERANCE_M { receiver = -2.0 - receiver; }
    // Side of a pixel at unit distance, or (orthographic) anywhere.
    let pixel_side = 2.0 * length(view.up.xyz) / f32(view.height);
    let footprint_m = select(0.0, pixel_side * select(pixel.reach_m, 1.0, view.orthographic == 1u), seen);
    points[index] = Point(select(vec3f(0.0), pixel.position, seen), receiver, pixel.seen.normal, footprint_m);
    let depth_m = pixel.first_m * dot(ray.direction, view.forward.xyz);
    visible_depth[index] = select(depth_m, FAR_DEPTH_M, pixel.first_m >= VERY_FAR_M);
    visible_albedo[index] = vec4f(pixel.seen.albedo, select(0.0, pixel.path_m, seen));
    visible_transport[index] = vec4f(pixel.weight, pixel.sky_weight, pixel.sky_path_m, notes);
}
