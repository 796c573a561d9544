//! Where obstacles cut the water at rest, on the grid of a basin.

use std::ops::Range;

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::cells::Cells;
use crate::mesh::Mesh;
use crate::scene::{Object, ResolvedScene, Ripples, Walls};

/// Crossings that are held at once.
const MOST_CROSSINGS: i64 = 1 << 22;

/// The obstacles of a basin on its grid.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    /// Whether a sample is inside an obstacle; row by row along x.
    pub(super) inside: Vec<bool>,
    /// Whether water can flow between a sample and the one before it along x, and along z. What is before the first sample is the last if
    /// the grid wraps; else nothing can flow.
    pub(super) open: [Vec<bool>; 2],
    /// Obstacles, as places in the list of the basin, that touch no sample.
    pub(super) idle: Vec<usize>,
}

impl Footprint {
    /// The obstacles of `ripples`; none if it has none.
    pub(super) fn of(ripples: &Ripples, resolved: &ResolvedScene, cells: &Cells) -> Option<Self> {
        if ripples.obstacles.is_empty() {
            return None;
        }
        let [width, height] = cells.size;
        let mut found = Self {
            inside: vec![false; cells.count()],
            open: [vec![true; cells.count()], vec![true; cells.count()]],
            idle: Vec::new(),
        };
        let level_m = resolved.scene.water.level_m;
        for (place, index) in ripples.obstacles.iter().enumerate() {
            let index = *index as usize;
            let object = resolved.scene.objects.get(index);
            let mut cut = match object.zip(resolved.meshes.get(index)) {
                Some((object, mesh)) => Cut::of(object, mesh, level_m),
                None => Cut::default(),
            };
            if cells.wraps && ripples.walls == Walls::Periodic {
                cut.repeat(ripples);
            }
            if !found.add(&cut, cells) {
                found.idle.push(place);
            }
        }
        for row in 0..height {
            for column in 0..width {
                let at = row * width + column;
                let before = [
                    row * width + (column + width - 1) % width,
                    (row + height - 1) % height * width + column,
                ];
                let first = [column == 0, row == 0];
                for axis in [0, 1] {
                    found.open[axis][at] &= !(found.inside[at]
                        || found.inside[before[axis]]
                        || (first[axis] && !cells.wraps));
                }
            }
        }
        Some(found)
    }

    /// Adds the cut of an obstacle. Whether it touches a sample.
    fn add(&mut self, cut: &Cut, cells: &Cells) -> bool {
        let mut touches = false;
        let is_closed = cut.is_closed();
        for axis in [0, 1] {
            let (along, lines) = (cells.size[axis], cells.size[1 - axis]);
            for lines_of_block in cut.blocks(axis, cells) {
                let first = lines_of_block.start;
                let mut crossings = cut.crossings(axis, cells, lines_of_block);
                for (line, places_m) in crossings.iter_mut().enumerate() {
                    let line = first + line;
                    places_m.sort_by(f64::total_cmp);
                    let at = |index: usize| match axis {
                        0 => line * along + index,
                        _ => index * lines + line,
                    };
                    for place_m in places_m.iter() {
                        // The first sample at or beyond it.
                        let index = ((place_m - cells.first_m[axis]) / cells.step_m[axis]).ceil();
                        let last = if cells.wraps { along } else { along - 1 };
                        if index >= 1.0 && index <= last as f64 {
                            self.open[axis][at(index as usize % along)] = false;
                            touches = true;
                        }
                    }
                    if axis == 0 && is_closed {
                        let mut passed = 0;
                        for index in 0..along {
                            let place_m = cells.place_m(axis, index);
                            while passed < places_m.len() && places_m[passed] <= place_m {
                                passed += 1;
                            }
                            if passed % 2 == 1 {
                                self.inside[at(index)] = true;
                                touches = true;
                            }
                        }
                    }
                }
            }
        }
        touches
    }

    /// Bytes that differ for different footprints.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let [x, z] = &self.open;
        let flags = self.inside.iter().zip(x).zip(z);
        flags
            .map(|((inside, x), z)| u8::from(*inside) | u8::from(*x) << 1 | u8::from(*z) << 2)
            .collect()
    }
}

/// The cut of a mesh with the plane of the water at rest: pieces of lines, (x, z), m.
#[derive(Clone, Debug, Default)]
struct Cut {
    pieces_m: Vec<[DVec2; 2]>,
}

