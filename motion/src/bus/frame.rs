//! A classical CAN frame with an 11-bit identifier, and the service and node in that identifier.
//!
//! Node numbers and COB-IDs are the defaults of CiA 301.

/// A CANopen node number, 1–127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(u8);

impl NodeId {
    /// The board, unless it has another number.
    pub const BOARD: Self = Self(1);
    /// The X drive of the built-in machine. For this node and the drives below, another machine's parameters give other
    /// numbers.
    pub const DRIVE_X: Self = Self(16);
    /// The Z drive.
    pub const DRIVE_Z: Self = Self(17);
    /// The C drive.
    pub const DRIVE_C: Self = Self(18);
    /// The drive of spindle 1.
    pub const SPINDLE_1: Self = Self(32);
    /// The drive of spindle 2.
    pub const SPINDLE_2: Self = Self(33);
    /// The drive of spindle 3.
    pub const SPINDLE_3: Self = Self(34);
    /// The drive of spindle 4.
    pub const SPINDLE_4: Self = Self(35);
    /// The gateway.
    pub const GATEWAY: Self = Self(127);

    /// Node `number`; `None` outside 1–127.
    #[must_use]
    pub const fn new(number: u8) -> Option<Self> {
        match number {
            1..=127 => Some(Self(number)),
            _ => None,
        }
    }

    /// The node whose number is nearest to this one.
    #[must_use]
    pub const fn nearest(number: u8) -> Self {
        match number {
            0 => Self(1),
            1..=127 => Self(number),
            _ => Self(127),
        }
    }

    /// The number, 1–127.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }
}

/// An 11-bit identifier; a smaller identifier has the higher priority.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CobId(u16);

impl CobId {
    /// Network management commands, for all nodes.
    pub const NMT: Self = Self(0x000);
    /// SYNC.
    pub const SYNC: Self = Self(0x080);

    /// The identifier `raw`; `None` above 7FFh.
    #[must_use]
    pub const fn new(raw: u16) -> Option<Self> {
        match raw {
            0..=0x7FF => Some(Self(raw)),
            _ => None,
        }
    }

    /// The identifier as a number, 0–7FFh.
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }

    /// A service of one node: the function code's base plus the node number.
    #[must_use]
    pub const fn of(service: Service, node: NodeId) -> Self {
        // At most 77Fh: the highest base is 700h and the highest node 7Fh.
        Self(service as u16 | node.0 as u16)
    }

    /// An identifier outside the default set: `base`, a multiple of 80h, and the node number.
    pub(crate) const fn free(base: u16, node: NodeId) -> Self {
        Self((base | node.0 as u16) & 0x7FF)
    }

    /// The service and the node of this identifier in the CiA 301 default set; `None` for NMT, SYNC, the time stamp and
    /// unused identifiers.
    #[must_use]
    pub const fn service(self) -> Option<(Service, NodeId)> {
        let service = match self.0 & 0x780 {
            0x080 => Service::Emcy,
            0x180 => Service::Tpdo1,
            0x200 => Service::Rpdo1,
            0x280 => Service::Tpdo2,
            0x300 => Service::Rpdo2,
            0x380 => Service::Tpdo3,
            0x400 => Service::Rpdo3,
            0x480 => Service::Tpdo4,
            0x500 => Service::Rpdo4,
            0x580 => Service::SdoReply,
            0x600 => Service::SdoRequest,
            0x700 => Service::Heartbeat,
            _ => return None,
        };
        match NodeId::new((self.0 & 0x7F) as u8) {
            Some(node) => Some((service, node)),
            None => None,
        }
    }
}

/// The services of a node in the CiA 301 default set, with their function codes. The names of the PDOs take the node's
/// view: the node sends a TPDO and receives an RPDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u16)]
pub enum Service {
    /// Emergency.
    Emcy = 0x080,
    /// First process data that the node sends.
    Tpdo1 = 0x180,
    /// First process data that the node receives.
    Rpdo1 = 0x200,
    /// Second process data that the node sends.
    Tpdo2 = 0x280,
    /// Second process data that the node receives.
    Rpdo2 = 0x300,
    /// Third process data that the node sends.
    Tpdo3 = 0x380,
    /// Third process data that the node receives.
    Rpdo3 = 0x400,
    /// Fourth process data that the node sends.
    Tpdo4 = 0x480,
    /// Fourth process data that the node receives.
    Rpdo4 = 0x500,
    /// Answers of the node's SDO server.
    SdoReply = 0x580,
    /// Requests to the node's SDO server.
    SdoRequest = 0x600,
    /// Heartbeat and boot-up.
    Heartbeat = 0x700,
}

