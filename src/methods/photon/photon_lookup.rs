//! Photon look-up — irradiance at points from the maps of all beam sets. A point that the view from the sun does not show gets none
//! (Mihálik 2008, §9.2: shadow mapping).

use super::photon_map::PHOTON_MAP;
use super::photon_view::LIGHT_DEPTH;
use super::view::{LIGHT_VIEW, LightView, light_view, uniforms};
use crate::graph::View;
use crate::stages::points::{POINT_IRRADIANCE, POINTS, band_rows, size};
use crate::stages::surface::wanted_for_light;
use crate::stages::{Groups, Pass, Step, Steps};

/// See the module.
pub static PASS: Pass = Pass {
    name: "photon_lookup",
    shader: "methods/photon/photon_lookup.wgsl",
    reads: &[&POINTS, &PHOTON_MAP, &LIGHT_DEPTH],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[(LIGHT_VIEW, LightView::LAYOUT)],
    views: &["light_depth"],
    wanted: wanted_for_light,
    // Each beam set has a map of its own, so none is traced again for a band.
    steps: Steps::Band(|facts, band| {
        let Some([width, _]) = size(facts) else {
            return Vec::new();
        };
        let groups = Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]);
        let sets = 0..facts.lights.beam_sets.len();
        sets.map(|index| {
            let view = LightView {
                width,
                row_count: band.rows,
                are_texels: u32::from(facts.output.camera.is_none()),
                ..light_view(facts, index)
            };
            Step {
                views: vec![View {
                    variable: "light_depth",
                    slot: &LIGHT_DEPTH,
                    layer: index as u32,
                }],
                ..Step::compute("photon_lookup_main", groups, uniforms(&view))
            }
        })
        .collect()
    }),
    work: |facts| {
        let points = size(facts).map_or(0.0, |[width, height]| {
            f64::from(width) * f64::from(band_rows(width, height))
        });
        points * facts.lights.beam_sets.len() as f64
    },
};
