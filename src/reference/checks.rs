//! Checks the scene's values, and lists the suns and point lights that the reference traces.

use super::ReferenceError;
use crate::scene::{Light, Output, PointLight, Scene, Sun, Water};
use crate::waves::Surface;

/// The water's extinction, 1/m, after checking its values.
pub(super) fn check_water(water: &Water) -> Result<[f64; 3], ReferenceError> {
    let mut extinction_per_m = [0.0; 3];
    for (c, extinction) in extinction_per_m.iter_mut().enumerate() {
        *extinction = water.absorption_per_m[c] + water.scattering_per_m[c];
        check("water extinction (a + b), 1/m", *extinction, 0.0, f64::MAX)?;
    }
    check("water.ior", water.ior, 1.0, f64::MAX)?;
    Ok(extinction_per_m)
}

/// Refuses waves whose values are not finite.
pub(super) fn check_surface(surface: &Surface) -> Result<(), ReferenceError> {
    let height_m = surface.max_height_m();
    check("the waves' height, m", height_m, f64::MIN, f64::MAX)?;
    check("the waves' slope", surface.max_slope(), f64::MIN, f64::MAX)
}

fn check(what: &'static str, value: f64, low: f64, high: f64) -> Result<(), ReferenceError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(ReferenceError::Figure {
        what,
        value,
        accepted: "a finite number in the range of the scene format is accepted",
    })
}

/// The lights that contribute to the output.
fn counted(scene: &Scene) -> Result<impl Iterator<Item = &Light>, ReferenceError> {
    let only = match &scene.output {
        Output::IrradianceMap(output) => output.light,
        Output::View(_) | Output::WaterMap(_) => None,
    };
    if let Some(index) = only
        && !matches!(
            scene.lights.get(index as usize),
            Some(Light::Sun(_) | Light::Point(_))
        )
    {
        return Err(ReferenceError::NotASun {
            index,
            lights: scene.lights.len(),
        });
    }
    let lights = scene.lights.iter().enumerate();
    Ok(lights
        .filter(move |(index, _)| only.is_none_or(|only| only as usize == *index))
        .map(|(_, light)| light))
}

/// The point lights of `scene`.
pub(super) fn point_lights(scene: &Scene) -> Result<Vec<&PointLight>, ReferenceError> {
    let mut points = Vec::new();
    for light in counted(scene)? {
        if let Light::Point(point) = light {
            for place in point.position_m {
                check("a point light's position_m", place, f64::MIN, f64::MAX)?;
            }
            for intensity in point.intensity_w_sr {
                check("a point light's intensity_w_sr", intensity, 0.0, f64::MAX)?;
            }
            points.push(point);
        }
    }
    Ok(points)
}

/// The suns of `scene` whose light enters the water.
pub(super) fn suns(scene: &Scene) -> Result<Vec<&Sun>, ReferenceError> {
    let mut suns = Vec::new();
    for light in counted(scene)? {
        if let Light::Sun(sun) = light {
            check("a sun's elevation_deg", sun.elevation_deg, -90.0, 90.0)?;
            check("a sun's azimuth_deg", sun.azimuth_deg, f64::MIN, f64::MAX)?;
            for irradiance in sun.irradiance_w_m2 {
                check("a sun's irradiance_w_m2", irradiance, 0.0, f64::MAX)?;
            }
            if sun.elevation_deg > 0.0 {
                suns.push(sun);
            }
        }
    }
    Ok(suns)
}
