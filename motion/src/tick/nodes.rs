//! Node numbers of the drives in a parameter set.

use crate::alarm::{Alarm, Arg, Code};
use crate::bus::NodeId;
use crate::call::TapSpindle;
use crate::params::Params;
use crate::units::Axis;

/// The node numbers of a machine's drives: one for each axis, and consecutive numbers for its spindles.
// Copied word by word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(4))]
pub struct DriveNodes {
    x: u8,
    z: u8,
    c: u8,
    /// Node of spindle 1.
    first: u8,
    /// Number of spindles, 1–4.
    spindles: u8,
    /// Node of the input and output block, which is no drive; 0: none.
    block: u8,
}

impl DriveNodes {
    /// The node numbers in a parameter set (9014–9016).
    #[must_use]
    #[inline(never)]
    pub const fn of(params: &Params) -> Self {
        Self {
            x: params.drive_node(Axis::X),
            z: params.drive_node(Axis::Z),
            c: params.drive_node(Axis::C),
            first: params.spindle_node(),
            spindles: params.tap_spindles(),
            block: params.block_node(),
        }
    }

    /// The node of an axis.
    // The parameters' ranges lie within the range of node numbers.
    #[must_use]
    pub const fn axis(&self, axis: Axis) -> NodeId {
        NodeId::nearest(match axis {
            Axis::X => self.x,
            Axis::Z => self.z,
            Axis::C => self.c,
        })
    }

    /// The node of a spindle, also where the machine does not have it.
    #[must_use]
    pub const fn spindle(&self, spindle: TapSpindle) -> NodeId {
        NodeId::nearest(self.first.wrapping_add(spindle.number()).wrapping_sub(1))
    }

    /// The letter that messages use for the drive with this node; all spindles are S. `None` where no drive has it.
    #[must_use]
    pub const fn letter(&self, node: NodeId) -> Option<u8> {
        let node = node.get();
        if node == self.x {
            Some(b'X')
        } else if node == self.z {
            Some(b'Z')
        } else if node == self.c {
            Some(b'C')
        } else if node.wrapping_sub(self.first) < self.spindles {
            Some(b'S')
        } else {
            None
        }
    }

    /// The place of the drive with this node in the order X, Z, C, spindles; `None` where no drive has it.
    pub(super) fn place(&self, node: NodeId) -> Option<usize> {
        let node = node.get();
        let spindle = node.wrapping_sub(self.first);
        if let Some(axis) = [self.x, self.z, self.c].iter().position(|at| *at == node) {
            Some(axis)
        } else if spindle < self.spindles {
            Some(usize::from(spindle).saturating_add(3))
        } else {
            None
        }
    }

    /// The node of the input and output block (9461).
    #[must_use]
    pub const fn block(&self) -> Option<NodeId> {
        NodeId::new(self.block)
    }

    /// Checks that a board with this number can be the master of the drives.
    ///
    /// # Errors
    /// [`Code::DriveNodeOfBoard`] where a drive has this number, [`Code::BlockNodeTaken`] where the block has.
    pub fn spare(&self, board: NodeId) -> Result<(), Alarm> {
        if self.block() == Some(board) {
            return Err(Alarm::of(
                Code::BlockNodeTaken,
                &[Arg::Int(board.get().into())],
            ));
        }
        let Some(letter) = self.letter(board) else {
            return Ok(());
        };
        let figures = [Arg::Letter(letter), Arg::Int(board.get().into())];
        Err(Alarm::of(Code::DriveNodeOfBoard, &figures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Entry;

    #[test]
    fn the_built_in_machine_has_them_where_they_are_known_to_be() {
        let nodes = DriveNodes::of(&Params::sheets());
        let axes = [NodeId::DRIVE_X, NodeId::DRIVE_Z, NodeId::DRIVE_C];
        assert_eq!(Axis::ALL.map(|axis| nodes.axis(axis)), axes);
        let spindles = [
            NodeId::SPINDLE_1,
            NodeId::SPINDLE_2,
            NodeId::SPINDLE_3,
            NodeId::SPINDLE_4,
        ];
        assert_eq!(TapSpindle::ALL.map(|s| nodes.spindle(s)), spindles);
    }

    #[test]
    fn what_is_no_drive_of_the_machine_has_no_letter() {
        let mut params = Params::sheets();
        for (key, value) in [("9014", 2), ("9015.Z", 126), ("9016", 5)] {
            params.set(Entry::find_text(key).unwrap(), value).unwrap();
        }
        let nodes = DriveNodes::of(&params);
        for node in (1..=127).filter_map(NodeId::new) {
            let letter = match node.get() {
                16 => Some(b'X'),
                126 => Some(b'Z'),
                18 => Some(b'C'),
                5 | 6 => Some(b'S'),
                _ => None,
            };
            assert_eq!(nodes.letter(node), letter, "{node:?}");
            let refused = nodes.spare(node).map_err(|alarm| {
                assert_eq!(alarm.args[1], Arg::Int(node.get().into()));
                (alarm.number(), alarm.args[0])
            });
            let expected = letter.map_or(Ok(()), |of| Err((4378, Arg::Letter(of))));
            assert_eq!(refused, expected);
        }
    }
}
