//! The box in which a method keeps a field: light between the surface and the lowest receiver, on evenly spaced horizontal slices.
//!
//! A field serves every frame in which only receivers or the camera move, so box and local origin must not follow them exactly. Where the
//! output does not fix the box, its sides lie on a coarse grid that grows with it: as long as what is seen or lit stays within them, the box
//! stays.

use glam::{DVec2, DVec3};
use serde_json::json;

use super::SceneFacts;
use super::method::{FieldGrid, Product};
use super::window::{Lit, Rect};
use crate::scene::ResolvedScene;

/// Grid on which the local origin lies, m: fine enough that f32 is accurate around it, coarse enough to stay while a camera moves.
pub(super) const ORIGIN_STEP_M: f64 = 16.0;
/// Steps of the grid of the box's sides in the least power of two that is no smaller than the box.
const STEPS: f64 = 4.0;
/// Least height of the box, as a share of its longer side: a floor at the surface has a field too.
const LEAST_HEIGHT: f64 = 1e-6;

/// The box of a field, local, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldBox {
    /// Its extent along x and z.
    pub rect: Rect,
    /// Height of slice 0: that of the floor, or below the lowest object.
    pub bottom_m: f64,
    /// Height of the last slice: that of the highest crest.
    pub top_m: f64,
    /// Slices, bottom and top included.
    pub slices: u32,
    /// Texels of a slice along x.
    pub width: u32,
    /// Texels of a slice along z.
    pub height: u32,
}

impl FieldBox {
    /// Distance of neighbouring slices, m.
    pub fn spacing_m(&self) -> f64 {
        (self.top_m - self.bottom_m) / f64::from(self.slices - 1)
    }

    /// Texels of a slice.
    pub fn texels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Texels per metre along x and z.
    pub fn texels_per_m(&self) -> DVec2 {
        DVec2::new(f64::from(self.width), f64::from(self.height)) / self.rect.size()
    }

    /// As a receiver.
    pub(super) fn lit(&self) -> Lit {
        Lit {
            min: DVec3::new(self.rect.min.x, self.bottom_m, self.rect.min.y),
            max: DVec3::new(self.rect.max.x, self.top_m, self.rect.max.y),
        }
    }
}

/// What a kept field depends on, and its size.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FieldKey {
    /// Hash of the water and its moment, the light's direction or place, the optics, the box, its resolution, the cells of water and the
    /// method. A light's power is not among them: a field is kept for a light of unit power.
    pub hash: String,
    /// Size, bytes.
    pub bytes: u64,
}

impl FieldKey {
    /// Key of the field of beam set number `index`; `None` for methods without one.
    pub(super) fn of(facts: &SceneFacts, resolved: &ResolvedScene, index: usize) -> Option<Self> {
        let field = facts.field.as_ref()?;
        let set = &facts.lights.beam_sets[index];
        let scene = &resolved.scene;
        // Numbers are written with all their digits.
        let basis = json!({
            "method": facts.method.name,
            "water": scene.water,
            "time_s": scene.time_s,
            "origin_m": format!("{:?}", facts.origin_m),
            "light": format!("{:?} {:?} {:?} {:?}", set.source, set.band.ior, set.band.extinction_per_m, set.window),
            "box": format!("{field:?}"),
            "cells": facts.quality.water_cells,
            "channels": facts.channels(),
        });
        Some(Self {
            hash: blake3::hash(basis.to_string().as_bytes())
                .to_hex()
                .to_string(),
            bytes: bytes(field, facts.channels()),
        })
    }
}

/// Size of a field, bytes: per texel and slice a word for each channel, and one for the mean direction.
pub fn bytes(field: &FieldBox, channels: u32) -> u64 {
    4 * u64::from(channels + 1) * field.texels() * u64::from(field.slices)
}

/// The local origin for a method with a field, from the one that others have.
pub(super) fn origin(origin_m: DVec3) -> DVec3 {
    let on_grid = |v: f64| (v / ORIGIN_STEP_M).round() * ORIGIN_STEP_M;
    DVec3::new(on_grid(origin_m.x), origin_m.y, on_grid(origin_m.z))
}

impl SceneFacts {
    /// Places the box of the field, if the method makes one and a receiver needs light.
    pub(super) fn place_field(&mut self) {
        let grid = match (self.method.product, self.method.field) {
            (Product::Field, Some(grid)) if self.has_receiver() => grid,
            _ => return,
        };
        self.field = self.field_box(grid);
    }

    fn field_box(&self, grid: FieldGrid) -> Option<FieldBox> {
        let of_objects = self.wet_objects().map(|index| {
            let object = &self.receivers.objects[index];
            Lit {
                min: object.min,
                max: object.max,
            }
        });
        let objects: Vec<Lit> = of_objects.collect();
        let floor = self.receivers.floor.as_ref();
        let map = self.receivers.floor_map.map(|map| map.rect);
        let rect = if self.output.is_floor_map() {
            map?
        } else {
            let all = objects.iter().map(Lit::rect).chain(map);
            let rect = on_grid(all.reduce(Rect::including)?);
            // The floor ends where it ends, unless objects stand beside it.
            let inside = floor.filter(|floor| objects.iter().all(|lit| is_over(lit, &floor.rect)));
            inside.map_or(Some(rect), |floor| rect.within(floor.rect))?
        };
        let crest_m = self.water.surface.max_height_m();
        // The floor hides what is below it, but not what is beside it.
        let is_seen = |lit: &&Lit| floor.is_none_or(|floor| !is_over(lit, &floor.rect));
        let lowest_m = objects.iter().filter(is_seen).map(|lit| lit.min.y);
        let lowest_m = lowest_m.reduce(f64::min);
        let bottom_m = match (floor.map(|floor| floor.y_m), lowest_m) {
            (Some(floor_m), lowest_m) if lowest_m.is_none_or(|y| y >= floor_m) => floor_m,
            (_, Some(lowest_m)) => {
                let step_m = step_m(crest_m - lowest_m);
                (lowest_m / step_m).floor() * step_m
            }
            _ => return None,
        };
        let size = rect.size();
        let texel_m = size.max_element() / f64::from(grid.texels);
        let count = |length_m: f64| {
            let texels = (length_m / texel_m).round() as u32;
            texels.clamp(1, grid.texels)
        };
        Some(FieldBox {
            rect,
            bottom_m,
            top_m: crest_m.max(bottom_m + LEAST_HEIGHT * size.max_element()),
            slices: grid.slices,
            width: count(size.x),
            height: count(size.y),
        })
    }

    /// Finds the keys of all fields, once the beam sets are known.
    pub(super) fn name_fields(&mut self, resolved: &ResolvedScene) {
        for index in 0..self.lights.beam_sets.len() {
            self.lights.beam_sets[index].field = FieldKey::of(self, resolved, index);
        }
    }
}

/// Whether an object's bounds lie over a rectangle.
fn is_over(lit: &Lit, rect: &Rect) -> bool {
    let own = lit.rect();
    rect.holds(own.min) && rect.holds(own.max)
}

/// Step of the grid for a length, m.
fn step_m(length_m: f64) -> f64 {
    length_m.max(f64::MIN_POSITIVE).log2().ceil().exp2() / STEPS
}

/// A rectangle with its sides moved outwards to a grid.
fn on_grid(rect: Rect) -> Rect {
    let step_m = step_m(rect.size().max_element());
    Rect {
        min: (rect.min / step_m).floor() * step_m,
        max: (rect.max / step_m).ceil() * step_m,
    }
}
