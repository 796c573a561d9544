//! The dials as one family: a number of water cells, and what the other dials have to be so that none of them spoils what the cells
//! give or costs more than it brings.

use crate::scene::Quality;

/// Fewest water cells of a rung.
pub const FEWEST_CELLS: u32 = 16;
/// Most water cells of a rung.
pub const MOST_CELLS: u32 = 2048;

/// The dials with `cells` water cells; those that are no matter of accuracy of the light stay as they are.
pub fn rung(given: &Quality, cells: u32) -> Quality {
    let cells = cells.clamp(FEWEST_CELLS, MOST_CELLS);
    Quality {
        water_cells: cells,
        map_texels: (3 * cells / 2).clamp(128, 2048),
        level_map_texels: cells.next_power_of_two().clamp(128, 1024),
        split_levels: 4,
        target_error: None,
        time_budget_ms: None,
        ..given.clone()
    }
}
