//! The device's requests, as orders to the tick.

use super::BackgroundSide;
use crate::board::message::Order;
use crate::board::queue::put;
use crate::board::ticker::Setup;
use crate::motion::Limits;

impl BackgroundSide<'_> {
    /// Carries out the device's requests. Where there is no room for an order, they wait in the device.
    #[inline(never)]
    pub(super) fn carry_out(&mut self) {
        while self.ends.has_room()
            && let Some(command) = self.state.device.command()
        {
            self.ends
                .order(&mut self.state.orders, Order::Command(command));
        }
        if self.ends.has_room()
            && let Some(signals) = self.state.device.signals()
        {
            self.ends
                .order(&mut self.state.orders, Order::Signals(signals));
        }
        if self.ends.has_room() && self.state.device.drops_tap() {
            // Where this is not possible, the device has refused it already.
            self.ends.order(&mut self.state.orders, Order::DiscardTap);
        }
        if self.ends.has_room() && !self.state.is_renewing() {
            self.take_params();
        }
    }

    /// A parameter set comes into force: here at once, in the tick with the next order. Nothing moves; the drives are
    /// enabled again.
    #[inline(never)]
    fn take_params(&mut self) {
        let state = &mut *self.state;
        let Some(params) = state.device.take_params() else {
            return;
        };
        state.params.clone_from(params);
        state.limits = Limits::from_params(&state.params);
        // The set was checked before it was staged, and there is room for one setup; otherwise the board stays as it is
        // [D148].
        if let Some(setup) = Setup::of(&state.params, state.device.found())
            && put(&mut self.ends.setups, setup).is_ok()
        {
            self.ends.order(&mut state.orders, Order::BeginAnew);
        }
    }
}
