//! The reference of an axis by a switch that the board looks for (9050 = 2): at an input of the machine, or at the drive.
//!
//! ```text
//! at rest ─► Listen: until the drive tells its inputs, where the switch is one of them
//!         ─► Clear: off the switch, where the axis stands on it ─► Approach: fast, until the switch is on
//!         ─► Leave: back, until it is off ─► Back: a little farther ─► Latch: slowly, until it is on: there is the mark
//!         ─► Retreat: off the mark
//! ```
//!
//! Each stage ends where the switch changes: the axis brakes, and the next stage begins from rest. The mark is always
//! passed from the same side and at the same speed, so what delays the switch shifts it by the same amount each time.
//! Where the axis is at the mark its drive says (6064h): a setpoint is ahead by the drive's lag, which a new gain changes.
//!
//! A drive samples its inputs (60FDh) where it samples its place: what has come since the last tick is of one SYNC, so the
//! place that counts is the one that came with the switch [D433].
//!
//! The axes move as they are moved by hand ([`Jog`](crate::motion::Jog)). Must not know which axis comes next.

use super::Ticker;
use crate::alarm::Code;
use crate::bus::Inputs;
use crate::motion::{AxisPress, AxisTravel, Limits, PathRate, Press};
use crate::operating::{PressState, Towards};
use crate::params::{HomeSwitch, Params};
use crate::units::{Axis, Length, Rpm};

/// Samples of the switch that have to agree, so that no disturbance ends a stage.
const LOOKS: u8 = 3;

/// How far the mark may be from where the switch was left: what it lets go late by, and what an input is late by at speed.
const SLACK: Length = Length::from_nm(5_000_000);

/// How far the axis goes back from where the switch was left, so that it has its speed, and its drive a steady lag, before
/// it comes to the mark.
const RUN_UP: Length = Length::from_nm(1_000_000);

/// The switch of an axis, and how the axis goes to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Switch {
    pub(super) at: HomeSwitch,
    /// The way to the switch.
    motion: AxisPress,
    /// The speed at the mark.
    slow: PathRate,
    /// How far it goes back from the mark.
    retreat: Length,
    /// The longest way of a stage, to either side.
    travel: Length,
    /// The longest time of the whole, in ticks.
    ticks: u32,
}

impl Switch {
    /// `None` where the axis finds its reference otherwise, or cannot move.
    #[inline(never)]
    pub(super) fn of(params: &Params, axis: Axis) -> Option<Self> {
        let at = params.home_switch(axis)?;
        let rate = |feed| PathRate::of_feed(feed, params.tick_us());
        let towards = match params.home_towards(axis)? {
            0 => Towards::Minus,
            _ => Towards::Plus,
        };
        let speeds = (rate(params.home_feed(axis)?), rate(params.rapid(axis)));
        let limits = Limits::from_params(params);
        let motion = AxisPress::new((axis, towards), speeds, true, &limits)?;
        let us = u64::from(params.home_time_ms(axis)).saturating_mul(1000);
        let ticks = us.checked_div(u64::from(params.tick_us()))?;
        Some(Self {
            at,
            motion,
            slow: rate(params.home_mark_feed(axis)?).min(motion.speed),
            retreat: params.home_retreat(axis)?,
            travel: Length::from_nm(params.home_travel(axis)),
            ticks: u32::try_from(ticks).unwrap_or(u32::MAX),
        })
    }
}

impl Switch {
    /// The side on which the axis looks for it.
    pub(super) const fn towards(&self) -> Towards {
        self.motion.towards
    }
}

/// A part of the search; see the head of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Listen,
    Clear,
    Approach,
    Leave,
    Back,
    Latch,
    Retreat,
}

impl Stage {
    const fn next(self) -> Self {
        match self {
            Self::Listen | Self::Clear => Self::Approach,
            Self::Approach => Self::Leave,
            Self::Leave => Self::Back,
            Self::Back => Self::Latch,
            Self::Latch | Self::Retreat => Self::Retreat,
        }
    }

    /// What it means that it does not end.
    const fn failed(self) -> Code {
        match self {
            Self::Approach => Code::HomeNotFound,
            // The switch does not let go; or it is not where it was left: the axis had run over it.
            _ => Code::HomeSwitchStuck,
        }
    }
}

/// What a search has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Searched {
    /// It goes on.
    Goes,
    /// The axis has its reference and stands off the mark.
    Found,
    /// An alarm: of the axis, and the input of its switch.
    Failed(Code),
}

/// A search that is under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    stage: Stage,
    /// Ticks in a row in which the switch was as the stage wants it.
    alike: u8,
    /// They were enough: the stage has come to its end, and the axis brakes.
    met: bool,
    /// The stage was held.
    held: bool,
    /// Ticks that are left.
    left: u32,
    /// How far the axis is behind its setpoint in the stage, by the last status of its drive.
    behind: Length,
    /// Where the axis was as the switch changed.
    mark: Length,
    /// How far it has gone beyond the mark by its setpoint; negative where that is still before it.
    over: Length,
}

impl Ticker {
    pub(super) const fn switch(&self, axis: Axis) -> Option<Switch> {
        let [x, z] = self.given.switches;
        match axis {
            Axis::X => x,
            Axis::Z => z,
            Axis::C => None,
        }
    }

