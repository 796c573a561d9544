//! Errors planted in shaders, and the hard cases that must catch them. Shaders are read at run time, so these plants need no build.

/// An error in a shader, and the cases that must catch it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShaderPlant {
    /// The family of hard cases that it is made for.
    pub(crate) family: &'static str,
    /// File below `shaders/`.
    pub(crate) file: &'static str,
    /// The original code; occurs exactly once.
    pub(crate) from: &'static str,
    /// The replacement.
    pub(crate) to: &'static str,
    /// Cases, of all families, that must fail; no other may.
    pub(crate) red: Red,
    /// A description of the error.
    pub(crate) what: &'static str,
}

/// Hard cases by their names.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Red {
    /// These.
    Only(&'static [&'static str]),
    /// All but these.
    AllBut(&'static [&'static str]),
}

impl Red {
    /// Whether a case is among them.
    pub(crate) fn holds(self, name: &str) -> bool {
        match self {
            Self::Only(names) => names.contains(&name),
            Self::AllBut(names) => !names.contains(&name),
        }
    }
}

/// All plants in shaders.
pub(crate) const ALL: &[ShaderPlant] = &[
    ShaderPlant {
        family: "light",
        file: "lib/fresnel.wgsl",
        from: "if cos_i <= 0.0 || square < 0.0 { return 0.0; }",
        to: "if cos_i <= 0.1 || square < 0.0 { return 0.0; }",
        red: Red::Only(&[
            "sun_at_1_degree",
            "sun_at_a_hundredth_of_a_degree",
            "waves_under_a_sun_at_10_degrees",
            "waves_under_a_sun_at_1_degree",
            "waves_under_a_sun_at_a_hundredth_of_a_degree",
            "slopes_of_20",
            "light_that_leaves_the_water_again",
        ]),
        what: "light that grazes the water is cut off",
    },
    ShaderPlant {
        family: "light",
        file: "shared/resolve.wgsl",
        from: "* resolve.power.xyz;",
        to: "* resolve.power.xxx;",
        red: Red::Only(&["one_dark_channel"]),
        what: "all channels get the power of the first",
    },
    ShaderPlant {
        family: "light",
        file: "lib/refraction.wgsl",
        from: "(cos_i - sqrt(square))",
        to: "(cos_i + sqrt(square))",
        red: Red::AllBut(&[
            "sun_on_the_horizon",
            "sun_below_the_horizon",
            "no_irradiance",
            "a_lamp_on_the_water",
            "a_lamp_a_millimetre_under_the_water",
            "a_lamp_a_millimetre_under_a_wave",
            "steep_waves_are_warned_of",
            "slopes_that_look_away",
            "index_below_1",
            "nothing_but_zero_area",
            "along_its_own_up",
            "pictures_of_8192_by_8192_pixels",
        ]),
        what: "the GPU refracts away from the normal",
    },
    ShaderPlant {
        family: "water",
        file: "lib/attenuation.wgsl",
        from: "return exp(-c_per_m * length_m);",
        to: "return max(exp(-c_per_m * length_m), 0.01);",
        red: Red::Only(&["absorption_of_1000_per_metre"]),
        what: "transmittance never falls below a hundredth",
    },
    ShaderPlant {
        family: "water",
        file: "shared/trace_light.wgsl",
        from: "if t >= 0.0 {",
        to: "if t >= 1e-3 {",
        red: Red::Only(&[
            "floor_at_depth_0",
            "floor_at_a_tenth_of_a_millimetre",
            "a_view_of_a_floor_at_depth_0",
            "a_view_of_a_floor_at_a_tenth_of_a_millimetre",
            "troughs_below_the_floor",
        ]),
        what: "a floor less than a millimetre away is missed",
    },
    ShaderPlant {
        family: "place",
        file: "shared/trace_light.wgsl",
        from: "if t >= 0.0 {",
        to: "if t >= 5e-3 {",
        red: Red::Only(&[
            "floor_at_depth_0",
            "floor_at_a_tenth_of_a_millimetre",
            "a_view_of_a_floor_at_depth_0",
            "a_view_of_a_floor_at_a_tenth_of_a_millimetre",
            "troughs_below_the_floor",
            "a_thousandth_of_the_size",
        ]),
        what: "a floor less than half a centimetre away is missed",
    },
    ShaderPlant {
        family: "mesh",
        file: "shared/geometry.wgsl",
        from: "if determinant == 0.0 { return vec3f(-1.0); }",
        to: "if determinant <= 0.0 { return vec3f(-1.0); }",
        red: Red::Only(&[
            "needle_triangles",
            "mixed_winding",
            "an_open_box",
            "three_sheets_on_an_edge",
            "around_the_camera",
            "detail_of_a_centimetre_a_thousand_kilometres_out",
        ]),
        what: "triangles have one side",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/footprint.wgsl",
        from: "y <= f.box.last.y; y++) { beside += deposit_row(target_map, f, y, triangle_flux); }",
        to: "y <= f.box.last.y && f.turn > 0.0; y++) { beside += deposit_row(target_map, f, y, triangle_flux); }",
        red: Red::Only(&[
            "waves_under_a_sun_at_10_degrees",
            "waves_under_a_sun_at_1_degree",
            "waves_under_a_sun_at_a_hundredth_of_a_degree",
            "sun_along_the_steepest_slope",
            "a_lamp_a_millimetre_above_a_wave",
            "ripples_of_a_millimetre",
            "slopes_of_1",
            "slopes_of_5",
            "slopes_of_20",
            "steep_waves_are_warned_of",
            "index_2_4",
            "a_line_focus_on_the_floor",
            "a_point_focus_on_the_floor",
            "footprints_that_turn_inside_out",
            "sums_beyond_32_bits",
            "light_that_leaves_the_water_again",
            "slopes_that_look_away",
        ]),
        what: "footprints that turn inside out lose their flux",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/flux.wgsl",
        from: "    if !WIDE_SUMS {\n        atomicAdd",
        to: "    if true {\n        atomicAdd",
        red: Red::Only(&[
            "waves_under_a_sun_at_a_hundredth_of_a_degree",
            "dim_and_bright_suns_together",
            "a_lamp_a_millimetre_above_the_water",
            "a_lamp_on_the_water",
            "a_lamp_a_millimetre_under_the_water",
            "a_lamp_exactly_above_a_vertex_of_the_grid",
            "a_lamp_a_millimetre_above_a_wave",
            "a_lamp_a_millimetre_under_a_wave",
            "slopes_of_1",
            "index_1",
            "index_1_0001",
            "index_2_4",
            "a_line_focus_on_the_floor",
            "a_point_focus_on_the_floor",
            "footprints_that_turn_inside_out",
            "footprints_within_one_texel",
            "footprints_of_a_hundred_thousand_texels",
            "footprints_of_millions_of_texels",
            "sums_beyond_32_bits",
            "one_column_of_8192_pixels",
            "ripples_of_a_millimetre",
            "light_that_leaves_the_water_again",
            "troughs_below_the_floor",
            "needle_triangles",
            "a_plate_on_a_reference_plane",
            "a_rod_thinner_than_a_map_texel",
            "detail_of_a_centimetre_a_thousand_kilometres_out",
        ]),
        what: "sums have 32 bits where the host requests 64",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/footprint.wgsl",
        from: "+ edges.dy.z * mean_clamped(",
        to: "- edges.dy.z * mean_clamped(",
        red: Red::Only(&[
            "slopes_of_20",
            "footprints_of_a_hundred_thousand_texels",
            "footprints_of_millions_of_texels",
            "light_that_leaves_the_water_again",
        ]),
        what: "the third edge of a wide footprint has the wrong sign",
    },
    ShaderPlant {
        family: "water",
        file: "stages/unfollowed.wgsl",
        from: "if gap < 0.0 { return true; }",
        to: "if gap < -0.2 { return true; }",
        red: Red::Only(&["light_that_leaves_the_water_again"]),
        what: "light that leaves the water only slightly is not reported",
    },
    ShaderPlant {
        family: "water",
        file: "stages/unfollowed.wgsl",
        from: "note_unfollowed(TERM_FACING_AWAY, -signed_unit_flux(",
        to: "note_unfollowed(TERM_FACING_AWAY, -0.5 * signed_unit_flux(",
        red: Red::Only(&["slopes_that_look_away"]),
        what: "only half of the flux on slopes that face away is reported",
    },
    ShaderPlant {
        family: "water",
        file: "shared/floor_distance.wgsl",
        from: "return max(-s / rate, 0.0);",
        to: "return -s / rate;",
        red: Red::Only(&["troughs_below_the_floor"]),
        what: "the clamp of path lengths to a floor above the start is missing",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/footprint.wgsl",
        from: "right = select(right, 1.0, right < FLAT_ROW);",
        to: "right = select(right, 1.0, false);",
        red: Red::Only(&[
            "sun_along_the_steepest_slope",
            "floor_at_11000_metres",
            "a_line_focus_on_the_floor",
            "a_point_focus_on_the_floor",
            "sums_beyond_32_bits",
            "one_column_of_8192_pixels",
            "every_corner_on_a_texel_corner",
        ]),
        what: "shares are divided by the footprint's area where it has none",
    },
    ShaderPlant {
        family: "camera",
        file: "stages/camera_hits.wgsl",
        from: "const START_M: f32 = -2.0 * SURFACE_TOLERANCE_M;",
        to: "const START_M: f32 = 1e-4;",
        red: Red::Only(&["a_view_of_a_floor_at_depth_0"]),
        what: "camera rays through the water start a tenth of a millimetre under it",
    },
    ShaderPlant {
        family: "camera",
        file: "lib/fresnel.wgsl",
        from: "if cos_i <= 0.0 || square < 0.0 { return 1.0; }",
        to: "if cos_i <= 0.0 { return 1.0; }",
        red: Red::Only(&["under_water_at_the_critical_angle"]),
        what: "total reflection is the root of a negative number",
    },
    ShaderPlant {
        family: "camera",
        file: "stages/camera_hits.wgsl",
        from: "(1.0 - reflectance) / (view.ior * view.ior)",
        to: "(1.0 - reflectance) / view.ior",
        red: Red::Only(&[
            "a_micrometre_over_the_surface",
            "on_the_surface",
            "on_a_wave",
            "a_view_of_a_floor_at_depth_0",
            "a_view_of_a_floor_at_a_tenth_of_a_millimetre",
            "a_field_of_view_of_a_tenth_of_a_degree",
            "a_field_of_view_of_179_degrees",
            "one_column_of_8192_pixels",
        ]),
        what: "radiance that leaves the water is divided by n instead of n²",
    },
    ShaderPlant {
        family: "camera",
        file: "stages/camera_hits.wgsl",
        from: "if over_water(ray.origin) >= 0.0 {",
        to: "if over_water(ray.origin) >= -2e-5 {",
        red: Red::Only(&["a_micrometre_under_the_surface", "on_a_wave"]),
        what: "a camera just under the water is treated as above it",
    },
];
