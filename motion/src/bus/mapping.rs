//! The PDO parameters of a node: communication (1400h, 1800h and behind them) and mapping (1600h, 1A00h and
//! behind them).
//!
//! The mapping is fixed, so 16xxh and 1Axxh are read-only. A client can change only two communication parameters:
//! whether a PDO is used, and the event time of a TPDO.

use super::frame::{CobId, NodeId, Service};
use super::object::{Abort, Object};

/// One entry of a PDO mapping: an object and its number of bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Mapped {
    /// The object.
    pub object: Object,
    /// Its length in bits.
    pub bits: u8,
}

impl Mapped {
    /// `bits` of sub-index `sub` of object `index`.
    #[must_use]
    pub const fn new(index: u16, sub: u8, bits: u8) -> Self {
        Self {
            object: Object::new(index, sub),
            bits,
        }
    }

    /// The value of the mapping object's sub-index.
    #[must_use]
    pub const fn raw(self) -> u32 {
        let [low, high] = self.object.index.to_le_bytes();
        u32::from_le_bytes([self.bits, self.object.sub, low, high])
    }

    /// Length in bytes of a PDO with this mapping.
    #[must_use]
    pub fn bytes(mapping: &[Self]) -> u16 {
        let bits = mapping.iter().fold(0_u16, |bits, mapped| {
            bits.saturating_add(mapped.bits.into())
        });
        bits >> 3
    }
}

/// The communication of one PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PdoCommunication {
    id: CobId,
    /// A TPDO.
    is_sent: bool,
    /// The PDO is used.
    valid: bool,
    /// Event time of a TPDO in milliseconds: it is sent again after this time; 0: never by time.
    event_ms: u16,
}

impl PdoCommunication {
    /// Transmission type for manufacturer-specific events, which include the event timer.
    pub const EVENT: u8 = 254;
    /// Sub-index of the COB-ID.
    pub const COB_ID: u8 = 1;
    /// Sub-index of the transmission type.
    pub const TRANSMISSION: u8 = 2;
    /// Sub-index of the event timer; TPDOs only.
    pub const EVENT_TIMER: u8 = 5;
    /// COB-ID bit 31: the PDO is not used.
    const INVALID: u32 = 1 << 31;
    /// COB-ID bit 30: no remote request for the PDO.
    const NO_RTR: u32 = 1 << 30;

    /// A PDO that `node` receives as `service` ([`Service::Rpdo1`] …); its content takes effect at once.
    #[must_use]
    pub const fn received(service: Service, node: NodeId) -> Self {
        Self {
            id: CobId::of(service, node),
            is_sent: false,
            valid: true,
            event_ms: 0,
        }
    }

    /// A PDO that `node` sends as `service` ([`Service::Tpdo1`] …), every `event_ms` milliseconds.
    #[must_use]
    pub const fn sent(service: Service, node: NodeId, event_ms: u16) -> Self {
        Self::sent_as(CobId::of(service, node), true, event_ms)
    }

    /// A PDO that is sent with this identifier, every `event_ms` milliseconds, if it is `valid`.
    #[must_use]
    pub const fn sent_as(id: CobId, valid: bool, event_ms: u16) -> Self {
        Self {
            id,
            is_sent: true,
            valid,
            event_ms,
        }
    }

    /// True where the PDO is used.
    #[must_use]
    pub const fn is_valid(&self) -> bool {
        self.valid
    }

    /// Event time of a TPDO in milliseconds; 0: never sent by time.
    #[must_use]
    pub const fn event_ms(&self) -> u16 {
        self.event_ms
    }

    const fn cob_id(&self) -> u32 {
        let id = self.id.get() as u32;
        let valid = if self.valid { 0 } else { Self::INVALID };
        let rtr = if self.is_sent { Self::NO_RTR } else { 0 };
        id | valid | rtr
    }

    /// Bytes of sub-index `sub`: 1, 2 or 4.
    pub const fn size(&self, sub: u8) -> Result<u8, Abort> {
        match sub {
            0 | Self::TRANSMISSION => Ok(1),
            Self::COB_ID => Ok(4),
            Self::EVENT_TIMER if self.is_sent => Ok(2),
            _ => Err(Abort::NoSubIndex),
        }
    }

