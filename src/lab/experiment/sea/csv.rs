//! The study as a table for programs: a row for each place.

use std::fmt::Write as _;

use super::study::{Estimate, SeaStudy};

/// CSV with a header; what was not measured is empty.
pub fn to_csv(study: &SeaStudy) -> String {
    let mut text = "wind_m_s,depth_m,texel_mm,mean_over_flat,mean_over_flat_error,cv,cv_error,peak_999,peak_999_error,highest,cv_point_sun,\
        cv_point_sun_error,peak_999_point_sun,highest_point_sun,flashes_per_min,flashes_per_min_error,flash_ms,flash_ms_error,flashes_counted,\
        water_cells,undersampled\n"
        .to_owned();
    let both = |estimate: Estimate| {
        let error = estimate.error.map(|error| error.to_string());
        format!("{},{}", estimate.value, error.unwrap_or_default())
    };
    let nothing = || ",".to_owned();
    for p in &study.places {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            p.place.wind_m_s,
            p.place.depth_m,
            p.texel_mm,
            both(p.sun.mean),
            both(p.sun.cv),
            both(p.sun.peak),
            p.sun.highest,
            both(p.point_sun.cv),
            p.point_sun.peak.value,
            p.point_sun.highest,
            p.flashes.map_or_else(nothing, |f| both(f.per_minute)),
            p.flashes
                .and_then(|f| f.length_ms)
                .map_or_else(nothing, both),
            p.flashes
                .map_or_else(String::new, |f| f.counted.to_string()),
            p.water_cells,
            p.undersampled,
        );
    }
    text
}
