//! Light fields of the wave equation: speed, the damping band, active cells, limits, and what the sums show.

use caustica::fronts::{
    Frame, FrontError, Grid, Height, Pulse, Sides, Sum, WaveLimits, WavePlan, WaveReport,
    WaveSettings, Waves,
};
use glam::{DVec2, DVec3};

fn flat(_: DVec2) -> Height {
    Height {
        height_m: 0.0,
        slope: DVec2::ZERO,
    }
}

/// A single sine along x, with a crest at 0.
fn sine(amplitude_m: f64, k: f64) -> impl Fn(DVec2) -> Height + Sync {
    move |p| Height {
        height_m: amplitude_m * (k * p.x).cos(),
        slope: DVec2::new(-amplitude_m * k * (k * p.x).sin(), 0.0),
    }
}

fn start<F: Fn(DVec2) -> Height + Sync>(grid: &Grid, settings: &WaveSettings, water: &F) -> Waves {
    let plan = WavePlan::of(grid, settings, &WaveLimits::default()).unwrap();
    Waves::start(grid, &plan, settings, &Frame::NORMAL, water).unwrap()
}

fn run<F: Fn(DVec2) -> Height + Sync>(
    grid: &Grid,
    settings: &WaveSettings,
    water: &F,
) -> (Vec<f32>, WaveReport) {
    let mut waves = start(grid, settings, water);
    let report = waves.run();
    (waves.sums().to_vec(), report)
}

/// A shaft of 12 × 12 cells of 1 cm, the water 10 cells below its top.
fn shaft(cells: usize) -> Grid {
    let bottom_m = -0.1 + 0.01 * cells as f64;
    Grid::filling(
        [12, 12, cells],
        DVec3::new(0.0, 0.0, -0.1),
        DVec3::new(0.12, 0.12, bottom_m),
    )
    .unwrap()
}

const MIRRORS: WaveSettings = WaveSettings {
    courant: 0.99,
    band: 16,
    pulse: Pulse::Smooth(2.0),
    sides: Sides::Mirror,
    clamped: false,
    sum: Sum::Values,
    silent: 1e-6,
};

#[test]
fn a_plane_pulse_travels_at_the_speed_of_light_and_does_not_come_back() {
    let grid = shaft(160);
    for courant in [0.5, 0.8, 0.99, 1.0] {
        let settings = WaveSettings { courant, ..MIRRORS };
        let plan = WavePlan::of(&grid, &settings, &WaveLimits::default()).unwrap();
        let mut waves = start(&grid, &settings, &flat);
        let marks = [50, 130];
        let mut history = [Vec::new(), Vec::new()];
        let crossing = (1.6 / plan.step_m) as usize;
        for _ in 0..crossing {
            for (mark, history) in marks.iter().zip(&mut history) {
                history.push(f64::from(waves.value([3, 5, *mark])));
            }
            waves.step();
        }
        // When it is highest, by a parabola through the three highest values.
        let [first, last] = history.each_ref().map(|values| {
            let top = (1..values.len() - 1)
                .max_by(|a, b| values[*a].total_cmp(&values[*b]))
                .unwrap();
            let (a, b, c) = (values[top - 1], values[top], values[top + 1]);
            (top as f64 + 0.5 * (a - c) / (a - 2.0 * b + c), b)
        });
        let speed = 0.01 * (marks[1] - marks[0]) as f64 / ((last.0 - first.0) * plan.step_m);
        // Until all that could turn back at the bottom has reached the middle again.
        for _ in 0..(0.8 / plan.step_m) as usize {
            waves.step();
        }
        let back = (0..160)
            .map(|k| waves.value([3, 5, k]).abs())
            .fold(0.0, f32::max);
        let back = f64::from(back) / first.1;
        println!(
            "{courant}: speed {speed}, height {} → {}, back {back}",
            first.1, last.1
        );
        // The default, and the longest step.
        if courant >= 0.99 {
            assert!((speed - 1.0).abs() < 0.01, "{courant}: {speed}");
            assert!(back < 0.01, "{courant}: {back} comes back");
        }
    }
}

