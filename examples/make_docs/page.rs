//! The page itself.
use crate::scenes::Scene;
use crate::wishes::Wish;
use caustica::accuracy::study::Study;
pub(crate) struct Chapter {
    pub scene: &'static Scene,
    pub study: Study,
    pub wishes: Vec<Wish>,
}
pub(crate) fn write(chapters: &[Chapter]) -> String {
    let mut t = String::new();
    for c in chapters {
        t += &format!("{} {}\n", c.scene.name, c.scene.about);
        t += &caustica::cli::accuracy::in_words(&c.study);
        for w in &c.wishes {
            let best = c
                .study
                .sweeps
                .iter()
                .flat_map(|s| &s.points)
                .filter(|p| p.error.relative_l1 <= w.target)
                .map(|p| p.cost.wall_ms.median)
                .fold(f64::INFINITY, f64::min);
            t += &format!(
                "target {} cells {} true {:.2e} est {:.2e} ms {:.1} best sweep {:.1} ratio {:.2} choosing {:.1} meets {}\n",
                w.target,
                w.chosen.water_cells,
                w.error,
                w.estimated.unwrap_or(0.),
                w.frame_ms,
                best,
                w.frame_ms / best,
                w.choosing_ms,
                w.chosen.meets
            );
        }
    }
    t
}
