//! Any bytes as a file of numbers.

use caustica::fields::{self, MAX_SAMPLES};

/// Reads `bytes`. An accepted file must be valid; a refusal must state its reason.
pub(crate) fn check(bytes: &[u8]) {
    let field = match fields::read(bytes) {
        Ok(field) => field,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let [width, height] = field.size;
    let count = width * height * field.frames;
    assert!(count > 0 && !field.channels.is_empty());
    assert!((count * field.channels.len()) as u64 <= MAX_SAMPLES);
    for channel in &field.channels {
        assert_eq!(channel.samples.count(), count);
        let [low, high] = channel.range;
        assert!(
            low.is_finite() && high.is_finite() && low <= high,
            "{low} {high}"
        );
        assert!(channel.resolution >= 0.0);
        let mut not_finite = 0;
        for index in 0..count {
            let value = channel.samples.at(index);
            if value.is_finite() {
                assert!((low..=high).contains(&value));
            } else {
                not_finite += 1;
            }
        }
        assert_eq!(
            not_finite,
            channel.not_finite.map_or(0, |found| found.count)
        );
        if let Some(found) = channel.not_finite {
            let [frame, row, column] = found.first;
            let value = channel.samples.at((frame * height + row) * width + column);
            assert!(!value.is_finite());
        }
    }
}
