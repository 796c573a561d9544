//! The float64 reference against single rays and against itself.

use caustica::accuracy::metrics::{relative_l1, total_flux_bias};
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::physics::refraction::{direction_to_light, refract_direction};
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::reference::{ReferenceMap, ReferenceSettings, irradiance_map, light_window};
use caustica::scene::{Light, Output, ResolvedScene, Scene, Sun, Wave};
use caustica::waves::{Surface, normal};
use glam::DVec2;

use crate::surfaces::surface_of;

use crate::reference_closed_form::single_sine;
use crate::truths;

pub(crate) const SINE_POOL: &str = include_str!("../../scenes/sine_pool.json");
pub(crate) const FLAT: &str = include_str!("../../scenes/flat.json");

pub(crate) fn resolved(json: &str) -> ResolvedScene {
    ResolvedScene::bare(serde_json::from_str(json).unwrap())
}

pub(crate) fn sun_mut(scene: &mut Scene) -> &mut Sun {
    match &mut scene.lights[0] {
        Light::Sun(sun) => sun,
        Light::Point(_) | Light::Sky(_) => panic!("the first light is the sun"),
    }
}

pub(crate) fn set_map(scene: &mut Scene, half_m: f64, width: u32, height: u32) {
    let Output::IrradianceMap(output) = &mut scene.output else {
        panic!("the output is a map");
    };
    output.min_m = Some([-half_m; 2]);
    output.max_m = Some([half_m; 2]);
    output.width = Some(width);
    output.height = Some(height);
}

/// All rays at once, no target.
pub(crate) fn count(resolved: &ResolvedScene, rays: u64) -> ReferenceMap {
    truths::floor_map(resolved, &by_rays(rays))
}

fn by_rays(rays: u64) -> ReferenceSettings {
    ReferenceSettings {
        target_error: None,
        max_rays: rays,
        initial_rays: 1,
    }
}

fn l1(a: &ReferenceMap, b: &ReferenceMap) -> f64 {
    relative_l1(a.irradiance.as_flattened(), b.irradiance.as_flattened()).unwrap()
}

#[track_caller]
pub(crate) fn assert_energy_closes(map: &ReferenceMap) {
    let e = &map.energy;
    for c in 0..3 {
        let landed: f64 = map.landed_w.iter().map(|w| w[c]).sum();
        let rest = e.reflected_w[c]
            + e.absorbed_w[c]
            + e.scattered_w[c]
            + landed
            + e.left_region_w[c]
            + e.missed_w[c];
        assert!(e.emitted_w[c] > 0.0);
        let closure = (rest / e.emitted_w[c] - 1.0).abs();
        assert!(closure < 1e-10, "channel {c}: {closure}, {e:?}");
    }
}

/// The plainest count there is: random rays, one by one, with the functions of `physics`.
fn plain_count(scene: &Scene, half_m: f64, texels: usize, rays: u32) -> Vec<f64> {
    let surface = surface_of(scene);
    let Light::Sun(sun) = &scene.lights[0] else {
        panic!("a sun");
    };
    let l = direction_to_light(sun.elevation_deg.to_radians(), sun.azimuth_deg.to_radians());
    let reach_m = half_m + 2.0;
    let mut values = vec![0.0; texels * texels * 3];
    let texel_m = 2.0 * half_m / texels as f64;
    let per_ray = (2.0 * reach_m).powi(2) / f64::from(rays) / (texel_m * texel_m);
    for i in 0..rays {
        // Roberts' R2 sequence.
        let x = ((f64::from(i) * 0.754_877_666_246_692_7).fract() * 2.0 - 1.0) * reach_m;
        let z = ((f64::from(i) * 0.569_840_290_998_053_2).fract() * 2.0 - 1.0) * reach_m;
        let point = surface.at(x, z);
        let n = normal(point);
        let cos_i = n.dot(l);
        let t = refract_direction(-l, n, scene.water.ior).unwrap();
        let path_m = (point.height_m + 2.0) / -t.y;
        let (u, v) = (
            ((x + t.x * path_m + half_m) / texel_m).floor(),
            ((z + t.z * path_m + half_m) / texel_m).floor(),
        );
        let inside = 0.0..texels as f64;
        if inside.contains(&u) && inside.contains(&v) {
            let flux = per_ray * cos_i / n.y * fresnel_transmittance(cos_i, scene.water.ior);
            for c in 0..3 {
                let extinction = scene.water.absorption_per_m[c] + scene.water.scattering_per_m[c];
                values[(v as usize * texels + u as usize) * 3 + c] +=
                    flux * sun.irradiance_w_m2[c] * (-extinction * path_m).exp();
            }
        }
    }
    values
}

fn lopsided_pool() -> ResolvedScene {
    let mut pool = resolved(SINE_POOL);
    let sun = sun_mut(&mut pool.scene);
    sun.azimuth_deg = 37.0;
    sun.elevation_deg = 50.0;
    sun.irradiance_w_m2 = [1.0, 2.0, 3.0];
    pool.scene.water.absorption_per_m = [0.35, 0.07, 0.07];
    set_map(&mut pool.scene, 0.5, 20, 20);
    pool
}

