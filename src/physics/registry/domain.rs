//! The arguments a twin is tested with.

use super::Twin;

/// How the values between the ends of a domain are spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// Evenly.
    Even,
    /// The same number in each decade between these magnitudes, with both signs if the domain has both. Values outside these
    /// magnitudes are covered by edges.
    Decades(f64, f64),
}

/// Range of an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How the values between are spread.
    pub spacing: Spacing,
    /// Special values to test in addition, alone and combined with those of other arguments.
    pub edges: &'static [f64],
}

impl Domain {
    /// The value at `share` (0 … 1) of the domain.
    fn at(&self, share: f64) -> f64 {
        match self.spacing {
            Spacing::Even => self.low + share * (self.high - self.low),
            Spacing::Decades(smallest, largest) => {
                let (sign, share) = match (self.low < 0.0, share < 0.5) {
                    (false, _) => (1.0, share),
                    (true, true) => (-1.0, 1.0 - 2.0 * share),
                    (true, false) => (1.0, 2.0 * share - 1.0),
                };
                sign * smallest * (largest / smallest).powf(share)
            }
        }
    }
}

/// 2 to 3 times `count` argument lists that cover a twin's domain: a low-discrepancy sequence; the same with one argument on an
/// edge; and edges in all arguments, in every combination if `count` is large enough.
pub fn samples(twin: &Twin, count: usize) -> Vec<[f64; 8]> {
    let mut all = Vec::with_capacity(3 * count);
    // The R sequence (Roberts 2018), which generalises the golden ratio: one irrational step per argument.
    let mut g: f64 = 1.5;
    for _ in 0..32 {
        g = (1.0 + g).powf(1.0 / (twin.domain.len() as f64 + 1.0));
    }
    let combinations: usize = twin
        .domain
        .iter()
        .map(|domain| domain.edges.len())
        .product();
    for index in 0..count {
        let mut args = [0.0; 8];
        let mut corner = [0.0; 8];
        let mut place = index;
        for (k, domain) in twin.domain.iter().enumerate() {
            let share = (0.5 + index as f64 * g.powi(-(k as i32) - 1)).fract();
            args[k] = domain.at(share);
            let edges = domain.edges;
            corner[k] = if combinations <= count {
                edges[place % edges.len()]
            } else {
                edges[(share * edges.len() as f64) as usize]
            };
            place /= edges.len();
        }
        all.push(args);
        if index < combinations {
            all.push(corner);
        }
        let k = index % twin.domain.len();
        let edges = twin.domain[k].edges;
        args[k] = edges[(index / twin.domain.len()) % edges.len()];
        all.push(args);
    }
    // Round the arguments to f32.
    for args in &mut all {
        for a in args {
            *a = f64::from(*a as f32);
        }
    }
    all
}
