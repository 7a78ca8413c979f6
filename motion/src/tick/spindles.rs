//! The drives of the spindles: spindle 1 turns and taps, the spindles from 2 on only tap.
//!
//! One spindle is *selected*: its drive gets a command in every period. The others stand in speed mode and are served in
//! turn, one in a period, so that bus and tick carry one more drive and not three [D91]. The board has an encoder for
//! spindle 1. For the other spindles, the position that their drive reports counts. Knows nothing of taps or programs.

use super::gear::GearDrive;
use super::lag::{Inverse, Lag};
use crate::alarm::Alarm;
use crate::bus::{
    DriveConfig, DriveMaster, Frame, Increments, MilliRpm, NodeId, Periods, SpindleDemand,
    SpindleMaster,
};
use crate::call::TapSpindle;
use crate::units::{Divisor, Turns, signed_product};

/// The command to the spindle for the next SYNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spindle {
    /// Turn at a speed.
    Speed(MilliRpm),
    /// Stand at an angle.
    Angle(Turns),
}

/// Periods between two commands to a spindle that is not selected.
const ROUND: u32 = 4;

/// All spindles of a machine.
#[derive(Debug)]
pub(super) struct Spindles {
    /// Only the first `present` of them exist.
    masters: [SpindleMaster; 4],
    present: u8,
    selected: TapSpindle,
    /// The spindle that is served next.
    turn: TapSpindle,
    /// Increments of a drive per turn of its spindle: of the first, in its gear, and of the others.
    of_first: Divisor,
    per_turn: Divisor,
    /// For the spindles from 2 on: the last commanded angle, in increments that do not wrap.
    counts: [i64; 3],
    /// What makes a spindle in position mode follow its angle, where the lag of its drive is known.
    inverse: Option<Inverse>,
}

impl Spindles {
    /// `present` spindles (1–4). `config` is that of the first drive; the others are like it, with consecutive nodes, and
    /// `lag` is of each.
    pub(super) fn new(config: &DriveConfig, present: u8, per_turn: u32, lag: Option<Lag>) -> Self {
        let mut masters = [SpindleMaster::new(*config); 4];
        for (master, before) in masters.iter_mut().zip(0..) {
            let node = config.node.get().saturating_add(before);
            master.drive_mut().set_node(NodeId::nearest(node));
        }
        Self {
            masters,
            present,
            selected: TapSpindle::First,
            turn: TapSpindle::First,
            of_first: Divisor::new(per_turn),
            per_turn: Divisor::new(per_turn),
            counts: [0; 3],
            inverse: lag.map(Inverse::new),
        }
    }

    /// The drives of the machine.
    pub(super) fn drives(&self) -> impl Iterator<Item = &DriveMaster> {
        let present = usize::from(self.present);
        self.masters.iter().take(present).map(SpindleMaster::drive)
    }

    /// The same, for enabling and reset.
    pub(super) fn drives_mut(&mut self) -> impl Iterator<Item = &mut DriveMaster> {
        let present = usize::from(self.present);
        let masters = self.masters.iter_mut().take(present);
        masters.map(SpindleMaster::drive_mut)
    }

    /// The drive of this node, if there is one.
    pub(super) const fn of_node(&mut self, node: u8) -> Option<&mut DriveMaster> {
        let [first, ..] = &self.masters;
        let before = node.wrapping_sub(first.drive().config().node.get());
        if before >= self.present {
            return None;
        }
        let spindle = match before {
            0 => TapSpindle::First,
            1 => TapSpindle::Second,
            2 => TapSpindle::Third,
            _ => TapSpindle::Fourth,
        };
        Some(pick_mut(&mut self.masters, spindle).drive_mut())
    }

    /// The first latched failure.
    pub(super) fn failure(&self) -> Option<Alarm> {
        // Spindles that the machine does not have cannot fail.
        if !self
            .masters
            .iter()
            .any(|master| master.drive().has_failed())
        {
            return None;
        }
        self.drives().find_map(DriveMaster::alarm)
    }

    /// Another gear of spindle 1, which stands.
    pub(super) fn shift(&mut self, gear: &GearDrive) {
        let [first, ..] = &mut self.masters;
        first.shift(gear.ratio);
        self.of_first = Divisor::new(gear.per_turn);
    }

    /// Increments of the drive of a spindle per turn.
    const fn per_turn(&self, spindle: TapSpindle) -> Divisor {
        match spindle {
            TapSpindle::First => self.of_first,
            _ => self.per_turn,
        }
    }

    /// From now on `spindle` gets a command in every period.
    pub(super) const fn select(&mut self, spindle: TapSpindle) {
        self.selected = spindle;
    }

    /// True while the selected spindle's drive is enabled.
    pub(super) const fn is_enabled(&self) -> bool {
        pick(&self.masters, self.selected).drive().is_enabled()
    }

    /// True where the drive of a spindle has reported the same position twice.
    pub(super) const fn rests(&self, spindle: TapSpindle) -> bool {
        pick(&self.masters, spindle).drive().has_told_the_same(2)
    }

