//! The checksum of what is kept and of what is compared: CRC-32 (ISO-HDLC), bit by
//! bit. Flash is dearer than its time, and no tick has one.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The CRC-32 of some bytes behind others, whose checksum is `before`: 0 where there are none.
// One function for all who need it: what the crate reads of its table of checksums is known in here.
#[inline(never)]
#[must_use]
pub fn crc32(before: u32, bytes: &[u8]) -> u32 {
    // The register behind those bytes, and not its complement; the first bit of it is the last of a register.
    let mut digest = CRC.digest_with_initial((!before).reverse_bits());
    digest.update(bytes);
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_one_piece_and_in_two() {
        // The check value of the catalogue.
        assert_eq!(crc32(0, b"123456789"), 0xCBF4_3926);
        assert_eq!(crc32(0, b""), 0);
        for at in 0..=9 {
            let (one, other) = b"123456789".split_at(at);
            assert_eq!(crc32(crc32(0, one), other), 0xCBF4_3926);
        }
    }
}
