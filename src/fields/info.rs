//! The description of a file, for lists and answers.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Channel, Field, FieldFormat};

/// A stored file of numbers, without them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FieldInfo {
    /// `blake3:<hex>` of the uploaded bytes.
    pub id: String,
    /// The format, found from the first bytes.
    pub format: FieldFormat,
    /// Samples of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Frames.
    pub frames: usize,
    /// The channels.
    pub channels: Vec<ChannelInfo>,
    /// Host memory, bytes.
    pub bytes: u64,
}

/// A channel of a stored file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChannelInfo {
    /// Its name: in EXR that of the file, in PNG `Y`, `A`, `R`, `G`, `B`, in NPY `value`, or `x` and `z` where the last axis has two.
    pub name: String,
    /// Smallest number in the file, NaN and infinity left out.
    pub min: f64,
    /// Largest number in the file, NaN and infinity left out.
    pub max: f64,
    /// How many numbers are NaN or infinite. A scene that uses such a channel is refused.
    pub not_finite: usize,
}

impl Field {
    /// The description of the file.
    pub fn info(&self) -> FieldInfo {
        let of_channel = |channel: &Channel| ChannelInfo {
            name: channel.name.clone(),
            min: channel.range[0],
            max: channel.range[1],
            not_finite: channel.not_finite.map_or(0, |found| found.count),
        };
        FieldInfo {
            id: self.id.clone(),
            format: self.format,
            width: self.size[0],
            height: self.size[1],
            frames: self.frames,
            channels: self.channels.iter().map(of_channel).collect(),
            bytes: self.bytes(),
        }
    }
}
