//! Warnings that are known before rendering: what is left out, sub-sampled or not simulated, with the flux concerned. The frame adds the
//! flux that only it can measure.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::blocked::{self, Blocked};
use super::height_fields;
use super::source::Source;
use super::unfollowed;
use super::window::Rect;
use super::{BeamSet, SceneFacts};
use crate::mesh::{Mesh, mtl, repair};
use crate::scene::{ResolvedScene, Scene, Wave};
use crate::stats::Warning;

/// Fewest cells per shortest wave; with fewer, caustics are blurred.
const CELLS_PER_WAVE: f64 = 8.0;
/// Height of a point light over the water, in water cells, below which its rays diverge too fast for the grid.
const CLOSE_CELLS: f64 = 4.0;

/// Projected area of an object's box, as a share of its largest face, below which it is only rounding error.
const NEGLIGIBLE: f64 = 1e-6;
/// Least height of a point light over the water at rest for its solid angle, as a share of the height that counts as close.
const LEAST_HEIGHT: f64 = 1e-9;

/// Code of the warning that scattered light is lost; the frame adds its flux.
pub const SCATTERING_NOT_FOLLOWED: &str = "scattering_not_followed";
/// Code of the warning that cells are coarse for the waves; the frame adds its flux.
pub const WAVES_UNDERSAMPLED: &str = "waves_undersampled";

/// Share of the mean square slope that may be missing without a warning.
const MAX_SLOPE_LOST: f64 = 0.01;

pub(super) fn warning(
    code: &str,
    message: impl Into<String>,
    pointer: impl Into<String>,
) -> Warning {
    Warning {
        pointer: Some(pointer.into()),
        ..Warning::new(code, message)
    }
}

pub(super) fn with_flux(warning: Warning, flux_w: [f64; 3]) -> Warning {
    Warning {
        flux_w: Some(flux_w),
        ..warning
    }
}

/// All warnings that can be found before rendering.
pub(super) fn warnings(facts: &SceneFacts, resolved: &ResolvedScene) -> Vec<Warning> {
    if facts.output.is_water_map() {
        let of_water = smoothed_waves(facts).into_iter();
        return of_water
            .chain(idle_obstacles(facts))
            .chain(seas_without_waves(facts, &resolved.scene))
            .chain(height_fields::warnings(facts))
            .chain(coarse_water_map(facts))
            .collect();
    }
    let meshes = &resolved.meshes;
    let blocked = Blocked::new(facts, meshes);
    let mut all = Vec::new();
    all.extend(scattering(&resolved.scene.water.scattering_per_m));
    all.extend(repaired_meshes(facts, meshes));
    all.extend(dry_parts(facts, &blocked));
    all.extend(thin_objects(facts, meshes));
    all.extend(left_out_by_method(facts, &blocked));
    all.extend(coarse_cells(facts));
    all.extend(smoothed_waves(facts));
    all.extend(idle_obstacles(facts));
    all.extend(seas_without_waves(facts, &resolved.scene));
    all.extend(height_fields::warnings(facts));
    let mut of_lights = Vec::new();
    for set in &facts.lights.beam_sets {
        of_lights.extend(from_below(set));
        of_lights.extend(within_objects(facts, set, &blocked));
        of_lights.extend(close_to_water(facts, set));
        if unfollowed::can_face_away(&facts.water.surface, set) {
            of_lights.push(unfollowed::waves_shade_waves(set.light_index));
        }
    }
    all.extend(joined(of_lights));
    all
}

/// One warning for those of several beam sets of one light that say the same, with the sum of their flux.
fn joined(warnings: Vec<Warning>) -> Vec<Warning> {
    let mut all: Vec<Warning> = Vec::new();
    for warning in warnings {
        let same = |known: &&mut Warning| {
            (&known.code, &known.message, &known.pointer)
                == (&warning.code, &warning.message, &warning.pointer)
        };
        match all.iter_mut().find(same) {
            Some(known) => {
                if let (Some(sum), Some(more)) = (&mut known.flux_w, warning.flux_w) {
                    for (sum, more) in sum.iter_mut().zip(more) {
                        *sum += more;
                    }
                }
            }
            None => all.push(warning),
        }
    }
    all
}

fn scattering(scattering_per_m: &[f64; 3]) -> Option<Warning> {
    scattering_per_m.iter().any(|&b| b > 0.0).then(|| {
        warning(
            SCATTERING_NOT_FOLLOWED,
            "light scattered out of the beams is counted as lost; light scattered into the picture is not simulated",
            "/water/scattering_per_m",
        )
    })
}

