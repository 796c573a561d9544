//! The numbers of a channel, in the smallest type that holds them exactly.

/// The numbers of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Unsigned integers of 16 bits.
    U16(Vec<u16>),
    /// Signed integers of 16 bits.
    I16(Vec<i16>),
    /// Floats of 16 bits, kept with 32.
    F16(Vec<f32>),
    /// Floats of 32 bits.
    F32(Vec<f32>),
    /// Integers of 32 bits, kept as floats.
    Integers(Vec<f64>),
    /// Floats of 64 bits.
    F64(Vec<f64>),
}

/// NaN and infinity in a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotFinite {
    /// How many.
    pub count: usize,
    /// Frame, row and column of the first.
    pub first: [usize; 3],
}

impl Samples {
    /// A number.
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::U16(values) => f64::from(values[index]),
            Self::I16(values) => f64::from(values[index]),
            Self::F16(values) | Self::F32(values) => f64::from(values[index]),
            Self::Integers(values) | Self::F64(values) => values[index],
        }
    }

    /// How many numbers.
    pub fn count(&self) -> usize {
        match self {
            Self::U16(values) => values.len(),
            Self::I16(values) => values.len(),
            Self::F16(values) | Self::F32(values) => values.len(),
            Self::Integers(values) | Self::F64(values) => values.len(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let each = match self {
            Self::U16(_) | Self::I16(_) => 2,
            Self::F16(_) | Self::F32(_) => 4,
            Self::Integers(_) | Self::F64(_) => 8,
        };
        each * self.count()
    }

    /// Range, sum, and what is not finite, of frames with rows of `width` and `area` samples each.
    pub(super) fn survey(&self, width: usize, area: usize) -> ([f64; 2], f64, Option<NotFinite>) {
        let (mut low, mut high, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        let mut not_finite: Option<NotFinite> = None;
        for index in 0..self.count() {
            let value = self.at(index);
            if value.is_finite() {
                (low, high, sum) = (low.min(value), high.max(value), sum + value);
            } else {
                let in_frame = index % area;
                let first = [index / area, in_frame / width, in_frame % width];
                not_finite
                    .get_or_insert(NotFinite { count: 0, first })
                    .count += 1;
            }
        }
        let range = if low <= high { [low, high] } else { [0.0; 2] };
        (range, sum, not_finite)
    }

    /// Distance of neighbouring numbers of this type at `largest`, without that of f64.
    pub(super) fn resolution(&self, largest: f64) -> f64 {
        let of_float = |bits: i32| {
            if largest > 0.0 {
                2.0_f64.powf(largest.log2().floor()) * 2.0_f64.powi(-bits)
            } else {
                0.0
            }
        };
        match self {
            Self::U16(_) | Self::I16(_) | Self::Integers(_) => 1.0,
            Self::F16(_) => of_float(10),
            Self::F32(_) => of_float(23),
            Self::F64(_) => of_float(52),
        }
    }
}
