//! A board on a bus, for owners with one thread: routes frames, lets the station go on, carries out what it asks for.
//!
//! ```text
//! each frame ─► receive() ─► true: a drive's, keep it for tick()
//! tick(), then send its frames
//! event() until there is none; serve(); background() until there is no work
//! transmit() as often as the bus has room: behind the frames of the tick, they come first
//! ```

use super::queue::{Calls, Segments};
use super::{Background, Board, Snapshot, State, Ticker};
use crate::alarm::Alarm;
use crate::bus::{Frame, NodeId, Periods};
use crate::motion::{Helix, Limits, Setpoint, TapLine};
use crate::program::{Position, TapAxis};
use crate::units::Length;

/// What the next measured angle is judged by: the law an axis follows, and where it was told to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    law: Law,
    position: Position,
}

#[derive(Clone, Copy, Debug)]
enum Law {
    /// The helix of a pass.
    Thread(Helix),
    /// The line of a tap.
    Tap(TapLine),
}

impl Reference {
    fn error(&self, ticker: &Ticker) -> Length {
        match self.law {
            Law::Thread(helix) => {
                let on_x = helix.long_x();
                let at = if on_x {
                    self.position.x
                } else {
                    self.position.z
                };
                at - helix.at(ticker.effective_angle(on_x))
            }
            Law::Tap(line) => {
                let on_x = line.gear.axis() == TapAxis::X;
                line.error(self.position, ticker.effective_angle(on_x))
            }
        }
    }
}

impl Board {
    /// Joins a network as `node`: from now on it hears and says something. An NMT master starts it.
    ///
    /// # Errors
    /// [`Code::BusOverload`](crate::alarm::Code::BusOverload) where the cycle leaves no room on the bus.
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.station.set_node(node);
        self.station.join(&self.params)
    }

    /// Takes a frame from the bus. True where it is not for the board as a node: it belongs to the next
    /// [`tick`](Self::tick).
    #[must_use]
    pub fn receive(&mut self, frame: &Frame) -> bool {
        let taken = self.station.receive(frame, &self.params);
        self.carry_out();
        !taken
    }

    /// Lets the station go on: `elapsed` periods after the last call, behind the tick that gave `setpoint`. True where a
    /// call went to the planner.
    pub fn serve(&mut self, elapsed: Periods, setpoint: &Setpoint) -> bool {
        // Before any call goes to the planner.
        self.heed();
        let snapshot = Snapshot::new(&self.ticker, setpoint);
        self.judge(elapsed, &snapshot);
        let (ticker, calls) = (&mut self.ticker, &mut self.calls);
        let mut offer = |call: &_| super::offer(ticker, calls, call);
        let worked = self
            .station
            .poll(elapsed, snapshot, &self.params, &mut offer);
        self.carry_out();
        worked
    }

    /// The next frame of the station to send.
    pub fn transmit(&mut self) -> Option<Frame> {
        self.station.transmit()
    }

    /// True where a program runs whose next call has not come, and there would be room for it. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.station.awaits_program() && !self.calls.is_full()
    }

    /// Says how many setpoints have come late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.station.set_late(late);
    }

    /// The board as a node.
    #[must_use]
    pub const fn station(&self) -> &super::Station {
        &self.station
    }

    /// The error of the setpoint before, which has taken effect by now, at the angle just measured.
    fn judge(&mut self, elapsed: Periods, snapshot: &Snapshot) {
        let error = match self.reference.take() {
            Some(reference) if elapsed == Periods::new(1) => Some(reference.error(&self.ticker)),
            _ => None,
        };
        if elapsed != Periods::new(0) {
            self.station.set_sync_error(error);
        }
        if snapshot.setpoint.locked
            && let Some(law) = self.law()
        {
            self.reference = Some(Reference {
                law,
                position: snapshot.setpoint.position,
            });
        }
    }

    fn law(&self) -> Option<Law> {
        self.helix().map(Law::Thread).or_else(|| {
            let line = self.float_line().or_else(|| self.tap_line())?;
            Some(Law::Tap(line))
        })
    }

    /// The application begins anew with the parameter set as it is now. Nothing moves; the drives are brought up again.
    fn restart(&mut self) {
        let remembered = match self.ticker.state() {
            State::Starting => None,
            _ => Some(self.ticker.executor().position()),
        };
        let Some(mut ticker) = Ticker::new(&self.params, remembered, None) else {
            // It has been checked before it was staged.
            return;
        };
        ticker.succeed(&self.ticker);
        self.ticker = ticker;
        self.limits = Limits::from_params(&self.params);
        self.calls = Calls::new();
        self.segments = Segments::new();
        self.detours = Segments::new();
        self.background = Background::new(remembered.unwrap_or_default());
        self.notice = None;
        self.reference = None;
    }

    fn carry_out(&mut self) {
        while let Some(command) = self.station.command() {
            self.ticker.command(command);
        }
        if let Some(signals) = self.station.signals() {
            self.ticker.signals(signals);
        }
        if self.station.drops_tap() {
            // Refused at the bus where that does not go.
            let _ = self.discard_tap();
        }
        if let Some(params) = self.station.take_params() {
            self.params.clone_from(params);
            self.restart();
        }
    }
}
