//! The thesis's experiment on a small scale, from scene to files.

use caustica::config::RenderConfig;
use caustica::lab::experiment::level_map::{self as experiment, Settings, TechniqueFigures};
use caustica::reference::{TruthSettings, truth};

use super::harness::{new_renderer, try_render};

#[test]
fn the_thesis_repeated_on_a_small_scale() {
    // Its own: what other scenes left there would be given back in between, and count.
    let mut renderer = new_renderer(&RenderConfig::default());
    renderer.watch_allocator(true);
    let settings = Settings {
        meshes: vec!["sphere".to_owned()],
        planes: vec![3, 9, 33],
        runs: 1,
        water_cells: 48,
        texels: 32,
    };
    let truth_settings = TruthSettings {
        target_error: Some(0.02),
        ..TruthSettings::default()
    };
    let mut heard = 0;
    let found = experiment::measure(
        &settings,
        &mut |scene| Ok(try_render(&mut renderer, scene)?),
        &mut |scene| Ok(Some(truth(scene, &truth_settings, &|_| {}, &|| false)?)),
        &mut |done, total, what| {
            println!("{done} of {total}: {what}");
            heard += 1;
        },
    )
    .unwrap();
    renderer.watch_allocator(false);
    assert!(heard >= 7);
    let mesh = &found.meshes[0];
    for p in &mesh.planes {
        println!("{p:?}");
        assert_eq!(p.luv_smart, 0.0, "{} planes", p.planes);
        assert!(p.used < p.planes);
        assert!(p.texels > 100 && p.texels_apart <= p.texels / 100);
        for figures in [&p.volumetric, &p.uniform, &p.smart] {
            assert_eq!(figures.planned_bytes, figures.peak_bytes);
            assert!(figures.ms.median > 0.0 && figures.own_ms.unwrap() > 0.0);
            assert!(figures.own_ms.unwrap() <= figures.ms.max);
        }
        assert!(p.volumetric.peak_bytes > p.uniform.peak_bytes);
    }
    // Memory of slices grows with the planes by an image each, that of level maps by two words each.
    let (few, many) = (&mesh.planes[0], &mesh.planes[2]);
    let images = u64::from(many.planes - few.planes) * 4 * 32 * 32;
    let grown = |few: &TechniqueFigures, many: &TechniqueFigures| {
        let by_allocator = many.allocated_bytes.unwrap() - few.allocated_bytes.unwrap();
        let by_account = many.peak_bytes - few.peak_bytes;
        println!("{by_allocator} bytes more by the allocator, {by_account} by our account");
        [by_allocator, by_account]
    };
    for more in grown(&few.volumetric, &many.volumetric) {
        assert!(more >= images && more <= 2 * images, "{more} of {images}");
    }
    for more in grown(&few.uniform, &many.uniform) {
        assert!(more <= images / 16, "{more} of {images}");
    }
    let error = |k: usize| mesh.planes[k].smart.error.unwrap();
    assert!(
        error(2) < error(0),
        "{} with 33 planes, {} with 3",
        error(2),
        error(0)
    );
    let best = mesh
        .hits
        .iter()
        .map(|h| h.figures.error.unwrap())
        .fold(1.0, f64::min);
    println!("hits at best {best:.4}, planes {:.4}", error(2));
    assert!(best < error(2));
    let example = found.memory;
    assert_eq!(example.slices_bytes, 100 * 4 * 512 * 512 * 101);
    assert!(example.level_maps_bytes * 10 < example.slices_bytes);
    let folder = std::env::temp_dir().join(format!("caustica-experiment-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let files = experiment::write(&folder, &found).unwrap();
    assert_eq!(files.len(), 3 + 2 * 2);
    for file in &files {
        assert!(
            std::fs::metadata(file).unwrap().len() > 200,
            "{}",
            file.display()
        );
    }
    if std::env::var_os("KEEP").is_none() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
