//! Structs that the host and WGSL share, tied by a test that compares names, offsets and sizes with naga's layout.

use bytemuck::{Pod, Zeroable};

/// Declares a `Pod` struct with a list of its fields' offsets.
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $name:ident = $wgsl:literal { $($(#[$fmeta:meta])* $field:ident: $ty:ty),+ $(,)? }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
        pub struct $name { $($(#[$fmeta])* pub $field: $ty),+ }
        impl $name {
            /// Name of the WGSL struct, its size, and (field, offset) pairs.
            pub const LAYOUT: (&'static str, usize, &'static [(&'static str, usize)]) = (
                $wgsl,
                size_of::<$name>(),
                &[$((stringify!($field), std::mem::offset_of!($name, $field))),+],
            );
        }
    };
}

gpu_struct! {
    /// The light of `shaders/shared/light.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Light = "Light" {
        source: [f32; 4],
        extinction_per_m: [f32; 4],
        window_min: [f32; 2],
        cell: [f32; 2],
        cells: u32,
        wave_count: u32,
        object_count: u32,
        has_floor: u32,
        ior: f32,
        flux_scale: f32,
        energy_scale: f32,
        channels: u32,
        split_levels: u32,
        layers: u32,
        wide_texels: u32,
        triangle_scale: f32,
        foot_m: [f32; 2],
        bend_per_m2: f32,
        kind: u32,
        objects_min_m: [f32; 2],
        objects_max_m: [f32; 2],
    }
}

gpu_struct! {
    /// The uniform of `shaders/passes/split.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Split = "Split" {
        level: u32,
        source: u32,
        destination: u32,
        capacity: u32,
        wide: u32,
        wide_capacity: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

gpu_struct! {
    /// A receiver of `shaders/shared/receivers.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Receiver = "Receiver" {
        u_row: [f32; 4],
        v_row: [f32; 4],
        s_row: [f32; 4],
        map_width: u32,
        map_height: u32,
        map_offset: u32,
        level_map_offset: u32,
        s_min: f32,
        s_max: f32,
        level_count: u32,
        density_per_flux: f32,
        axis: [f32; 4],
        irradiance_offset: u32,
        s_per_m: f32,
        layer: u32,
        planes: u32,
        floor_min_m: [f32; 2],
        floor_max_m: [f32; 2],
    }
}

gpu_struct! {
    /// The uniform of `shaders/shared/cull.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Planes = "Planes" {
        receiver: u32,
        object: u32,
        planes: u32,
        list: u32,
        plane: u32,
        scratch: u32,
        capacity: u32,
        smart: u32,
    }
}

gpu_struct! {
    /// A wave component of `shaders/shared/water_surface.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Wave = "Wave" {
        amplitude_m: f32,
        frequency_x_per_m: f32,
        frequency_z_per_m: f32,
        phase_turns: f32,
    }
}

gpu_struct! {
    /// A comparison of `shaders/shared/comparison.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Comparison = "Comparison" {
        fine_width: u32,
        fine_height: u32,
        coarse_width: u32,
        coarse_height: u32,
        first_fine: u32,
        first_coarse: u32,
        receiver: u32,
        blocks: u32,
        first_group: u32,
        places: u32,
        one_in: u32,
        pad: u32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/passes/coarse_irradiance.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    CoarseLight = "CoarseLight" {
        power: [f32; 4],
        first_group: u32,
        group_count: u32,
        comparison_count: u32,
        adds: u32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/passes/estimate.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Estimate = "Estimate" {
        comparison_count: u32,
        group_count: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/shared/resolve.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Resolve = "Resolve" {
        power: [f32; 4],
        first_texel: u32,
        texel_count: u32,
        first_output: u32,
        adds: u32,
        density_per_flux: f32,
        receiver_count: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/passes/landed.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Span = "Span" {
        texel_count: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/passes/unfollowed.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Unfollowed = "Unfollowed" {
        max_height_m: f32,
        max_slope: f32,
        least_step_m: f32,
        floor_y_m: f32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/shared/view.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    View = "View" {
        eye: [f32; 4],
        right: [f32; 4],
        up: [f32; 4],
        forward: [f32; 4],
        extinction_per_m: [f32; 4],
        sky_radiance: [f32; 4],
        floor_albedo: [f32; 4],
        floor_min_m: [f32; 2],
        floor_max_m: [f32; 2],
        floor_y_m: f32,
        has_floor: u32,
        width: u32,
        height: u32,
        first_row: u32,
        row_count: u32,
        orthographic: u32,
        wave_count: u32,
        instance_count: u32,
        light_count: u32,
        air_light_count: u32,
        max_height_m: f32,
        max_slope: f32,
        ior: f32,
        sky_transmittance: f32,
        sky_path_factor: f32,
        layers: u32,
        sample_index: u32,
        sample_offset: [f32; 2],
    }
}

gpu_struct! {
    /// A light in the air of `shaders/passes/camera_irradiance.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    AirLight = "AirLight" {
        source: [f32; 4],
        power: [f32; 4],
    }
}

gpu_struct! {
    /// The uniform of `shaders/shared/level_map_view.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    LevelMapView = "LevelMapView" {
        u_row: [f32; 4],
        v_row: [f32; 4],
        s_row: [f32; 4],
        s_min: f32,
        s_max: f32,
        texels: u32,
        first_triangle: u32,
        arena_offset: u32,
        level: u32,
        source_offset: u32,
        target_offset: u32,
    }
}

gpu_struct! {
    /// A placed mesh of `shaders/shared/geometry.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    Instance = "Instance" {
        mesh_x: [f32; 4],
        mesh_y: [f32; 4],
        mesh_z: [f32; 4],
        albedo: [f32; 4],
        nodes: [[u32; 4]; 4],
        first_node: u32,
        node_count: u32,
        first_triangle: u32,
        pad: u32,
    }
}

/// A struct's WGSL name, size in bytes, and (field, offset) pairs.
pub type Layout = (&'static str, usize, &'static [(&'static str, usize)]);

/// Layouts of all shared structs.
pub const LAYOUTS: [Layout; 15] = [
    Light::LAYOUT,
    Split::LAYOUT,
    Receiver::LAYOUT,
    Planes::LAYOUT,
    Wave::LAYOUT,
    Comparison::LAYOUT,
    CoarseLight::LAYOUT,
    Estimate::LAYOUT,
    Resolve::LAYOUT,
    Span::LAYOUT,
    Unfollowed::LAYOUT,
    View::LAYOUT,
    AirLight::LAYOUT,
    LevelMapView::LAYOUT,
    Instance::LAYOUT,
];

/// A double triple as the GPU holds it, with a fourth value.
pub fn vec4(v: impl Into<[f64; 3]>, w: f64) -> [f32; 4] {
    let [x, y, z] = v.into();
    [x as f32, y as f32, z as f32, w as f32]
}

/// A double pair as the GPU holds it.
pub fn vec2(v: glam::DVec2) -> [f32; 2] {
    [v.x as f32, v.y as f32]
}