#[test]
fn steps_beyond_the_courant_limit_and_other_settings_are_refused() {
    let grid = shaft(32);
    let refused = |settings: WaveSettings| {
        let error = WavePlan::of(&grid, &settings, &WaveLimits::default()).unwrap_err();
        error.to_string()
    };
    for courant in [0.0, -0.5, 1.01, 1.7, f64::NAN] {
        let text = refused(WaveSettings { courant, ..MIRRORS });
        assert!(
            text.starts_with("courant is ") && text.contains("at most 1:"),
            "{text}"
        );
    }
    assert!(refused(WaveSettings { band: 3, ..MIRRORS }).contains("4 to 64"));
    assert!(
        refused(WaveSettings {
            silent: 0.5,
            ..MIRRORS
        })
        .starts_with("silent is 0.5")
    );
    let wide = WaveSettings {
        pulse: Pulse::Smooth(9.0),
        ..MIRRORS
    };
    assert!(refused(wide).starts_with("pulse is 9"));
    // A frame in which light reaches the surface at different times.
    let plan = WavePlan::of(&grid, &MIRRORS, &WaveLimits::default()).unwrap();
    let snell = Frame::snell(DVec3::Z, 1.333).unwrap();
    assert!(Waves::start(&grid, &plan, &MIRRORS, &snell, &flat).is_err());
}

/// At the largest step that is accepted nothing grows, also from a pulse of single cells, in flat cells, in the band.
#[test]
fn the_largest_step_is_stable() {
    let (low_m, high_m) = (DVec3::new(-0.5, -0.5, -0.1), DVec3::new(0.5, 0.5, 0.4));
    for size in [[24, 24, 24], [32, 20, 40]] {
        for sides in [Sides::Absorb, Sides::Mirror] {
            let grid = Grid::filling(size, low_m, high_m).unwrap();
            let settings = WaveSettings {
                courant: 1.0,
                pulse: Pulse::Cells,
                sides,
                band: 8,
                ..MIRRORS
            };
            let mut waves = start(&grid, &settings, &sine(0.04, 6.0));
            let largest = |waves: &Waves| {
                let cells = (0..grid.cells()).map(|index| waves.value(grid.cell(index)).abs());
                cells.fold(0.0, f32::max)
            };
            for _ in 0..1500 {
                waves.step();
            }
            let left = largest(&waves);
            println!("{size:?} {sides:?}: {left}");
            assert!(left < 0.2, "{size:?} {sides:?}: {left}");
        }
    }
}