    /// Begins to look for the switch of an axis that stands. False where the axis has none.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_search(&mut self, axis: Axis) -> bool {
        let Some(switch) = self.switch(axis) else {
            return false;
        };
        self.home.search = Some(Search {
            stage: Stage::Listen,
            alike: 0,
            met: false,
            held: false,
            left: switch.ticks,
            behind: Length::ZERO,
            mark: Length::ZERO,
            over: Length::ZERO,
        });
        if let HomeSwitch::Drive(_) = switch.at {
            self.drives.forget_inputs(axis);
        }
        true
    }

    /// A tick of the search for the switch of `axis`.
    #[cold]
    #[inline(never)]
    pub(super) fn go_on_search(&mut self, axis: Axis) -> Searched {
        let Some(switch) = self.switch(axis) else {
            return Searched::Goes;
        };
        let Some(mut search) = self.home.search else {
            return Searched::Failed(Code::HomeSwitchStuck);
        };
        let on = match self.looks_on(axis, switch.at) {
            Ok(on) => on,
            Err(code) => return Searched::Failed(code),
        };
        let Some(on) = on else {
            return Searched::Goes;
        };
        if search.stage == Stage::Listen {
            let first = if on { Stage::Clear } else { Stage::Approach };
            self.begin_stage(axis, &switch, first);
            return Searched::Goes;
        }
        let here = self.place_of(axis);
        if let Some(actual) = self.drives.place_told(axis) {
            search.behind = here - actual;
        }
        let meets = match search.stage {
            Stage::Clear | Stage::Leave => !on,
            Stage::Approach | Stage::Latch => on,
            Stage::Listen | Stage::Back | Stage::Retreat => false,
        };
        search.alike = match meets {
            true => search.alike.saturating_add(1),
            false => 0,
        };
        if search.alike == LOOKS {
            search.met = true;
            search.mark = here - search.behind;
            self.jog.release();
        }
        let held = self.operator.hold;
        search.held |= held;
        search.left = search.left.saturating_sub((!held).into());
        self.home.search = Some(search);
        let (_, press) = self.jog.last();
        let next = if search.left == 0 {
            return Searched::Failed(search.stage.failed());
        } else if held || self.jog.is_busy() {
            return Searched::Goes;
        } else if search.met {
            search.stage.next()
        } else {
            match (search.stage, press) {
                // The mark is taken after the whole run-up.
                (Stage::Back | Stage::Latch, _) if search.held => Stage::Leave,
                (Stage::Back, PressState::Ended) => search.stage.next(),
                // After a hold on the way off the mark, too: the axis has its reference, and stands.
                (Stage::Retreat, PressState::Ended) => return Searched::Found,
                (stage, PressState::Limit) => return Searched::Failed(stage.failed()),
                // After a hold.
                (stage, _) => stage,
            }
        };
        if search.met && search.stage == Stage::Latch {
            // That place has the coordinate of 9058 from now on.
            let position = self.executor.position();
            let Some(position) = self.drives.refer_to_mark(axis, position, search.mark) else {
                return Searched::Failed(Code::BeyondDriveRange);
            };
            self.stand_referenced(axis, position);
            let over = here - search.mark;
            search.over = match switch.motion.towards {
                Towards::Plus => over,
                Towards::Minus => -over,
            };
            self.home.search = Some(search);
        }
        self.begin_stage(axis, &switch, next);
        Searched::Goes
    }

    /// Whether the switch is on; `None` while its drive has not told yet.
    fn looks_on(&mut self, axis: Axis, at: HomeSwitch) -> Result<Option<bool>, Code> {
        match at {
            HomeSwitch::Machine(input) => {
                let on = self.machine.inputs(input.bit());
                let on = on.ok_or(Code::HomeSwitchStuck)?;
                Ok(Some(on & input.bit() != 0))
            }
            HomeSwitch::Drive(bit) => match self.drives.look_at_inputs(axis) {
                Inputs::Told(inputs) => Ok(Some(inputs & bit != 0)),
                Inputs::Awaited => Ok(None),
                Inputs::Untold => Err(Code::HomeInputsUntold),
            },
        }
    }

    /// The axis begins a stage, from rest.
    fn begin_stage(&mut self, axis: Axis, switch: &Switch, stage: Stage) {
        let here = self.place_of(axis);
        // What is not referenced has no limits but these. The mark is where the switch was left.
        let (mut from, mut free) = (here, switch.travel);
        let mut over = Length::ZERO;
        if let Some(search) = &mut self.home.search {
            over = search.over;
            (search.stage, search.alike) = (stage, 0);
            (search.met, search.held) = (false, false);
            if stage == Stage::Latch {
                (from, free) = (search.mark, SLACK);
            }
        }
        let travel = AxisTravel {
            low: from - free,
            high: from + free,
        };
        self.free = [travel, travel];
        let mut motion = switch.motion;
        let way = match stage {
            Stage::Back => Some(RUN_UP),
            Stage::Retreat => Some(switch.retreat + over),
            _ => None,
        };
        let on_to_the_mark = match stage {
            Stage::Approach | Stage::Latch => true,
            Stage::Listen | Stage::Clear | Stage::Leave | Stage::Back => false,
            // A setpoint that is behind the axis may have come to rest before the mark.
            Stage::Retreat => way.is_some_and(|way| way < Length::ZERO),
        };
        if stage == Stage::Latch {
            motion.speed = switch.slow;
        }
        if !on_to_the_mark {
            motion.towards = motion.towards.opposite();
        }
        let mut press = Press {
            number: 0,
            x: None,
            z: None,
            spindle: Rpm::STOPPED,
            at_rapid: true,
            slow: false,
            tip: None,
            way: way.map(Length::abs),
            wheel: None,
            until: None,
            returns: false,
        };
        let moves = if axis == Axis::X {
            &mut press.x
        } else {
            &mut press.z
        };
        *moves = Some(motion);
        self.jog.begin(&press);
    }

    /// Where X or Z is.
    const fn place_of(&self, axis: Axis) -> Length {
        let position = self.executor.position();
        match axis {
            Axis::X => position.x,
            _ => position.z,
        }
    }
}
