//! Combinations of dials (rungs): for each number of water cells, values of the other dials that neither spoil the accuracy of the
//! cells nor cost more than they gain.

use crate::scene::{Output, Quality, Receiver};

/// Fewest water cells of a rung.
pub const FEWEST_CELLS: u32 = 16;
/// Most water cells of a rung.
pub const MOST_CELLS: u32 = 2048;

/// Fewest texels of level maps of meshes that only cast shadows. Shadow edges are found on the triangles themselves, but parts thinner
/// than a texel may be missed.
const SHADOW_TEXELS: u32 = 128;

/// The dials with `cells` water cells. Dials that do not affect the accuracy of the light stay as they are, and so does the size of a
/// requested map.
///
/// A beam's error falls with the square of the cells; the error of an unresolved piece falls only with its size. So a large number of
/// cells needs more split levels, each of which costs as much as all before it. In a scene of many meshes 295 cells with one level
/// had a smaller error than 256 with two (0.67 % and 0.71 %) in less time (169 and 229 ms; docs/accuracy.md, `reef`). A camera
/// interpolates between the texels of the floor's map, so the map has more texels than there are cells.
pub fn rung(given: &Quality, output: &Output, cells: u32) -> Quality {
    let cells = cells.clamp(FEWEST_CELLS, MOST_CELLS);
    Quality {
        water_cells: cells,
        map_texels: (3 * cells / 2).clamp(128, 2048),
        level_map_texels: match output {
            Output::View(_) | Output::WaterMap(_) => {
                (cells.next_power_of_two() / 2).clamp(128, 1024)
            }
            Output::IrradianceMap(map) => match map.receiver {
                Receiver::Floor(_) => (cells.next_power_of_two() / 2).clamp(SHADOW_TEXELS, 256),
                Receiver::Object(_) => given.level_map_texels,
            },
        },
        split_levels: match cells {
            ..512 => 1,
            512..1024 => 2,
            _ => 3,
        },
        target_error: None,
        time_budget_ms: None,
        ..given.clone()
    }
}

/// Whether [`rung`] sets this field of `quality`, whatever was given.
pub fn sets(dial: &str, output: &Output) -> bool {
    match dial {
        "water_cells" | "map_texels" | "split_levels" => true,
        "level_map_texels" => !matches!(
            output,
            Output::IrradianceMap(map) if matches!(map.receiver, Receiver::Object(_))
        ),
        _ => false,
    }
}
