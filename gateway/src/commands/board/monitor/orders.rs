//! Orders and levels on their way to a board: repeated until the board has them, and never waited for.
//!
//! Time and what was heard are arguments; frames come out. So a hold goes out at once, whatever else is on its way.

use std::time::{Duration, Instant};

use leadscrew_core::bus::{Beat, BoardCommand, Frame, NodeId, Order};

use crate::link::Seen;
use crate::words::{Both, both};

/// An order is repeated after this time.
const REPEAT: Duration = Duration::from_millis(20);
/// An order without confirmation in this time has failed.
const CONFIRMED: Duration = Duration::from_secs(5);
/// Levels have no confirmation: they are sent so often.
const LEVELS: u8 = 3;

/// What became of an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The board has it. Whether it was let in is in the next beat.
    Taken(Order),
    /// Another client has ordered meanwhile, so that nobody knows whether the board had this one.
    Overtaken(Order),
    /// The board has not confirmed it.
    Unconfirmed(Order),
}

impl Outcome {
    /// What is wrong with it, in words.
    #[must_use]
    pub fn words(self) -> Option<Both> {
        match self {
            Self::Taken(_) => None,
            Self::Overtaken(_) => Some(both!(
                "somebody else has ordered at the same time: look, then give it again",
                "其他操作者同时下达了指令：请查看后再次下达"
            )),
            Self::Unconfirmed(_) => Some(both!(
                "the board has not confirmed the order",
                "控制板未确认该指令"
            )),
        }
    }
}

/// An order that is not given, because another waits for its confirmation.
#[must_use]
pub fn on_its_way() -> Both {
    both!(
        "the order before is still on its way: give it again",
        "上一条指令尚未送达：请再次下达"
    )
}

/// The board has started again while something was on its way to it.
#[must_use]
pub fn restarted() -> Both {
    both!(
        "the board has started again: what was ordered before is taken back; look at the machine",
        "控制板已重新启动：此前的指令已撤回；请查看机床"
    )
}

#[derive(Clone, Copy, Debug)]
struct Pending {
    order: Order,
    count: u8,
    /// The counts that the board may have until then: its last one, and that of an order that this one has replaced.
    before: [u8; 2],
    /// The beat that says how old it is: the first that was known. A repetition is as old as the order [D535].
    echo: Option<Beat>,
    next: Instant,
    end: Instant,
}

/// The orders of this side.
#[derive(Debug)]
pub struct Orders {
    node: NodeId,
    pending: Option<Pending>,
    levels: Option<(BoardCommand, u8, Instant)>,
    outcome: Option<Outcome>,
}

impl Orders {
    /// None is on its way.
    #[must_use]
    pub const fn new(node: NodeId) -> Self {
        Self {
            node,
            pending: None,
            levels: None,
            outcome: None,
        }
    }

    /// Nothing is on its way any more.
    pub const fn forget(&mut self) {
        *self = Self::new(self.node);
    }

    /// Gives an order. Hold and stop take the place of one on its way; another waits for nothing and is not given: false.
    pub fn give(&mut self, order: Order, seen: &Seen, now: Instant) -> bool {
        let last = seen.status.unwrap_or_default().count;
        let replaced = self.pending.map(|pending| pending.count);
        if replaced.is_some() && !halts(order) {
            return false;
        }
        let behind = replaced.unwrap_or(last);
        self.pending = Some(Pending {
            order,
            count: behind.wrapping_add(1),
            before: [last, behind],
            echo: None,
            next: now,
            end: now + CONFIRMED,
        });
        true
    }

    /// Sets levels, together with those on their way.
    pub fn set(&mut self, levels: BoardCommand, now: Instant) {
        let before = self
            .levels
            .map_or_else(BoardCommand::default, |(before, ..)| before);
        let both = BoardCommand {
            single_block: levels.single_block.or(before.single_block),
            dry_run: levels.dry_run.or(before.dry_run),
            feed: levels.feed.or(before.feed),
            rapid: levels.rapid.or(before.rapid),
            spindle: levels.spindle.or(before.spindle),
            ..levels
        };
        self.levels = Some((both, LEVELS, now));
    }

    /// What is to be sent now. `beat` is the newest of the board.
    pub fn frame(&mut self, seen: &Seen, beat: Option<Beat>, now: Instant) -> Option<Frame> {
        let count = seen.status.map(|status| status.count);
        if let Some(pending) = &mut self.pending {
            let end = match count {
                Some(count) if count == pending.count => Some(Outcome::Taken(pending.order)),
                Some(count) if pending.before.contains(&count) => None,
                None => None,
                // What halts is given again behind whatever somebody else has ordered.
                Some(count) if halts(pending.order) => {
                    pending.count = count.wrapping_add(1);
                    pending.before = [count; 2];
                    pending.next = now;
                    None
                }
                Some(_) => Some(Outcome::Overtaken(pending.order)),
            };
            let end = end.or((now >= pending.end).then_some(Outcome::Unconfirmed(pending.order)));
            if end.is_some() {
                self.outcome = end;
                self.pending = None;
            } else if now >= pending.next {
                // An order that shows its age waits for the beat that it needs.
                pending.echo = pending.echo.or(beat);
                let echo = pending.echo.filter(|_| pending.order.needs_echo());
                if echo.is_some() || !pending.order.needs_echo() {
                    pending.next = now + REPEAT;
                    let command = BoardCommand {
                        count: pending.count,
                        order: Some(pending.order),
                        echo,
                        ..BoardCommand::default()
                    };
                    return Some(command.frame(self.node));
                }
            }
        }
        let (levels, left, next) = self.levels.as_mut()?;
        if now < *next {
            return None;
        }
        *next = now + REPEAT;
        *left -= 1;
        let command = BoardCommand {
            count: count.unwrap_or(0),
            ..*levels
        };
        if *left == 0 {
            self.levels = None;
        }
        Some(command.frame(self.node))
    }

