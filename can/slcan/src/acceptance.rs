//! Which frames an adapter hands on: acceptance code and mask as the SJA1000 reads them with two filters, which is how
//! adapters start.
//!
//! Each half of the 32 bits is a filter of its own; a frame passes if it agrees with one of them wherever the mask has a
//! zero. A half holds the upper 16 bits of an extended identifier, or a standard identifier, its remote bit and four
//! bits of data; those four are not looked at.

use super::frame::SlcanFrame;

/// Code and mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Acceptance {
    /// What the bits have to be.
    pub code: u32,
    /// Ones do not count.
    pub mask: u32,
}

impl Acceptance {
    /// Everything passes.
    pub const ALL: Self = Self {
        code: 0,
        mask: u32::MAX,
    };

    /// The bits of a half that are looked at in a frame with a standard identifier.
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
