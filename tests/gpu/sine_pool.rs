//! The sine pool against the float64 reference: the error at each number of cells, and its order of convergence.

use caustica::accuracy::{convergence_order, metrics};
use caustica::reference::ReferenceMap;

use super::harness::{Map, truth_settings};
use super::scene_files;
use super::truths;

/// Error of the truth itself: well below what is judged by it.
const TRUTH_ERROR: f64 = 5e-4;

pub(crate) fn truth() -> ReferenceMap {
    let scene = scene_files::load("sine_pool", &[]);
    let truth = truths::floor_map(&scene, &truth_settings(TRUTH_ERROR));
    println!(
        "truth: {:.1e} with {} rays",
        truth.relative_error, truth.rays
    );
    assert!(truth.relative_error <= 2e-3);
    truth
}

fn error_at(cells: u32) -> f64 {
    let cells = cells.to_string();
    let scene = scene_files::load("sine_pool", &[("/quality/water_cells", cells.as_str())]);
    let map = Map::from(&scene);
    assert!(map.closure() <= 1e-5, "{:e}", map.closure());
    metrics::relative_l1(map.values(), truth().irradiance.as_flattened()).unwrap()
}

#[test]
fn error_falls_with_the_square_of_the_cells() {
    let points: Vec<(f64, f64)> = [64, 128, 256, 512]
        .iter()
        .map(|&cells| (f64::from(cells), error_at(cells)))
        .collect();
    let order = convergence_order(&points);
    println!("{points:?}, order {order:.2}");
    let at = |cells: f64| points.iter().find(|(n, _)| *n == cells).unwrap().1;
    assert!(at(256.0) <= 5e-3, "{points:?}");
    assert!(at(512.0) <= 1.2e-3, "{points:?}");
    assert!(order >= 1.8, "{order} from {points:?}");
}

#[test]
fn the_comparison_rejects_wrong_maps() {
    let map = Map::from(&scene_files::load("sine_pool", &[]));
    let truth = truth();
    let truth = truth.irradiance.as_flattened();
    let width = map.width as usize;
    let mirrored: Vec<f64> = map
        .texels
        .chunks_exact(width)
        .flat_map(|row| row.iter().rev().flatten().copied())
        .collect();
    let shifted: Vec<f64> = map.values()[3..].iter().chain(&[0.0; 3]).copied().collect();
    let transposed: Vec<f64> = (0..width * width)
        .flat_map(|i| map.texels[i % width * width + i / width])
        .collect();
    let brighter: Vec<f64> = map.values().iter().map(|v| v * 1.006).collect();
    for (wrong, least) in [
        (mirrored, 0.3),
        (transposed, 0.3),
        (shifted, 0.02),
        (brighter, 0.005),
    ] {
        let error = metrics::relative_l1(&wrong, truth).unwrap();
        assert!(error > least, "{error} passes for {least}");
    }
}
