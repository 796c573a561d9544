// The cut of a caustic volume: the triangle in which the horizontal plane through a point meets it, with corners relative to the point.

// Twice the area (m²) below which a cut counts as empty: it holds no point, and its density would leave the range of f32.
const LEAST_DOUBLE_AREA_M2: f32 = 1e-30;

// Twice the signed area of the point and the edge from a to b (both relative to the point), and on which side of the edge the point lies, 1
// or −1. Both are computed from the vertex with the smaller number to the other, so the two triangles at an edge get the same number with
// opposite signs. A point on the edge counts as moved by (ε, ε²), so that exactly one of them has it.
fn edge_side(a: vec2f, b: vec2f, is_forward: bool) -> vec2f {
    let from_m = select(b, a, is_forward);
    let to_m = select(a, b, is_forward);
    let double_area = from_m.x * to_m.y - from_m.y * to_m.x;
    let along = to_m - from_m;
    var side = select(-1.0, 1.0, double_area > 0.0);
    if double_area == 0.0 {
        side = select(1.0, -1.0, along.y > 0.0);
        if along.y == 0.0 { side = select(-1.0, 1.0, along.x >= 0.0); }
    }
    return vec2f(double_area, side) * select(-1.0, 1.0, is_forward);
}

// The three edges of a cut, each against the corner that it leaves out, see edge_side().
struct Cut {
    double_areas: vec3f,
    sides: vec3f,
}

fn cut_between(vertices: vec3u, p0: vec2f, p1: vec2f, p2: vec2f) -> Cut {
    let e0 = edge_side(p1, p2, vertices.y < vertices.z);
    let e1 = edge_side(p2, p0, vertices.z < vertices.x);
    let e2 = edge_side(p0, p1, vertices.x < vertices.y);
    return Cut(vec3f(e0.x, e1.x, e2.x), vec3f(e0.y, e1.y, e2.y));
}

// Twice the signed area of a cut.
fn double_area_of(cut: Cut) -> f32 {
    return cut.double_areas.x + cut.double_areas.y + cut.double_areas.z;
}

// Whether the point lies in the cut, whichever way round that is.
fn is_in(cut: Cut) -> bool {
    return cut.sides.x == cut.sides.y && cut.sides.x == cut.sides.z && abs(double_area_of(cut)) >= LEAST_DOUBLE_AREA_M2;
}
