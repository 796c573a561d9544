//! The hierarchy against testing every triangle, and the triangle test against f64.

use caustica::mesh::hierarchy::{self, LEAF, Ray, TriangleHit};
use caustica::mesh::{HierarchyNode, Triangle};
use glam::{DVec3, Vec3};

/// A linear congruential generator (Knuth's MMIX constants), upper bits.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u32 << 24) as f32
    }

    fn point(&mut self, half: f32) -> Vec3 {
        Vec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * 2.0 * half
    }
}

fn triangle(positions_m: [Vec3; 3]) -> Triangle {
    let [a, b, c] = positions_m;
    Triangle {
        positions_m,
        normals: [(b - a).cross(c - a).normalize_or(Vec3::Y); 3],
        material: 0,
    }
}

fn soup(count: usize, half: f32, size: f32, random: &mut Random) -> Vec<Triangle> {
    (0..count)
        .map(|_| {
            let middle = random.point(half);
            triangle([0, 1, 2].map(|_| middle + random.point(size)))
        })
        .collect()
}

/// A closed sphere of radius 1 with 2 · `around` · (`down` − 1) triangles.
fn sphere(around: usize, down: usize) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let polar = std::f64::consts::PI * j as f64 / down as f64;
        let azimuth = std::f64::consts::TAU * (i % around) as f64 / around as f64;
        if j == 0 || j == down {
            return Vec3::Y * polar.cos() as f32;
        }
        DVec3::new(
            polar.sin() * azimuth.cos(),
            polar.cos(),
            polar.sin() * azimuth.sin(),
        )
        .as_vec3()
    };
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..down {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if j > 0 {
                triangles.push(triangle([a, b, c]));
            }
            if j + 1 < down {
                triangles.push(triangle([a, c, d]));
            }
        }
    }
    triangles
}

fn brute_force(
    triangles: &[Triangle],
    origin: Vec3,
    direction: Vec3,
    t_min: f32,
    t_max: f32,
) -> Option<TriangleHit> {
    let ray = Ray::new(origin, direction);
    let mut best: Option<TriangleHit> = None;
    for (index, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.positions_m;
        // A triangle too small to be distinguished from a point at this distance: the traversal's boxes protect it from
        // misjudging such a one, here it has to be near the ray.
        let along = (a - origin).project_onto(direction);
        let far_off = (a - origin - along).length();
        if far_off > 1.01 * (b - a).length().max((c - a).length()) + 1e-4 {
            continue;
        }
        if let Some((t, u, v)) = ray.hit_triangle(&triangle.positions_m)
            && (t_min..=t_max).contains(&t)
            && best.is_none_or(|b| t < b.t)
        {
            best = Some(TriangleHit {
                t,
                triangle: index as u32,
                u,
                v,
            });
        }
    }
    best
}

