//! Axes and the spindle moved by keys: a press while its key is held, or one step.
//!
//! Time and what was heard are arguments; frames come out. A press lives while the terminal goes on telling that its key is
//! down [D321]: a terminal that is gone tells no release.

use std::time::{Duration, Instant};

use leadscrew_core::bus::{Beat, BoardState, Frame, JogRequest, NodeId, StepRequest};
use leadscrew_core::operating::{OperatingMode, PressState, Towards};

use crate::cli::HandWay;
use crate::link::Seen;
use crate::words::{Both, both};

/// A press is renewed so often: with the beat of up to 10 ms before, well within the dead man's 100 ms.
const RENEWAL: Duration = Duration::from_millis(20);
/// The board's answer to a press comes with its beat, every 10 ms by default.
const ANSWER: Duration = Duration::from_secs(1);
/// A keyboard repeats a key that is held for the first time within this time.
const FIRST_REPEAT: Duration = Duration::from_secs(1);
/// And then within this.
const NEXT_REPEAT: Duration = Duration::from_millis(250);

/// How a press or a step has ended, where that is worth a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At a limit of the travel.
    Limit,
    /// By the board: a hold, an alarm, another order, or frames that came too late.
    Broken,
    /// The terminal has told no more that the key is down.
    Untold,
    /// Not let in; the board says why.
    Refused,
    /// The board has not answered.
    Unanswered,
}

impl End {
    /// The same in words; `None`: the board says why.
    #[must_use]
    pub fn words(self) -> Option<Both> {
        Some(match self {
            Self::Refused => return None,
            Self::Limit => both!("at the limit of the travel or a zone", "已到行程极限或禁区"),
            Self::Broken => broken(),
            Self::Untold => both!(
                "the terminal has told no more that the key is held: press it again",
                "终端不再报告按键按住：请重新按下"
            ),
            Self::Unanswered => both!(
                "the board does not answer to a press (RPDO2, RPDO3, TPDO5)",
                "控制板对手动请求没有应答（RPDO2、RPDO3、TPDO5）"
            ),
        })
    }
}