    /// What became of the last order; told once.
    pub const fn outcome(&mut self) -> Option<Outcome> {
        self.outcome.take()
    }
}

/// True for an order that no other client may undo unnoticed.
const fn halts(order: Order) -> bool {
    matches!(order, Order::Hold | Order::Stop)
}

#[cfg(test)]
mod tests {
    use leadscrew_core::bus::{BoardStatus, CobId};
    use leadscrew_core::operating::OperatingMode;

    use super::*;

    const NODE: NodeId = NodeId::BOARD;

    fn heard(count: u8) -> Seen {
        let mut seen = Seen::default();
        seen.status = Some(BoardStatus {
            count,
            ..BoardStatus::default()
        });
        seen
    }

    struct Time(Instant);

    impl Time {
        fn at(&self, ms: u64) -> Instant {
            self.0 + Duration::from_millis(ms)
        }
    }

    fn sent(frame: Option<Frame>) -> Option<(u8, Order, Option<Beat>)> {
        let (_, command) = BoardCommand::decode(&frame?)?;
        Some((command.count, command.order?, command.echo))
    }

    #[test]
    fn an_order_is_repeated_until_the_board_has_it() {
        let (mut orders, time) = (Orders::new(NODE), Time(Instant::now()));
        let beat = Some(Beat::new(7));
        assert!(orders.give(Order::Resume, &heard(4), time.at(0)));
        let resume = Some((5, Order::Resume, beat));
        assert_eq!(sent(orders.frame(&heard(4), beat, time.at(0))), resume);
        assert_eq!(orders.frame(&heard(4), beat, time.at(19)), None);
        assert_eq!(sent(orders.frame(&heard(4), beat, time.at(20))), resume);
        assert_eq!(orders.outcome(), None);
        assert_eq!(orders.frame(&heard(5), beat, time.at(40)), None);
        assert_eq!(orders.outcome(), Some(Outcome::Taken(Order::Resume)));
        assert_eq!(orders.outcome(), None);
        // It ends all the same where nobody answers, and where somebody else has ordered.
        assert!(orders.give(Order::Reset, &heard(5), time.at(50)));
        assert_eq!(
            sent(orders.frame(&heard(5), beat, time.at(50))),
            Some((6, Order::Reset, None))
        );
        assert_eq!(orders.frame(&heard(5), beat, time.at(5_050)), None);
        assert_eq!(orders.outcome(), Some(Outcome::Unconfirmed(Order::Reset)));
        assert!(orders.give(Order::Reset, &heard(5), time.at(6_000)));
        assert_eq!(orders.frame(&heard(9), beat, time.at(6_000)), None);
        assert_eq!(orders.outcome(), Some(Outcome::Overtaken(Order::Reset)));
    }

    #[test]
    fn a_hold_takes_the_place_of_what_is_on_its_way_and_nothing_takes_its_own() {
        let (mut orders, time) = (Orders::new(NODE), Time(Instant::now()));
        let mode = Order::Mode(OperatingMode::Step);
        assert!(orders.give(mode, &heard(255), time.at(0)));
        // An order that has to show its age waits for a beat.
        assert_eq!(orders.frame(&heard(255), None, time.at(0)), None);
        assert!(orders.give(Order::Hold, &heard(255), time.at(1)));
        let hold = |count| Some((count, Order::Hold, None));
        assert_eq!(sent(orders.frame(&heard(255), None, time.at(1))), hold(1));
        assert!(!orders.give(Order::Resume, &heard(255), time.at(2)));
        // The order before has come to the board, after all.
        assert_eq!(sent(orders.frame(&heard(0), None, time.at(21))), hold(1));
        // And so has somebody else's.
        assert_eq!(sent(orders.frame(&heard(8), None, time.at(22))), hold(9));
        assert_eq!(orders.frame(&heard(9), None, time.at(23)), None);
        assert_eq!(orders.outcome(), Some(Outcome::Taken(Order::Hold)));
    }

    #[test]
    fn a_level_that_is_set_behind_others_on_their_way_takes_none_of_them_back() {
        let (mut orders, time) = (Orders::new(NODE), Time(Instant::now()));
        let each: [fn(&mut BoardCommand); 5] = [
            |levels| levels.dry_run = Some(true),
            |levels| levels.single_block = Some(false),
            |levels| levels.feed = Some(90),
            |levels| levels.rapid = Some(25),
            |levels| levels.spindle = Some(110),
        ];
        let mut all = BoardCommand::default();
        for set in each {
            let mut one = BoardCommand::default();
            set(&mut one);
            set(&mut all);
            orders.set(one, time.at(0));
        }
        let frame = orders.frame(&heard(0), None, time.at(0)).unwrap();
        assert_eq!(BoardCommand::decode(&frame), Some((NODE, all)));
    }

    #[test]
    fn levels_are_sent_three_times_and_without_an_order() {
        let (mut orders, time) = (Orders::new(NODE), Time(Instant::now()));
        let levels = BoardCommand {
            feed: Some(90),
            ..BoardCommand::default()
        };
        orders.set(levels, time.at(0));
        let mut count = 0;
        for ms in 0..200 {
            if let Some(frame) = orders.frame(&heard(3), None, time.at(ms)) {
                let expected = BoardCommand { count: 3, ..levels };
                assert_eq!(BoardCommand::decode(&frame), Some((NODE, expected)));
                assert_ne!(frame.id(), CobId::NMT);
                count += 1;
            }
        }
        assert_eq!(count, LEVELS);
    }
}
