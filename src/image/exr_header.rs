//! The order of attributes in an EXR header.
//!
//! The library keeps custom attributes in a hash map, so their order changes from run to run. This module sorts them by name
//! after writing, as OpenEXR's own writer does. Only the attributes move: the header keeps its length, so the offset table after
//! it stays valid.

/// Length of magic number and version, which precede the first attribute.
const PREAMBLE_BYTES: usize = 8;

/// Sorts the attributes of a single-part file by name.
///
/// # Errors
/// What is wrong with the header.
pub(super) fn sort_attributes(file: &mut [u8]) -> Result<(), &'static str> {
    let mut attributes: Vec<(usize, &[u8])> = Vec::new();
    let mut at = PREAMBLE_BYTES;
    while *file.get(at).ok_or("the header has no end")? != 0 {
        let (name_bytes, attribute) = attribute_at(&file[at..])?;
        attributes.push((name_bytes, attribute));
        at += attribute.len();
    }
    attributes.sort_by(|a, b| a.1[..a.0].cmp(&b.1[..b.0]));
    let sorted = attributes
        .iter()
        .flat_map(|(_, attribute)| attribute.iter().copied())
        .collect::<Vec<u8>>();
    file[PREAMBLE_BYTES..at].copy_from_slice(&sorted);
    Ok(())
}

/// The attribute that `bytes` start with, and the length of its name: name, 0, type, 0, size (i32), value.
fn attribute_at(bytes: &[u8]) -> Result<(usize, &[u8]), &'static str> {
    const CUT: &str = "an attribute of the header is cut off";
    let zero_after = |from: usize| {
        bytes[from..]
            .iter()
            .position(|byte| *byte == 0)
            .map(|length| from + length)
            .ok_or(CUT)
    };
    let name_end = zero_after(0)?;
    let type_end = zero_after(name_end + 1)?;
    let size = bytes[type_end + 1..].first_chunk::<4>().ok_or(CUT)?;
    let size = usize::try_from(i32::from_le_bytes(*size)).map_err(|_| CUT)?;
    let attribute = bytes.get(..type_end + 1 + 4 + size).ok_or(CUT)?;
    Ok((name_end, attribute))
}
