//! A serial number of 32 bits for a chip that has a longer unique number.

use crate::failure::checksum;

/// The serial number of a chip with this unique number. A CRC-32 tells any two numbers apart that differ within 32 bits
/// in a row; those of chips of one lot do. The result is never 0, because 0 means no serial number.
#[must_use]
pub fn serial_of(unique: [u32; 3]) -> u32 {
    checksum(&unique).max(1)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    #[test]
    fn chips_of_one_lot_have_numbers_of_their_own() {
        let lot = [0x0032_0028, 0x3134_5117, 0x2037_3353];
        // The CRC-32 of the lot's bytes, least significant first, computed by another implementation.
        assert_eq!(serial_of(lot), 0xAD64_4CA9);
        let mut seen = std::collections::BTreeSet::new();
        for x in 0..128 {
            for y in 0..128 {
                let [_, wafer, name] = lot;
                assert!(seen.insert(serial_of([x << 16 | y, wafer, name])));
            }
        }
        for wafer in 0..25 {
            let [at, _, name] = lot;
            seen.insert(serial_of([at, 0x3134_5100 | wafer, name]));
        }
        assert_eq!(seen.len(), 128 * 128 + 24, "one of them is in both");
    }
}