/// Repairs and clamped values that were found when meshes were read; once per mesh, at its first object.
fn repaired_meshes(facts: &SceneFacts, meshes: &[Arc<Mesh>]) -> Vec<Warning> {
    let is_first = |index: usize| {
        let id = &meshes[index].id;
        meshes[..index].iter().all(|mesh| mesh.id != *id)
    };
    let shows_material = |id: &str| {
        let mut same = facts
            .receivers
            .objects
            .iter()
            .filter(|object| object.mesh == id);
        facts.output.camera.is_some() && same.any(|object| object.albedo.is_none())
    };
    let shows_material = &shows_material;
    let of_object = |index: usize| {
        let reported = meshes[index].warnings.iter();
        reported.filter_map(move |w| {
            let at = format!("/objects/{index}/mesh");
            let found = warning(&w.code, w.message.clone(), at);
            if repair::LEFT_OUT.contains(&w.code.as_str()) {
                // Triangles without area and duplicates block no additional light.
                Some(with_flux(found, [0.0; 3]))
            } else {
                (w.code == mtl::CLAMPED && shows_material(&meshes[index].id)).then_some(found)
            }
        })
    };
    (0..meshes.len())
        .filter(|&index| is_first(index))
        .flat_map(of_object)
        .collect()
}

/// Objects above the water or reaching out of it: their shadows on the water are not simulated.
fn dry_parts(facts: &SceneFacts, blocked: &Blocked<'_>) -> Vec<Warning> {
    let mut through_water = facts
        .lights
        .beam_sets
        .iter()
        .filter(|light| !light.is_submerged());
    if through_water.next().is_none() {
        return Vec::new();
    }
    let of_object = |(index, object): (usize, &super::placement::ObjectFacts)| {
        let at = format!("/objects/{index}");
        if !object.wet {
            let found = warning(
                "dry_object_casts_no_shadow",
                "the object is above the water; its shadow on the water is not simulated",
                at,
            );
            return Some(with_flux(found, blocked.above_water_w(index)));
        }
        if object.max.y <= 0.0 {
            return None;
        }
        let found = warning(
            "object_cuts_surface",
            "the object reaches through the water at rest; the shadow of its dry part on the water is not simulated",
            at,
        );
        let flux_w = blocked.above_water_w(index);
        // A part below the highest crests may never be out of the water.
        let is_clear = object.max.y > facts.water.surface.max_height_m();
        (is_clear || flux_w != [0.0; 3]).then(|| with_flux(found, flux_w))
    };
    facts
        .receivers
        .objects
        .iter()
        .enumerate()
        .filter_map(of_object)
        .collect()
}

/// Objects that are narrower, as seen from the light, than a texel of their level map.
fn thin_objects(facts: &SceneFacts, meshes: &[Arc<Mesh>]) -> Vec<Warning> {
    let of_object = |index: usize| {
        let object = &facts.receivers.objects[index];
        let mut flux_w = [0.0; 3];
        let mut thinnest: Option<(f64, f64)> = None;
        for light in &facts.lights.beam_sets {
            let Some(level_box) = &facts.lights.boxes_of(light)[index] else {
                continue;
            };
            let texel_m = level_box.density_per_flux.powf(-0.5);
            let across = object.across(&meshes[index], level_box.axis);
            // A sheet seen edge-on blocks nothing.
            if across.width_m >= texel_m || across.area_m2 <= NEGLIGIBLE * across.largest_m2 {
                continue;
            }
            let middle_m = object.wet_middle();
            let unit = light
                .source
                .most_onto(middle_m, across.area_m2, facts.water.ior);
            for (sum, power) in flux_w.iter_mut().zip(light.power) {
                *sum += power * unit;
            }
            if thinnest.is_none_or(|(width_m, _)| across.width_m < width_m) {
                thinnest = Some((across.width_m, texel_m));
            }
        }
        let (width_m, texel_m) = thinnest?;
        let helps = if facts.detail_of(index) < 1.0 {
            "a smaller quality.level_of_detail and more quality.level_map_texels help"
        } else {
            "more quality.level_map_texels help"
        };
        let message = format!(
            "the object is {width_m:.1e} m wide as seen from the light, less than a texel of its level map ({texel_m:.1e} m): some or all of the light that it should block gets through; {helps}"
        );
        let at = format!("/objects/{index}");
        Some(with_flux(
            warning("object_thinner_than_texel", message, at),
            flux_w,
        ))
    };
    facts.wet_objects().filter_map(of_object).collect()
}

