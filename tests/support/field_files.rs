//! Files of numbers as users have them, and scenes that name them.

use caustica::assets::{FieldStore, MeshStore};
use caustica::config::Limits;
use caustica::scene::{ResolvedScene, Scene, SceneError};
use serde_json::{Value, json};

/// An NPY file of float64 in C order.
pub(crate) fn npy(shape: &[usize], values: &[f64]) -> Vec<u8> {
    let data = values.iter().flat_map(|value| value.to_le_bytes());
    npy_of("<f8", shape, &data.collect::<Vec<u8>>())
}

/// An NPY file of float32 in C order.
pub(crate) fn npy_f32(shape: &[usize], values: &[f64]) -> Vec<u8> {
    let data = values
        .iter()
        .flat_map(|value| (*value as f32).to_le_bytes());
    npy_of("<f4", shape, &data.collect::<Vec<u8>>())
}

/// An NPY file with this type and these bytes.
pub(crate) fn npy_of(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    npy_with(
        &format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}\n"),
        data,
    )
}

/// An NPY file with this header and these bytes.
pub(crate) fn npy_with(header: &str, data: &[u8]) -> Vec<u8> {
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(data);
    file
}

/// An EXR file with channels of float32.
pub(crate) fn exr(width: usize, height: usize, channels: &[(&str, Vec<f32>)]) -> Vec<u8> {
    use exr::prelude::*;
    let channels = channels
        .iter()
        .map(|(name, values)| AnyChannel::new(*name, FlatSamples::F32(values.clone())));
    let image = Image::from_channels((width, height), AnyChannels::sort(channels.collect()));
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).unwrap();
    file.into_inner()
}

/// A PNG file of 8 or 16 bits; `codes` are those of all channels of a pixel after each other.
pub(crate) fn png(size: [u32; 2], color: png::ColorType, bits: u32, codes: &[u16]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size[0], size[1]);
    encoder.set_color(color);
    let (depth, data): (_, Vec<u8>) = if bits == 16 {
        let bytes = codes.iter().flat_map(|code| code.to_be_bytes());
        (png::BitDepth::Sixteen, bytes.collect())
    } else {
        (
            png::BitDepth::Eight,
            codes.iter().map(|code| *code as u8).collect(),
        )
    };
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&data).unwrap();
    writer.finish().unwrap();
    file
}

/// A scene whose first wave is a height field of these files.
pub(crate) fn try_scene(mut scene: Value, files: &[Vec<u8>]) -> Result<ResolvedScene, SceneError> {
    let limits = Limits::default();
    let (meshes, fields) = (MeshStore::new(&limits), FieldStore::new(&limits));
    let ids = files.iter().map(|file| {
        let inserted = fields
            .insert(file)
            .unwrap_or_else(|error| panic!("{error}"));
        inserted.field.id.clone()
    });
    let ids: Vec<String> = ids.collect();
    scene["water"]["waves"][0]["kind"] = json!("height_field");
    scene["water"]["waves"][0]["frames"] = json!(ids);
    caustica::methods::resolve(Scene::from_value(scene)?, &limits, (&meshes, &fields))
}

/// The same; panics if the scene is refused.
pub(crate) fn scene(scene: Value, files: &[Vec<u8>]) -> ResolvedScene {
    try_scene(scene, files).unwrap_or_else(|error| panic!("{error}"))
}

/// Values of a function of (x, z) on an even grid, row by row along x.
pub(crate) fn sampled(
    size: [usize; 2],
    min_m: [f64; 2],
    step_m: [f64; 2],
    of: impl Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let places = (0..size[1]).flat_map(|z| (0..size[0]).map(move |x| (x as f64, z as f64)));
    places
        .map(|(x, z)| of(min_m[0] + x * step_m[0], min_m[1] + z * step_m[1]))
        .collect()
}
