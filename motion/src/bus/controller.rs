//! The state of a CAN controller on its bus, as the controller's owner reports it.
//!
//! A CAN controller counts errors. At 128 of either kind the controller is *error passive*: it may still send, with
//! restrictions. At 256 sending errors the controller is *bus-off*: it neither sends nor receives until it is started
//! again. A controller that keeps its frames in a memory and cannot read that memory in time is *restricted*: it
//! receives and acknowledges, and sends no frame of its own.

/// The state of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BusState {
    /// Error active: the normal state.
    #[default]
    Active,
    /// Error passive.
    Passive,
    /// Bus-off.
    Off,
    /// Restricted: the controller has failed to read its own memory, and sends no frame until it is started again.
    Restricted,
}

impl BusState {
    /// True where no frame of the controller reaches the bus: the controller must be started again.
    #[must_use]
    pub const fn is_cut_off(self) -> bool {
        matches!(self, Self::Off | Self::Restricted)
    }
}

/// The errors a controller has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ErrorCounts {
    /// Errors while sending (TEC).
    pub sending: u8,
    /// Errors while receiving (REC).
    pub receiving: u8,
}

/// The state of a controller and its counters, read at the same time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Controller {
    /// Its state.
    pub state: BusState,
    /// Its counters; for a controller that left the bus, the last values before that.
    pub errors: ErrorCounts,
}
