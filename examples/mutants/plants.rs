//! Errors planted in Rust, and the tests that must catch them.

/// A wrong sign or factor, and the tests that must catch it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plant {
    /// Source file, from the root of the project.
    pub(crate) file: &'static str,
    /// The original code, a whole expression or a statement; occurs exactly once.
    pub(crate) from: &'static str,
    /// The replacement, of the same type.
    pub(crate) to: &'static str,
    /// `cpu` or `gpu`: the tests in that folder of `tests`.
    pub(crate) binary: &'static str,
    /// Tests that must fail, as `file::name`; one of them is enough. Where they are hard cases, all of them must, and no other hard case
    /// may.
    pub(crate) tests: &'static [&'static str],
    /// A description of the error.
    pub(crate) what: &'static str,
}

/// All plants.
pub(crate) const ALL: &[Plant] = &[
    Plant {
        file: "src/reference/refract.rs",
        from: "x_m[i] = -l.x * per_eta - along_normal * a;",
        to: "x_m[i] = -l.x * per_eta + along_normal * a;",
        binary: "cpu",
        tests: &[
            "reference::waves_under_a_low_sun_are_what_single_rays_say",
            "reference_closed_form::a_single_sine_is_the_closed_form",
        ],
        what: "the reference refracts away from the normal along x",
    },
    Plant {
        file: "src/waves/sines.rs",
        from: "cos * c - sin * s",
        to: "cos * c + sin * s",
        binary: "cpu",
        tests: &[
            "reference::waves_under_a_low_sun_are_what_single_rays_say",
            "reference_closed_form::a_single_sine_is_the_closed_form",
        ],
        what: "the reference steps backwards through the slopes of its waves",
    },
    Plant {
        file: "src/reference/occluders.rs",
        from: "u + v > 1.0",
        to: "u - v > 1.0",
        binary: "cpu",
        tests: &["reference_meshes::the_shadow_of_a_triangle_is_half_of_its_rectangle"],
        what: "triangles of the reference extend beyond their third edge",
    },
    Plant {
        file: "src/reference/patch.rs",
        from: "from_m + direction * (above_m / against) - self.center_m",
        to: "from_m - direction * (above_m / against) - self.center_m",
        binary: "cpu",
        tests: &[
            "truth::the_search_finds_all_light_on_tilted_squares",
            "truth::points_on_the_floor_agree_with_the_map_of_the_floor",
        ],
        what: "the search for light on a point of a view searches in the wrong direction along the rays",
    },
    Plant {
        file: "src/accuracy/metrics.rs",
        from: "pairs.iter().map(|(a, b)| (a - b).abs()).sum()",
        to: "pairs.iter().map(|(a, b)| a - b).sum()",
        binary: "cpu",
        tests: &["accuracy_metrics::every_figure_rejects_wrong_images"],
        what: "errors of opposite signs cancel in the relative L1 error",
    },
    Plant {
        file: "src/tuning/choose.rs",
        from: "(error / target).powf(1.0 / falls)",
        to: "(target / error).powf(1.0 / falls)",
        binary: "cpu",
        tests: &["tuning::the_fewest_cells_under_the_target_are_chosen"],
        what: "a smaller target error chooses fewer cells",
    },
    Plant {
        file: "src/tuning/choose.rs",
        from: "budget_ms * BUDGET_SHARE",
        to: "budget_ms / BUDGET_SHARE",
        binary: "cpu",
        tests: &["tuning::a_budget_gets_the_most_cells_it_pays_for"],
        what: "a time budget is exceeded",
    },
    Plant {
        file: "src/waves/sines.rs",
        from: "reduce_turns(turns_per_s * scene.time_s)",
        to: "reduce_turns(f64::from((turns_per_s * scene.time_s) as f32))",
        binary: "gpu",
        tests: &[
            "hard_cases::water::a_period_after_a_million_seconds",
            "hard_cases::water::a_period_after_a_billion_seconds",
            "hard_cases::water::a_period_before_minus_a_million_seconds",
        ],
        what: "phases of waves are in f32",
    },
    Plant {
        file: "src/waves/sines.rs",
        from: "reduce_turns(origin_m.x * c.frequency_per_m.x)",
        to: "reduce_turns(f64::from((origin_m.x * c.frequency_per_m.x) as f32))",
        binary: "gpu",
        tests: &["hard_cases::place::moved_by_100_km"],
        what: "waves far from the origin are in f32",
    },
    Plant {
        file: "src/gpu/pieces.rs",
        from: "wide(self.first)",
        to: "wide([0; 3])",
        binary: "gpu",
        tests: &[
            "hard_cases::machine::every_dispatch_in_pieces",
            "hard_cases::fold::footprints_of_a_hundred_thousand_texels",
            "hard_cases::fold::footprints_of_millions_of_texels",
            "hard_cases::fold::sums_beyond_32_bits",
            "hard_cases::fold::footprints_within_one_texel",
            "hard_cases::mesh::a_rod_thinner_than_a_map_texel",
            "hard_cases::mesh::needle_triangles",
        ],
        what: "every piece of a dispatch does the work of the first piece",
    },
    Plant {
        file: "src/physics/interpolated_flux.rs",
        from: "2.0 * mixed * upper_density",
        to: "mixed * upper_density",
        binary: "cpu",
        tests: &["physics::flux_between_two_cuts_is_the_integral"],
        what: "the flux of a sub-volume is that of other areas between its planes",
    },
    Plant {
        file: "src/methods/sub_volume/point_in_sub_volume.rs",
        from: "(-camera.forward, true)",
        to: "(camera.forward, true)",
        binary: "gpu",
        tests: &["sub_volumes::points_have_the_light_of_the_plain_program"],
        what: "parallel rays see the back faces of sub-volumes",
    },
];
