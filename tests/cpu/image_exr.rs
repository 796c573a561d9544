//! EXR files: channels, numbers, orientation, metadata, refusals.

use caustica::image::layers::format_of;
use caustica::image::{DecodeError, EncodeError, Encoded, Metadata, decode_exr, encode};
use caustica::scene::{Camera, ExrPixel, LayerName};
use exr::prelude::{ReadChannels, ReadLayers};
use half::f16;

use super::image_support::{exr, frame, layer, map};

const ALL: [(LayerName, usize); 7] = [
    (LayerName::Radiance, 4),
    (LayerName::Depth, 1),
    (LayerName::SeenDepth, 1),
    (LayerName::Normal, 3),
    (LayerName::Position, 3),
    (LayerName::Albedo, 3),
    (LayerName::Irradiance, 3),
];

/// Different in every pixel, channel and layer, and not exact in half.
fn value(layer: usize, x: u32, y: u32, channel: usize) -> f32 {
    layer as f32 * 100.0 + y as f32 * 7.03 + x as f32 * 0.301 + channel as f32 * 0.013 - 3.0
}

/// All layers; taller than one ZIP block of 16 rows.
fn full(width: u32, height: u32) -> caustica::frame::Frame {
    let mut frame = frame(
        width,
        height,
        LayerName::Radiance,
        layer(width, height, 4, |x, y, c| value(0, x, y, c)),
    );
    for (index, (name, channels)) in ALL.iter().enumerate().skip(1) {
        frame.layers.insert(
            *name,
            layer(width, height, *channels, |x, y, c| value(index, x, y, c)),
        );
    }
    frame
}

fn write(frame: &caustica::frame::Frame, pixel: ExrPixel) -> Encoded {
    encode(frame, &exr(pixel), &Metadata::of(&frame.stats)).expect("a plain frame")
}

#[test]
fn every_layer_comes_back_under_its_names() {
    let (width, height) = (5, 37);
    let frame = full(width, height);
    for pixel in [ExrPixel::Half, ExrPixel::Float] {
        let encoded = write(&frame, pixel);
        assert_eq!(encoded.media_type, "image/x-exr");
        assert_eq!(encoded.warnings, vec![]);
        let read = decode_exr(&encoded.bytes).expect("an EXR");
        assert_eq!((read.width, read.height), (width, height));
        let names: Vec<&str> = read.channels.keys().map(String::as_str).collect();
        assert_eq!(
            names,
            [
                "A",
                "B",
                "G",
                "N.X",
                "N.Y",
                "N.Z",
                "P.X",
                "P.Y",
                "P.Z",
                "R",
                "Z",
                "albedo.B",
                "albedo.G",
                "albedo.R",
                "irradiance.B",
                "irradiance.G",
                "irradiance.R",
                "seen.Z",
            ]
        );
        for (index, (name, _)) in ALL.iter().enumerate() {
            let is_half =
                pixel == ExrPixel::Half && matches!(name, LayerName::Radiance | LayerName::Albedo);
            for (c, channel) in format_of(*name).exr_channels.iter().enumerate() {
                assert_eq!(read.is_half[*channel], is_half, "{channel}");
                let samples = &read.channels[*channel];
                for y in 0..height {
                    for x in 0..width {
                        let exact = value(index, x, y, c);
                        let wanted = if is_half {
                            f16::from_f32(exact).to_f32()
                        } else {
                            exact
                        };
                        let found = samples[(y * width + x) as usize];
                        assert_eq!(found, wanted, "{channel} at ({x}, {y})");
                    }
                }
            }
        }
    }
}

