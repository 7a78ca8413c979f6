//! The device's requests, as orders to the tick.

use super::BackgroundSide;
use super::orders::has_room;
use super::press::plan_press;
use crate::motion::Limits;
use crate::tick::queue::{put, room};
use crate::tick::{Command, Order, Setup};

impl BackgroundSide<'_> {
    /// Carries out the device's requests. Where there is no room for an order, they wait in the device.
    #[inline(never)]
    pub(super) fn carry_out(&mut self) {
        while has_room(&self.ends)
            && let Some(command) = self.state.device.command()
        {
            self.state
                .orders
                .give(&mut self.ends, Order::Command(command));
        }
        if has_room(&self.ends)
            && room(&self.ends.presses) > 0
            && let Some(asked) = self.state.device.asked()
        {
            let snapshot = &self.state.snapshot;
            let forbidden = self.state.device.forbidden(&self.state.params);
            let press = plan_press(
                &asked,
                (
                    // Off a hard limit switch an axis goes as slowly as without a reference.
                    snapshot.referenced.minus(snapshot.hard_limits.axes()),
                    snapshot.interlocks.has_door(),
                ),
                (&forbidden, snapshot.setpoint.position),
                &self.state.params,
                &self.state.limits,
            );
            // There is room.
            let _ = put(&mut self.ends.presses, press);
            self.state.orders.give(&mut self.ends, Order::Press);
        }
        if has_room(&self.ends)
            && let Some(way) = self.state.device.turned()
        {
            let turned = Order::Command(Command::Turned(way));
            self.state.orders.give(&mut self.ends, turned);
        }
        if has_room(&self.ends)
            && let Some(signals) = self.state.device.signals()
        {
            self.state
                .orders
                .give(&mut self.ends, Order::Signals(signals));
        }
        if has_room(&self.ends) && self.state.device.drops_tap() {
            // Where this is not possible, the device has refused it already.
            self.state.orders.give(&mut self.ends, Order::DiscardTap);
        }
        // As long as a set is not taken, nothing that moves is let in.
        let at_rest = self.state.snapshot.is_at_rest();
        let drives_stand = self.state.device.drives_stand();
        if (drives_stand || !at_rest)
            && let Some(params) = self.state.device.take_params()
        {
            self.state.params.clone_from(params);
            self.state.limits = Limits::from_params(&self.state.params);
            self.state.setup_waits = true;
        }
        // What was let in before the set, and has begun to move since, comes to its end first, in the drives as well.
        let stands = at_rest && drives_stand;
        let has_room = has_room(&self.ends) && !self.state.orders.begin_anew();
        if self.state.setup_waits && stands && has_room {
            self.state.setup_waits = false;
            self.begin_anew();
        }
    }

    /// A parameter set that is in force here comes into force in the tick with the next order. Nothing moves; the drives
    /// are enabled again.
    #[inline(never)]
    fn begin_anew(&mut self) {
        let state = &mut *self.state;
        // The set was checked before it was staged, and there is room for one setup; otherwise the board stays as it is
        // [D148].
        if let Some(setup) = Setup::of(&state.params, state.device.found())
            && put(&mut self.ends.setups, setup).is_ok()
        {
            state.orders.give(&mut self.ends, Order::BeginAnew);
        }
    }
}
