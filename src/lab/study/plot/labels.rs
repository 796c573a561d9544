//! Places labels without overlap: each goes where it hides least.

use super::canvas::Spot;

/// A rectangle, logical pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub from: Spot,
    pub to: Spot,
}

impl Area {
    pub(super) fn around(centre: Spot, half_width: f64, half_height: f64) -> Self {
        Self {
            from: (centre.0 - half_width, centre.1 - half_height),
            to: (centre.0 + half_width, centre.1 + half_height),
        }
    }

    fn overlap(&self, other: &Self) -> f64 {
        let width = self.to.0.min(other.to.0) - self.from.0.max(other.from.0);
        let height = self.to.1.min(other.to.1) - self.from.1.max(other.from.1);
        width.max(0.0) * height.max(0.0)
    }

    fn holds(&self, other: &Self) -> bool {
        self.from.0 <= other.from.0
            && self.from.1 <= other.from.1
            && self.to.0 >= other.to.0
            && self.to.1 >= other.to.1
    }

    fn size(&self) -> f64 {
        (self.to.0 - self.from.0) * (self.to.1 - self.from.1)
    }

    fn centre(&self) -> Spot {
        (
            0.5 * (self.from.0 + self.to.0),
            0.5 * (self.from.1 + self.to.1),
        )
    }
}

/// What is drawn already.
pub(super) struct Occupied {
    paper: Area,
    areas: Vec<Area>,
    lines: Vec<(Spot, Spot)>,
}

/// A label that would hide more than this share of itself is left out.
const MOST_HIDDEN: f64 = 0.15;
/// What a line through a label counts for, as a share of the label.
const LINE_COST: f64 = 0.10;
/// Steps along a line when it is tested against a label.
const STEPS: u32 = 96;

impl Occupied {
    pub(super) fn new(paper: Area) -> Self {
        Self {
            paper,
            areas: Vec::new(),
            lines: Vec::new(),
        }
    }

    pub(super) fn add(&mut self, area: Area) {
        self.areas.push(area);
    }

    pub(super) fn add_line(&mut self, from: Spot, to: Spot) {
        self.lines.push((from, to));
    }

    /// Centre for a label of this size near a marker at `spot`, and remembers it; nothing where there is no room.
    pub(super) fn place(&mut self, spot: Spot, width: f64, height: f64) -> Option<Spot> {
        let (mut best, mut least) = (None, f64::INFINITY);
        for (rank, area) in candidates(spot, width, height).enumerate() {
            if !self.paper.holds(&area) {
                continue;
            }
            let hidden: f64 = self.areas.iter().map(|a| a.overlap(&area)).sum();
            let crossed = self
                .lines
                .iter()
                .filter(|line| crosses(line, &area))
                .count();
            // The first places are the best to read.
            let cost =
                hidden / area.size() + LINE_COST * crossed.min(3) as f64 + 0.004 * rank as f64;
            let allowed = hidden / area.size() <= MOST_HIDDEN;
            if allowed && cost < least {
                (best, least) = (Some(area), cost);
            }
        }
        let area = best?;
        self.areas.push(area);
        Some(area.centre())
    }
}

/// Places around a spot, best first: right of it and above, then around, then farther out.
fn candidates(spot: Spot, width: f64, height: f64) -> impl Iterator<Item = Area> {
    const AROUND: [Spot; 8] = [
        (0.75, -0.75),
        (1.0, 0.0),
        (0.0, -1.0),
        (0.75, 0.75),
        (0.0, 1.0),
        (-0.75, -0.75),
        (-1.0, 0.0),
        (-0.75, 0.75),
    ];
    [8.0, 13.0, 20.0].into_iter().flat_map(move |gap| {
        AROUND.into_iter().map(move |(x, y)| {
            let centre = (
                spot.0 + x * (gap + 0.5 * width),
                spot.1 + y * (gap + 0.5 * height),
            );
            Area::around(centre, 0.5 * width, 0.5 * height)
        })
    })
}

fn crosses((from, to): &(Spot, Spot), area: &Area) -> bool {
    (0..=STEPS).any(|step| {
        let t = f64::from(step) / f64::from(STEPS);
        let (x, y) = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
        (area.from.0..=area.to.0).contains(&x) && (area.from.1..=area.to.1).contains(&y)
    })
}
