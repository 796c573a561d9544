// The water surface: sines, trochoids, and splines through the samples of grids.
//
// Elements, after the first, which has the numbers of sines, trochoids and grids:
// - a sine: amplitude (m), frequency along x and z (turns/m), phase (turns);
// - a trochoid: the same, and a second element with its steepness;
// - a grid: place of its first coefficient (x, z) and reciprocals of its steps; numbers of coefficients along x and z, the element in
//   which its coefficients begin, and 1 if it repeats, 0 if the water beyond it is flat;
// - the coefficients of all grids (m), row by row along x, four to an element.
@group(0) @binding(1) var<storage, read> waves: array<vec4f>;

// Whether there are any; if not, nothing of them is compiled.
override TROCHOIDS: bool = true;
override WAVE_GRIDS: bool = true;

// Newton steps for Kepler's equation: with Danby's first guess, four reach the rounding of f32 up to a steepness of 0.95.
const KEPLER_STEPS: u32 = 4u;

// (height above the water at rest in m, ∂h/∂x, ∂h/∂z) at local (x, z) in m.
fn water_surface_at(p_m: vec2f) -> vec3f {
    let counts = vec3u(waves[0].xyz);
    var surface = vec3f(0.0);
    for (var i = 0u; i < counts.x; i++) {
        let w = waves[1u + i];
        let sc = sin_cos_turns(p_m.x * w.y + p_m.y * w.z + w.w);
        let slope_scale = 6.2831853 * w.x * sc.y;
        surface += vec3f(w.x * sc.x, slope_scale * w.y, slope_scale * w.z);
    }
    if TROCHOIDS {
        for (var i = 0u; i < counts.y; i++) {
            let element = 1u + counts.x + 2u * i;
            surface += trochoid_at(waves[element], waves[element + 1u].x, p_m);
        }
    }
    if WAVE_GRIDS {
        for (var i = 0u; i < counts.z; i++) {
            let element = 1u + counts.x + 2u * counts.y + 2u * i;
            surface += grid_surface_at(waves[element], waves[element + 1u], p_m);
        }
    }
    return surface;
}

// A trochoid: x = (α − s sin α)/k, h = A (cos α + s/2).
fn trochoid_at(w: vec4f, steepness: f32, p_m: vec2f) -> vec3f {
    let turns = p_m.x * w.y + p_m.y * w.z + w.w;
    let angle = 6.2831853 * (turns - round(turns));
    var alpha = angle + 0.85 * steepness * select(1.0, -1.0, angle < 0.0);
    for (var i = 0u; i < KEPLER_STEPS; i++) {
        let sc = sin_cos_turns(alpha * 0.15915494);
        alpha -= (alpha - steepness * sc.x - angle) / (1.0 - steepness * sc.y);
    }
    let sc = sin_cos_turns(alpha * 0.15915494);
    let slope_scale = -6.2831853 * w.x * sc.x / (1.0 - steepness * sc.y);
    return vec3f(w.x * (sc.y + 0.5 * steepness), slope_scale * w.y, slope_scale * w.z);
}

// The cubic B-spline through the samples of a grid.
fn grid_surface_at(place: vec4f, shape: vec4f, p_m: vec2f) -> vec3f {
    var at = (p_m - place.xy) * place.zw;
    if shape.w == 0.0 && (any(at < vec2f(0.0)) || any(at >= shape.xy)) {
        return vec3f(0.0);
    }
    // Rounding may leave it just below 0 or at the end; the indices below wrap.
    at -= shape.xy * floor(at / shape.xy);
    let cell = floor(at);
    let t = at - cell;
    let wx = spline_weights(t.x);
    let dx = spline_slopes(t.x);
    let wz = spline_weights(t.y);
    let dz = spline_slopes(t.y);
    let size = vec2u(shape.xy);
    // The first of four rows and columns, one before the cell.
    let first = vec2u(vec2i(cell) + vec2i(size) - 1);
    var surface = vec3f(0.0);
    for (var j = 0u; j < 4u; j++) {
        let row = ((first.y + j) % size.y) * size.x;
        var values = vec4f(0.0);
        for (var i = 0u; i < 4u; i++) {
            let index = row + (first.x + i) % size.x;
            values[i] = waves[u32(shape.z) + index / 4u][index % 4u];
        }
        let across = dot(values, wx);
        surface += vec3f(wz[j] * across, wz[j] * dot(values, dx) * place.z, dz[j] * across * place.w);
    }
    return surface;
}

// Weights of the four coefficients around a point at t, 0 … 1, between the middle two.
fn spline_weights(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(
        s * s * s / 6.0,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        t * t * t / 6.0,
    );
}

// Their derivatives.
fn spline_slopes(t: f32) -> vec4f {
    let s = 1.0 - t;
    return vec4f(-0.5 * s * s, -2.0 * t + 1.5 * t * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t);
}
