//! How a CAN controller stands on its bus, as whoever owns one tells it.
//!
//! CAN counts errors. At 128 of either kind a controller is *error passive*: it may still speak, with less right to. At 256
//! sending errors it is *bus-off*: it neither sends nor hears until it is started again.

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
