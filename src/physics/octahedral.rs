//! Octahedral map: all directions on a square. The sphere is mapped to an octahedron whose upper half is folded outwards.

use glam::{DVec2, DVec3};

/// Unit direction of the point (u, v) in −1 … 1: straight down in the middle, horizontal on |u| + |v| = 1, straight up in the
/// corners.
///
/// Source: Cigolle et al., Journal of Computer Graphics Techniques 3(2), 2014, §2 ("oct"), about the −y axis.
pub fn octahedral_direction(u: f64, v: f64) -> DVec3 {
    let rise = u.abs() + v.abs() - 1.0;
    let fold = rise.max(0.0);
    DVec3::new(u - fold.copysign(u), rise, v - fold.copysign(v)).normalize()
}

/// The point (u, v) of a direction of any length that goes down or is horizontal.
pub fn octahedral_place(direction: DVec3) -> DVec2 {
    DVec2::new(direction.x, direction.z) / direction.abs().element_sum()
}