/// Read with the library's plain RGBA interface, as a stranger would.
#[test]
fn other_readers_see_the_picture_upright() {
    let (width, height) = (4_usize, 3_usize);
    let frame = frame(
        4,
        3,
        LayerName::Radiance,
        layer(4, 3, 4, |x, y, c| (x * 16 + y * 4) as f32 + c as f32),
    );
    let bytes = write(&frame, ExrPixel::Half).bytes;
    let image = exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            move |_, _| vec![(0.0, 0.0, 0.0, 0.0); width * height],
            move |pixels: &mut Vec<(f32, f32, f32, f32)>, at, rgba: (f32, f32, f32, f32)| {
                pixels[at.y() * width + at.x()] = rgba;
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(&bytes))
        .expect("an EXR");
    let pixels = &image.layer_data.channel_data.pixels;
    for y in 0..height {
        for x in 0..width {
            let base = (x * 16 + y * 4) as f32;
            assert_eq!(
                pixels[y * width + x],
                (base, base + 1.0, base + 2.0, base + 3.0)
            );
        }
    }
}

#[test]
fn an_irradiance_map_fills_the_root_with_floats() {
    let frame = map(
        3,
        2,
        layer(3, 2, 3, |x, y, c| {
            70_000.1 + (x + 3 * y) as f32 + c as f32 * 0.1
        }),
    );
    // Even if half is requested.
    let encoded = write(&frame, ExrPixel::Half);
    assert_eq!(encoded.warnings, vec![]);
    let read = decode_exr(&encoded.bytes).expect("an EXR");
    assert_eq!(
        read.channels.keys().collect::<Vec<_>>(),
        ["B", "G", "R"],
        "nothing but the root"
    );
    assert!(read.is_half.values().all(|half| !half));
    assert_eq!(
        read.channels["G"][4],
        70_000.1_f32 + 4.0 + 0.1,
        "column 1, row 1"
    );
}

#[test]
fn values_beyond_half_are_clamped_and_reported() {
    let values = [70_000.0, -1e9, 65_504.0, 1e-9, 6e-8, 0.0];
    let frame = frame(
        6,
        1,
        LayerName::Radiance,
        layer(
            6,
            1,
            4,
            |x, _, c| {
                if c == 0 { values[x as usize] } else { 1.0 }
            },
        ),
    );
    let half = write(&frame, ExrPixel::Half);
    let codes: Vec<&str> = half.warnings.iter().map(|w| w.code.as_str()).collect();
    assert_eq!(codes, ["half_clamped", "half_flushed"]);
    assert!(half.warnings[0].message.starts_with("2 of 24 values"));
    assert!(half.warnings[1].message.starts_with("1 of 24 values"));
    let read = decode_exr(&half.bytes).expect("an EXR");
    assert_eq!(
        read.channels["R"],
        [
            65_504.0,
            -65_504.0,
            65_504.0,
            0.0,
            f16::from_f32(6e-8).to_f32(),
            0.0
        ]
    );
    assert!(read.texts["caustica:stats"].contains("half_clamped"));

    let float = write(&frame, ExrPixel::Float);
    assert_eq!(float.warnings, vec![]);
    let read = decode_exr(&float.bytes).expect("an EXR");
    assert_eq!(read.channels["R"], values);
}

/// A layer alone has the channels that it has beside others.
#[test]
fn channels_do_not_depend_on_the_other_layers() {
    let together = decode_exr(&write(&full(4, 3), ExrPixel::Half).bytes).expect("an EXR");
    for (index, (name, channels)) in ALL.iter().enumerate() {
        let alone = frame(
            4,
            3,
            *name,
            layer(4, 3, *channels, |x, y, c| value(index, x, y, c)),
        );
        let alone = decode_exr(&write(&alone, ExrPixel::Half).bytes).expect("an EXR");
        assert_eq!(alone.channels.len(), *channels, "{name:?}");
        for (channel, samples) in &alone.channels {
            assert_eq!(Some(samples), together.channels.get(channel), "{channel}");
            assert_eq!(
                alone.is_half[channel], together.is_half[channel],
                "{channel}"
            );
        }
    }
}