#[test]
fn waves_under_a_low_sun_are_what_single_rays_say() {
    let pool = lopsided_pool();
    let truth = plain_count(&pool.scene, 0.5, 20, 4_000_000);
    let map = count(&pool, 4_000_000);
    let error = relative_l1(map.irradiance.as_flattened(), &truth).unwrap();
    let bias = total_flux_bias(map.irradiance.as_flattened(), &truth).unwrap();
    assert!(error < 1.2e-2, "{error}");
    assert!(bias.abs() < 1e-3, "{bias}");
}

#[test]
fn a_wrong_sign_of_the_slope_is_detected() {
    let pool = resolved(SINE_POOL);
    let truth = count(&pool, 4_000_000);
    let mut turned = pool.clone();
    for wave in &mut turned.scene.water.waves {
        let Wave::Sine(wave) = wave else {
            panic!("a sine");
        };
        // −A turns every slope around.
        wave.amplitude_m = -wave.amplitude_m;
    }
    let error = l1(&count(&turned, 4_000_000), &truth);
    assert!(error > 0.3, "turned slopes differ by {error} only");
    let mut mirrored = truth.clone();
    for row in mirrored.irradiance.chunks_mut(256) {
        row.reverse();
    }
    let error = l1(&mirrored, &truth);
    assert!(error > 0.3, "a mirrored image differs by {error} only");
}

#[test]
fn a_mirrored_scene_gives_the_mirrored_map() {
    let pool = lopsided_pool();
    let mut mirrored = pool.clone();
    for wave in &mut mirrored.scene.water.waves {
        let Wave::Sine(wave) = wave else {
            panic!("a sine");
        };
        wave.direction_deg = 180.0 - wave.direction_deg;
    }
    let sun = sun_mut(&mut mirrored.scene);
    sun.azimuth_deg = 180.0 - sun.azimuth_deg;
    let mut map = count(&mirrored, 4_000_000);
    for row in map.irradiance.chunks_mut(20) {
        row.reverse();
    }
    let error = l1(&map, &count(&pool, 4_000_000));
    assert!(error < 1e-2, "{error}");
}

#[test]
fn the_bits_do_not_depend_on_run_or_threads() {
    let pool = lopsided_pool();
    let with_threads = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| irradiance_map(&pool, &by_rays(2_000_000), &|_| ()).unwrap())
    };
    let first = with_threads(1);
    for threads in [1, 2, 5] {
        // PartialEq of f64 would take −0 for 0; compare the text, which has every bit.
        assert_eq!(format!("{first:?}"), format!("{:?}", with_threads(threads)));
    }
}

#[test]
fn a_doubled_sun_doubles_every_texel() {
    let pool = lopsided_pool();
    let mut doubled = pool.clone();
    sun_mut(&mut doubled.scene).irradiance_w_m2 = [2.0, 4.0, 6.0];
    let (single, double) = (count(&pool, 500_000), count(&doubled, 500_000));
    for (a, b) in single.irradiance.iter().zip(&double.irradiance) {
        for c in 0..3 {
            assert_eq!(2.0 * a[c], b[c]);
        }
    }
}

