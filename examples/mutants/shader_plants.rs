//! What is planted in shaders, and which hard cases must notice. Shaders are read at run time: such a plant takes no build.

/// An error in a shader, and who must notice it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShaderPlant {
    /// The family of hard cases that it is made for.
    pub(crate) family: &'static str,
    /// File below `shaders/`.
    pub(crate) file: &'static str,
    /// What stands there; occurs exactly once.
    pub(crate) from: &'static str,
    /// What is put there instead.
    pub(crate) to: &'static str,
    /// Cases, of all families, that must fail; no other may.
    pub(crate) cases: &'static [&'static str],
    /// What it breaks, for people.
    pub(crate) what: &'static str,
}

/// All plants in shaders.
pub(crate) const ALL: &[ShaderPlant] = &[
    ShaderPlant {
        family: "light",
        file: "lib/fresnel.wgsl",
        from: "if cos_i <= 0.0 || square < 0.0 { return 0.0; }",
        to: "if cos_i <= 0.1 || square < 0.0 { return 0.0; }",
        cases: &[
            "waves_under_a_sun_at_1_degree",
            "waves_under_a_sun_at_a_hundredth_of_a_degree",
        ],
        what: "light that grazes the water is cut off",
    },
    ShaderPlant {
        family: "light",
        file: "shared/resolve.wgsl",
        from: "* resolve.power.xyz;",
        to: "* resolve.power.xxx;",
        cases: &["one_dark_channel"],
        what: "all channels get the power of the first",
    },
    ShaderPlant {
        family: "light",
        file: "lib/refraction.wgsl",
        from: "(cos_i - sqrt(square))",
        to: "(cos_i + sqrt(square))",
        cases: &[
            "waves_under_a_sun_at_10_degrees",
            "sun_along_the_steepest_slope",
        ],
        what: "the GPU refracts away from the normal",
    },
    ShaderPlant {
        family: "water",
        file: "lib/attenuation.wgsl",
        from: "return exp(-c_per_m * length_m);",
        to: "return max(exp(-c_per_m * length_m), 0.01);",
        cases: &["absorption_of_1000_per_metre"],
        what: "a hundredth of the light is never absorbed",
    },
    ShaderPlant {
        family: "water",
        file: "shared/trace_light.wgsl",
        from: "if t >= 0.0 {",
        to: "if t >= 1e-3 {",
        cases: &["floor_at_depth_0", "floor_at_a_tenth_of_a_millimetre"],
        what: "a floor less than a millimetre away is missed",
    },
    ShaderPlant {
        family: "place",
        file: "shared/trace_light.wgsl",
        from: "if t >= 0.0 {",
        to: "if t >= 5e-3 {",
        cases: &["a_thousandth_of_the_size"],
        what: "a floor less than half a centimetre away is missed",
    },
    ShaderPlant {
        family: "mesh",
        file: "shared/geometry.wgsl",
        from: "if determinant == 0.0 { return vec3f(-1.0); }",
        to: "if determinant <= 0.0 { return vec3f(-1.0); }",
        cases: &["mixed_winding"],
        what: "triangles have one side",
    },
    ShaderPlant {
        family: "mesh",
        file: "passes/split.wgsl",
        from: "(sum - own) * 0.5, i >= 3u",
        to: "(sum + own) * 0.5, i >= 3u",
        cases: &["one_triangle"],
        what: "beams are halved at points beyond their edges",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/footprint.wgsl",
        from: "f.turn = sign((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));",
        to: "f.turn = 1.0;",
        cases: &["footprints_that_turn_inside_out"],
        what: "footprints that turn inside out are dealt out as if they had no area",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/flux.wgsl",
        from: "    if !WIDE_SUMS {\n        atomicAdd",
        to: "    if true {\n        atomicAdd",
        cases: &[
            "footprints_within_one_texel",
            "footprints_of_a_hundred_thousand_texels",
            "footprints_of_millions_of_texels",
        ],
        what: "sums have 32 bits where the host asks for 64",
    },
    ShaderPlant {
        family: "fold",
        file: "shared/footprint.wgsl",
        from: "+ edges.dy.z * mean_clamped(",
        to: "- edges.dy.z * mean_clamped(",
        cases: &["footprints_of_millions_of_texels"],
        what: "the third edge of a wide footprint counts against its texels",
    },
    ShaderPlant {
        family: "camera",
        file: "lib/fresnel.wgsl",
        from: "if cos_i <= 0.0 || square < 0.0 { return 1.0; }",
        to: "if cos_i <= 0.0 { return 1.0; }",
        cases: &["under_water_at_the_critical_angle"],
        what: "total reflection is the root of a negative number",
    },
    ShaderPlant {
        family: "camera",
        file: "passes/camera_hits.wgsl",
        from: "(1.0 - reflectance) / (view.ior * view.ior)",
        to: "(1.0 - reflectance) / view.ior",
        cases: &["a_micrometre_over_the_surface"],
        what: "radiance that leaves the water is divided by n, not by n²",
    },
    ShaderPlant {
        family: "camera",
        file: "passes/camera_hits.wgsl",
        from: "if over_water(ray.origin) >= 0.0 {",
        to: "if over_water(ray.origin) >= -2e-5 {",
        cases: &["a_micrometre_under_the_surface"],
        what: "a camera just under the water is taken to be over it",
    },
];