#[test]
fn only_finite_numbers_are_written() {
    for (name, channels) in ALL {
        for bad in [f32::NAN, f32::NEG_INFINITY, f32::INFINITY] {
            let mut frame = full(4, 3);
            if let Some(layer) = frame.layers.get_mut(&name) {
                // Column 1, row 2, last channel.
                layer.data[(2 * 4 + 1) * channels + channels - 1] = bad;
            }
            let result = encode(&frame, &exr(ExrPixel::Half), &Metadata::of(&frame.stats));
            let error = result.expect_err("not a number");
            let EncodeError::NonFinite {
                layer,
                x,
                y,
                channel,
                ..
            } = error
            else {
                panic!("{error}");
            };
            assert_eq!(
                (layer, x, y, channel),
                (format_of(name).word, 1, 2, channels - 1)
            );
        }
    }
}

#[test]
fn the_camera_and_the_scene_are_in_the_file() {
    let scene = r#"{"camera":"große Höhe"}"#;
    let mut frame = full(4, 3);
    let camera: Camera = serde_json::from_str(
        r#"{ "position_m": [10, 20, 30], "target_m": [10, 20, 20],
             "intrinsics": { "fx": 8, "fy": 6, "cx": 1, "cy": 2 } }"#,
    )
    .unwrap();
    frame.projection = Some(camera.projection([4, 3]));
    frame.scene = Some(scene.to_owned());
    let bytes = write(&frame, ExrPixel::Half).bytes;
    let texts = decode_exr(&bytes).expect("an EXR").texts;
    assert!(texts["caustica:scene"].is_ascii());
    let read: serde_json::Value = serde_json::from_str(&texts["caustica:scene"]).unwrap();
    assert_eq!(read["camera"], "große Höhe");
    let meta = exr::meta::MetaData::read_from_buffered(std::io::Cursor::new(&bytes), true)
        .expect("a header");
    let own = &meta.headers[0].own_attributes;
    // For row vectors: the camera looks along −z; camera space has z ahead.
    assert_eq!(
        own.world_to_camera.unwrap(),
        [
            1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., -10., -20., 30., 1.
        ]
    );
    let ndc = own.world_to_normalized_device.unwrap();
    // A point 2 m ahead, 0.5 m to the right and 0.25 m up is at u = 8 · 0.5 / 2 + 1 = 3, v = −6 · 0.25 / 2 + 2 = 1.25.
    let p = [10.5, 20.25, 28.0, 1.0];
    let [x, y, z, w] = [0, 1, 2, 3].map(|j| (0..4).map(|i| p[i] * ndc[4 * i + j]).sum::<f32>());
    assert!(
        (x / w - 3.0 / 4.0).abs() < 1e-6 && (y / w - 1.25 / 3.0).abs() < 1e-6,
        "{x} {y} {w}"
    );
    assert!((z / w - (1.0 - 0.01 / 2.0)).abs() < 1e-6, "{z} {w}");
    let degrees = |a: f64, b: f64| (a.atan() + b.atan()).to_degrees() as f32;
    assert_eq!(
        own.horizontal_field_of_view,
        Some(degrees(1.0 / 8.0, 3.0 / 8.0))
    );
    assert_eq!(
        own.vertical_field_of_view,
        Some(degrees(2.0 / 6.0, 1.0 / 6.0))
    );
    // At distance 1 the picture reaches from −1/8 to 3/8 and, upwards, from −1/6 to 2/6; a pixel is 1/8 wide and 1/6 high.
    assert_eq!(
        (own.screen_window_width, own.screen_window_center.0),
        (0.5, 0.125)
    );
    assert!((own.screen_window_center.1 - 0.5 / 6.0).abs() < 1e-7);
    assert_eq!(meta.headers[0].shared_attributes.pixel_aspect, 0.75);
    // Without them nothing is written.
    let plain = write(&full(4, 3), ExrPixel::Half).bytes;
    assert!(
        !decode_exr(&plain)
            .unwrap()
            .texts
            .contains_key("caustica:scene")
    );
}

#[test]
fn misshapen_layers_are_refused() {
    let mut frame = full(4, 3);
    frame
        .layers
        .insert(LayerName::Normal, layer(3, 4, 4, |_, _, _| 0.0));
    let error = encode(&frame, &exr(ExrPixel::Half), &Metadata::of(&frame.stats))
        .expect_err("four values per normal");
    assert_eq!(
        error.to_string(),
        "layer normal holds 48 values in 4 channels; 4 x 3 pixels of 3 channels are needed"
    );
}

