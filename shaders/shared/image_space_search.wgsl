// The search for the end of a ray in the depth texture of a view (Mihálik 2008, §7.1), here along the sun's rays.

// Height of the surface that the view shows per texel (m); the bottom's where it shows nothing.
@group(0) @binding(23) var light_depth: texture_2d<f32>;

// Length of two sides of a triangle, as a share of the third, up to which a point counts as between two others (§9.1).
const BETWEEN: f32 = 1.1;

struct End {
    t: f32,         // along the ray, m
    gap_m: f32,     // distance along the light between the end and the surface that the view shows there
    is_empty: bool, // whether there is no receiver
}

// A of the paper: the surface that the view shows on the light's ray through `p`.
fn shown_at(p: vec3f) -> vec3f {
    let uv = view_place(p);
    var y = light_view.bottom_y_m;
    if is_within(uv) { y = textureLoad(light_depth, vec2i(uv), 0).x; }
    return point_at(place_of_point(p), y);
}

// Whether the view shows no receiver at a height.
fn shows_nothing(y: f32) -> bool {
    return light_view.has_floor == 0u && y <= light_view.bottom_y_m;
}

// The nearest to its own A of the points W_1 … W_iterations on a ray.
fn search(u: vec3f, r: vec3f) -> End {
    var a_before = shown_at(u);
    var t = length(a_before - u);
    var best = End(0.0, 3e38, true);
    for (var i = 0u; i < light_view.iterations; i++) {
        let w = u + r * t;
        let a = shown_at(w);
        let gap = length(a - w);
        if gap < best.gap_m { best = End(t, gap, shows_nothing(a.y)); }
        // Formula (3): where the ray meets the line from A_i to A_(i+1).
        let q = a - a_before;
        let across = cross(r, q);
        let across2 = dot(across, across);
        var is_between = false;
        if across2 > 0.0 {
            let t_line = dot(cross(a_before - u, q), across) / across2;
            let met = u + r * t_line;
            is_between = length(met - a_before) + length(a - met) <= BETWEEN * length(q);
            if is_between { t = t_line; }
        }
        // Else on by the distance to A, or back if the surface is nearer to the light than W (figures 10 to 12).
        if !is_between { t += select(gap, -gap, w.y < a.y); }
        a_before = a;
    }
    return best;
}
