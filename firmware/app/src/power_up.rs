//! The memory of a board, and how the board comes up.

use core::mem::MaybeUninit;

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::{
    self, Background, BackgroundSide, Contacts, Event, Output, Queues, Setup, Snapshot, Tick,
    TickSide,
};
use leadscrew_core::bus::{DataRates, NodeId};
use leadscrew_core::call::Position;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::motion::Setpoint;

use crate::failure::Failure;
use crate::reset::ResetCause;

/// The memory of a board, for good: it belongs in a `static`.
pub struct Memory {
    queues: Queues,
    tick: MaybeUninit<Tick>,
    background: MaybeUninit<Background>,
    output: MaybeUninit<Output>,
}

/// The two sides of a board that is up, and the output of its tick.
pub struct Sides {
    /// Belongs to the tick's interrupt.
    pub tick: TickSide<'static>,
    /// Belongs to the tick's interrupt too.
    pub output: &'static mut Output,
    /// Belongs to the thread.
    pub background: BackgroundSide<'static>,
}

/// What a board has to know at power-up.
#[derive(Clone, Copy, Debug)]
pub struct PowerUp<'a> {
    /// The parameter set, and what is to be reported about it.
    pub set: &'a board::PowerUp,
    /// Where the machine stood, if known; see [`Tick::new`].
    pub remembered: Option<Position>,
    /// The stored entry of the tap journal.
    pub tap: Option<TapRecord>,
    /// The board's node number on the bus.
    pub node: NodeId,
    /// The board's serial number (1018h:04); 0: none.
    pub serial: u32,
    /// Rates that the CAN controller can give the data of CAN FD frames. A set that asks for another one is refused.
    pub data_rates: DataRates,
    /// Why the board stopped the last time. Nothing moves before a reset, or any more where the failure is final.
    pub failure: Option<Failure>,
    /// Why the processor started.
    pub cause: ResetCause,
}

impl Memory {
    /// Memory of a board that is not up.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            queues: Queues::new(),
            tick: MaybeUninit::uninit(),
            background: MaybeUninit::uninit(),
            output: MaybeUninit::uninit(),
        }
    }

    /// Brings a board up. It has joined the bus: an NMT master starts it.
    ///
    /// # Errors
    /// [`Code::ParametersUnusable`] for a set that does not pass its own checks; [`Code::BusOverload`] where the set's
    /// cycle leaves no room on the bus; [`Code::DriveNodeOfBoard`] where a drive has the board's number.
    pub fn power_up(&'static mut self, up: &PowerUp<'_>) -> Result<Sides, Alarm> {
        let tick = new_tick(&mut self.tick, up)?;
        let snapshot = Snapshot::new(tick.ticker(), &Setpoint::default(), Contacts::default());
        let background = new_background(&mut self.background, up, snapshot);
        background.power_up(up.set);
        if up.failure.is_none()
            && let Some(warning) = up.cause.warning()
        {
            background.note(&Event::Warning(warning));
        }
        background.set_serial(up.serial);
        background.set_data_rates(up.data_rates);
        background.join(up.node)?;
        let (tick_ends, background_ends) = self.queues.split();
        Ok(Sides {
            tick: TickSide::new(tick, tick_ends),
            output: self.output.write(Output::default()),
            background: BackgroundSide::new(background, background_ends),
        })
    }
}

// A function of its own makes each of the two, in its final place. The stack has no room for a copy of one, nor for the
// working space of both at once [D146].

#[inline(never)]
fn new_tick<'a>(place: &'a mut MaybeUninit<Tick>, up: &PowerUp<'_>) -> Result<&'a mut Tick, Alarm> {
    let Some(setup) = Setup::of(&up.set.params, up.set.found) else {
        return Err(Alarm::new(Code::ParametersUnusable, Span::default()));
    };
    let tick = place.write(Tick::new(&setup, up.remembered, up.tap));
    if let Some(failure) = up.failure {
        tick.begin_in_alarm(failure.alarm());
    }
    Ok(tick)
}

#[inline(never)]
fn new_background<'a>(
    place: &'a mut MaybeUninit<Background>,
    up: &PowerUp<'_>,
    snapshot: Snapshot,
) -> &'a mut Background {
    let position = up.remembered.unwrap_or_default();
    place.write(Background::new(&up.set.params, position, up.tap, snapshot))
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}
