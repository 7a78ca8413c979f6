//! The acceptance filter of an adapter: code and mask of the SJA1000 in its mode with two filters, which adapters have
//! at the start.
//!
//! Each half of the 32 bits is a separate filter. A frame passes if it agrees with one filter in all bits where the
//! mask has a zero. A half holds the upper 16 bits of an extended identifier, or a standard identifier, its remote bit
//! and four bits of data. The filter ignores these four bits.

use super::frame::SlcanFrame;

/// Acceptance code and mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Acceptance {
    /// The required bits.
    pub code: u32,
    /// Bits that are one do not count.
    pub mask: u32,
}

impl Acceptance {
    /// Everything passes.
    pub const ALL: Self = Self {
        code: 0,
        mask: u32::MAX,
    };

    /// The bits of a half that count for a frame with a standard identifier.
    const STANDARD: u16 = 0xFFF0;

    /// True where the frame passes.
    pub fn passes(self, frame: &SlcanFrame) -> bool {
        let standard = |id: u16, remote: bool| {
            (
                id.wrapping_shl(5) | u16::from(remote).wrapping_shl(4),
                Self::STANDARD,
            )
        };
        let extended = |id: u32| (id.wrapping_shr(13) as u16, u16::MAX);
        let (bits, counting) = match frame {
            SlcanFrame::Data(frame) => standard(frame.id().get(), false),
            SlcanFrame::Remote(id, _) => standard(id.get(), true),
            SlcanFrame::Extended(frame) => extended(frame.id().get()),
            SlcanFrame::RemoteExtended(id, _) => extended(id.get()),
        };
        let agrees = |code: u16, mask: u16| (bits ^ code) & !mask & counting == 0;
        agrees(
            self.code.wrapping_shr(16) as u16,
            self.mask.wrapping_shr(16) as u16,
        ) || agrees(self.code as u16, self.mask as u16)
    }
}
