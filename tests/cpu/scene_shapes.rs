//! Values of the wrong type in a scene: a table of inputs, with pointer and text of the refusal.

use caustica::scene::IssueKind;

use super::scene_parse::refusal;

/// (JSON text, pointer, part of the detail, part of what is accepted)
type Refusal = (&'static str, &'static str, &'static str, &'static str);

const SHAPES: &[Refusal] = &[
    // The document itself.
    ("[]", "", "an array", "an object with the fields `water`"),
    ("null", "", "null", "an object"),
    ("\"scene\"", "", "the string \"scene\"", "an object"),
    ("3", "", "the number 3", "an object"),
    // Unknown fields and near misses.
    (
        r#"{"watr": {}}"#,
        "/watr",
        "did you mean `water`?",
        "`water`, `floor`",
    ),
    (r#"{"zzz": {}}"#, "/zzz", "unknown field `zzz`", "`time_s`"),
    (r#"{"a/b~c": 1}"#, "/a~1b~0c", "unknown field", "`water`"),
    (
        r#"{"floor": {"depth": 2, "size_m": [4, 4]}}"#,
        "/floor/depth",
        "unknown field `depth`; did you mean `depth_m`?",
        "`depth_m`, `size_m`, `center_m` or `albedo`",
    ),
    (
        r#"{"floor": {"depth_cm": 2, "size_m": [4, 4]}}"#,
        "/floor/depth_cm",
        "did you mean `depth_m`?",
        "`depth_m`",
    ),
    (
        r#"{"quality": {"waterCells": 2}}"#,
        "/quality/waterCells",
        "did you mean `water_cells`?",
        "`water_cells`",
    ),
    (
        r#"{"lights": [{"kind": "sun", "elevation_rad": 1, "irradiance_w_m2": [1, 1, 1]}]}"#,
        "/lights/0/elevation_rad",
        "did you mean `elevation_deg`?",
        "`azimuth_deg`",
    ),
    (
        r#"{"water": {"waves": [{"kind": "sine", "amplitude": 1, "wavelength_m": 1}]}}"#,
        "/water/waves/0/amplitude",
        "did you mean `amplitude_m`?",
        "`wavelength_m`",
    ),
    // Missing fields.
    (
        r#"{"floor": {"size_m": [4, 4]}}"#,
        "/floor/depth_m",
        "missing field `depth_m`",
        "in m",
    ),
    (
        r#"{"objects": [{}]}"#,
        "/objects/0/mesh",
        "missing field `mesh`",
        "`mesh`",
    ),
    (
        r#"{"lights": [{"kind": "sun", "irradiance_w_m2": [1, 1, 1]}]}"#,
        "/lights/0/elevation_deg",
        "missing field `elevation_deg`",
        "in degrees",
    ),
    (
        r#"{"output": {"kind": "irradiance_map"}}"#,
        "/output/receiver",
        "missing field `receiver`",
        "`receiver`",
    ),
    // Kinds.
    (
        r#"{"lights": [{}]}"#,
        "/lights/0/kind",
        "missing field `kind`",
        "`sun`, `point` or `sky`",
    ),
    (
        r#"{"lights": [{"kind": "lamp"}]}"#,
        "/lights/0/kind",
        "unknown kind `lamp`",
        "`sun`, `point` or `sky`",
    ),
    (
        r#"{"lights": [{"kind": 3}]}"#,
        "/lights/0/kind",
        "the number 3",
        "`sun`, `point` or `sky`",
    ),
    (
        r#"{"lights": [{"kind": null}]}"#,
        "/lights/0/kind",
        "null",
        "`sun`, `point` or `sky`",
    ),
    (
        r#"{"lights": ["sun"]}"#,
        "/lights/0",
        "the string \"sun\"",
        "the field `kind`: `sun`, `point` or `sky`",
    ),
    (
        r#"{"lights": {"kind": "sun"}}"#,
        "/lights",
        "an object is of the wrong type",
        "an array",
    ),
    (
        r#"{"water": {"waves": [{"kind": "stokes"}]}}"#,
        "/water/waves/0/kind",
        "unknown kind `stokes`",
        "`sine`, `gerstner`, `spectrum`, `ripples` or `height_field`",
    ),
    (
        r#"{"camera": {"kind": "fisheye"}}"#,
        "/camera/kind",
        "unknown kind",
        "`perspective` or `orthographic`",
    ),
    (
        r#"{"output": {}}"#,
        "/output/kind",
        "missing field `kind`",
        "`view`, `irradiance_map` or `water_map`",
    ),
    (
        r#"{"output": {"kind": "View"}}"#,
        "/output/kind",
        "unknown kind `View`",
        "`view`",
    ),
    // Types.
    (
        r#"{"time_s": "NaN"}"#,
        "/time_s",
        "the string \"NaN\"",
        "a number",
    ),
    (r#"{"time_s": null}"#, "/time_s", "null", "a number"),
    (
        r#"{"time_s": true}"#,
        "/time_s",
        "the boolean true",
        "a number",
    ),
    (r#"{"time_s": [1]}"#, "/time_s", "an array", "a number"),
    (
        r#"{"water": []}"#,
        "/water",
        "an array",
        "an object with the fields `waves`",
    ),
    (
        r#"{"floor": [2, [4, 4]]}"#,
        "/floor",
        "an array",
        "an object",
    ),
    (r#"{"quality": [ ]}"#, "/quality", "an array", "an object"),
    (
        r#"{"water": {"waves": [
            {"kind": "sine", "amplitude_m": 1, "wavelength_m": 1},
            {"kind": "sine", "amplitude_m": 1, "wavelength_m": 1},
            {"kind": "sine", "amplitude_m": "1", "wavelength_m": 1}]}}"#,
        "/water/waves/2/amplitude_m",
        "the string \"1\"",
        "a number",
    ),
    (
        r#"{"water": {"dispersion": "shallow"}}"#,
        "/water/dispersion",
        "unknown word `shallow`",
        "`deep` or `finite_depth`",
    ),
    (
        r#"{"water": {"dispersion": {"deep": null}}}"#,
        "/water/dispersion",
        "an object",
        "`deep` or `finite_depth`",
    ),
    (
        r#"{"output": {"kind": "view", "format": "jpg"}}"#,
        "/output/format",
        "unknown word `jpg`",
        "`png` or `exr`",
    ),
    (
        r#"{"output": {"kind": "view", "format": {"png": null}}}"#,
        "/output/format",
        "an object",
        "`png` or `exr`",
    ),
    (
        r#"{"output": {"kind": "view", "layers": ["radiance", "dept"]}}"#,
        "/output/layers/1",
        "did you mean `depth`?",
        "`irradiance`",
    ),
    (
        r#"{"output": {"kind": "view", "layers": "radiance"}}"#,
        "/output/layers",
        "the string \"radiance\"",
        "an array",
    ),
    (
        r#"{"output": {"kind": "irradiance_map", "receiver": "floor", "include_sky": 1}}"#,
        "/output/include_sky",
        "the number 1",
        "true or false",
    ),
    // Lengths.
    (
        r#"{"floor": {"depth_m": 2, "size_m": [4]}}"#,
        "/floor/size_m",
        "it has 1 values",
        "length 2",
    ),
    (
        r#"{"floor": {"depth_m": 2, "size_m": [4, 4, 4]}}"#,
        "/floor/size_m",
        "it has 3 values",
        "length 2",
    ),
    (
        r#"{"floor": {"depth_m": 2, "size_m": [4, "4"]}}"#,
        "/floor/size_m/1",
        "the string \"4\"",
        "a number",
    ),
    // Integers.
    (
        r#"{"output": {"kind": "view", "width": 960.5}}"#,
        "/output/width",
        "the number 960.5",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "width": -1}}"#,
        "/output/width",
        "the number -1",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "width": -1.0}}"#,
        "/output/width",
        "the number -1",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "width": 1e10}}"#,
        "/output/width",
        "10000000000",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "width": 10000000000}}"#,
        "/output/width",
        "10000000000",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "width": "960"}}"#,
        "/output/width",
        "the string \"960\"",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "width": null}}"#,
        "/output/width",
        "null",
        "an integer, 1 … 16384",
    ),
    (
        r#"{"output": {"kind": "view", "png_bits": 8.5}}"#,
        "/output/png_bits",
        "8.5",
        "8 or 16",
    ),
    (
        r#"{"quality": {"water_cells": 2.5}}"#,
        "/quality/water_cells",
        "2.5",
        "an integer, 2 … 2048",
    ),
    (
        r#"{"output": {"kind": "irradiance_map", "receiver": "floor", "width": 0.5}}"#,
        "/output/width",
        "0.5",
        "an integer, 1 … 8192",
    ),
    (
        r#"{"output": {"kind": "irradiance_map", "receiver": "floor", "light": -1}}"#,
        "/output/light",
        "-1",
        "an index into `lights`",
    ),
    // Words or numbers.
    (
        r#"{"output": {"kind": "irradiance_map", "receiver": "wall"}}"#,
        "/output/receiver",
        "\"wall\"",
        "\"floor\" or an index",
    ),
    (
        r#"{"output": {"kind": "irradiance_map", "receiver": 0.5}}"#,
        "/output/receiver",
        "0.5",
        "\"floor\" or an index",
    ),
    (
        r#"{"output": {"kind": "irradiance_map", "receiver": [0]}}"#,
        "/output/receiver",
        "an array",
        "\"floor\" or an index",
    ),
    (
        r#"{"objects": [{"mesh": "m", "scale": "big"}]}"#,
        "/objects/0/scale",
        "\"big\"",
        "a number or an array of length 3",
    ),
    (
        r#"{"objects": [{"mesh": "m", "scale": [1, 2]}]}"#,
        "/objects/0/scale",
        "2 values",
        "length 3",
    ),
    (
        r#"{"objects": [{"mesh": "m", "scale": [1, 2, null]}]}"#,
        "/objects/0/scale/2",
        "null",
        "a number",
    ),
    (
        r#"{"objects": [{"mesh": "m", "rotation": [0, 0, 1]}]}"#,
        "/objects/0/rotation",
        "3 values",
        "length 4",
    ),
    (
        r#"{"objects": [{"mesh": 7}]}"#,
        "/objects/0/mesh",
        "the number 7",
        "a string",
    ),
];

#[test]
fn wrong_types_are_refused_with_place_and_accepted_values() {
    for (text, pointer, detail, accepted) in SHAPES {
        let issue = refusal(text);
        assert_eq!(issue.pointer, *pointer, "{text}: {issue}");
        assert!(issue.detail.contains(detail), "{text}: {issue}");
        assert!(issue.accepted.contains(accepted), "{text}: {issue}");
        assert_eq!(issue.kind, IssueKind::Invalid, "{text}");
    }
}