/// Effects that the method leaves out.
fn left_out_by_method(facts: &SceneFacts, blocked: &Blocked<'_>) -> Vec<Warning> {
    let mut all = Vec::new();
    let wet = facts.wet_objects().count();
    if facts.lights.lit.is_empty() {
        return all;
    }
    let method = &facts.method;
    if !method.keeps_account {
        all.extend(without_account(facts));
    }
    if wet > 0 && method.leaves_out.shadows {
        let found = warning(
            "objects_cast_no_shadows",
            format!(
                "method {} leaves shadows out: light that an object blocks still reaches what is behind it",
                method.name
            ),
            "/quality/method",
        );
        all.push(with_flux(found, blocked.blocked_w()));
    }
    if wet > 0 && method.leaves_out.waves_in_shadows && facts.water.surface.max_slope() > 0.0 {
        let found = warning(
            "shadows_ignore_waves",
            format!(
                "method {} takes the shadows of flat water: light that an object blocks is missing where it would be missing without waves",
                method.name
            ),
            "/quality/method",
        );
        all.push(with_flux(found, blocked.blocked_w()));
    }
    if wet > 1 && method.leaves_out.shadows_on_objects {
        let found = warning(
            "objects_cast_no_shadows_on_objects",
            format!(
                "method {} lights each object as if it were alone: light that one object blocks still reaches the others",
                method.name
            ),
            "/quality/method",
        );
        all.push(with_flux(found, blocked.blocked_again_w()));
    }
    if wet > 0 && facts.quality.layers > 1 && method.leaves_out.further_layers {
        all.push(warning(
            "further_layers_stay_dark",
            format!(
                "method {} lights only the first surface along the light; further layers stay dark",
                method.name
            ),
            "/quality/layers",
        ));
    }
    all
}

/// The warning about a method that computes light at points only, and keeps no account of it.
fn without_account(facts: &SceneFacts) -> Option<Warning> {
    let mut sum_w = [0.0; 3];
    for set in &facts.lights.beam_sets {
        let unit = match set.source {
            Source::Sun { to_light } => set.window.size().element_product() * to_light.y,
            Source::Point { position_m } => blocked::rect_sr(set.window, position_m),
            Source::Submerged { .. } => 0.0,
        };
        for (sum, power) in sum_w.iter_mut().zip(set.power) {
            *sum += power * unit;
        }
    }
    facts.has_receiver().then(|| {
        let found = warning(
            "method_does_not_conserve",
            format!(
                "method {} computes light at points, so it keeps no energy account; the flux is that of the lights onto the water over the receivers, and light that falls less than a metre per kilometre under water is left out of the points",
                facts.method.name
            ),
            "/quality/method",
        );
        with_flux(found, sum_w)
    })
}

impl SceneFacts {
    /// Whether the cells of a light's grid are too large for the shortest wave.
    pub fn is_undersampled(&self, light: &BeamSet) -> bool {
        cells_needed(self, light) > f64::from(self.cells())
    }

    /// Cells along each side of the water that the method follows light from.
    fn cells(&self) -> u32 {
        let own = self.method.own_cells.map(|own| own.cells);
        own.unwrap_or(self.quality.water_cells)
    }
}

/// Cells along a side of a light's grid that the shortest wave needs.
fn cells_needed(facts: &SceneFacts, light: &BeamSet) -> f64 {
    let widest_m = light.span_m(facts.cells());
    (widest_m * CELLS_PER_WAVE / facts.water.surface.shortest_wave_m()).ceil()
}

/// The light whose water cells are coarsest for the shortest wave.
fn coarse_cells(facts: &SceneFacts) -> Option<Warning> {
    let light = facts
        .lights
        .beam_sets
        .iter()
        .filter(|light| facts.is_undersampled(light))
        .max_by(|a, b| cells_needed(facts, a).total_cmp(&cells_needed(facts, b)))?;
    let cells = facts.cells();
    let own_dial = facts.method.own_cells.map(|own| own.dial);
    let at = match own_dial {
        Some(dial) => format!("/quality/method/{dial}"),
        None => "/quality/water_cells".to_owned(),
    };
    Some(warning(
        WAVES_UNDERSAMPLED,
        format!(
            "a water cell of {:.3} m is coarse for the shortest wave of {:.3} m; {:.0} cells would do",
            light.span_m(cells) / f64::from(cells),
            facts.water.surface.shortest_wave_m(),
            cells_needed(facts, light)
        ),
        at,
    ))
}

