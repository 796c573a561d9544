//! The WGSL files that methods share, embedded in the program. Each method lists its own files.

/// Paths below `shaders/` with the text of each file.
pub type Embedded = &'static [(&'static str, &'static str)];

/// Lists files below `shaders/` with their text.
macro_rules! embed_shaders {
    ($($path:literal),* $(,)?) => {
        &[$(($path, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)))),*]
    };
}

pub(crate) use embed_shaders;

/// Shared shader files; a test compares them and those of the methods with the folder.
pub static SHARED: Embedded = embed_shaders![
    "lib/attenuation.wgsl",
    "lib/coverage.wgsl",
    "lib/fresnel.wgsl",
    "lib/interpolated_flux.wgsl",
    "lib/octahedral.wgsl",
    "lib/refraction.wgsl",
    "lib/sky.wgsl",
    "lib/slicing.wgsl",
    "lib/solid_angle.wgsl",
    "lib/turns.wgsl",
    "shared/account.wgsl",
    "shared/air_lights.wgsl",
    "shared/beam.wgsl",
    "shared/beam_triangle.wgsl",
    "shared/blocked_way.wgsl",
    "shared/cell_account.wgsl",
    "shared/comparison.wgsl",
    "shared/cull.wgsl",
    "shared/deposit_share.wgsl",
    "shared/entry.wgsl",
    "shared/floor_distance.wgsl",
    "shared/flux.wgsl",
    "shared/footprint.wgsl",
    "shared/geometry.wgsl",
    "shared/grid.wgsl",
    "shared/grid_beam.wgsl",
    "shared/grid_rays.wgsl",
    "shared/image_space_search.wgsl",
    "shared/level_map_view.wgsl",
    "shared/level_maps.wgsl",
    "shared/light.wgsl",
    "shared/light_field.wgsl",
    "shared/light_fields.wgsl",
    "shared/light_view.wgsl",
    "shared/losses.wgsl",
    "shared/normals.wgsl",
    "shared/planes_uniform.wgsl",
    "shared/points.wgsl",
    "shared/queue.wgsl",
    "shared/receivers.wgsl",
    "shared/reference_planes.wgsl",
    "shared/resolve.wgsl",
    "shared/terms.wgsl",
    "shared/trace_light.wgsl",
    "shared/unit_flux.wgsl",
    "shared/view.wgsl",
    "shared/volume_cut.wgsl",
    "shared/volume_search.wgsl",
    "shared/volumes.wgsl",
    "shared/water_surface.wgsl",
    "shared/wide_footprint.wgsl",
    "stages/beams.wgsl",
    "stages/camera_hits.wgsl",
    "stages/camera_irradiance.wgsl",
    "stages/coarse_irradiance.wgsl",
    "stages/deposit.wgsl",
    "stages/estimate.wgsl",
    "stages/field_irradiance.wgsl",
    "stages/hits.wgsl",
    "stages/irradiance.wgsl",
    "stages/landed.wgsl",
    "stages/level_map.wgsl",
    "stages/level_map_pyramid.wgsl",
    "stages/shade.wgsl",
    "stages/sky_and_air_lights.wgsl",
    "stages/split.wgsl",
    "stages/surface.wgsl",
    "stages/texel_points.wgsl",
    "stages/unfollowed.wgsl",
    "stages/volume_bounds.wgsl",
    "stages/water_map.wgsl",
];
