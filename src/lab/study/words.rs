//! Numbers and settings as people write them.

use serde_json::Value;

use super::study::{Point, SpreadMs, Sweep};

/// A number with `digits` significant digits, without exponent and without trailing zeros behind the point; `0` for 0.
///
/// A value that is not finite comes out as Rust prints it.
pub fn significant(value: f64, digits: u32) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor() as i32;
    let decimals = digits as i32 - 1 - magnitude;
    let step = 10f64.powi(-decimals);
    let rounded = (value / step).round() * step;
    let text = format!("{rounded:.*}", decimals.max(0) as usize);
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    // The minus sign of print.
    text.replace('-', "−")
}

/// A share of 1 as `1.23 %`, three significant digits.
pub fn percent(share: f64) -> String {
    significant(100.0 * share, 3) + " %"
}

/// A signed share of 1 as `+1.23 %`; two significant digits more than a millionth are kept, less is 0.
pub fn signed_percent(share: f64) -> String {
    if share.abs() < 5e-9 {
        return "0 %".to_owned();
    }
    let sign = if share > 0.0 { "+" } else { "" };
    sign.to_owned() + &percent(share)
}

/// A time in ms, three significant digits.
pub fn ms(value: f64) -> String {
    significant(value, 3)
}

/// `12.3 (12.1–13)`: median, smallest and largest.
pub fn spread(spread: SpreadMs) -> String {
    format!(
        "{} ({}–{})",
        ms(spread.median),
        ms(spread.min),
        ms(spread.max)
    )
}

/// Bytes as MiB, three significant digits.
pub fn mib(bytes: u64) -> String {
    significant(bytes as f64 / (1024.0 * 1024.0), 3)
}

/// A whole number with thin spaces between thousands.
pub fn thousands(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A dial's value: words without quotes, switches as on and off.
pub fn value(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        Value::Bool(true) => "on".to_owned(),
        Value::Bool(false) => "off".to_owned(),
        Value::Null => "none".to_owned(),
        other => other.to_string(),
    }
}

/// The values of a point's dials in the order of the sweep's name: `512`, or `512, exact`. In a comparison, the numbers with their names.
pub fn setting(sweep: &Sweep, point: &Point) -> String {
    if sweep.series.is_some() {
        return numbers(sweep, point);
    }
    let texts: Vec<String> = dials(sweep, point).iter().map(|(_, v)| value(v)).collect();
    texts.join(", ")
}

/// The dials of a point with their values: `beams 512, hits exact`. In a comparison, after the series: `planes: water_cells 512`.
pub fn named_setting(sweep: &Sweep, point: &Point) -> String {
    if sweep.series.is_some() {
        return format!("{}: {}", sweep.dial, numbers(sweep, point));
    }
    let texts: Vec<String> = dials(sweep, point)
        .iter()
        .map(|(dial, v)| format!("{dial} {}", value(v)))
        .collect();
    texts.join(", ")
}

/// What stands beside a mark: the values of the dials, in a comparison that of the chief dial alone.
pub fn label(sweep: &Sweep, point: &Point) -> String {
    match &sweep.series {
        Some(of) => point.dials.get(&of.chief).map_or_else(String::new, value),
        None => setting(sweep, point),
    }
}

/// The numbers of a point of a comparison, the chief one first: `photons 512, iterations 3`.
fn numbers(sweep: &Sweep, point: &Point) -> String {
    let chief = sweep.series.as_ref().map(|of| of.chief.as_str());
    let numbers = point.dials.iter().filter(|(_, value)| value.is_number());
    let mut numbers: Vec<(&String, &Value)> = numbers.collect();
    numbers.sort_by_key(|(name, _)| Some(name.as_str()) != chief);
    let texts: Vec<String> = numbers
        .iter()
        .map(|(name, number)| format!("{name} {}", value(number)))
        .collect();
    texts.join(", ")
}

/// Dials in the order of the sweep's name; any others follow by name.
fn dials<'a>(sweep: &Sweep, point: &'a Point) -> Vec<(&'a str, &'a Value)> {
    let names: Vec<&str> = sweep.dial.split(" × ").collect();
    let mut dials: Vec<(&str, &Value)> = point.dials.iter().map(|(k, v)| (k.as_str(), v)).collect();
    dials.sort_by_key(|(dial, _)| names.iter().position(|n| n == dial).unwrap_or(names.len()));
    dials
}