#[test]
fn layers_are_named_as_in_a_scene() {
    for (name, channels) in ALL {
        let word = serde_json::to_value(name).expect("a word");
        assert_eq!(word, format_of(name).word);
        assert_eq!(format_of(name).exr_channels.len(), channels);
    }
}

#[test]
fn files_carry_provenance_and_colour_space_and_no_time() {
    let bytes = write(&full(4, 3), ExrPixel::Half).bytes;
    let texts = decode_exr(&bytes).expect("an EXR").texts;
    assert_eq!(texts["caustica:scene_hash"], "blake3:0123");
    assert_eq!(texts["colorInteropID"], "lin_rec709_scene");
    let stats: serde_json::Value = serde_json::from_str(&texts["caustica:stats"]).expect("JSON");
    assert_eq!(stats["adapter"]["name"], "Übersichtskarte 水");

    let meta = exr::meta::MetaData::read_from_buffered(std::io::Cursor::new(&bytes), true)
        .expect("a header");
    let [header] = meta.headers.as_slice() else {
        panic!("one part is wanted");
    };
    assert_eq!(header.compression, exr::meta::attribute::Compression::ZIP16);
    let own = &header.own_attributes;
    assert_eq!(
        own.software_name.as_ref().map(ToString::to_string),
        Some("Caustica 9.8.7".to_owned())
    );
    assert!(
        own.comments
            .as_ref()
            .is_some_and(|c| c.to_string().contains("W/(m2 sr)"))
    );
    assert_eq!(own.capture_date, None);
    assert_eq!(own.white_luminance, None);
    let primaries = header
        .shared_attributes
        .chromaticities
        .expect("chromaticities");
    assert_eq!((primaries.red.0, primaries.white.1), (0.64_f32, 0.3290_f32));
}

/// The library keeps attributes in a hash map whose order differs from one map to the next.
#[test]
fn the_same_frame_gives_the_same_bytes() {
    let frame = full(40, 50);
    let mut again = frame.clone();
    again.stats.time_ms.total = 99.0;
    again.stats.passes[0].runs = 7;
    let first = write(&frame, ExrPixel::Half).bytes;
    for _ in 0..20 {
        assert!(first == write(&again, ExrPixel::Half).bytes);
    }
    // Attributes in the order of their names, as OpenEXR itself writes them.
    let place = |name: &[u8]| {
        first
            .windows(name.len())
            .position(|window| window == name)
            .expect("an attribute")
    };
    let order = [
        b"caustica:scene_hash\0string\0".as_slice(),
        b"caustica:stats\0string\0",
        b"channels\0chlist\0",
        b"chromaticities\0",
        b"colorInteropID\0string\0",
        b"compression\0",
        b"software\0string\0",
    ]
    .map(place);
    assert!(order.is_sorted(), "{order:?}");
}

#[test]
fn texts_outside_latin_1_are_refused_by_name() {
    let frame = full(2, 2);
    let mut metadata = Metadata::of(&frame.stats);
    metadata.scene_hash = "水".to_owned();
    let error = encode(&frame, &exr(ExrPixel::Half), &metadata).expect_err("not Latin-1");
    assert_eq!(
        error,
        EncodeError::Text {
            name: "caustica:scene_hash"
        }
    );
}

#[test]
fn the_reader_refuses_damage() {
    let refused = |bytes: &[u8]| {
        matches!(
            decode_exr(bytes),
            Err(DecodeError::Unreadable { format: "EXR", .. })
        )
    };
    assert!(refused(b""));
    assert!(refused(b"not a picture at all"));
    let bytes = write(&full(40, 50), ExrPixel::Half).bytes;
    assert!(refused(&bytes[..bytes.len() / 2]));
    let mut wrong_magic = bytes;
    wrong_magic[0] ^= 1;
    assert!(refused(&wrong_magic));
}
