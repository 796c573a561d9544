//! PNG files: codes, orientation, metadata, refusals.

use caustica::image::tone::{code, pbr_neutral, srgb_from_linear};
use caustica::image::{DecodeError, EncodeError, Metadata, decode_png, encode};
use caustica::scene::{LayerName, ToneCurve};
use image::GenericImageView;

use super::image_support::{frame, layer, map, png, stats};

/// A picture that no mirror, flip, transposition or exchange of channels leaves as it is.
fn asymmetric(x: u32, y: u32, channel: usize) -> f32 {
    match channel {
        3 => 1.0,
        c => (x as f32 * 0.11 + y as f32 * 0.23 + c as f32 * 0.05) / 1.5,
    }
}

#[test]
fn codes_and_orientation_survive_in_8_and_16_bits() {
    let (width, height) = (5, 3);
    let frame = frame(
        width,
        height,
        LayerName::Radiance,
        layer(width, height, 4, asymmetric),
    );
    for bits in [8, 16] {
        let encoded = encode(
            &frame,
            &png(bits, ToneCurve::Clip),
            &Metadata::of(&frame.stats),
        )
        .expect("a plain frame");
        assert_eq!(encoded.media_type, "image/png");
        assert_eq!(encoded.warnings, vec![]);
        // Read by somebody else.
        let read = image::load_from_memory(&encoded.bytes).expect("a PNG");
        assert_eq!(read.dimensions(), (width, height));
        let read = read.to_rgb16();
        let max = if bits == 8 { 255 } else { u16::MAX };
        for (x, y, pixel) in read.enumerate_pixels() {
            for channel in 0..3 {
                let light = f64::from(asymmetric(x, y, channel));
                let mut wanted = code(srgb_from_linear(light), max);
                if bits == 8 {
                    // The reader widens 8 bits to 16 by repeating them.
                    wanted *= 257;
                }
                assert_eq!(
                    pixel[channel], wanted,
                    "({x}, {y}) channel {channel}, {bits} bits"
                );
            }
        }
    }
}

#[test]
fn our_own_reader_agrees_with_the_other_one() {
    let frame = frame(5, 3, LayerName::Radiance, layer(5, 3, 4, asymmetric));
    for bits in [8, 16] {
        let bytes = encode(
            &frame,
            &png(bits, ToneCurve::PbrNeutral),
            &Metadata::of(&frame.stats),
        )
        .expect("a plain frame")
        .bytes;
        let ours = decode_png(&bytes).expect("our own file");
        let theirs = image::load_from_memory(&bytes).expect("a PNG");
        let theirs: Vec<u16> = if bits == 8 {
            theirs.to_rgb8().iter().map(|v| u16::from(*v)).collect()
        } else {
            theirs.to_rgb16().into_raw()
        };
        assert_eq!((ours.width, ours.height, ours.bits), (5, 3, bits));
        assert_eq!(ours.rgb, theirs);
    }
}

#[test]
fn exposure_comes_before_the_tone_curve() {
    let mut frame = frame(
        1,
        1,
        LayerName::Radiance,
        layer(1, 1, 4, |_, _, c| [8.0, 4.0, 2.0, 1.0][c]),
    );
    frame.stats = stats(0.25);
    let bytes = encode(
        &frame,
        &png(16, ToneCurve::PbrNeutral),
        &Metadata::of(&frame.stats),
    )
    .expect("a plain frame")
    .bytes;
    let wanted = pbr_neutral([2.0, 1.0, 0.5]).map(|v| code(srgb_from_linear(v), u16::MAX));
    assert_eq!(decode_png(&bytes).expect("a PNG").rgb, wanted);
}

#[test]
fn irradiance_maps_are_shown_as_white_diffuse_surfaces() {
    // E = π is radiance 1 of a white surface; half of it is 0.5.
    let pi = std::f32::consts::PI;
    let frame = map(
        2,
        1,
        layer(2, 1, 3, |x, _, _| if x == 0 { pi } else { pi / 2.0 }),
    );
    let encoded = encode(
        &frame,
        &png(8, ToneCurve::Clip),
        &Metadata::of(&frame.stats),
    )
    .expect("a map");
    assert_eq!(encoded.warnings, vec![]);
    let rgb = decode_png(&encoded.bytes).expect("a PNG").rgb;
    assert_eq!(rgb, [255, 255, 255, 188, 188, 188]);
}

#[test]
fn losses_are_reported() {
    let values = [[2.0, 0.0, 0.0], [1.0, 1.0, 1.0], [-0.5, 0.5, 0.5]];
    let mut frame = frame(
        3,
        1,
        LayerName::Radiance,
        layer(3, 1, 4, |x, _, c| {
            values[x as usize].get(c).copied().unwrap_or(1.0)
        }),
    );
    frame
        .layers
        .insert(LayerName::Depth, layer(3, 1, 1, |_, _, _| 1.0));
    let encode_with =
        |curve| encode(&frame, &png(8, curve), &Metadata::of(&frame.stats)).expect("a plain frame");

    let clip = encode_with(ToneCurve::Clip);
    let codes: Vec<&str> = clip.warnings.iter().map(|w| w.code.as_str()).collect();
    assert_eq!(
        codes,
        ["png_clipped", "png_negative", "png_layers_left_out"]
    );
    assert!(
        clip.warnings[0].message.starts_with("1 of 3 pixels"),
        "{}",
        clip.warnings[0].message
    );
    assert!(
        clip.warnings[2].message.contains("depth"),
        "{}",
        clip.warnings[2].message
    );
    // The file says so too, after what the frame had to say.
    let texts = decode_png(&clip.bytes).expect("a PNG").texts;
    let stats: serde_json::Value = serde_json::from_str(&texts["caustica:stats"]).expect("JSON");
    assert_eq!(stats["warnings"].as_array().map(Vec::len), Some(4));
    assert_eq!(stats["warnings"][1]["code"], "png_clipped");

    let neutral = encode_with(ToneCurve::PbrNeutral);
    assert!(neutral.warnings.iter().all(|w| w.code != "png_clipped"));
}

