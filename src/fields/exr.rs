//! OpenEXR: all channels of the first part, and those of further parts of the same size.

use std::io::Cursor;

use ::exr::image::FlatSamples;
use ::exr::meta::MetaData;
use ::exr::prelude::{ReadChannels, ReadLayers};

use super::error::FieldError;
use super::samples::Samples;
use super::{Read, check_claim};

pub(super) const MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

fn broken(reason: impl Into<String>) -> FieldError {
    FieldError::unreadable("EXR", reason)
}

pub(super) fn read(bytes: &[u8]) -> Result<Read, FieldError> {
    check_headers(bytes)?;
    let image = ::exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| broken(error.to_string()))?;
    let parts = image.layer_data;
    let size = match parts.first() {
        Some(part) => [part.size.0, part.size.1],
        None => return Err(FieldError::NoSamples),
    };
    let is_single = parts.len() == 1;
    let mut channels: Vec<(String, Samples)> = Vec::new();
    for part in parts {
        if [part.size.0, part.size.1] != size {
            continue;
        }
        let prefix = match &part.attributes.layer_name {
            Some(name) if !is_single => format!("{name}."),
            _ => String::new(),
        };
        for channel in part.channel_data.list {
            let samples = match channel.sample_data {
                FlatSamples::F16(values) => {
                    Samples::F16(values.iter().map(|value| value.to_f32()).collect())
                }
                FlatSamples::F32(values) => Samples::F32(values),
                FlatSamples::U32(values) => {
                    Samples::Integers(values.into_iter().map(f64::from).collect())
                }
            };
            if samples.count() != size[0] * size[1] {
                return Err(broken(format!(
                    "its channel `{}` has fewer samples than pixels",
                    super::printable(&channel.name.to_string())
                )));
            }
            channels.push((format!("{prefix}{}", channel.name), samples));
        }
    }
    if channels.is_empty() {
        return Err(FieldError::NoSamples);
    }
    Ok(Read {
        size,
        frames: 1,
        channels,
    })
}

/// Refuses sizes that the file cannot hold.
fn check_headers(bytes: &[u8]) -> Result<(), FieldError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| broken(error.to_string()))?;
    if meta.headers.iter().any(|header| header.deep) {
        return Err(broken("it has deep data, several samples to a pixel"));
    }
    let (mut pixels, mut samples) = (0_u64, 0_u64);
    for header in &meta.headers {
        let size = [header.layer_size.0 as u64, header.layer_size.1 as u64];
        check_claim("EXR", size, header.channels.list.len() as u64, bytes.len())?;
        pixels += size[0] * size[1];
        samples += size[0] * size[1] * header.channels.list.len() as u64;
    }
    check_claim(
        "EXR",
        [pixels, 1],
        samples.div_ceil(pixels.max(1)),
        bytes.len(),
    )
}
