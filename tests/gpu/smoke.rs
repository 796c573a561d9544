use caustica::config::RenderConfig;
use caustica::render::Renderer;
use caustica::scene::{ResolvedScene, Scene};
use tokio_util::sync::CancellationToken;

#[test]
fn smoke() {
    let mut renderer = Renderer::new(&RenderConfig::default()).unwrap();
    println!("{:?}", renderer.adapter());
    let flat = r#"{"floor":{"depth_m":2,"size_m":[8,8]},"lights":[{"kind":"sun","elevation_deg":60,"azimuth_deg":30,"irradiance_w_m2":[1000,1000,1000]}],
      "water":{"absorption_per_m":[0.35,0.07,0.03]},
      "output":{"kind":"irradiance_map","receiver":"floor","min_m":[-1,-1],"max_m":[1,1],"width":64,"height":64}, "quality":{"water_cells":32}}"#;
    let scene: Scene = serde_json::from_str(flat).unwrap();
    let resolved = ResolvedScene {
        scene,
        meshes: vec![],
    };
    println!("{}", renderer.plan(&resolved).unwrap());
    for _ in 0..3 {
        let frame = renderer
            .render(&resolved, &CancellationToken::new())
            .unwrap();
        let e = &frame.layers[&caustica::scene::LayerName::Irradiance].data;
        println!("{:?} {:?}", &e[..6], frame.stats.energy);
        println!(
            "{:?} {:?} {:?}",
            frame.stats.time_ms, frame.stats.passes, frame.stats.memory
        );
    }
    let sine = r#"{"floor":{"depth_m":2,"size_m":[8,8]},"lights":[{"kind":"sun","elevation_deg":60,"azimuth_deg":180,"irradiance_w_m2":[1,1,1]}],
      "water":{"waves":[{"kind":"sine","amplitude_m":0.03,"wavelength_m":1.3,"direction_deg":20,"phase_deg":22.918311805232928},
       {"kind":"sine","amplitude_m":0.015,"wavelength_m":0.8,"direction_deg":100,"phase_deg":97.40282517223995},
       {"kind":"sine","amplitude_m":0.006,"wavelength_m":0.5,"direction_deg":-35,"phase_deg":166.15776058793872}]},
      "output":{"kind":"irradiance_map","receiver":"floor","min_m":[-1,-1],"max_m":[1,1],"width":256,"height":256}}"#;
    for cells in [256, 512] {
        let mut scene: Scene = serde_json::from_str(sine).unwrap();
        scene.quality.water_cells = cells;
        let resolved = ResolvedScene {
            scene,
            meshes: vec![],
        };
        let mut best = f64::MAX;
        let mut dep = f64::MAX;
        let mut hits = f64::MAX;
        let mut res = f64::MAX;
        let mut surf = f64::MAX;
        for _ in 0..25 {
            let frame = renderer
                .render(&resolved, &CancellationToken::new())
                .unwrap();
            best = best.min(frame.stats.time_ms.total);
            let g = |n: &str| {
                frame
                    .stats
                    .passes
                    .iter()
                    .find(|p| p.name == n)
                    .unwrap()
                    .gpu_ms
                    .unwrap_or(1e9)
            };
            dep = dep.min(g("deposit"));
            hits = hits.min(g("hits"));
            res = res.min(g("irradiance"));
            surf = surf.min(g("surface"));
        }
        println!(
            "BENCH {cells}: total {best:.1} deposit {dep:.1} hits {hits:.1} surface {surf:.1} irradiance {res:.1}"
        );
    }

    let truth = caustica::reference::irradiance_map(
        &ResolvedScene {
            scene: serde_json::from_str(sine).unwrap(),
            meshes: vec![],
        },
        &caustica::reference::ReferenceSettings {
            target_error: Some(0.0005),
            ..Default::default()
        },
        &|_| {},
    )
    .unwrap();
    println!("TRUTH {} {}", truth.relative_error, truth.rays);
    for cells in [64, 128, 256, 512, 1024] {
        let mut scene: Scene = serde_json::from_str(sine).unwrap();
        scene.quality.water_cells = cells;
        let resolved = ResolvedScene {
            scene,
            meshes: vec![],
        };
        let frame = renderer
            .render(&resolved, &CancellationToken::new())
            .unwrap();
        let e = &frame.layers[&caustica::scene::LayerName::Irradiance].data;
        println!(
            "ERR {cells} {:?}",
            caustica::accuracy::metrics::relative_l1(e, truth.irradiance.as_flattened())
        );
    }
}
