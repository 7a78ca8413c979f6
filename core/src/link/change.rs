//! The changes in a staged parameter set: the old values of all parameters that it changes (object 5010h:0Ah of the
//! board).
//!
//! ```text
//! identity of the set before (u32, little-endian) · for each value that changes: its place (u16), what it was (i64)
//! ```
//!
//! Places and values are encoded with `postcard`. A reader that knows the new set can restore the old set from these
//! bytes, and need not read the whole old set. For a password they show only whether it exists, as in every image.

use super::writer::{Put, Writer};
use super::{LinkError, identity};
use crate::params::{Params, SLOTS};

/// Bytes of the identity.
const HEAD: usize = 4;

/// Writes the values of `before` in the places where `after` differs. Gives the number of bytes.
///
/// # Errors
/// [`LinkError::TooLong`]: too many values change for these bytes.
pub fn encode_changes(
    before: &Params,
    after: &Params,
    into: &mut [u8],
) -> Result<usize, LinkError> {
    let mut writer = Writer::new(into);
    writer.bytes(&identity(before).to_le_bytes());
    for place in 0..SLOTS {
        let was = before.told_slot(place).unwrap_or(0);
        if after.told_slot(place) == Some(was) {
            continue;
        }
        (place as u16).put(&mut writer);
        was.put(&mut writer);
    }
    writer.finish()
}

/// The old set: `bytes` hold its differences from `after`.
///
/// # Errors
/// [`LinkError::Malformed`]: the bytes belong to another set than `after`, or are damaged; the identity shows this.
pub fn decode_changes(bytes: &[u8], after: &Params) -> Result<Params, LinkError> {
    let (head, mut rest) = bytes
        .split_first_chunk::<HEAD>()
        .ok_or(LinkError::Malformed)?;
    let mut before = after.clone();
    while !rest.is_empty() {
        let ((place, was), behind) =
            postcard::take_from_bytes::<(u16, i64)>(rest).map_err(|_| LinkError::Malformed)?;
        before.put_slot(place.into(), was);
        rest = behind;
    }
    let whole = before.first_out_of_range().is_none();
    if whole && identity(&before) == u32::from_le_bytes(*head) {
        Ok(before)
    } else {
        Err(LinkError::Malformed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Entry;

    fn set(values: &[(&str, i64)]) -> Params {
        let mut params = Params::sheets();
        for (key, raw) in values {
            params.set(Entry::find_text(key).unwrap(), *raw).unwrap();
        }
        params
    }

    #[test]
    fn the_set_before_comes_back_from_what_changes() {
        let before = set(&[("1420.X", 11_000_000_000), ("182.7", 1), ("9028", 1)]);
        let after = set(&[("9007", 20), ("1320.X", 123_456_789), ("9028", 1)]);
        let mut bytes = [0; 64];
        let length = encode_changes(&before, &after, &mut bytes).unwrap();
        // The identity, and four places with their old values.
        assert_eq!(length, 4 + (1 + 1) + (1 + 5) + (1 + 6) + (1 + 1));
        let bytes = &bytes[..length];
        assert_eq!(decode_changes(bytes, &after), Ok(before.clone()));
        // The bytes do not fit another set, and a part of them is not enough.
        let other = set(&[("9007", 21)]);
        assert_eq!(decode_changes(bytes, &other), Err(LinkError::Malformed));
        for part in 0..length {
            let part = bytes.get(..part).unwrap();
            assert_eq!(decode_changes(part, &after), Err(LinkError::Malformed));
        }
        for room in 0..length {
            let mut small = [0; 64];
            let small = small.get_mut(..room).unwrap();
            let encoded = encode_changes(&before, &after, small);
            assert_eq!(encoded, Err(LinkError::TooLong), "{room} bytes");
        }
        let mut none = [0; 4];
        assert_eq!(encode_changes(&before, &before, &mut none), Ok(4));
    }

    #[test]
    fn a_password_is_not_told() {
        let before = set(&[("9028", 4711)]);
        let after = set(&[]);
        let mut bytes = [0; 16];
        let length = encode_changes(&before, &after, &mut bytes).unwrap();
        let told = decode_changes(&bytes[..length], &after);
        assert_eq!(told, Ok(set(&[("9028", 1)])));
    }
}
