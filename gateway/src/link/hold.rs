//! The immediate hold: a hold as process data, which needs no turn.
//!
//! The runner of a program may want to stop while a transfer is under way, or while other clients have their turn. The link
//! checks for this wherever it listens or sends, and sends the hold before any other frame [D178].

use std::time::{Duration, Instant};

use leadscrew_core::bus::{BoardCommand, BoardStatus, Order};

use super::{Link, LinkResult};

/// The link's state of the immediate hold.
#[derive(Default)]
pub(super) struct Hold {
    /// Returns true as soon as the machine is to be held; `None` where no hold can be wanted.
    wanted: Option<Box<dyn Fn() -> bool + Send>>,
    /// The hold has been given with this count.
    given: Option<u8>,
    /// Count of the order that is being given and not confirmed yet.
    pub under_way: Option<u8>,
}

impl Link {
    /// From now on the board gets the order to hold as soon as `wanted` returns true: once, and without waiting for a
    /// confirmation. No order to run is given after it.
    pub fn hold_when(&mut self, wanted: impl Fn() -> bool + Send + 'static) {
        self.hold = Hold {
            wanted: Some(Box::new(wanted)),
            ..Hold::default()
        };
    }

    /// Gives the hold if it is wanted. True where it has been given, now or before. Before the first status the count of an
    /// order is unknown, so the hold waits for this status.
    ///
    /// # Errors
    /// The bus is closed.
    pub(super) fn hold_at_once(&mut self) -> LinkResult<bool> {
        if let Some(status) = self.seen.status
            && self.hold.given.is_none()
            && self.hold.wanted.as_ref().is_some_and(|wanted| wanted())
        {
            let last = self.hold.under_way.unwrap_or(status.count);
            let hold = BoardCommand::order(Order::Hold, last);
            self.hold.given = Some(hold.count);
            self.put(&[hold.frame(self.node)])?;
        }
        Ok(self.hold.given.is_some())
    }

    /// True where the hold was given and the board reports it. An earlier order that was still on its way does not count as
    /// an order of another client.
    ///
    /// # Errors
    /// The bus is closed.
    pub(super) fn is_held_already(&mut self, patience: Duration) -> LinkResult<bool> {
        let Some(given) = self.hold.given else {
            return Ok(false);
        };
        if self.seen.status.is_some_and(|now| now.count == given) {
            return Ok(true);
        }
        let node = self.node;
        self.listen(Instant::now() + patience, &mut |frame| {
            BoardStatus::decode(frame)
                .is_some_and(|(from, status)| from == node && status.count == given)
        })
    }

    /// An order of the runner needs no immediate hold in its middle.
    pub(super) fn holds_by_itself(&mut self) {
        self.hold.wanted = None;
    }
}
