//! Error frames: reports of the kernel's drivers about controller and bus, as data.
//!
//! The bits are those of the kernel's `linux/can/error.h`.

use std::fmt;

/// An error frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ErrorFrame {
    /// Classes of error, one bit each.
    pub class: u32,
    /// Details by class.
    pub data: [u8; 8],
}

/// One fault in an error frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// A frame was not sent in time.
    TransmitTimeout,
    /// A frame lost arbitration, and the controller does not send it again.
    LostArbitration,
    /// The controller's receive buffer overflowed: a frame was lost before the kernel could read it.
    ControllerOverflow,
    /// Nearly error passive: 96 errors counted.
    Warning,
    /// Error passive: 128 errors counted. The controller still sends, with restrictions.
    Passive,
    /// Error active again.
    Active,
    /// A frame on the bus violated the protocol: a bit, its stuffing, its form or its checksum.
    Protocol,
    /// The transceiver reports a fault of the wires.
    Transceiver,
    /// No node acknowledged a frame.
    NoAcknowledge,
    /// Bus-off: 256 errors counted. The controller neither sends nor receives until it is started again.
    BusOff,
    /// An error on the bus.
    BusError,
    /// Started again after bus-off.
    Restarted,
}

impl ErrorFrame {
    const TX_TIMEOUT: u32 = 0x001;
    const LOST_ARBITRATION: u32 = 0x002;
    const CONTROLLER: u32 = 0x004;
    const PROTOCOL: u32 = 0x008;
    const TRANSCEIVER: u32 = 0x010;
    const NO_ACK: u32 = 0x020;
    const BUS_OFF: u32 = 0x040;
    const BUS_ERROR: u32 = 0x080;
    const RESTARTED: u32 = 0x100;
    const COUNTERS: u32 = 0x200;

    /// The faults in the error frame, the worst first.
    pub fn faults(&self) -> impl Iterator<Item = Fault> {
        let controller = if self.class & Self::CONTROLLER == 0 {
            0
        } else {
            self.data[1]
        };
        [
            (self.class & Self::BUS_OFF != 0, Fault::BusOff),
            (controller & 0x30 != 0, Fault::Passive),
            (controller & 0x0C != 0, Fault::Warning),
            (controller & 0x03 != 0, Fault::ControllerOverflow),
            (self.class & Self::NO_ACK != 0, Fault::NoAcknowledge),
            (self.class & Self::PROTOCOL != 0, Fault::Protocol),
            (self.class & Self::TRANSCEIVER != 0, Fault::Transceiver),
            (self.class & Self::BUS_ERROR != 0, Fault::BusError),
            (self.class & Self::TX_TIMEOUT != 0, Fault::TransmitTimeout),
            (
                self.class & Self::LOST_ARBITRATION != 0,
                Fault::LostArbitration,
            ),
            (self.class & Self::RESTARTED != 0, Fault::Restarted),
            (controller & 0x40 != 0, Fault::Active),
        ]
        .into_iter()
        .filter_map(|(said, fault)| said.then_some(fault))
    }

    /// The controller's error counters (sending, receiving), where the driver reports them.
    #[must_use]
    pub const fn counters(&self) -> Option<(u8, u8)> {
        // Old drivers report the counters without this bit, but never two zeros.
        let [.., sending, receiving] = self.data;
        if self.class & Self::COUNTERS != 0 || sending != 0 || receiving != 0 {
            Some((sending, receiving))
        } else {
            None
        }
    }
}

impl Fault {
    /// The fault in English words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TransmitTimeout => "a frame was not sent in time",
            Self::LostArbitration => "lost against a frame of higher priority",
            Self::ControllerOverflow => "the controller's receive buffer ran over",
            Self::Warning => "near to error passive",
            Self::Passive => "error passive",
            Self::Active => "error active again",
            Self::Protocol => "a frame broke the rules of the line",
            Self::Transceiver => "the transceiver reports a fault of the wires",
            Self::NoAcknowledge => "nobody acknowledged a frame",
            Self::BusOff => "bus-off",
            Self::BusError => "an error on the line",
            Self::Restarted => "started again after bus-off",
        }
    }
}

impl fmt::Display for ErrorFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for fault in self.faults() {
            write!(f, "{between}{}", fault.name())?;
            between = ", ";
        }
        if between.is_empty() {
            write!(f, "error class {:X}h", self.class)?;
        }
        if let Some((sending, receiving)) = self.counters() {
            write!(
                f,
                " (error counters: {sending} sending, {receiving} receiving)"
            )?;
        }
        Ok(())
    }
}