    /// Begins position mode of a spindle at its present angle and returns this angle. A drive counts in 32 bits, so its
    /// count means many angles. For spindle 1 the angle nearest to the board's encoder (`observed`) is taken, for the
    /// others the angle nearest to the last command. `None` while the drive is not enabled or has not come to rest.
    pub(super) fn engage(&mut self, spindle: TapSpindle, observed: Turns) -> Option<Turns> {
        let told = pick_mut(&mut self.masters, spindle).engage()?;
        let near = match self.count(spindle) {
            None => increments(observed, self.of_first),
            Some(count) => *count,
        };
        let off = told.get().wrapping_sub(near as i32);
        let count = near.wrapping_add(i64::from(off));
        if let Some(last) = self.count(spindle) {
            *last = count;
        }
        let angle = angle(count, self.per_turn(spindle));
        if let Some(inverse) = &mut self.inverse {
            inverse.rest_at(angle);
        }
        Some(angle)
    }

    /// How far the drive of spindle 1 is beside its last target by its last status; `None` while it is not enabled.
    #[cold]
    #[inline(never)]
    pub(super) fn beside(&self) -> Option<Turns> {
        let drive = pick(&self.masters, TapSpindle::First).drive();
        let status = drive.status().filter(|_| drive.is_enabled())?;
        let off = status.actual.get().wrapping_sub(drive.target().get());
        Some(angle(off.into(), self.of_first))
    }

    /// Makes the frames of a period: the command to the selected spindle, and to the spindle that is served next.
    pub(super) fn tick(&mut self, spindle: Spindle, put: &mut impl FnMut(Frame)) {
        let demand = match spindle {
            Spindle::Speed(velocity) => SpindleDemand::Speed(velocity),
            Spindle::Angle(angle) => {
                let target = match &mut self.inverse {
                    None => angle,
                    Some(inverse) => inverse.angle(angle),
                };
                let count = increments(target, self.per_turn(self.selected));
                if let Some(last) = self.count(self.selected) {
                    *last = count;
                }
                SpindleDemand::Position(Increments::new(count as i32))
            }
        };
        let master = pick_mut(&mut self.masters, self.selected);
        master.tick(demand, put);
        if self.present > 1 {
            self.look_after_next(put);
        }
    }

    fn look_after_next(&mut self, put: &mut impl FnMut(Frame)) {
        let next = self.turn;
        self.turn = match next {
            TapSpindle::First => TapSpindle::Second,
            TapSpindle::Second => TapSpindle::Third,
            TapSpindle::Third => TapSpindle::Fourth,
            TapSpindle::Fourth => TapSpindle::First,
        };
        if next == self.selected || next.number() > self.present {
            return;
        }
        let master = pick_mut(&mut self.masters, next);
        master.tick(SpindleDemand::Speed(MilliRpm::STOPPED), put);
        master.drive_mut().skip(Periods::new(ROUND - 1));
    }

    /// The last commanded angle of a spindle without an encoder on the board.
    const fn count(&mut self, spindle: TapSpindle) -> Option<&mut i64> {
        let [second, third, fourth] = &mut self.counts;
        match spindle {
            TapSpindle::First => None,
            TapSpindle::Second => Some(second),
            TapSpindle::Third => Some(third),
            TapSpindle::Fourth => Some(fourth),
        }
    }
}

/// The angle of a count, to the nearest. It uses the reciprocal, because the tick calls it.
fn angle(count: i64, by: Divisor) -> Turns {
    // Whole turns rounded down, then the rest of a turn.
    let per_turn = by.get();
    let (turns, rest) = if count < 0 {
        let (turns, rest) = by.divide(!count as u64);
        (!(turns as i64), per_turn.wrapping_sub(1).wrapping_sub(rest))
    } else {
        let (turns, rest) = by.divide(count as u64);
        (turns as i64, rest)
    };
    let rest = (u64::from(rest) << 32).wrapping_add(u64::from(per_turn >> 1));
    let (part, _) = by.divide(rest);
    Turns::from_raw(turns.wrapping_shl(32).wrapping_add(part as i64))
}

/// The increment nearest to a spindle angle, not wrapped.
fn increments(angle: Turns, per_turn: Divisor) -> i64 {
    let wide = signed_product(angle.raw(), i64::from(per_turn.get()));
    (wide.wrapping_add(1 << 31) >> 32) as i64
}

const fn pick(masters: &[SpindleMaster; 4], spindle: TapSpindle) -> &SpindleMaster {
    let [first, second, third, fourth] = masters;
    match spindle {
        TapSpindle::First => first,
        TapSpindle::Second => second,
        TapSpindle::Third => third,
        TapSpindle::Fourth => fourth,
    }
}

const fn pick_mut(masters: &mut [SpindleMaster; 4], spindle: TapSpindle) -> &mut SpindleMaster {
    let [first, second, third, fourth] = masters;
    match spindle {
        TapSpindle::First => first,
        TapSpindle::Second => second,
        TapSpindle::Third => third,
        TapSpindle::Fourth => fourth,
    }
}