#[test]
fn values_that_are_not_numbers_are_refused_with_their_place() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let frame = frame(
            4,
            3,
            LayerName::Radiance,
            layer(
                4,
                3,
                4,
                |x, y, c| {
                    if (x, y, c) == (3, 1, 2) { bad } else { 0.5 }
                },
            ),
        );
        let error = encode(
            &frame,
            &png(8, ToneCurve::Clip),
            &Metadata::of(&frame.stats),
        )
        .expect_err("not a number");
        let EncodeError::NonFinite {
            layer,
            x,
            y,
            channel,
            value,
            ..
        } = &error
        else {
            panic!("{error}");
        };
        assert_eq!((*layer, *x, *y, *channel), ("radiance", 3, 1, 2));
        assert_eq!(value.to_bits(), bad.to_bits());
        assert!(
            error
                .to_string()
                .starts_with("layer radiance, pixel (3, 1)"),
            "{error}"
        );
    }
}

#[test]
fn frames_that_cannot_be_shown_are_refused() {
    let good = || frame(2, 2, LayerName::Radiance, layer(2, 2, 4, |_, _, _| 0.5));
    let encoding = png(8, ToneCurve::Clip);
    let refuse = |frame: &caustica::frame::Frame, encoding: &caustica::scene::Encoding| {
        encode(frame, encoding, &Metadata::of(&frame.stats)).expect_err("must be refused")
    };

    let mut short = good();
    short.height = 3;
    assert!(matches!(
        refuse(&short, &encoding),
        EncodeError::Shape { values: 16, .. }
    ));
    let rgb = frame(2, 2, LayerName::Radiance, layer(2, 2, 3, |_, _, _| 0.5));
    assert!(matches!(
        refuse(&rgb, &encoding),
        EncodeError::Shape {
            wanted_channels: 4,
            ..
        }
    ));
    let depth = frame(2, 2, LayerName::Depth, layer(2, 2, 1, |_, _, _| 0.5));
    assert!(refuse(&depth, &encoding).to_string().contains("depth only"));
    let mut empty = good();
    empty.layers.clear();
    assert!(matches!(
        refuse(&empty, &encoding),
        EncodeError::Empty { .. }
    ));
    assert!(matches!(
        refuse(&good(), &png(12, ToneCurve::Clip)),
        EncodeError::PngBits { bits: 12 }
    ));
    for scale in [f64::NAN, f64::INFINITY, -1.0, 1e201] {
        let mut unexposed = good();
        unexposed.stats.exposure.scale = scale;
        assert!(
            matches!(refuse(&unexposed, &encoding), EncodeError::Exposure { .. }),
            "{scale}"
        );
    }
}

#[test]
fn files_carry_their_provenance_and_colour_space() {
    let mut frame = frame(2, 2, LayerName::Radiance, layer(2, 2, 4, |_, _, _| 0.5));
    frame.scene = Some("{\"name\":\"große Höhe\"}".to_owned());
    let bytes = encode(
        &frame,
        &png(8, ToneCurve::Clip),
        &Metadata::of(&frame.stats),
    )
    .expect("a plain frame")
    .bytes;
    let texts = decode_png(&bytes).expect("a PNG").texts;
    assert_eq!(texts["caustica:scene"], "{\"name\":\"große Höhe\"}");
    assert_eq!(texts["Software"], "Caustica 9.8.7");
    assert_eq!(texts["caustica:scene_hash"], "blake3:0123");
    assert!(texts["caustica:stats"].contains("\"planned_peak_bytes\":4096"));
    let reader = png::Decoder::new(std::io::Cursor::new(&bytes))
        .read_info()
        .expect("a PNG");
    assert_eq!(
        reader.info().srgb,
        Some(png::SrgbRenderingIntent::Perceptual)
    );
}

#[test]
fn the_same_frame_gives_the_same_bytes() {
    let frame = frame(64, 40, LayerName::Radiance, layer(64, 40, 4, asymmetric));
    let mut again = frame.clone();
    again.stats.time_ms.total = 99.0;
    again.stats.passes[0].gpu_ms = None;
    again.stats.passes[0].runs = 7;
    let encoding = png(16, ToneCurve::PbrNeutral);
    let a = encode(&frame, &encoding, &Metadata::of(&frame.stats)).expect("a plain frame");
    let b = encode(&again, &encoding, &Metadata::of(&again.stats)).expect("a plain frame");
    assert_eq!(a.bytes, b.bytes);
}

#[test]
fn the_reader_refuses_what_it_cannot_compare() {
    assert!(matches!(
        decode_png(b"not a picture"),
        Err(DecodeError::Unreadable { format: "PNG", .. })
    ));
    let frame = frame(8, 8, LayerName::Radiance, layer(8, 8, 4, asymmetric));
    let bytes = encode(
        &frame,
        &png(8, ToneCurve::Clip),
        &Metadata::of(&frame.stats),
    )
    .expect("a plain frame")
    .bytes;
    assert!(decode_png(&bytes[..bytes.len() - 30]).is_err());

    let mut grey = Vec::new();
    let mut encoder = png::Encoder::new(&mut grey, 1, 1);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&[7]).expect("a pixel");
    writer.finish().expect("an end");
    assert!(matches!(
        decode_png(&grey),
        Err(DecodeError::PngKind { .. })
    ));
}
