// The kept field of light: flux down and mean direction on horizontal slices of a box, and its look-up between them. It serves any point of
// the water, whether a surface is there or not.
#import "shared/light_fields.wgsl"

// Light that falls through a horizontal plane.
struct FallingLight {
    flux_w_m2: vec3f, // irradiance of the plane from above
    drift: vec2f,     // its mean direction: metres along x and z per metre down, weighted by flux
}

@group(0) @binding(27) var<storage, read> light_field: array<u32>;

// The light of a texel, per unit power.
fn field_texel(f: LightField, slice: u32, texel: vec2u) -> FallingLight {
    let word = f.first_word + ((slice * f.height + texel.y) * f.width + texel.x) * (f.channels + 1u);
    var flux = vec3f(bitcast<f32>(light_field[word]));
    if f.channels == 3u {
        flux.y = bitcast<f32>(light_field[word + 1u]);
        flux.z = bitcast<f32>(light_field[word + 2u]);
    }
    return FallingLight(flux, unpack2x16snorm(light_field[word + f.channels]) * f.most_drift);
}

fn weight_of(light: FallingLight) -> f32 {
    return light.flux_w_m2.x + light.flux_w_m2.y + light.flux_w_m2.z;
}

// The sum of two lights with shares 1 − `share` and `share`; the drift is that of the light, so dark texels do not turn it.
fn mixed(a: FallingLight, b: FallingLight, share: f32) -> FallingLight {
    let weights = vec2f((1.0 - share) * weight_of(a), share * weight_of(b));
    let sum = weights.x + weights.y;
    let b_share = select(share, weights.y / sum, sum > 0.0);
    return FallingLight(mix(a.flux_w_m2, b.flux_w_m2, share), mix(a.drift, b.drift, b_share));
}

// Place in a slice, texels: (½, ½) is the middle of the first.
fn field_place(f: LightField, xz: vec2f) -> vec2f {
    return (xz - f.min_m) * f.texels_per_m;
}

fn is_in_box(f: LightField, place: vec2f) -> bool {
    return all(place >= vec2f(0.0)) && all(place <= vec2f(f32(f.width), f32(f.height)));
}

// Light of a slice at a place of it, linear between the middles of texels; beyond the box that of its edge.
fn slice_light(f: LightField, slice: u32, place: vec2f) -> FallingLight {
    let last = vec2u(f.width - 1u, f.height - 1u);
    let q = clamp(place - 0.5, vec2f(0.0), vec2f(last));
    let low = vec2u(q);
    let share = q - floor(q);
    var sum = FallingLight(vec3f(0.0), vec2f(0.0));
    var weight = 0.0;
    var weighted = vec2f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2u(i & 1u, i >> 1u);
        let shares = select(1.0 - share, share, corner == vec2u(1u));
        let own_share = shares.x * shares.y;
        let own = field_texel(f, slice, min(low + corner, last));
        sum.flux_w_m2 += own_share * own.flux_w_m2;
        sum.drift += own_share * own.drift;
        weight += own_share * weight_of(own);
        weighted += own_share * weight_of(own) * own.drift;
    }
    // The drift is that of the light: dark texels do not turn it.
    if weight > 0.0 { sum.drift = weighted / weight; }
    return sum;
}

// Height above which the field has no light.
fn field_top_m(f: LightField) -> f32 {
    return f.bottom_m + f.spacing_m * f32(f.slices - 1u);
}

// Light at `p`, from the slices above and below: each is looked up where a ray through `p` meets it that has the mean direction of the nearer
// slice. Above and below the box that of the outermost slice, moved along that ray. If the ray leaves the box before it meets one of the two,
// the other is taken alone.
fn falling_light(f: LightField, p: vec3f) -> FallingLight {
    let level = (p.y - f.bottom_m) / f.spacing_m;
    let lower = u32(clamp(floor(level), 0.0, f32(f.slices - 2u)));
    let share = clamp(level - f32(lower), 0.0, 1.0);
    let nearer = slice_light(f, lower + select(0u, 1u, share >= 0.5), field_place(f, p.xz));
    // How far below `p` each slice is.
    let fall_m = p.y - (f.bottom_m + f.spacing_m * vec2f(f32(lower), f32(lower + 1u)));
    let below = field_place(f, p.xz + nearer.drift * fall_m.x);
    let above = field_place(f, p.xz + nearer.drift * fall_m.y);
    let are_in = vec2<bool>(is_in_box(f, below), is_in_box(f, above));
    var own_share = share;
    if are_in.x && !are_in.y { own_share = 0.0; }
    if are_in.y && !are_in.x { own_share = 1.0; }
    let light = mixed(slice_light(f, lower, below), slice_light(f, lower + 1u, above), own_share);
    return FallingLight(light.flux_w_m2 * f.power.xyz, light.drift);
}

// Irradiance of a surface with this unit normal: flux through a horizontal square metre over flux through one of the surface.
fn irradiance_of(light: FallingLight, normal: vec3f) -> vec3f {
    return light.flux_w_m2 * max(normal.y - dot(normal.xz, light.drift), 0.0);
}