/// A classical CAN data frame. Bytes from `len` on are zero, so that equal frames compare equal.
// Word alignment: the compiler then copies the frame by words, inline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(align(4))]
pub struct Frame {
    id: CobId,
    len: u8,
    data: [u8; 8],
}

impl Frame {
    /// A frame with the bytes of `payload`; `None` if there are more than eight.
    #[must_use]
    pub fn new(id: CobId, payload: &[u8]) -> Option<Self> {
        let mut data = [0; 8];
        for (place, byte) in data.get_mut(..payload.len())?.iter_mut().zip(payload) {
            *place = *byte;
        }
        Some(Self {
            id,
            len: payload.len() as u8,
            data,
        })
    }

    /// A frame with a payload of a fixed size. More than eight bytes fail at compile time.
    pub const fn of<const N: usize>(id: CobId, payload: [u8; N]) -> Self {
        const { assert!(N <= 8, "a classical CAN frame has at most eight bytes") };
        let mut data = [0; 8];
        if let Some((head, _)) = data.split_first_chunk_mut::<N>() {
            *head = payload;
        }
        Self {
            id,
            len: N as u8,
            data,
        }
    }

    /// The identifier.
    #[must_use]
    pub const fn id(&self) -> CobId {
        self.id
    }

    /// The payload, up to eight bytes.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        self.data.get(..usize::from(self.len)).unwrap_or(&self.data)
    }

    /// The payload if it has exactly `N` bytes.
    #[must_use]
    pub fn exactly<const N: usize>(&self) -> Option<[u8; N]> {
        // Reads the array without a slice, because a board reads every received frame this way.
        if usize::from(self.len) == N {
            self.data.first_chunk().copied()
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_the_defaults_of_cia_301() {
        let n = NodeId::new(0x10).unwrap();
        for (service, id) in [
            (Service::Emcy, 0x090),
            (Service::Tpdo1, 0x190),
            (Service::Rpdo1, 0x210),
            (Service::Tpdo2, 0x290),
            (Service::Rpdo2, 0x310),
            (Service::Tpdo3, 0x390),
            (Service::Rpdo3, 0x410),
            (Service::Tpdo4, 0x490),
            (Service::Rpdo4, 0x510),
            (Service::SdoReply, 0x590),
            (Service::SdoRequest, 0x610),
            (Service::Heartbeat, 0x710),
        ] {
            assert_eq!(CobId::of(service, n).get(), id);
            assert_eq!(CobId::of(service, n).service(), Some((service, n)));
        }
    }

    #[test]
    fn every_identifier_is_read_back_or_belongs_to_nobody() {
        let mut owned = 0;
        for raw in 0..=0x7FF {
            let id = CobId::new(raw).unwrap();
            if let Some((service, node)) = id.service() {
                assert_eq!(CobId::of(service, node), id);
                owned += 1;
            }
        }
        assert_eq!(owned, 12 * 127);
        assert_eq!(CobId::NMT.service(), None);
        assert_eq!(CobId::SYNC.service(), None);
        assert_eq!(CobId::new(0x800), None);
        assert_eq!(NodeId::new(0), None);
        assert_eq!(NodeId::new(128), None);
    }

    #[test]
    fn a_frame_keeps_its_bytes_and_refuses_a_ninth() {
        let id = CobId::new(0x123).unwrap();
        for len in 0..=8 {
            let bytes: [u8; 8] = [1, 2, 3, 4, 5, 6, 7, 8];
            let frame = Frame::new(id, &bytes[..len]).unwrap();
            assert_eq!(frame.payload(), &bytes[..len]);
        }
        assert_eq!(Frame::new(id, &[0; 9]), None);
        assert_eq!(Frame::of(id, [1, 2]), Frame::new(id, &[1, 2]).unwrap());
        assert_eq!(Frame::of(id, [1, 2]).exactly::<3>(), None);
    }
}