/// Möller–Trumbore in f64: t, and the smallest of the three weights.
fn exact([a, b, c]: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<(f64, f64)> {
    let [a, b, c, o, d] = [a, b, c, origin, direction].map(|p| p.as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let p = d.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = o - a;
    let u = s.dot(p) / determinant;
    let q = s.cross(ab);
    let v = d.dot(q) / determinant;
    Some((ac.dot(q) / determinant, u.min(v).min(1.0 - u - v)))
}

/// Walks random rays from a cube of `half` a side towards the triangles; returns how many hit.
fn compare(triangles: &[Triangle], rays: usize, half: f32, random: &mut Random) -> usize {
    let nodes = hierarchy::build(triangles);
    check_structure(&nodes, triangles);
    let size = triangles
        .iter()
        .flat_map(|t| t.positions_m)
        .fold(0.0, |size: f32, p| size.max(p.length()));
    let mut hits = 0;
    for index in 0..rays {
        let origin = random.point(half);
        let mut direction = random.point(half.min(size)) - origin;
        // Every fourth ray runs along an axis or in a plane of two axes.
        match index % 16 {
            0 => direction = Vec3::X * direction.x.signum(),
            4 => direction = Vec3::NEG_Y,
            8 => direction.z = 0.0,
            12 => direction.x = -0.0,
            _ => {}
        }
        let (t_min, t_max) = (0.0, if index % 2 == 0 { 1e9 } else { 0.7 });
        let walked = hierarchy::first_hit(&nodes, triangles, origin, direction, t_min, t_max);
        let tried = brute_force(triangles, origin, direction, t_min, t_max);
        hits += usize::from(tried.is_some());
        // Of triangles that meet the ray at the same place, rounding decides which is first.
        assert_eq!(
            walked.is_some(),
            tried.is_some(),
            "ray {index}: {origin} {direction}"
        );
        if let (Some(walked), Some(tried)) = (walked, tried) {
            let apart = (walked.t - tried.t).abs() * direction.length();
            assert!(
                apart <= 1e-6 * (size + origin.length()),
                "ray {index}: {walked:?} {tried:?}"
            );
        }
        if let Some(hit) = walked {
            check_hit(&hit, triangles, origin, direction);
        }
    }
    hits
}

/// The hit point lies on the triangle, at the weights and the distance given.
fn check_hit(hit: &TriangleHit, triangles: &[Triangle], origin: Vec3, direction: Vec3) {
    assert!(
        hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.000_001,
        "{hit:?}"
    );
    let [a, b, c] = triangles[hit.triangle as usize].positions_m;
    let on_triangle = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
    let scale = 1.0 + origin.length() + (hit.t * direction).length();
    assert!(
        (origin + hit.t * direction - on_triangle).length() < 2e-6 * scale,
        "{hit:?}"
    );
}

/// Each triangle is one leaf, inside the boxes of all its ancestors; every link leads on.
fn check_structure(nodes: &[HierarchyNode], triangles: &[Triangle]) {
    assert_eq!(nodes.len(), 2 * triangles.len() - 1);
    let end = nodes.len() as u32;
    assert_eq!(nodes[0].exit, end);
    let mut seen = vec![false; triangles.len()];
    let mut ancestors: Vec<usize> = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        assert!(node.exit > index as u32 && node.exit <= end);
        while ancestors
            .last()
            .is_some_and(|&a| nodes[a].exit <= index as u32)
        {
            ancestors.pop();
        }
        ancestors.push(index);
        if node.entry & LEAF == 0 {
            assert_eq!(node.entry, index as u32 + 1);
            continue;
        }
        assert_eq!(node.exit, index as u32 + 1);
        let triangle = (node.entry & !LEAF) as usize;
        assert!(!std::mem::replace(&mut seen[triangle], true));
        for corner in triangles[triangle].positions_m {
            for &ancestor in &ancestors {
                let (min, max) = (
                    Vec3::from(nodes[ancestor].min_m),
                    Vec3::from(nodes[ancestor].max_m),
                );
                assert!(corner.cmpgt(min).all() && corner.cmplt(max).all());
            }
        }
    }
    assert!(seen.iter().all(|&s| s));
}

#[test]
fn no_triangles_make_no_nodes() {
    assert!(hierarchy::build(&[]).is_empty());
    assert_eq!(
        hierarchy::first_hit(&[], &[], Vec3::ZERO, Vec3::X, 0.0, 1.0),
        None
    );
}

#[test]
fn one_triangle_is_a_leaf() {
    let triangles = [triangle([Vec3::ZERO, Vec3::X, Vec3::Z])];
    let nodes = hierarchy::build(&triangles);
    assert_eq!((nodes.len(), nodes[0].entry, nodes[0].exit), (1, LEAF, 1));
    let shoot = |x: f32, z: f32, t_min: f32, t_max: f32| {
        let origin = Vec3::new(x, 2.0, z);
        hierarchy::first_hit(&nodes, &triangles, origin, Vec3::NEG_Y * 0.5, t_min, t_max)
    };
    let hit = shoot(0.25, 0.5, 0.0, 10.0).expect("a ray through the middle");
    assert_eq!((hit.t, hit.triangle), (4.0, 0));
    assert!(
        (hit.u - 0.25).abs() < 1e-6 && (hit.v - 0.5).abs() < 1e-6,
        "{hit:?}"
    );
    assert!(
        shoot(0.25, 0.5, 4.0, 4.0).is_some(),
        "both ends of the range count"
    );
    assert!(shoot(0.25, 0.5, 0.0, 3.99).is_none());
    assert!(shoot(0.25, 0.5, 4.01, 10.0).is_none());
    assert!(shoot(0.6, 0.6, 0.0, 10.0).is_none());
    // From below, and from behind the plane.
    let up = |y: f32| {
        hierarchy::first_hit(
            &nodes,
            &triangles,
            Vec3::new(0.2, y, 0.2),
            Vec3::Y,
            0.0,
            10.0,
        )
    };
    assert_eq!(up(-1.0).map(|h| h.t), Some(1.0));
    assert_eq!(up(1.0), None);
    // A negative range looks backwards.
    let back = hierarchy::first_hit(
        &nodes,
        &triangles,
        Vec3::new(0.2, 1.0, 0.2),
        Vec3::Y,
        -2.0,
        -0.5,
    );
    assert_eq!(back.map(|h| h.t), Some(-1.0));
    let hits = compare(&triangles, 500, 1.5, &mut Random(1));
    assert!(hits > 10, "{hits}");
}

#[test]
fn random_triangles_agree_with_brute_force() {
    let mut random = Random(2);
    for (count, size) in [(2, 0.8), (3, 0.5), (64, 0.3), (500, 0.1)] {
        let triangles = soup(count, 1.0, size, &mut random);
        let hits = compare(&triangles, 1_000, 1.5, &mut random);
        assert!(
            (20..1_000).contains(&hits),
            "{count} triangles: {hits} hits"
        );
    }
}

#[test]
fn ten_thousand_triangles_agree_with_brute_force() {
    let mut random = Random(3);
    let triangles = soup(10_000, 1.0, 0.05, &mut random);
    let hits = compare(&triangles, 400, 1.5, &mut random);
    assert!(hits > 100, "{hits}");
}

#[test]
fn flat_and_repeated_sets_agree_with_brute_force() {
    let mut random = Random(4);
    for axis in 0..3 {
        // All in one plane across an axis, also the plane through the origin.
        for height in [0.0, 0.3] {
            let mut triangles = soup(200, 1.0, 0.2, &mut random);
            for corner in triangles.iter_mut().flat_map(|t| &mut t.positions_m) {
                corner[axis] = height;
            }
            assert!(compare(&triangles, 500, 1.5, &mut random) > 20);
        }
    }
    // All with the same middle, and all the same.
    let middle = vec![triangle([Vec3::X, Vec3::Y, Vec3::Z]); 100];
    assert!(compare(&middle, 500, 1.5, &mut random) > 5);
}

#[test]
fn sizes_far_apart_agree_with_brute_force() {
    let mut random = Random(5);
    let mut triangles = Vec::new();
    for power in -14..2 {
        let size = 10_f32.powi(power);
        triangles.extend(soup(3, size, size, &mut random));
    }
    // From near all of them, from far away, whence few rays hit, and from among the smallest.
    let hits = [(1.0, 500), (100.0, 5000), (1e-6, 500)]
        .map(|(half, rays)| compare(&triangles, rays, half, &mut random));
    assert!(hits.iter().all(|&hits| hits > 10), "{hits:?}");
}

#[test]
fn the_triangle_test_agrees_with_f64() {
    let mut random = Random(6);
    let mut hits = 0;
    for _ in 0..20_000 {
        let corners = [0, 1, 2].map(|_| random.point(1.0));
        let (origin, direction) = (random.point(2.0), random.point(1.0));
        let found = Ray::new(origin, direction).hit_triangle(&corners);
        let Some((t, least_weight)) = exact(corners, origin, direction) else {
            continue;
        };
        // Seen from the side, or past an edge by less than rounding: either answer is right.
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let facing = normal.dot(direction).abs() / direction.length();
        if facing < 1e-2 || least_weight.abs() < 1e-4 {
            continue;
        }
        assert_eq!(found.is_some(), least_weight > 0.0);
        if let Some((found_t, ..)) = found {
            hits += 1;
            let error = (f64::from(found_t) - t).abs() * f64::from(direction.length());
            assert!(error < 1e-4, "{error}");
        }
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn no_ray_leaves_a_closed_surface() {
    let triangles = sphere(100, 51);
    assert_eq!(triangles.len(), 10_000);
    let nodes = hierarchy::build(&triangles);
    let mut random = Random(7);
    let mut origins = vec![Vec3::ZERO];
    origins.extend((0..4).map(|_| random.point(0.5)));
    // Through every corner and the middle of every edge, where a crack would be.
    for origin in origins {
        for (
            index,
            Triangle {
                positions_m: [a, b, c],
                ..
            },
        ) in triangles.iter().enumerate()
        {
            for target in [
                *a,
                *b,
                *c,
                (*a + *b) * 0.5,
                (*b + *c) * 0.5,
                (*c + *a) * 0.5,
            ] {
                let hit =
                    hierarchy::first_hit(&nodes, &triangles, origin, target - origin, 0.0, 10.0);
                let hit = hit.unwrap_or_else(|| {
                    panic!("a ray from {origin} slips by triangle {index} at {target}")
                });
                assert!((hit.t - 1.0).abs() < 1e-4, "{hit:?}");
            }
        }
    }
}

#[test]
fn thin_triangles_are_hit() {
    // A strip of needles, 10⁻⁶ wide: each ray straight down must meet one.
    let mut triangles = Vec::new();
    for i in 0..1_000 {
        let (x0, x1) = (i as f32 * 1e-6, (i + 1) as f32 * 1e-6);
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        triangles.push(triangle([at(x0, -1.0), at(x0, 1.0), at(x1, 1.0)]));
        triangles.push(triangle([at(x0, -1.0), at(x1, 1.0), at(x1, -1.0)]));
    }
    let nodes = hierarchy::build(&triangles);
    let mut random = Random(8);
    for _ in 0..2_000 {
        let origin = Vec3::new(random.unit() * 1e-3, 1.0, random.unit() * 2.0 - 1.0);
        let hit = hierarchy::first_hit(&nodes, &triangles, origin, Vec3::NEG_Y, 0.0, 10.0);
        assert_eq!(hit.map(|h| h.t), Some(1.0), "{origin}");
    }
}
