//! Finds probable faults of a bus from its error frames.

use std::fmt;

use crate::{Fault, Packet};

/// This many errors in a row, without a good frame between them, raise a suspicion.
const ERRORS_WITHOUT_A_FRAME: u32 = 16;

/// The health of a bus, judged by its received packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Packets other than error frames.
    pub frames: u64,
    /// FD frames among them.
    pub fd_frames: u64,
    /// Error frames.
    pub errors: u64,
    /// Bus-off, until the controller is started again.
    bus_off: bool,
    /// Error passive, until it is active again.
    passive: bool,
    /// Last reported error counters of the controller.
    counters: Option<(u8, u8)>,
    /// Errors on the line since the last frame.
    line_errors: u32,
    /// Error frames about a missing acknowledgement since the last frame.
    unacknowledged: u32,
}

/// A probable fault; the worst comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suspicion {
    /// The controller has left the bus.
    BusOff,
    /// Errors and not one frame: the other nodes probably have another bit rate.
    BitRate,
    /// No node acknowledges: this node is probably alone on the bus.
    Alone,
    /// Error passive, with error counters.
    Passive(Option<(u8, u8)>),
}

impl Health {
    /// Takes a received packet into account.
    pub fn note(&mut self, packet: &Packet) {
        let Packet::Error(error) = packet else {
            self.frames += 1;
            self.fd_frames += u64::from(matches!(packet, Packet::Fd(_)));
            self.line_errors = 0;
            self.unacknowledged = 0;
            return;
        };
        self.errors += 1;
        self.counters = error.counters().or(self.counters);
        let mut on_the_line = false;
        for fault in error.faults() {
            match fault {
                Fault::BusOff => self.bus_off = true,
                Fault::Restarted => (self.bus_off, self.passive) = (false, false),
                Fault::Passive => self.passive = true,
                Fault::Active => self.passive = false,
                Fault::Protocol | Fault::BusError => on_the_line = true,
                Fault::NoAcknowledge => {
                    self.unacknowledged = self.unacknowledged.saturating_add(1);
                }
                _ => {}
            }
        }
        self.line_errors = self.line_errors.saturating_add(u32::from(on_the_line));
    }

    /// The present probable fault of the bus.
    #[must_use]
    pub const fn suspicion(&self) -> Option<Suspicion> {
        if self.bus_off {
            Some(Suspicion::BusOff)
        } else if self.unacknowledged >= ERRORS_WITHOUT_A_FRAME {
            Some(Suspicion::Alone)
        } else if self.line_errors >= ERRORS_WITHOUT_A_FRAME {
            Some(Suspicion::BitRate)
        } else if self.passive {
            Some(Suspicion::Passive(self.counters))
        } else {
            None
        }
    }
}

impl fmt::Display for Suspicion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BusOff => f.write_str(
                "bus-off: the controller counted 256 errors and has left the bus; check wiring, termination (120 Ω at both \
                 ends) and bit rate, then start it again: `ip link set IFACE down`, `ip link set IFACE up`",
            ),
            Self::BitRate => f.write_str(
                "errors on the line and not one good frame: the bit rate is probably not that of the other nodes; set it \
                 with `ip link set IFACE down`, `ip link set IFACE type can bitrate 1000000`, `ip link set IFACE up`",
            ),
            Self::Alone => f.write_str(
                "nobody acknowledges what is sent: no other node is switched on, the wires are open, or all others run at \
                 another bit rate",
            ),
            Self::Passive(counters) => {
                f.write_str("error passive: the controller counted 128 errors")?;
                if let Some((sending, receiving)) = counters {
                    write!(f, " (now {sending} sending, {receiving} receiving)")?;
                }
                f.write_str("; check wiring, termination and bit rate")
            }
        }
    }
}
