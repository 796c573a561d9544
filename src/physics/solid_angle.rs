//! Solid angles of triangles, to which the flux of a point light is proportional.

use glam::DVec3;

/// Angle of the point (x, y) against the x axis, rad, above −π, at most π; 0 at the origin. The sign of zeros does not matter.
pub fn point_angle(y: f64, x: f64) -> f64 {
    // Adding 0 makes −0 into 0.
    (y + 0.0).atan2(x + 0.0)
}

/// Solid angle of the triangle with corners `a`, `a + ab`, `a + ac`, seen from the origin, sr, −2π … 2π.
///
/// tan(Ω/2) = a·(b × c) / (abc + (a·b)c + (a·c)b + (b·c)a); positive if `ab` × `ac` points away from the origin. Source: Van
/// Oosterom & Strackee, IEEE Transactions on Biomedical Engineering 30, 1983, eq. 8. The triple product is computed from a, ab
/// and ac, which is equal and accurate for small triangles.
pub fn solid_angle(a: DVec3, ab: DVec3, ac: DVec3) -> f64 {
    let (b, c) = (a + ab, a + ac);
    let (a_m, b_m, c_m) = (a.length(), b.length(), c.length());
    let triple = a.dot(ab.cross(ac));
    let sum = a_m * b_m * c_m + a.dot(b) * c_m + a.dot(c) * b_m + b.dot(c) * a_m;
    2.0 * point_angle(triple, sum)
}
