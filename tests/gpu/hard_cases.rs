//! The suite of hard cases, one test for each. Another test compares the names here with the suite's.

use std::process::Command;

use caustica::lab::hard_cases::{self, Settings, Truths, Verdict};

use super::harness::renderer;

/// `CAUSTICA_RENDERS` says how many frames the case of many makes. Other tests run in this process: its memory is not the suite's.
fn settings() -> Settings {
    let renders = std::env::var("CAUSTICA_RENDERS").map_or(Settings::default().renders, |text| {
        text.parse().expect("CAUSTICA_RENDERS is a number")
    });
    Settings {
        renders,
        is_alone: false,
    }
}

/// Runs a case and says what came of it.
fn check(name: &str) {
    let case = hard_cases::find(name).unwrap_or_else(|| panic!("there is no case {name}"));
    let outcome = hard_cases::run_with(case, &mut renderer(), &mut Truths::default(), settings());
    println!(
        "{} / {name}: {:.1e} of {:e} ({}), closure {:.0e}, warnings {:?}",
        case.family.name(),
        outcome.figure.unwrap_or(f64::NAN),
        case.bound,
        case.check,
        outcome.closure,
        outcome.warnings
    );
    assert!(
        outcome.verdict.is_expected(),
        "{name}, where {} could break: {:?}, {}",
        case.breaks,
        outcome.verdict,
        outcome.failure.unwrap_or_default()
    );
    assert_eq!(
        outcome.verdict == Verdict::FailsAsKnown,
        case.known_failure.is_some()
    );
}

/// Declares a test for each case, and the list of their names.
macro_rules! cases {
    ($($family:ident { $($name:ident),+ $(,)? })+) => {
        $(mod $family {$(
            #[test]
            fn $name() {
                super::check(stringify!($name));
            }
        )+})+

        const NAMES: &[(&str, &str)] = &[$($((stringify!($family), stringify!($name))),+),+];
    };
}

cases! {
    light {
        sun_in_the_zenith,
        sun_at_10_degrees,
        sun_at_1_degree,
        sun_at_a_hundredth_of_a_degree,
        sun_on_the_horizon,
        sun_below_the_horizon,
        waves_under_a_sun_at_10_degrees,
        waves_under_a_sun_at_1_degree,
        waves_under_a_sun_at_a_hundredth_of_a_degree,
        sun_along_the_steepest_slope,
        no_irradiance,
        one_dark_channel,
        dim_and_bright_suns_together,
        a_lamp_a_millimetre_above_the_water,
        a_lamp_on_the_water,
        a_lamp_a_millimetre_under_the_water,
        a_lamp_exactly_above_a_vertex_of_the_grid,
        a_lamp_a_millimetre_above_a_wave,
        a_lamp_a_millimetre_under_a_wave,
    }
    water {
        flat_water,
        ripples_of_a_millimetre,
        slopes_of_1,
        slopes_of_5,
        slopes_of_20,
        steep_waves_are_warned_of,
        light_that_leaves_the_water_again,
        slopes_that_look_away,
        troughs_below_the_floor,
        floor_at_depth_0,
        floor_at_a_tenth_of_a_millimetre,
        floor_at_11000_metres,
        waves_over_11000_metres,
        index_1,
        index_1_0001,
        index_2_4,
        index_below_1,
        a_period_after_0,
        a_period_after_a_million_seconds,
        a_period_after_a_billion_seconds,
        a_period_before_minus_a_million_seconds,
        absorption_of_a_billionth,
        absorption_of_1000_per_metre,
        scattering_of_1_per_metre,
        waves_that_cancel,
        a_line_focus_on_the_floor,
        a_point_focus_on_the_floor,
    }
    sea {
        a_sea_without_wind,
        a_sea_at_30_metres_per_second,
        waves_of_four_samples,
        waves_of_one_sample,
        a_loop_of_one_frame,
        a_sea_after_a_billion_seconds,
        a_tile_of_a_centimetre,
        a_tile_of_10_kilometres,
        a_drop_on_a_wall,
        drops_before_at_and_after_the_moment,
        a_basin_after_a_billion_seconds,
        a_drop_on_a_wall_that_absorbs,
        quiet_water_behind_a_wall,
        heights_that_jump_from_sample_to_sample,
        heights_ten_thousand_kilometres_away,
        heights_with_one_that_is_no_number,
        heights_of_one_sample,
    }
    place {
        moved_by_100_km,
        lifted_by_100_km,
        a_thousandth_of_the_size,
        a_thousand_times_the_size,
    }
    mesh {
        one_triangle,
        degenerate_triangles_among_sound_ones,
        duplicate_triangles,
        needle_triangles,
        nothing_but_zero_area,
        flipped_winding,
        mixed_winding,
        an_open_box,
        a_mesh_through_itself,
        three_sheets_on_an_edge,
        wholly_above_the_water,
        cut_by_the_surface,
        touching_the_floor,
        below_the_floor,
        around_the_camera,
        a_plate_across_the_light,
        a_plate_on_a_reference_plane,
        a_rod_thinner_than_a_map_texel,
        a_rod_thinner_than_a_level_map_texel,
        a_million_triangles,
        detail_of_a_centimetre_a_thousand_kilometres_out,
        a_wall_without_thickness_edge_on,
    }
    fold {
        footprints_that_turn_inside_out,
        footprints_within_one_texel,
        footprints_of_a_hundred_thousand_texels,
        footprints_of_millions_of_texels,
        texels_long_and_thin,
        every_corner_on_a_texel_corner,
        sums_beyond_32_bits,
    }
    field {
        slices_of_flat_water,
        slices_at_one_height,
        a_receiver_in_a_box_of_one_layer,
        a_receiver_between_slices_under_a_low_sun,
        slices_with_one_wave_per_cell,
        slices_under_a_sun_at_10_degrees,
        a_sheet_that_folds_within_the_slices,
        water_at_the_side_of_the_slices,
        slices_filled_by_single_footprints,
    }
    camera {
        a_micrometre_under_the_surface,
        a_micrometre_over_the_surface,
        on_the_surface,
        on_a_wave,
        a_view_of_a_floor_at_depth_0,
        a_view_of_a_floor_at_a_tenth_of_a_millimetre,
        along_its_own_up,
        a_field_of_view_of_a_tenth_of_a_degree,
        a_field_of_view_of_179_degrees,
        under_water_at_the_critical_angle,
        one_pixel,
        one_column_of_8192_pixels,
        pictures_of_8192_by_8192_pixels,
    }
    machine {
        a_device_lost_in_mid_frame,
        out_of_memory_once,
        out_of_memory_for_good,
        every_dispatch_in_pieces,
        cancelled_between_pieces,
        thousands_of_small_renders,
    }
}

/// In a process of its own, the memory of the process is checked, too.
#[test]
fn many_renders_leave_the_process_as_it_was() {
    let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(["hard-cases", "thousands_of_small_renders"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("ok") && said.contains("thousands_of_small_renders"),
        "{said}"
    );
}

#[test]
fn every_case_of_the_suite_has_its_test() {
    let suite: Vec<(&str, &str)> = hard_cases::all()
        .map(|case| (case.family.name(), case.name))
        .collect();
    assert_eq!(suite, NAMES);
    let mut names: Vec<&str> = suite.iter().map(|(_, name)| *name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), suite.len(), "names are unique");
}
