//! The study of sunlight under the sea on a small scale, from scene to files.

use caustica::lab::experiment::sea::{self, Settings};

use super::harness::{renderer, try_render};

#[test]
fn light_under_a_small_sea() {
    let mut renderer = renderer();
    let settings = Settings {
        depths_m: vec![0.5, 4.0, 7.0],
        winds_m_s: vec![3.0, 12.0],
        moments: 3,
        seconds: 0.024,
        texels: 32,
        water_cells: 96,
    };
    let (mut heard, mut most) = (0, 0);
    let found = sea::measure(
        &settings,
        &mut |scene| Ok(try_render(&mut renderer, scene)?),
        &mut |done, total, what| {
            assert_eq!(done, heard, "{what}");
            (heard, most) = (done + 1, total);
        },
    )
    .unwrap();
    drop(renderer);
    assert_eq!(heard, most, "as many frames as announced");
    assert!(found.closure <= 1e-5, "{:e}", found.closure);
    assert_eq!((found.places.len(), found.slopes.len()), (6, 2));
    for p in &found.places {
        println!("{p:?}");
        // Waves move light about, and hardly change how much there is of it.
        let mean = p.sun.mean;
        let off = (mean.value - 1.0).abs();
        assert!(off < 0.1 + 4.0 * mean.error.unwrap(), "{mean:?}");
        assert!(p.water_cells <= 96);
        // 96 cells are few for the window of a deep floor, and it is said.
        assert!(p.undersampled || p.place.depth_m < 1.0, "{p:?}");
        assert!(p.sun.cv.value > 0.1 && p.sun.cv.value < 2.0);
        // Blurring takes from the fluctuation.
        assert!(p.sun.cv.value <= p.point_sun.cv.value);
        assert!(p.sun.peak.value > 1.0 && p.sun.peak.value <= p.sun.highest);
    }
    // More wind, steeper waves; less than Cox and Munk's, whose sea has the shortest waves too.
    let [calm, windy] = [&found.slopes[0], &found.slopes[1]].map(|s| s.mean_square);
    assert!(
        calm > 0.002 && calm < windy && windy < 0.0644,
        "{calm} {windy}"
    );
    // Something flashes near the surface, for some milliseconds.
    let flashes = found.places[0].flashes.unwrap();
    assert!(flashes.counted > 10, "{flashes:?}");
    let length_ms = flashes.length_ms.unwrap().value;
    assert!(length_ms > 1.0 && length_ms < 500.0, "{length_ms}");
    assert_eq!(found.places[2].flashes, None, "too deep");
    let rows = found.checks.iter().map(|checks| checks.rows.len());
    assert_eq!(rows.collect::<Vec<_>>(), [5, 2]);
    let cv = |row: usize| found.checks[0].rows[row].cv.unwrap().value;
    // The same light on the same detectors, from texels of half the side.
    assert!((cv(2) / cv(0) - 1.0).abs() < 0.02, "{} {}", cv(2), cv(0));
    assert!(cv(3) > cv(0), "smaller detectors see more");
    let folder = std::env::temp_dir().join(format!("caustica-sea-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let files = sea::write(&folder, &found).unwrap();
    assert_eq!(files.len(), 3 + 3 * 2);
    let json = std::fs::read_to_string(&files[0]).unwrap();
    let read: sea::SeaStudy = serde_json::from_str(&json).unwrap();
    assert_eq!(read.places.len(), 6);
    std::fs::remove_dir_all(&folder).unwrap();
}