#[test]
fn five_hundred_and_twelve_cubed_is_refused_with_numbers() {
    let of = |n: usize| {
        let grid = Grid::filling([n; 3], DVec3::ZERO, DVec3::ONE).unwrap();
        WavePlan::of(&grid, &WaveSettings::default(), &WaveLimits::default())
    };
    let error = of(512).unwrap_err();
    println!("{error}");
    let FrontError::TooLarge {
        bytes,
        cells,
        steps,
        cell_steps,
        most_bytes,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!(cells, 544 * 544 * 544);
    assert!(bytes > 8 * cells + 4 * 512 * 512 * 512 && bytes > most_bytes);
    assert!((cell_steps - cells as f64 * steps as f64).abs() < 1.0);
    for number in [bytes, steps, cells, most_bytes] {
        assert!(error.to_string().contains(&number.to_string()), "{error}");
    }
    // What table 1 of the paper has is allowed; a smaller budget refuses it.
    let plan = of(256).unwrap();
    assert_eq!(plan.size, [288; 3]);
    let grid = Grid::filling([256; 3], DVec3::ZERO, DVec3::ONE).unwrap();
    let limits = WaveLimits {
        bytes: plan.bytes,
        cell_steps: 1e9,
    };
    assert!(WavePlan::of(&grid, &WaveSettings::default(), &limits).is_err());
}

/// A box whose water focuses at half its depth.
fn lens() -> (Grid, impl Fn(DVec2) -> Height + Sync) {
    let grid = Grid::filling(
        [96, 12, 80],
        DVec3::new(-0.785, -0.098, -0.1),
        DVec3::new(0.785, 0.098, 1.208),
    )
    .unwrap();
    (grid, sine(0.03, 8.0))
}

#[test]
fn few_cells_are_active_and_the_others_do_not_matter() {
    let (grid, water) = lens();
    let settings = |silent: f64| WaveSettings {
        silent,
        sum: Sum::Squares,
        ..MIRRORS
    };
    let (all, every) = run(&grid, &settings(1e-7), &water);
    let (thin, report) = run(&grid, &settings(0.01), &water);
    println!("{every:?} {report:?}");
    assert!(every.mean_active > 0.6, "{every:?}");
    assert!((0.03..0.5).contains(&report.mean_active), "{report:?}");
    assert!(report.most_active < 1.0 && report.mean_active <= report.most_active);
    let total: f32 = all.iter().sum();
    let off: f32 = all.iter().zip(&thin).map(|(a, b)| (a - b).abs()).sum();
    println!("{}", off / total);
    assert!(off / total < 0.02, "{}", off / total);
}

/// Sums in the slice at the focus: at the crest's foot, relative to the mean.
fn brightness(settings: &WaveSettings) -> f64 {
    let (grid, water) = lens();
    let (sums, _) = run(&grid, settings, &water);
    let focus_m = 1.0 / (0.03 * 64.0);
    let k = ((focus_m - grid.origin_m.z) / grid.step_m.z).round() as usize;
    let slice = &sums[k * grid.slice()..][..grid.slice()];
    assert!(slice.iter().all(|value| value.is_finite()));
    let mean = slice.iter().map(|value| f64::from(*value)).sum::<f64>() / slice.len() as f64;
    f64::from(slice[48 + 96 * 6]) / mean
}

/// The sum of φ over all times solves Laplace's equation, so it does not show a focus; squares and clamped waves do.
#[test]
fn squares_and_clamped_waves_show_a_focus_and_plain_sums_do_not() {
    let with = |sum, clamped, silent| {
        brightness(&WaveSettings {
            sum,
            clamped,
            silent,
            ..MIRRORS
        })
    };
    let plain = with(Sum::Values, false, 1e-4);
    let squares = with(Sum::Squares, false, 1e-3);
    let clamped = with(Sum::Values, true, 0.05);
    println!("plain {plain}, squares {squares}, clamped {clamped}");
    assert!((plain - 1.0).abs() < 0.1, "{plain}");
    assert!(squares > 2.0, "{squares}");
    assert!(clamped > 1.2, "{clamped}");
}

#[test]
fn clamped_waves_are_nowhere_negative() {
    let (grid, water) = lens();
    let settings = WaveSettings {
        clamped: true,
        silent: 0.01,
        ..MIRRORS
    };
    let (sums, _) = run(&grid, &settings, &water);
    assert!(sums.iter().all(|sum| *sum >= 0.0));
}

#[test]
fn flat_water_is_even_between_mirrors_on_any_number_of_threads() {
    let grid = shaft(48);
    for pulse in [Pulse::Cells, Pulse::Smooth(3.0)] {
        let settings = WaveSettings { pulse, ..MIRRORS };
        let (sums, report) = run(&grid, &settings, &flat);
        // Half of the pulse goes down: its width is 1 or 3 cells. Of a pulse of one cell the band sends more back.
        let (width_m, back, off) = match pulse {
            Pulse::Cells => (0.01, 0.05, 0.05),
            Pulse::Smooth(_) => (0.03, 0.004, 0.02),
        };
        println!("{pulse:?}: {report:?}");
        assert!(report.left_over < back, "{report:?}");
        for k in 16..48 {
            let slice = &sums[k * 144..][..144];
            let even = slice
                .iter()
                .all(|value| (value / slice[0] - 1.0).abs() < 1e-4);
            assert!(even, "{pulse:?}, slice {k}");
            let share = f64::from(slice[0]) / (0.5 * width_m);
            assert!((share - 1.0).abs() < off, "{pulse:?}, slice {k}: {share}");
        }
        let single = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .unwrap();
        assert_eq!(
            single.install(|| run(&grid, &settings, &flat)),
            (sums, report)
        );
    }
}
