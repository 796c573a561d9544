//! Legs: the ways that a camera ray takes where it splits at the water.

use super::SceneFacts;

/// How camera rays split at the water.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Legs {
    /// How often a ray may meet the water, 1 … 4.
    pub bounces: u32,
    /// How often it splits into a ray that goes through and one that is mirrored, 0 … `bounces`.
    pub splits: u32,
    /// Why it splits, or why not.
    pub reason: String,
}

impl Legs {
    /// Number of ways.
    pub fn count(&self) -> u32 {
        1 << self.splits
    }
}

impl SceneFacts {
    /// How the rays of the camera split.
    ///
    /// From above, a mirrored ray shows more than the sky only if an object stands out of the water; from below, a ray that goes through
    /// shows more than the sky only then. Without such an object, each ray has one way, and the other shows the sky.
    pub fn legs(&self) -> Legs {
        let wanted = self.quality.bounces;
        let least_m = -self.water.surface.max_height_m();
        let stands_out = |o: &super::placement::ObjectFacts| o.max.y > least_m;
        let objects = self.receivers.objects.iter().filter(|o| stands_out(o));
        let objects = objects.count();
        // A ray that flat water has mirrored never meets it again.
        let is_flat = self.water.surface.max_slope() == 0.0;
        let (splits, reason) = match wanted {
            0 => (0, "`bounces` is 0: the water mirrors only the sky".to_owned()),
            1 if objects == 0 => (
                0,
                "no object stands out of the water: beside what is seen through it there is only the sky".to_owned(),
            ),
            _ if is_flat && objects == 0 => (
                0,
                "the water is flat and no object stands out of it: beside what is seen through it there is only the sky".to_owned(),
            ),
            _ if is_flat => (1, "the water is flat: rays meet it once".to_owned()),
            1 => (1, format!("objects that stand out of the water: {objects}")),
            _ => (wanted, format!("rays may meet the water {wanted} times")),
        };
        Legs {
            bounces: if is_flat { 1 } else { wanted.max(1) },
            splits,
            reason,
        }
    }
}
