// Camera hits — the surface that each pixel sees, and the media in between. One invocation per pixel: the ray is intersected with the
// actual water surface, refracted or mirrored there, and traced on to the first surface. Where it splits at the water, the pass runs once for
// each of its legs.
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

// A ray counts as steeper than all waves if it is so by this factor: closer to it, Newton's method gains little.
const STEEP: f32 = 1.1;
// Bisection alone finds the water within this share of the waves' height: 2⁻²⁴.
const NEWTON_STEPS: u32 = 24u;
// Steps below this share of the distance are rounding.
const ROUNDING: f32 = 2.4e-7;
const MARCH_STEPS: u32 = 160u;
const SURFACE_TOLERANCE_M: f32 = 2e-5;
// Start of the search along a refracted or reflected ray: as far before the found point on the water as that point may lie behind the true
// surface, so that objects just under the surface are not missed.
const START_M: f32 = -2.0 * SURFACE_TOLERANCE_M;
// Depth of a pixel whose ray meets nothing (m).
const FAR_DEPTH_M: f32 = 1e10;

// MARCH_UNFINISHED if a march ran out of steps before it hit the water or was clear of it; CUT_OFF if the ray met the water too often.
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
    let direction = normalize(view.middle.xyz + offset);
    return Ray(view.eye.xyz + direction * view.start_m, direction);
}

// Signed height over the water: > 0 above it.
fn over_water(p: vec3f) -> f32 {
    return p.y - water_surface_at(p.xz).x;
}

// Whether a point is over the water by at least `by_m`. Only within reach of the waves they are evaluated.
fn is_over_water(p: vec3f, by_m: f32) -> bool {
    if abs(p.y) > view.max_height_m + by_m { return p.y > 0.0; }
    return over_water(p) >= by_m;
}

// Distance at which a ray that starts on `side` (1 above, −1 below) of the surface crosses it; < 0: not before t_max.
fn meet_water(ray: Ray, side: f32, t_max: f32) -> f32 {
    let d = ray.direction;
    if abs(d.y) > STEEP * view.max_slope * length(d.xz) { return meet_once(ray, side, t_max); }
    return march(ray, side, t_max);
}

// A ray that is steeper than all waves crosses them once: Newton's method, kept within the slab that contains the waves.
fn meet_once(ray: Ray, side: f32, t_max: f32) -> f32 {
    let d = ray.direction;
    if side * d.y >= 0.0 { return -1.0; }
    let fall = abs(d.y);
    let height_m = side * ray.origin.y;
    var low = max((height_m - view.max_height_m) / fall, 0.0);
    var high = (height_m + view.max_height_m) / fall;
    var t = clamp(height_m / fall, low, high);
    for (var i = 0u; i < NEWTON_STEPS; i++) {
        let p = ray.origin + d * t;
        let surface = water_surface_at(p.xz);
        let f = side * (p.y - surface.x);
        if f > 0.0 { low = t; } else { high = t; }
        let newton = t + f / (fall + side * dot(surface.yz, d.xz));
        let near = abs(f) <= SURFACE_TOLERANCE_M || abs(newton - t) <= ROUNDING * t;
        if near { t = clamp(newton, low, high); break; }
        t = select(0.5 * (low + high), newton, newton > low && newton < high);
    }
    return select(t, -1.0, t > t_max);
}