#[test]
fn suns_add_up_and_can_be_singled_out() {
    let mut both = lopsided_pool();
    let other: Light = serde_json::from_str(
        r#"{ "kind": "sun", "elevation_deg": 75, "azimuth_deg": -80, "irradiance_w_m2": [5, 1, 0] }"#,
    )
    .unwrap();
    let sky: Light =
        serde_json::from_str(r#"{ "kind": "sky", "radiance_w_m2_sr": [9, 9, 9] }"#).unwrap();
    let set: Light = serde_json::from_str(
        r#"{ "kind": "sun", "elevation_deg": -5, "irradiance_w_m2": [5, 1, 1] }"#,
    )
    .unwrap();
    both.scene.lights.extend([sky, set, other]);
    let single = |light: Option<u32>| {
        let mut one = both.clone();
        if let Output::IrradianceMap(output) = &mut one.scene.output {
            output.light = light;
        }
        count(&one, 2_000_000)
    };
    let (all, first, last, dark) = (
        single(None),
        single(Some(0)),
        single(Some(3)),
        single(Some(2)),
    );
    let sum: Vec<f64> = first
        .irradiance
        .as_flattened()
        .iter()
        .zip(last.irradiance.as_flattened())
        .map(|(a, b)| a + b)
        .collect();
    let error = relative_l1(all.irradiance.as_flattened(), &sum).unwrap();
    assert!(error < 1e-2, "{error}");
    assert_eq!(all.windows.len(), 2);
    assert_energy_closes(&all);
    assert!(dark.irradiance.as_flattened().iter().all(|v| *v == 0.0));
    assert_eq!((dark.rays, dark.relative_error), (0, 0.0));
}

#[test]
fn light_beyond_the_floor_does_not_count() {
    let mut flat = resolved(FLAT);
    let floor = flat.scene.floor.as_mut().unwrap();
    floor.size_m = [1.0, 0.5];
    floor.center_m = [0.25, 0.0];
    let map = count(&flat, 200_000);
    let Light::Sun(sun) = &flat.scene.lights[0] else {
        panic!("a sun");
    };
    let inside = flat_water_irradiance(&flat.scene.water, 2.0, sun);
    let texel_m = 2.0 / 64.0;
    for (index, irradiance) in map.irradiance.iter().enumerate() {
        let x = -1.0 + ((index % 64) as f64 + 0.5) * texel_m;
        let z = -1.0 + ((index / 64) as f64 + 0.5) * texel_m;
        let lit = (x - 0.25).abs() < 0.5 && z.abs() < 0.25;
        let expected = if lit { inside[0] } else { 0.0 };
        assert!(
            (irradiance[0] - expected).abs() < 1e-6 * inside[0],
            "{x} {z}"
        );
    }
    assert_energy_closes(&map);
}

#[test]
fn a_map_far_away_is_as_good_as_one_at_the_origin() {
    // Whole wavelengths away along a single wave, everything is the same.
    let (near, _) = single_sine(0.03, 2.0, 0.1);
    let mut far = near.clone();
    let shift_m = 0.9 * 1e6;
    far.scene.floor.as_mut().unwrap().center_m = [shift_m, -shift_m];
    far.scene.water.level_m = 500.0;
    if let Output::IrradianceMap(output) = &mut far.scene.output {
        output.min_m = Some([shift_m - 1.0, -shift_m - 1.0]);
        output.max_m = Some([shift_m + 1.0, -shift_m + 1.0]);
    }
    let error = l1(&count(&far, 2_000_000), &count(&near, 2_000_000));
    assert!(error < 1e-3, "{error}");
}

#[test]
fn the_window_holds_all_light_that_matters() {
    let surface = Surface::of(&resolved(SINE_POOL)).unwrap();
    for (elevation_deg, azimuth_deg) in [(90.0, 0.0), (60.0, 180.0), (25.0, 70.0), (4.0, -130.0)] {
        let l = direction_to_light(f64::to_radians(elevation_deg), f64::to_radians(azimuth_deg));
        let window = light_window(&surface, l, 1.333, 2.0, DVec2::NEG_ONE, DVec2::ONE);
        let (mut inside, mut outside, mut within_window) = (0, 0, 0);
        for i in 0..400_000 {
            let u = DVec2::new(
                (f64::from(i) * 0.754_877_666_246_692_7).fract(),
                (f64::from(i) * 0.569_840_290_998_053_2).fract(),
            );
            let p = window.min_m - 0.7 + u * (window.max_m - window.min_m + 1.4);
            let within = p.cmpge(window.min_m).all() && p.cmple(window.max_m).all();
            within_window += i32::from(within);
            let point = surface.at(p.x, p.y);
            let n = normal(point);
            if n.dot(l) <= 0.0 {
                continue;
            }
            let t = refract_direction(-l, n, 1.333).unwrap();
            let landing = p + DVec2::new(t.x, t.z) * ((point.height_m + 2.0) / -t.y);
            if landing.abs().max_element() < 1.0 {
                *(if within { &mut inside } else { &mut outside }) += 1;
            }
        }
        assert_eq!(outside, 0, "{elevation_deg}° {azimuth_deg}°");
        assert!(
            f64::from(inside) > 0.25 * f64::from(within_window),
            "{elevation_deg}°: most of the window is idle, {inside} of {within_window}"
        );
    }
}

#[test]
fn rounds_go_on_until_the_target_is_met() {
    let pool = lopsided_pool();
    let heard = std::sync::Mutex::new(Vec::new());
    let settings = ReferenceSettings {
        target_error: Some(2e-3),
        max_rays: 200_000_000,
        initial_rays: 10_000,
    };
    let map = irradiance_map(&pool, &settings, &|part| heard.lock().unwrap().push(part)).unwrap();
    assert!(map.relative_error <= 2e-3, "{}", map.relative_error);
    assert!(map.rays > 10_000 && map.rays <= 200_000_000);
    let heard = heard.into_inner().unwrap();
    assert!(heard.iter().all(|part| (0.0..=1.0).contains(part)));
    assert_eq!(heard.last(), Some(&1.0));
    let limited = ReferenceSettings {
        max_rays: 20_000,
        ..settings
    };
    let map = irradiance_map(&pool, &limited, &|_| ()).unwrap();
    assert!(
        map.relative_error > 2e-3,
        "an unmet target is told, not hidden"
    );
    assert!(map.rays <= 21_000, "{}", map.rays);
}

#[test]
fn steep_and_shallow_water_stays_finite_and_closes() {
    for (amplitude_m, elevation_deg, depth_m) in [
        (0.5, 3.0, 2.0),
        (0.5, 90.0, 0.2),
        (3.0, 10.0, 2.0),
        (0.05, 1e-3, 0.0),
    ] {
        let (mut scene, _) = single_sine(amplitude_m, depth_m, 0.1);
        sun_mut(&mut scene.scene).elevation_deg = elevation_deg;
        let map = count(&scene, 300_000);
        assert!(map.irradiance.as_flattened().iter().all(|v| v.is_finite()));
        assert_energy_closes(&map);
    }
}