impl Cut {
    fn of(object: &Object, mesh: &Mesh, level_m: f64) -> Self {
        let [x, y, z, w] = object.rotation;
        let linear = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize())
            * DMat3::from_diagonal(DVec3::from(object.scale.per_axis()));
        let moved_m = linear * mesh.origin_m + DVec3::from(object.translation_m);
        let mut pieces_m = Vec::new();
        for triangle in &mesh.triangles {
            let corners = triangle
                .positions_m
                .map(|p| linear * p.as_dvec3() + moved_m);
            let above = corners.map(|p| p.y >= level_m);
            let ends: Vec<DVec2> = [[0, 1], [1, 2], [2, 0]]
                .into_iter()
                .filter(|[a, b]| above[*a] != above[*b])
                .map(|[a, b]| {
                    // From below to above, so that triangles on both sides of an edge find the same point.
                    let (low, high) = if above[a] { (b, a) } else { (a, b) };
                    let (low, high) = (corners[low], corners[high]);
                    let point = low + (high - low) * ((level_m - low.y) / (high.y - low.y));
                    // No −0, so that equal points have equal bits.
                    DVec2::new(point.x + 0.0, point.z + 0.0)
                })
                .collect();
            if let [a, b] = ends[..] {
                pieces_m.push([a, b]);
            }
        }
        Self { pieces_m }
    }

    /// Adds the copies of an obstacle that reaches over the sides of a periodic basin: those next to it.
    fn repeat(&mut self, ripples: &Ripples) {
        let [min, max] = [ripples.min_m, ripples.max_m].map(DVec2::from);
        let reaches_over = |p: &DVec2| p.cmplt(min).any() || p.cmpgt(max).any();
        if !self.pieces_m.iter().flatten().any(reaches_over) {
            return;
        }
        let around = [-1.0, 0.0, 1.0];
        let shifts = around
            .iter()
            .flat_map(|x| around.map(|z| DVec2::new(*x, z)));
        let shifts = shifts
            .map(|shift| shift * (max - min))
            .filter(|shift| *shift != DVec2::ZERO);
        let copies: Vec<[DVec2; 2]> = shifts
            .flat_map(|shift| {
                self.pieces_m
                    .iter()
                    .map(move |piece_m| piece_m.map(|p| p + shift))
            })
            .collect();
        self.pieces_m.extend(copies);
    }

    /// Whether every piece continues at both of its ends.
    fn is_closed(&self) -> bool {
        let bits = |p: &DVec2| [p.x.to_bits(), p.y.to_bits()];
        let mut ends: Vec<[u64; 2]> = self.pieces_m.iter().flatten().map(bits).collect();
        ends.sort_unstable();
        ends.chunk_by(|a, b| a == b).all(|same| same.len() % 2 == 0)
    }

    /// The lines of samples along `axis` that a piece may cross.
    fn lines(piece_m: &[DVec2; 2], axis: usize, cells: &Cells) -> Range<usize> {
        let lines = cells.size[1 - axis];
        let index = |place_m: f64| {
            let index = (place_m - cells.first_m[1 - axis]) / cells.step_m[1 - axis];
            index.clamp(0.0, lines as f64) as usize
        };
        let [a, b] = piece_m.map(|p| p[1 - axis]);
        // One more at each end, for rounding.
        index(a.min(b)).saturating_sub(1)..(index(a.max(b)) + 2).min(lines)
    }

    /// Lines of samples along `axis`, in blocks of about [`MOST_CROSSINGS`] crossings at most: a mesh of many long fins crosses every line
    /// with each of them.
    fn blocks(&self, axis: usize, cells: &Cells) -> Vec<Range<usize>> {
        let lines = cells.size[1 - axis];
        let mut changes = vec![0_i64; lines + 1];
        for piece_m in &self.pieces_m {
            let range = Self::lines(piece_m, axis, cells);
            if !range.is_empty() {
                changes[range.start] += 1;
                changes[range.end] -= 1;
            }
        }
        let (mut blocks, mut start, mut crossed, mut now) = (Vec::new(), 0, 0, 0);
        for (line, change) in changes[..lines].iter().enumerate() {
            now += change;
            if crossed > 0 && crossed + now > MOST_CROSSINGS {
                blocks.push(start..line);
                (start, crossed) = (line, 0);
            }
            crossed += now;
        }
        blocks.push(start..lines);
        blocks
    }

    /// Where the cut crosses each line of a block along `axis`, m.
    fn crossings(&self, axis: usize, cells: &Cells, block: Range<usize>) -> Vec<Vec<f64>> {
        let mut crossings = vec![Vec::new(); block.len()];
        for piece_m in &self.pieces_m {
            let [a, b] = piece_m.map(|p| [p.x, p.y]);
            let range = Self::lines(piece_m, axis, cells);
            for line in range.start.max(block.start)..range.end.min(block.end) {
                let line_m = cells.place_m(1 - axis, line);
                // Each end belongs to one side, so that a line through a corner crosses once or twice, as it should.
                if (a[1 - axis] <= line_m) != (b[1 - axis] <= line_m) {
                    let share = (line_m - a[1 - axis]) / (b[1 - axis] - a[1 - axis]);
                    crossings[line - block.start].push(a[axis] + share * (b[axis] - a[axis]));
                }
            }
        }
        crossings
    }
}
