//! The health of the bus: the controller, late setpoints, and other nodes that send to the drives. A fault becomes a
//! [`BusTrouble`] for the tick.

use super::Device;
use crate::bus::CobId;
use crate::bus::{Controller, Periods};
use crate::params::Params;
use crate::tick::{BusTrouble, Command, DriveNodes, Intrusion, State};

/// Late setpoints within this time count against their limit.
const LATE_MS: u32 = 1000;

impl Device {
    /// Sets the state of the CAN controller. Call it at every change, or more often. An error-passive, bus-off or
    /// restricted controller is a controlled stop with an alarm, and no reset clears the alarm before the controller is
    /// well again. A controller that has left the bus, or does not send, must not be started again before
    /// [`may_rejoin`](Self::may_rejoin), and never by itself. Back on the bus, the device sends an emergency message with
    /// the counters and waits for an NMT start [D124].
    pub fn set_controller(&mut self, controller: Controller, params: &Params) {
        let before = core::mem::replace(&mut self.controller, controller).state;
        if !self.has_joined() || before == controller.state {
            return;
        }
        if before.is_cut_off() {
            self.urgent.clear();
            let boot_up = self.nmt.boot();
            self.say(boot_up);
        }
        if controller.state.is_cut_off() {
            self.end_transfer(params);
        }
        self.tell_trouble(BusTrouble::of(controller));
    }

    /// True where a controller that has left the bus, or does not send, may be started again: the machine stands on an
    /// alarm, and the drives have been let go.
    #[must_use]
    pub const fn may_rejoin(&self) -> bool {
        self.controller.state.is_cut_off() && matches!(self.values.snapshot.state, State::Alarm(_))
    }

    /// Another node sends to the drives. While nothing moves, a drive that stops following reports its own failure.
    pub(super) fn resist(&mut self, intrusion: Intrusion) {
        if !matches!(intrusion, Intrusion::Network(_)) || !self.values.snapshot.is_at_rest() {
            self.tell_trouble(Some(BusTrouble::Intruder(intrusion)));
        }
    }

    /// The setpoints in a frame with this identifier from another node to the board's drives.
    pub(super) fn setpoints_of_others(&self, id: CobId, params: &Params) -> Option<Intrusion> {
        let together = (params.setpoint_frame() == 1).then(|| self.node());
        Intrusion::of_setpoints(id, &DriveNodes::of(params), together)
    }

    /// Reports a trouble. The first trouble stays until a reset; a trouble that is still present then is reported again.
    fn tell_trouble(&mut self, trouble: Option<BusTrouble>) {
        if let Some(trouble) = trouble {
            self.values.command(Command::Trouble(trouble));
        }
    }

    pub(super) fn watch_bus(&mut self, elapsed: Periods, params: &Params) {
        let (from, since) = &mut self.lateness;
        *since = since.plus(elapsed);
        let over = Periods::from_ms(LATE_MS, params.tick_us()).is_none_or(|all| *since > all);
        // Late setpoints do no harm while nothing moves.
        if over || self.values.snapshot.is_at_rest() {
            *since = Periods::new(0);
            *from = self.values.late;
        }
        let count = self.values.late.saturating_sub(*from);
        if elapsed == Periods::new(0) || self.values.snapshot.alarm().is_some() {
            return;
        }
        let limit = params.late_setpoints();
        let late = limit != 0 && count > limit;
        let late = late.then_some(BusTrouble::Late { count, limit });
        self.tell_trouble(BusTrouble::of(self.controller).or(late));
    }
}