// Steps are bounded by the steepest slope, so no crest is skipped; the last bracket is refined by false position.
fn march(ray: Ray, side: f32, t_max: f32) -> f32 {
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
    notes = f32(u32(notes) | MARCH_UNFINISHED);
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

// Where the pixel's ray ends if it takes the way `view.leg`: bit i says which of its two ways it takes where it meets the water for the
// (i + 1)th time. The main way (0) leads through the water, but from below only if an object is seen there; else it is the mirrored one.
// After `view.splits` times it takes the main way, and the other one shows the sky if it leads into the air. A ray that meets the water
// more than `view.bounces` times is cut off there; in the water it goes straight on.
fn follow(first: Ray) -> Pixel {
    let nothing = Seen(0.0, -1, vec3f(0.0), vec3f(0.0));
    var pixel = Pixel(nothing, vec3f(0.0), VERY_FAR_M, view.start_m, 0.0, 0.0, 0.0, 0.0);
    var ray = first;
    var in_air = is_over_water(ray.origin, 0.0);
    let from_air = in_air;
    let apparent = select(1.0 / view.ior, view.ior, in_air);
    var weight = 1.0;
    var path_m = 0.0;
    var t_min = 0.0;
    var splits = 0u;
    for (var meeting = 0u; meeting <= view.bounces; meeting++) {
        let notes_before = notes;
        var t_water = meet_water(ray, select(-1.0, 1.0, in_air), VERY_FAR_M);
        let is_last = meeting == view.bounces && t_water >= 0.0;
        let t_cut = t_water;
        if is_last && !in_air { t_water = -1.0; }
        let seen = trace_scene(ray, t_min, select(VERY_FAR_M, t_water, t_water >= 0.0));
        let length_m = max(select(t_water, seen.t, seen.receiver >= 0), 0.0);
        // Relative to the medium of the camera.
        let apparent_m = select(length_m / apparent, length_m, in_air == from_air);
        if seen.receiver >= 0 {
            if is_last && !in_air && seen.t > t_cut { notes = f32(u32(notes) | CUT_OFF); } else { notes = notes_before; }
            pixel.seen = seen;
            pixel.position = ray.origin + ray.direction * seen.t;
            pixel.weight = weight;
            pixel.path_m = path_m + select(length_m, 0.0, in_air);
            pixel.reach_m += apparent_m;
            if meeting == 0u { pixel.first_m = view.start_m + length_m; }
            break;
        }
        if is_last { notes = f32(u32(notes) | CUT_OFF); }
        if t_water < 0.0 || is_last {
            if in_air { pixel.sky_weight += weight; pixel.sky_path_m = path_m; }
            break;
        }
        if meeting == 0u { pixel.first_m = view.start_m + t_water; }
        pixel.reach_m += apparent_m;
        path_m += select(length_m, 0.0, in_air);
        let p = ray.origin + ray.direction * t_water;
        let slope = water_surface_at(p.xz).yz;
        let upward = normal_from_slope(slope.x, slope.y);
        let normal = select(-upward, upward, in_air);
        let ior = select(1.0 / view.ior, view.ior, in_air);
        let reflectance = fresnel_reflectance(clamp(-dot(ray.direction, normal), 0.0, 1.0), ior);
        let refracted = refract_direction(ray.direction, normal, ior);
        let through = select(0.0, (1.0 - reflectance) / (ior * ior), refracted.w > 0.0);
        var goes_through = in_air;
        if !in_air && through > 0.0 {
            goes_through = trace_objects(view.instance_count, p, refracted.xyz, START_M, VERY_FAR_M).receiver >= 0;
        }
        if splits < view.splits {
            if ((view.leg >> splits) & 1u) == 1u { goes_through = !goes_through; }
            splits++;
        } else if in_air || !goes_through {
            pixel.sky_weight += weight * select(through, reflectance, in_air);
            pixel.sky_path_m = path_m;
        }
        weight *= select(reflectance, through, goes_through);
        if weight == 0.0 { break; }
        ray = Ray(p, select(reflect_direction(ray.direction, normal), refracted.xyz, goes_through));
        in_air = in_air != goes_through;
        t_min = START_M;
    }
    if (view.leg >> splits) > 0u {
        // The ray met the water less often: another leg has taken this way.
        notes = 0.0;
        return Pixel(nothing, vec3f(0.0), pixel.first_m, 0.0, 0.0, 0.0, 0.0, 0.0);
    }
    return pixel;
}

@compute @workgroup_size(8, 8)
fn camera_hits_main(@builtin(global_invocation_id) id: vec3u) {
    let index = band_pixel(id);
    if index >= view.width * view.row_count { return; }
    let ray = pixel_ray(id.x, id.y + view.first_row);
    notes = 0.0;
    let pixel = follow(ray);
    let seen = pixel.seen.receiver >= 0;
    var receiver = f32(pixel.seen.receiver);
    if seen && is_over_water(pixel.position, SURFACE_TOLERANCE_M) { receiver = -2.0 - receiver; }
    // Side of a pixel at unit distance, or (orthographic) anywhere.
    let pixel_side = 2.0 * length(view.up.xyz) / f32(view.height);
    let footprint_m = select(0.0, pixel_side * select(pixel.reach_m, 1.0, view.orthographic == 1u), seen);
    points[index] = Point(select(vec3f(0.0), pixel.position, seen), receiver, pixel.seen.normal, footprint_m);
    let depth_m = pixel.first_m * dot(ray.direction, view.forward.xyz);
    visible_depth[index] = select(depth_m, FAR_DEPTH_M, pixel.first_m >= VERY_FAR_M);
    visible_albedo[index] = vec4f(pixel.seen.albedo, select(0.0, pixel.path_m, seen));
    visible_transport[index] = vec4f(pixel.weight, pixel.sky_weight, pixel.sky_path_m, notes);
}