/// A press that the board has ended, or has not begun, for a reason that it does not tell.
#[must_use]
pub fn broken() -> Both {
    both!(
        "the board has ended the motion: a feed hold, another order, or frames that came too late (9040)",
        "控制板结束了移动：进给保持、其他指令，或报文到达过晚（9040）"
    )
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doing {
    Press {
        way: HandWay,
        rapid: bool,
        /// The key is held.
        held: bool,
        /// Until then, unless it is told again.
        until: Instant,
    },
    Step {
        on_z: bool,
        way: i32,
    },
}

#[derive(Clone, Copy, Debug)]
struct Active {
    doing: Doing,
    begun: Instant,
    /// When it was let go.
    released: Option<Instant>,
    /// When a step was told to be over, and the number of statuses before.
    over: Option<(Instant, u64)>,
    /// The next frame.
    next: Instant,
    /// The beat of its first frame.
    echo: Option<Beat>,
}

/// The hand of this side.
#[derive(Debug)]
pub struct Hand {
    node: NodeId,
    session: u8,
    number: u8,
    active: Option<Active>,
    ended: Option<End>,
}

impl Hand {
    /// Nothing is pressed.
    #[must_use]
    pub const fn new(node: NodeId, session: u8) -> Self {
        Self {
            node,
            session,
            number: 0,
            active: None,
            ended: None,
        }
    }

    /// Nothing is pressed any more.
    pub const fn forget(&mut self) {
        *self = Self::new(self.node, self.session);
    }

    /// A key is held, as far as the terminal tells.
    #[must_use]
    pub fn presses(&self) -> bool {
        matches!(
            self.active,
            Some(Active {
                doing: Doing::Press { held: true, .. },
                ..
            })
        )
    }

    /// Nothing is pressed, and no step is under way.
    #[must_use]
    pub const fn is_idle(&self) -> bool {
        self.active.is_none()
    }

    /// Begins a press.
    pub fn press(&mut self, way: HandWay, rapid: bool, seen: &Seen, now: Instant) {
        let doing = Doing::Press {
            way,
            rapid,
            held: true,
            until: now + FIRST_REPEAT,
        };
        self.begin(doing, seen, now);
    }

    /// Begins a step, in 0.1 µm of the slide; not before the last one is over, so that a key that repeats makes one step
    /// at a time.
    pub fn step(&mut self, on_z: bool, way: i32, seen: &Seen, now: Instant) {
        if self.active.is_none() {
            self.begin(Doing::Step { on_z, way }, seen, now);
        }
    }

    fn begin(&mut self, doing: Doing, seen: &Seen, now: Instant) {
        // Each has a number that the board has not seen of this session.
        let told = seen.beat.filter(|told| told.session == self.session);
        let last = told.map_or(self.number, |told| told.press);
        self.number = last.wrapping_add(1);
        self.ended = None;
        self.active = Some(Active {
            doing,
            begun: now,
            released: None,
            over: None,
            next: now,
            echo: None,
        });
    }

    /// The terminal tells that a key is still down. Another one, or Shift let go, ends the press.
    pub fn still_held(&mut self, which: HandWay, fast: bool, now: Instant) {
        let Some(Active {
            doing:
                Doing::Press {
                    way,
                    rapid,
                    held: true,
                    until,
                },
            ..
        }) = &mut self.active
        else {
            return;
        };
        if *way != which || *rapid != fast {
            self.release(now);
        } else if now < *until {
            *until = now + NEXT_REPEAT;
        }
    }

    /// Ends a press: its key was let go, or anything else has happened.
    pub fn release(&mut self, now: Instant) {
        if let Some(active) = &mut self.active
            && let Doing::Press { held, .. } = &mut active.doing
            && *held
        {
            *held = false;
            active.released = Some(now);
            active.next = now;
        }
    }

    /// What is to be sent now.
    pub fn frame(&mut self, seen: &Seen, now: Instant) -> Option<Frame> {
        if let Some(Active {
            doing: Doing::Press {
                held: true, until, ..
            },
            ..
        }) = self.active
            && now >= until
        {
            self.release(now);
            self.ended = Some(End::Untold);
        }
        self.heed(seen, now);
        let active = self.active.as_mut().filter(|active| now >= active.next)?;
        active.next = now + RENEWAL;
        let told = seen.beat?;
        let first = *active.echo.get_or_insert(told.beat);
        let has_come = told.session == self.session && told.press == self.number;
        // A step that has not come is as old as its key; one that has come is renewed [D535].
        let echo = match active.doing {
            Doing::Step { .. } if !has_come => first,
            _ => told.beat,
        };
        Some(frame(
            active.doing,
            self.session,
            self.number,
            echo,
            self.node,
        ))
    }

    /// Sees what has become of it.
    fn heed(&mut self, seen: &Seen, now: Instant) {
        let Some(active) = self.active else {
            return;
        };
        let told = seen
            .beat
            .filter(|told| told.session == self.session && told.press == self.number);
        let released = active.released.is_some();
        let is_step = matches!(active.doing, Doing::Step { .. });
        let end = match told.map(|told| told.state) {
            Some(PressState::Runs | PressState::None) => {
                // The board brakes by itself where nobody renews.
                if active.released.is_some_and(|at| now >= at + ANSWER) {
                    self.active = None;
                }
                return;
            }
            Some(PressState::Ended) if is_step => {
                let (at, before) = active.over.unwrap_or((now, seen.statuses));
                // What has ended it is in the status, which comes behind the beat.
                if seen.statuses == before && now < at + ANSWER {
                    self.active = Some(Active {
                        over: Some((at, before)),
                        ..active
                    });
                    return;
                }
                is_cut_short(seen).then_some(End::Broken)
            }
            Some(PressState::Ended) if released => None,
            Some(PressState::Ended) => Some(End::Broken),
            Some(PressState::Limit) => Some(End::Limit),
            // Let go before its first frame.
            Some(PressState::Refused)
                if released && seen.beat.is_some_and(|told| told.refused == 0) =>
            {
                None
            }
            Some(PressState::Refused) => Some(End::Refused),
            None if now < active.begun + ANSWER => return,
            // Let go before its first frame.
            None if released => None,
            None => Some(End::Unanswered),
        };
        self.active = None;
        self.ended = self.ended.or(end);
    }

    /// How the last one has ended; told once.
    pub const fn ended(&mut self) -> Option<End> {
        match self.active {
            Some(_) => None,
            None => self.ended.take(),
        }
    }
}

/// The board tells of a step that a hold, an alarm or a change of mode has ended as of one that was made.
fn is_cut_short(seen: &Seen) -> bool {
    let status = seen.status.unwrap_or_default();
    let left = seen
        .beat
        .is_some_and(|told| told.mode != OperatingMode::Step);
    left || status.flags.hold || status.state == BoardState::Alarm
}

fn frame(doing: Doing, session: u8, number: u8, echo: Beat, node: NodeId) -> Frame {
    match doing {
        Doing::Step { on_z, way } => StepRequest {
            session,
            count: number,
            on_z,
            way,
            echo,
        }
        .frame(node),
        Doing::Press {
            way, rapid, held, ..
        } => {
            let told = |towards: Option<Towards>| towards.filter(|_| held);
            JogRequest {
                session,
                press: number,
                x: told(way.of_axis(false)),
                z: told(way.of_axis(true)),
                spindle: told(way.of_spindle()),
                rapid,
                speed: 0,
                echo,
            }
            .frame(node)
        }
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::bus::{BoardBeat, BoardStatus};

    use super::*;

    /// What was heard after so many statuses.
    fn heard(statuses: u64, press: u8, state: PressState) -> Seen {
        let mut seen = Seen::default();
        seen.statuses = statuses;
        seen.status = Some(BoardStatus::default());
        seen.beat = Some(BoardBeat {
            mode: OperatingMode::Step,
            session: 7,
            press,
            state,
            ..BoardBeat::default()
        });
        seen
    }

    #[test]
    fn a_step_that_is_over_is_judged_by_the_next_status() {
        type Ended = fn(&mut Seen);
        let cases: [(Ended, Option<End>); 4] = [
            (|_| {}, None),
            (
                |seen| seen.status.as_mut().unwrap().flags.hold = true,
                Some(End::Broken),
            ),
            (
                |seen| seen.status.as_mut().unwrap().state = BoardState::Alarm,
                Some(End::Broken),
            ),
            (
                |seen| seen.beat.as_mut().unwrap().mode = OperatingMode::Manual,
                Some(End::Broken),
            ),
        ];
        for (ends, wanted) in cases {
            let now = Instant::now();
            let mut hand = Hand::new(NodeId::BOARD, 7);
            hand.step(true, -10_000, &heard(0, 0, PressState::None), now);
            assert!(hand.frame(&heard(1, 1, PressState::Runs), now).is_some());
            // The status is still that from before.
            hand.frame(&heard(1, 1, PressState::Ended), now);
            assert!(!hand.is_idle());
            let mut over = heard(2, 1, PressState::Ended);
            ends(&mut over);
            hand.frame(&over, now);
            assert!(hand.is_idle());
            assert_eq!(hand.ended(), wanted);
        }
    }
}
