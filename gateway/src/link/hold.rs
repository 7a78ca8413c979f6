//! The hold that waits for nothing: it is process data, and needs nobody's turn.
//!
//! Whoever runs a program may want it to stop while a transfer is under way, or while others have their turn. The link asks
//! wherever it listens or sends, and gives the hold before whatever else it has to say [D178].

use std::time::{Duration, Instant};

use leadscrew_core::bus::{BoardCommand, BoardStatus, Order};

use super::{Link, LinkResult};

/// What a link knows of it.
#[derive(Default)]
pub(super) struct Hold {
    /// True as soon as the machine is to be held; none where nobody wants to be asked.
    wanted: Option<Box<dyn Fn() -> bool + Send>>,
    /// It has been given, with this count.
    given: Option<u8>,
    /// The count of the order that is being given and not confirmed yet.
    pub under_way: Option<u8>,
}

impl Link {
    /// From now on the board has the order to hold as soon as `wanted` is true: once, and without a confirmation. An order
    /// to run is not given behind it.
    pub fn hold_when(&mut self, wanted: impl Fn() -> bool + Send + 'static) {
        self.hold = Hold {
            wanted: Some(Box::new(wanted)),
            ..Hold::default()
        };
    }

    /// Gives the hold where it is wanted. True where it has been given, now or before. Before the first status the count of
    /// an order is not known: then it waits for that.
    ///
    /// # Errors
    /// The bus is gone.
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

    /// True where it was given and the board says that it has it. What an order before it has left behind on the way is not
    /// taken for somebody else's.
    ///
    /// # Errors
    /// The bus is gone.
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

    /// What the runner orders in the usual way needs no other hold in its middle.
    pub(super) fn holds_by_itself(&mut self) {
        self.hold.wanted = None;
    }
}
