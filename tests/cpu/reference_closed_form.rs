//! The float64 reference against closed forms.

use caustica::accuracy::metrics::relative_l1;
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::reference::closed_form::{SineUnderZenith, flat_water_irradiance};
use caustica::scene::{Light, ResolvedScene, Sun};

use crate::reference::{FLAT, assert_energy_closes, count, resolved, sun_mut};

#[test]
fn flat_water_is_the_closed_form() {
    let mut flat = resolved(FLAT);
    flat.scene.water.scattering_per_m = [0.1, 0.02, 0.0];
    for elevation_deg in [90.0, 60.0, 45.0, 20.0, 5.0, 2.0] {
        sun_mut(&mut flat.scene).elevation_deg = elevation_deg;
        sun_mut(&mut flat.scene).irradiance_w_m2 = [1000.0, 700.0, 3.0];
        let sun = sun_mut(&mut flat.scene).clone();
        let expected = flat_water_irradiance(&flat.scene.water, 2.0, &sun);
        let map = count(&flat, 200_000);
        for (texel, irradiance) in map.irradiance.iter().enumerate() {
            for c in 0..3 {
                assert!(
                    (irradiance[c] / expected[c] - 1.0).abs() < 1e-6,
                    "{elevation_deg}°, texel {texel}: {irradiance:?}, expected {expected:?}"
                );
            }
        }
        assert!(map.relative_error < 1e-10);
        assert_energy_closes(&map);
    }
}

#[test]
fn flat_closed_form_by_hand() {
    let flat = resolved(FLAT);
    let Light::Sun(sun) = &flat.scene.lights[0] else {
        panic!("a sun");
    };
    // 1000 W/m² from 60°: cos θ_i = 0.8660, sin θ_t = 0.5/1.333, T = 0.9790 (R_s = 0.0329, R_p = 0.0091), d = 2.158 m.
    let expected = [
        866.03 * 0.979 * (-0.35f64 * 2.1577).exp(),
        866.03 * 0.979 * (-0.07f64 * 2.1577).exp(),
        866.03 * 0.979 * (-0.03f64 * 2.1577).exp(),
    ];
    let got = flat_water_irradiance(&flat.scene.water, 2.0, sun);
    for c in 0..3 {
        assert!(
            (got[c] / expected[c] - 1.0).abs() < 1e-3,
            "{got:?} {expected:?}"
        );
    }
    for elevation_deg in [0.0, -10.0] {
        let set = Sun {
            elevation_deg,
            ..sun.clone()
        };
        assert_eq!(
            flat_water_irradiance(&flat.scene.water, 2.0, &set),
            [0.0; 3]
        );
    }
}

pub(crate) fn single_sine(
    amplitude_m: f64,
    depth_m: f64,
    absorption_per_m: f64,
) -> (ResolvedScene, SineUnderZenith) {
    let json = format!(
        r#"{{
            "water": {{
                "waves": [{{ "kind": "sine", "amplitude_m": {amplitude_m}, "wavelength_m": 0.9, "phase_deg": 40 }}],
                "absorption_per_m": [{absorption_per_m}, 0, {absorption_per_m}]
            }},
            "floor": {{ "depth_m": {depth_m}, "size_m": [4, 4] }},
            "lights": [{{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 2] }}],
            "output": {{ "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 128, "height": 8 }}
        }}"#
    );
    let closed = SineUnderZenith {
        amplitude_m,
        wavelength_m: 0.9,
        phase_rad: 40f64.to_radians(),
        ior: 1.333,
        depth_m,
        extinction_per_m: absorption_per_m,
    };
    (resolved(&json), closed)
}

#[test]
fn a_single_sine_is_the_closed_form() {
    // Before the first focus, and far behind it.
    for (amplitude_m, depth_m, folds) in [(0.01, 1.0, 0), (0.03, 6.0, 2)] {
        let (scene, mut closed) = single_sine(amplitude_m, depth_m, 0.35);
        assert_eq!(closed.folds_m().len(), folds);
        let lossy = closed.texel_means(-1.0, 2.0 / 128.0, 128);
        closed.extinction_per_m = 0.0;
        let clear = closed.texel_means(-1.0, 2.0 / 128.0, 128);
        let truth: Vec<f64> = (0..8)
            .flat_map(|_| (0..128).flat_map(|i| [lossy[i], clear[i], 2.0 * lossy[i]]))
            .collect();
        let map = count(&scene, 20_000_000);
        let error = relative_l1(map.irradiance.as_flattened(), &truth).unwrap();
        assert!(error < 1e-3, "{depth_m} m deep: {error}");
        assert!(
            error < 3.0 * map.relative_error,
            "the estimate {} does not cover the error {error}",
            map.relative_error
        );
        assert_energy_closes(&map);
    }
}

#[test]
fn the_closed_sine_keeps_its_flux() {
    for (amplitude_m, depth_m) in [(0.01, 1.0), (0.03, 6.0), (0.1, 5.0)] {
        let (_, mut closed) = single_sine(amplitude_m, depth_m, 0.0);
        for extinction_per_m in [0.0, 0.35] {
            closed.extinction_per_m = extinction_per_m;
            let texels = closed.texel_means(0.17, 0.9 / 90.0, 90);
            let mean = texels.iter().sum::<f64>() / 90.0;
            assert!(
                (mean / closed.mean_irradiance() - 1.0).abs() < 1e-7,
                "{mean} {}",
                closed.mean_irradiance()
            );
        }
    }
    let (_, flat) = single_sine(0.0, 2.0, 0.0);
    assert!((flat.mean_irradiance() - fresnel_transmittance(1.0, 1.333)).abs() < 1e-12);
}

#[test]
fn the_closed_sine_is_consistent_with_itself() {
    let (_, closed) = single_sine(0.03, 6.0, 0.1);
    let texel_m = 1e-5;
    for i in 0..200 {
        let x = f64::from(i) * 0.0123;
        // dX/dx is the derivative of X.
        let h = 1e-6;
        let numeric = (closed.landing_m(x + h) - closed.landing_m(x - h)) / (2.0 * h);
        assert!((numeric - closed.stretch(x)).abs() < 1e-6, "{x}");
        // Points agree with texels, away from the folds.
        let near_fold = closed.folds_m().iter().any(|fold| {
            let off = (closed.landing_m(*fold) - x) / 0.9;
            (off - off.round()).abs() < 0.02
        });
        if !near_fold {
            let texel = closed.texel_means(x - 0.5 * texel_m, texel_m, 1)[0];
            let point = closed.irradiance_at(x);
            assert!((texel / point - 1.0).abs() < 1e-5, "{x}: {texel} {point}");
        }
    }
    for fold in closed.folds_m() {
        assert!(closed.stretch(fold).abs() < 1e-10);
    }
}
