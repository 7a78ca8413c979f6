//! The setpoints of all drives of a board in one CAN FD frame: controlword and target of each drive, six bytes a drive,
//! in the order X, Z, C and the existing spindles.
//!
//! ```text
//! 480h + board   X: 6040h/16 607Ah/32   Z: 6040h/16 607Ah/32   C …   spindle 1 …
//! ```
//!
//! The frame is a TPDO of the board and the RPDO1 of every drive. A drive maps dummy entries (CiA 301) for all bytes
//! before its own six bytes, and ignores the bytes after them.

use super::fd::FdFrame;
use super::frame::{CobId, NodeId, Service};
use super::increments::Increments;
use super::mapping::Mapped;
use super::pdo::DriveCommand;
use super::{Controlword, Frame};

/// Bytes of a drive.
const BYTES: usize = 6;

/// Controlwords and targets of all drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoints {
    told: [[u8; BYTES]; Self::MOST],
    drives: u8,
}

impl Setpoints {
    /// The largest number of drives: three axes and four spindles.
    pub const MOST: usize = 7;

    /// The dummy entries of CiA 301 for 16 and 32 bits: UNSIGNED16 and UNSIGNED32.
    const DUMMY_16: Mapped = Mapped::new(0x0006, 0, 16);
    const DUMMY_32: Mapped = Mapped::new(0x0007, 0, 32);

    /// Setpoints for `drives` drives without a command: controlword 0000h, no voltage.
    #[must_use]
    pub const fn of(drives: u8) -> Self {
        Self {
            told: [[0; BYTES]; Self::MOST],
            drives,
        }
    }

    /// The identifier of the frame: the board's TPDO4.
    #[must_use]
    pub const fn cob_id(board: NodeId) -> CobId {
        CobId::of(Service::Tpdo4, board)
    }

    /// Takes the content of the RPDO1 for the drive at this place.
    pub fn tell(&mut self, place: usize, command: &Frame) {
        if let (Some(told), Some(content)) = (self.told.get_mut(place), command.exactly()) {
            *told = content;
        }
    }

    /// Sets the drive at this place to controlword 0000h, no voltage, so that no earlier command can enable it.
    pub fn withdraw(&mut self, place: usize) {
        if let Some(told) = self.told.get_mut(place) {
            *told = [0; BYTES];
        }
    }

    /// The frame of `board`; its data have the higher bit rate.
    #[must_use]
    pub fn frame(&self, board: NodeId) -> Option<FdFrame> {
        let bytes = usize::from(self.drives).saturating_mul(BYTES);
        let payload = self.told.as_flattened().get(..bytes)?;
        FdFrame::new(Self::cob_id(board), payload, true)
    }

    /// The command for the drive at this place in the payload of such a frame; `None` where the payload is too short.
    #[must_use]
    pub fn command(payload: &[u8], place: usize) -> Option<DriveCommand> {
        let (drives, _) = payload.as_chunks::<BYTES>();
        let [a, b, c, d, e, f] = *drives.get(place)?;
        Some(DriveCommand {
            control: Controlword::from_raw(u16::from_le_bytes([a, b])),
            target: Increments::new(i32::from_le_bytes([c, d, e, f])),
        })
    }

    /// The RPDO1 mapping of the drive at this place: as few dummy entries as possible, then its own objects.
    pub fn mapping(place: usize) -> impl Iterator<Item = Mapped> {
        let before = place.saturating_mul(BYTES);
        let long = core::iter::repeat_n(Self::DUMMY_32, before / 4);
        let short = (!before.is_multiple_of(4)).then_some(Self::DUMMY_16);
        long.chain(short).chain(DriveCommand::MAPPING)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    fn command(target: i32) -> DriveCommand {
        DriveCommand {
            control: Controlword::ENABLE_OPERATION,
            target: Increments::new(target),
        }
    }

    #[test]
    fn each_drive_finds_its_own_behind_the_dummies_it_maps() {
        for drives in 4..=7 {
            let mut setpoints = Setpoints::of(drives);
            let count = usize::from(drives);
            for place in 0..count {
                let told = command(1000 + place as i32).frame(NodeId::DRIVE_X);
                setpoints.tell(place, &told);
            }
            let frame = setpoints.frame(NodeId::BOARD).unwrap();
            assert_eq!(frame.id().get(), 0x481);
            assert!(frame.is_rate_switched());
            let length = [24, 32, 48, 48][count - 4];
            assert_eq!(frame.payload().len(), length);
            for place in 0..count {
                let mapping: Vec<Mapped> = Setpoints::mapping(place).collect();
                assert_eq!(usize::from(Mapped::bytes(&mapping)), 6 * place + 6);
                let told = Setpoints::command(frame.payload(), place);
                assert_eq!(told, Some(command(1000 + place as i32)));
            }
        }
    }

    #[test]
    fn dummies_are_as_few_as_can_be() {
        let entries = [0, 1, 2, 3, 4, 5, 6].map(|place| Setpoints::mapping(place).count());
        assert_eq!(entries, [2, 4, 5, 7, 8, 10, 11]);
        let raw: Vec<u32> = Setpoints::mapping(3).map(Mapped::raw).collect();
        let dummy = 0x0007_0020;
        let expected = [
            dummy,
            dummy,
            dummy,
            dummy,
            0x0006_0010,
            0x6040_0010,
            0x607A_0020,
        ];
        assert_eq!(raw, expected);
    }

    #[test]
    fn who_is_told_nothing_is_without_voltage() {
        let mut setpoints = Setpoints::of(4);
        setpoints.tell(2, &command(7).frame(NodeId::DRIVE_C));
        setpoints.withdraw(2);
        let frame = setpoints.frame(NodeId::BOARD).unwrap();
        assert_eq!(frame.payload(), [0; 24]);
        let told = Setpoints::command(frame.payload(), 2).unwrap();
        assert_eq!(told.control, Controlword::DISABLE_VOLTAGE);
        assert_eq!(Setpoints::command(frame.payload(), 4), None);
        // A frame that is no RPDO1 changes nothing.
        setpoints.tell(2, &Frame::of(CobId::SYNC, [1]));
        assert_eq!(setpoints, Setpoints::of(4));
    }
}
