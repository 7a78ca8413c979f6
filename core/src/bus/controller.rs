//! How a CAN controller stands on its bus, as whoever owns one tells it.
//!
//! CAN counts errors. At 128 of either kind a controller is *error passive*: it may still speak, with less right to. At
//! 256 sending errors it is *bus-off*: it neither sends nor hears until it is started again. One that keeps its frames in
//! a memory and cannot read it in time is *restricted*: it hears and acknowledges, and sends nothing of its own.

/// The state of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BusState {
    /// Error active: all is well.
    #[default]
    Active,
    /// Error passive.
    Passive,
    /// Bus-off.
    Off,
    /// Restricted: it has failed to read its own memory, and sends nothing until it is started again.
    Restricted,
}

impl BusState {
    /// Nothing that is said reaches anybody: it has to be started again.
    #[must_use]
    pub const fn is_cut_off(self) -> bool {
        matches!(self, Self::Off | Self::Restricted)
    }
}

/// The errors a controller has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ErrorCounts {
    /// While sending (TEC).
    pub sending: u8,
    /// While receiving (REC).
    pub receiving: u8,
}

/// A controller at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Controller {
    /// Its state.
    pub state: BusState,
    /// Its counters; those of a controller that left the bus are the last ones before.
    pub errors: ErrorCounts,
}