    /// The value of sub-index `sub`.
    pub const fn read(&self, sub: u8) -> Result<u32, Abort> {
        match sub {
            0 if self.is_sent => Ok(Self::EVENT_TIMER as u32),
            0 => Ok(Self::TRANSMISSION as u32),
            Self::COB_ID => Ok(self.cob_id()),
            Self::TRANSMISSION => Ok(Self::EVENT as u32),
            Self::EVENT_TIMER if self.is_sent => Ok(self.event_ms as u32),
            _ => Err(Abort::NoSubIndex),
        }
    }

    /// Changes sub-index `sub`. In the COB-ID only bit 31 may change. A write of the transmission type must not change
    /// it.
    pub const fn write(&mut self, sub: u8, value: u32) -> Result<(), Abort> {
        match sub {
            0 => Err(Abort::ReadOnly),
            Self::COB_ID => {
                if value & !Self::INVALID != self.cob_id() & !Self::INVALID {
                    return Err(Abort::Value);
                }
                self.valid = value & Self::INVALID == 0;
                Ok(())
            }
            Self::TRANSMISSION if value == Self::EVENT as u32 => Ok(()),
            Self::TRANSMISSION => Err(Abort::Value),
            Self::EVENT_TIMER if self.is_sent => {
                if value > u16::MAX as u32 {
                    return Err(Abort::TooHigh);
                }
                self.event_ms = value as u16;
                Ok(())
            }
            _ => Err(Abort::NoSubIndex),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mapping_entry_has_index_sub_index_and_bits() {
        let control = Mapped::new(0x6040, 0, 16);
        assert_eq!(control.raw(), 0x6040_0010);
        assert_eq!(Mapped::new(0x5001, 0x0B, 32).raw(), 0x5001_0B20);
        assert_eq!(Mapped::bytes(&[control, Mapped::new(0x607A, 0, 32)]), 6);
    }

    #[test]
    fn a_tpdo_can_be_slowed_down_and_switched_off() {
        let mut pdo = PdoCommunication::sent(Service::Tpdo2, NodeId::BOARD, 10);
        let read = |pdo: &PdoCommunication| [0, 1, 2, 5].map(|sub| pdo.read(sub).unwrap());
        assert_eq!(read(&pdo), [5, 0x4000_0281, 254, 10]);
        assert_eq!([0, 1, 2, 5].map(|sub| pdo.size(sub).unwrap()), [1, 4, 1, 2]);
        assert_eq!(pdo.write(5, 100), Ok(()));
        assert_eq!(pdo.write(1, 0xC000_0281), Ok(()));
        assert_eq!(pdo.write(2, 254), Ok(()));
        assert_eq!(read(&pdo), [5, 0xC000_0281, 254, 100]);
        assert!(!pdo.is_valid());
        assert_eq!(pdo.event_ms(), 100);
        for (sub, value, abort) in [
            (0, 5, Abort::ReadOnly),
            (1, 0x4000_0282, Abort::Value),
            (1, 0x281, Abort::Value),
            (2, 1, Abort::Value),
            (3, 0, Abort::NoSubIndex),
            (5, 0x1_0000, Abort::TooHigh),
            (6, 0, Abort::NoSubIndex),
        ] {
            assert_eq!(pdo.write(sub, value), Err(abort), "{sub}");
        }
        assert_eq!(pdo.write(1, 0x4000_0281), Ok(()));
        assert!(pdo.is_valid());
    }

    #[test]
    fn an_rpdo_has_no_event_timer() {
        let mut pdo = PdoCommunication::received(Service::Rpdo1, NodeId::BOARD);
        assert_eq!([0, 1, 2].map(|sub| pdo.read(sub).unwrap()), [2, 0x201, 254]);
        for sub in [3, 5] {
            assert_eq!(pdo.read(sub), Err(Abort::NoSubIndex));
            assert_eq!(pdo.size(sub), Err(Abort::NoSubIndex));
            assert_eq!(pdo.write(sub, 0), Err(Abort::NoSubIndex));
        }
    }
}
