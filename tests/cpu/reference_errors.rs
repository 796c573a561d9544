//! What the float64 reference refuses, and the errors it returns.

use caustica::reference::{ReferenceError, ReferenceSettings, irradiance_map};
use caustica::scene::{IrradianceMapOutput, Output, ResolvedScene, Scene, Wave};

use crate::reference::{SINE_POOL, resolved, set_map, sun_mut};

const DRY: &str = include_str!("../../scenes/dry.json");

#[test]
fn scenes_that_cannot_be_counted_are_errors() {
    type Spoil = fn(&mut ResolvedScene);
    let cases: [(&str, Spoil); 11] = [
        ("irradiance_map", |r| *r = resolved(DRY)),
        ("waves", |r| {
            let Wave::Sine(wave) = &mut r.scene.water.waves[0] else {
                panic!("a sine");
            };
            wave.amplitude_m = f64::NAN;
        }),
        ("irradiance_map", |r| {
            r.scene.output = Output::default();
        }),
        ("floor only", |r| {
            set_receiver(&mut r.scene, "0");
        }),
        ("no floor", |r| {
            r.scene.floor = None;
        }),
        ("is empty", |r| set_map(&mut r.scene, -1.0, 8, 8)),
        ("is empty", |r| set_map(&mut r.scene, 1.0, 0, 8)),
        ("is empty", |r| set_map(&mut r.scene, f64::NAN, 8, 8)),
        ("extinction", |r| {
            r.scene.water.absorption_per_m[1] = f64::NAN;
        }),
        ("ior", |r| r.scene.water.ior = 0.5),
        ("irradiance_w_m2", |r| {
            sun_mut(&mut r.scene).irradiance_w_m2[2] = f64::INFINITY;
        }),
    ];
    for (word, spoil) in cases {
        let mut scene = resolved(SINE_POOL);
        spoil(&mut scene);
        let error = irradiance_map(&scene, &ReferenceSettings::default(), &|_| ()).unwrap_err();
        assert!(error.to_string().contains(word), "{word}: {error}");
    }
}

fn set_receiver(scene: &mut Scene, receiver: &str) {
    if let Output::IrradianceMap(output) = &mut scene.output {
        output.receiver = serde_json::from_str(receiver).unwrap();
    }
}

#[test]
fn lights_and_settings_that_make_no_sense_are_errors() {
    let pool = resolved(SINE_POOL);
    let with = |change: fn(&mut IrradianceMapOutput)| {
        let mut scene = pool.clone();
        if let Output::IrradianceMap(output) = &mut scene.scene.output {
            change(output);
        }
        irradiance_map(&scene, &ReferenceSettings::default(), &|_| ()).unwrap_err()
    };
    assert_eq!(
        with(|output| output.light = Some(1)),
        ReferenceError::NotASun {
            index: 1,
            lights: 1
        }
    );
    assert_eq!(
        with(|output| output.include_sky = true),
        ReferenceError::IncludesSky
    );
    let good = ReferenceSettings::default();
    for bad in [
        ReferenceSettings {
            max_rays: 0,
            ..good
        },
        ReferenceSettings {
            initial_rays: 0,
            ..good
        },
        ReferenceSettings {
            target_error: Some(0.0),
            ..good
        },
        ReferenceSettings {
            target_error: Some(f64::NAN),
            ..good
        },
    ] {
        let error = irradiance_map(&pool, &bad, &|_| ()).unwrap_err();
        assert!(matches!(error, ReferenceError::Settings(_)), "{error}");
    }
}