/// Spectra that have no wave, although the scene does not ask for a height of 0.
fn seas_without_waves(facts: &SceneFacts, scene: &Scene) -> Vec<Warning> {
    let flat = facts.water.surface.flat_grids();
    flat.filter_map(|wave| match scene.water.waves.get(wave) {
        Some(Wave::Spectrum(waves)) if waves.significant_height_m != Some(0.0) => {
            let [shortest_m, longest_m] = waves.band_m();
            Some(warning(
                "sea_without_waves",
                format!(
                    "the spectrum has no wave between {shortest_m:.4} and {longest_m:.4} m on this tile, so the water is flat; a larger tile, another band or more wind makes waves"
                ),
                format!("/water/waves/{wave}"),
            ))
        }
        _ => None,
    })
    .collect()
}

/// Water whose samples do not carry its shortest waves. What of the light that concerns is not known before it is traced.
fn smoothed_waves(facts: &SceneFacts) -> Vec<Warning> {
    let lost = facts.water.surface.slope_lost();
    lost.filter(|(_, share)| *share > MAX_SLOPE_LOST)
        .map(|(wave, share)| {
            warning(
                "waves_smoothed",
                format!(
                    "the samples miss {:.1} % of the mean square slope of these waves; more samples, or fewer short waves, miss less",
                    100.0 * share
                ),
                format!("/water/waves/{wave}"),
            )
        })
        .collect()
}

/// Obstacles of basins that reflect nothing.
fn idle_obstacles(facts: &SceneFacts) -> Vec<Warning> {
    let idle = facts.water.surface.idle_obstacles();
    idle.map(|(wave, place)| {
        warning(
            "obstacle_outside_basin",
            "the object does not cut the water at rest where its basin has samples, so it reflects no ripples",
            format!("/water/waves/{wave}/obstacles/{place}"),
        )
    })
    .collect()
}

/// A map of the water whose texels are too far apart for its shortest wave: between them it shows other waves than there are.
fn coarse_water_map(facts: &SceneFacts) -> Option<Warning> {
    let texel_m = facts.output.water_map?.texel_m().max_element();
    let shortest_m = facts.water.surface.shortest_wave_m();
    (texel_m > 0.5 * shortest_m).then(|| {
        warning(
            "water_map_coarse",
            format!(
                "texels are {texel_m:.4} m apart, more than half the shortest wave of {shortest_m:.4} m: each value is that of its texel's centre, but they do not show that wave"
            ),
            "/output",
        )
    })
}

fn from_below(light: &BeamSet) -> Option<Warning> {
    light.is_submerged().then(|| {
        let found = warning(
            "light_from_below_not_followed",
            "the light is under water; the light it sends up to the surface, at most half of its power, is not traced into the air or back down",
            format!("/lights/{}", light.light_index),
        );
        with_flux(found, light.power.map(|i| std::f64::consts::TAU * i))
    })
}

fn within_objects(facts: &SceneFacts, light: &BeamSet, blocked: &Blocked<'_>) -> Vec<Warning> {
    let Some(position_m) = light.source.position_m() else {
        return Vec::new();
    };
    let of_object = |index: usize| {
        let found = warning(
            "light_within_object",
            format!(
                "the light is within the bounds of object {index}; of the surfaces around the light, only the side in the object's level map is lit, by part of the flux onto the object"
            ),
            format!("/lights/{}", light.light_index),
        );
        with_flux(found, blocked.onto_w(index, position_m, light.power))
    };
    facts
        .wet_objects()
        .filter(|&index| blocked::is_around(&facts.receivers.objects[index], position_m))
        .map(of_object)
        .collect()
}

fn close_to_water(facts: &SceneFacts, light: &BeamSet) -> Option<Warning> {
    let Source::Point { position_m } = light.source else {
        return None;
    };
    let finest_m = light.grid.places.size().min_element() / f64::from(facts.quality.water_cells);
    let close_m = CLOSE_CELLS * finest_m;
    if light.window.distance_m(position_m) >= close_m {
        return None;
    }
    let foot_m = DVec2::new(position_m.x, position_m.z);
    let near = Rect {
        min: foot_m,
        max: foot_m,
    };
    let from_m = DVec3::new(
        position_m.x,
        position_m.y.max(LEAST_HEIGHT * close_m),
        position_m.z,
    );
    let unit = near
        .grown(close_m)
        .within(light.window)
        .map_or(0.0, |rect| blocked::rect_sr(rect, from_m));
    let found = warning(
        "light_close_to_water",
        format!(
            "the light is {:.1e} m above the water at rest, less than {CLOSE_CELLS} of the smallest water cells of {finest_m:.1e} m: the light of the cells around its foot is placed coarsely",
            position_m.y
        ),
        format!("/lights/{}", light.light_index),
    );
    Some(with_flux(found, light.power.map(|i| i * unit)))
}
