//! The packets of a bus, and filters for them.

use std::time::Duration;

use leadscrew_core::bus::{self, CobId, Frame, NodeId, Service};

use crate::ErrorFrame;

/// A point in time: nanoseconds since 1970 by this machine's clock, or since the start of a recording in virtual time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Stamp(u64);

impl Stamp {
    /// This many nanoseconds.
    #[must_use]
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// This many microseconds.
    #[must_use]
    pub const fn from_micros(micros: u64) -> Self {
        Self(micros.saturating_mul(1000))
    }

    /// Now.
    #[must_use]
    pub fn now() -> Self {
        let since = std::time::UNIX_EPOCH.elapsed().unwrap_or_default();
        Self(u64::try_from(since.as_nanos()).unwrap_or(u64::MAX))
    }

    /// Nanoseconds.
    #[must_use]
    pub const fn nanos(self) -> u64 {
        self.0
    }

    /// Time since an earlier stamp; zero where `earlier` is later.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }
}

/// An identifier of either length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Id {
    /// 11 bits.
    Standard(CobId),
    /// 29 bits.
    Extended(u32),
}

/// Up to `N` bytes. Unused bytes are zero, so that equal contents compare equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Data<const N: usize> {
    len: u8,
    bytes: [u8; N],
}

impl<const N: usize> Data<N> {
    /// These bytes; `None` for more than `N`.
    #[must_use]
    pub fn new(content: &[u8]) -> Option<Self> {
        let mut bytes = [0; N];
        bytes.get_mut(..content.len())?.copy_from_slice(content);
        Some(Self {
            len: u8::try_from(content.len()).ok()?,
            bytes,
        })
    }

    /// At most the first `N` of these bytes.
    pub(crate) fn truncated(content: &[u8]) -> Self {
        let mut bytes = [0; N];
        let mut len = 0;
        for (to, from) in bytes.iter_mut().zip(content) {
            *to = *from;
            len += 1;
        }
        Self { len, bytes }
    }

    /// The bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes
            .get(..usize::from(self.len))
            .unwrap_or(&self.bytes)
    }
}

/// A CAN FD frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FdFrame {
    /// Its identifier.
    pub id: Id,
    /// Up to 64 bytes.
    pub data: Data<64>,
    /// The data had the higher bit rate.
    pub rate_switched: bool,
    /// The sender was error passive.
    pub sender_passive: bool,
}

impl FdFrame {
    /// The frame as the core's type; `None` for an extended identifier or an impossible length.
    #[must_use]
    pub fn frame(&self) -> Option<bus::FdFrame> {
        match self.id {
            Id::Standard(id) => bus::FdFrame::new(id, self.data.bytes(), self.rate_switched)
                .filter(|frame| frame.payload().len() == self.data.bytes().len()),
            Id::Extended(_) => None,
        }
    }
}

impl From<&bus::FdFrame> for FdFrame {
    fn from(frame: &bus::FdFrame) -> Self {
        Self {
            id: Id::Standard(frame.id()),
            data: Data::truncated(frame.payload()),
            rate_switched: frame.is_rate_switched(),
            sender_passive: false,
        }
    }
}

/// Anything that a bus can deliver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Packet {
    /// A classical data frame with an 11-bit identifier: all of CANopen.
    Frame(Frame),
    /// A classical data frame with a 29-bit identifier.
    Extended(u32, Data<8>),
    /// A remote request for a frame, with the requested length.
    Remote(Id, u8),
    /// A CAN FD frame.
    Fd(FdFrame),
    /// A report of the controller or its driver.
    Error(ErrorFrame),
}

impl Packet {
    /// The classical data frame with an 11-bit identifier, if this packet is one.
    #[must_use]
    pub const fn frame(&self) -> Option<&Frame> {
        match self {
            Self::Frame(frame) => Some(frame),
            _ => None,
        }
    }

    /// The identifier; an error frame has none.
    #[must_use]
    pub const fn id(&self) -> Option<Id> {
        match self {
            Self::Frame(frame) => Some(Id::Standard(frame.id())),
            Self::Extended(id, _) => Some(Id::Extended(*id)),
            Self::Remote(id, _) => Some(*id),
            Self::Fd(frame) => Some(frame.id),
            Self::Error(_) => None,
        }
    }
}

/// A packet and its time of arrival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received {
    /// Time when the kernel got the packet; for an adapter on a line, when this program read it.
    pub time: Stamp,
    /// The packet.
    pub packet: Packet,
}

/// Passes frames whose 11-bit identifiers agree with `id` in the bits of `mask`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    id: u16,
    mask: u16,
}

impl Filter {
    /// Passes one identifier.
    #[must_use]
    pub const fn exactly(id: CobId) -> Self {
        Self {
            id: id.get(),
            mask: 0x7FF,
        }
    }

    /// Passes one service of every node.
    #[must_use]
    pub const fn service(service: Service) -> Self {
        Self {
            id: service as u16,
            mask: 0x780,
        }
    }

    /// Passes every service of one node.
    #[must_use]
    pub const fn node(node: NodeId) -> Self {
        Self {
            id: node.get() as u16,
            mask: 0x07F,
        }
    }

    /// Identifier and mask: the mask has the bits that count, the identifier their values.
    #[must_use]
    pub const fn bits(self) -> (u16, u16) {
        (self.id, self.mask)
    }

    /// True where the filter passes this packet.
    #[must_use]
    pub const fn passes(self, packet: &Packet) -> bool {
        match packet.id() {
            Some(Id::Standard(id)) => (id.get() ^ self.id) & self.mask == 0,
            Some(Id::Extended(_)) => false,
            None => true,
        }
    }

    /// True where one of the filters passes this packet, or `filters` is empty.
    #[must_use]
    pub fn any_passes(filters: &[Self], packet: &Packet) -> bool {
        filters.is_empty() || filters.iter().any(|filter| filter.passes(packet))
    }
}
