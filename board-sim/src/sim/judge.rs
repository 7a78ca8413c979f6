//! Judges each setpoint by the truth. A row waits here until the true angles at the instant of its effect are known.
//!
//! The truth comes from the plant only: nothing of it reaches the board.

use leadscrew_core::call::{TapAxis, TapSpindle};
use leadscrew_core::motion::{Helix, TapLine};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length, Turns};

use super::{CutPoint, Row, Sim, TapPoint};
use crate::plant::FineTurns;

/// The longest latency of a drive that a row can wait for, in ticks.
pub(super) const LATENCY_TICKS: usize = 128 + 64;

/// The number of kept truths: one for every SYNC that a row waits for, and one before an instant between two SYNCs.
pub(super) const TRUTHS: usize = LATENCY_TICKS + 2;

/// The truth at an instant: the angles of the spindles, and where the tools are on X and Z that have no ideal drives.
#[derive(Clone, Copy, Default)]
pub(super) struct Instant {
    pub(super) angles: [FineTurns; 4],
    pub(super) loads: [Option<Length>; 2],
}

impl Instant {
    /// The truth at `part` of `whole` between this and the next instant.
    fn towards(self, next: Self, part: u32, whole: u32) -> Self {
        let mut between = next;
        for (angle, before) in between.angles.iter_mut().zip(self.angles) {
            *angle = before.towards(*angle, part, whole);
        }
        for (load, before) in between.loads.iter_mut().zip(self.loads) {
            *load = load.zip(before).map(|(load, before)| {
                let way = (load - before).nm().saturating_mul(i64::from(part));
                let way = way.checked_div(i64::from(whole)).unwrap_or(0);
                before + Length::from_nm(way)
            });
        }
        between
    }
}

#[derive(Clone, Copy)]
pub(super) struct Pending {
    pub(super) row: Row,
    pub(super) law: Law,
    /// The number of turns by which the board's count is above the truth.
    pub(super) ahead: Turns,
}

/// The rule by which a row is judged.
#[derive(Clone, Copy)]
pub(super) enum Law {
    /// No axis follows a spindle.
    Free,
    /// The helix of a pass; true while the long axis follows it.
    Thread(Helix, bool),
    /// The line of a tap, and the spindle of this tap.
    Tap(TapLine, TapSpindle),
    /// The line of an ordinary tap. Its setpoint is meant for the angle of 5275 cycles later.
    Float(TapLine),
}

impl CutPoint {
    /// What a tool at `actual` cuts at this angle.
    fn of(law: &Law, actual: [Length; 2], angle: Turns) -> Option<Self> {
        let Law::Thread(helix, true) = law else {
            return None;
        };
        let [x, z] = actual;
        let at = if helix.long_x() { x } else { z };
        let exact = helix.at(angle);
        Some(Self {
            angle,
            error: at - exact,
            lead: helix.at(angle + Turns::ONE) - exact,
        })
    }
}

impl Law {
    /// True where X is the axis that follows the spindle.
    fn on_x(&self) -> bool {
        match self {
            Self::Free => false,
            Self::Thread(helix, _) => helix.long_x(),
            Self::Tap(line, _) | Self::Float(line) => line.gear.axis() == TapAxis::X,
        }
    }
}

/// Whole ticks, and the remainder in µs.
#[derive(Clone, Copy)]
pub(super) struct Delay {
    whole: usize,
    rest_us: u32,
}

impl Delay {
    pub(super) fn of(params: &Params, axis: Axis) -> Self {
        let (latency, tick_us) = (params.latency_us(axis), params.tick_us());
        Self {
            whole: latency.checked_div(tick_us).unwrap_or(0) as usize,
            rest_us: latency.checked_rem(tick_us).unwrap_or(0),
        }
    }

    /// The number of SYNCs from a tick to the first SYNC at which the truth of its row is known.
    const fn wait(self) -> usize {
        // With a remainder the instant lies between two SYNCs: the previous one and this one.
        let between = if self.rest_us == 0 { 0 } else { 1 };
        self.whole.saturating_add(1).saturating_add(between)
    }
}

impl Sim {
    /// The rule for the setpoint just made. The tick that ends a tap still belongs to the tap.
    pub(super) fn law(&mut self, locked: bool) -> Law {
        if let Some(line) = self.board.tap_line() {
            self.line = Some(Law::Tap(line, self.board.ticker().tap_spindle()));
        } else if let Some(line) = self.board.float_line() {
            self.line = Some(Law::Float(line));
        }
        match (self.board.helix(), self.line) {
            (Some(helix), _) => Law::Thread(helix, locked),
            (None, Some(line)) if locked => line,
            _ => Law::Free,
        }
    }

    /// The number of SYNCs that every row waits for: that of the slower drive.
    fn wait(&self) -> usize {
        let [x, z] = self.delays.map(Delay::wait);
        x.max(z).saturating_add(self.lag)
    }

    /// The number of turns by which the board's count is above the truth. Whole turns mean nothing, so they are
    /// subtracted. While an axis follows the spindle the number stays fixed: so a lost turn would show.
    pub(super) fn ahead(&mut self, locked: bool) -> Turns {
        let observer = self.board.ticker().observer();
        if !locked && observer.indexed() {
            let apart = observer.angle() - self.spindle_angle();
            let half = 1_i64 << 31;
            self.ahead = Turns::from_raw(apart.raw().wrapping_add(half) >> 32 << 32);
        }
        self.ahead
    }

    /// The row whose setpoint takes effect now, completed with the truth.
    pub(super) fn release(&mut self) -> Option<Row> {
        if self.pending.len() < self.wait() {
            return None;
        }
        self.complete()
    }

    /// The oldest row that waits, completed with the present truth.
    fn complete(&mut self) -> Option<Row> {
        let Pending {
            mut row,
            law,
            ahead,
        } = self.pending.pop_front()?;
        let [x, z] = self.delays;
        // Where an axis follows the spindle, the instant of this axis counts.
        let delay = if law.on_x() { x } else { z };
        let Instant { angles, loads } = self.truth(delay);
        let [first, second, third, fourth] = angles;
        row.spindle = first;
        if let [x, z] = loads
            && (x.is_some() || z.is_some())
        {
            let actual = [x.unwrap_or(row.position.x), z.unwrap_or(row.position.z)];
            row.actual = Some(actual);
            row.cut = CutPoint::of(&law, actual, first.turns() + ahead);
        }
        for (tapper, truth) in row.tappers.iter_mut().zip([second, third, fourth]) {
            tapper.truth = truth;
        }
        row.error = match law {
            Law::Free | Law::Thread(_, false) => None,
            Law::Thread(helix, true) => {
                let exact = helix.at(row.spindle.turns() + ahead);
                let actual = if law.on_x() {
                    row.position.x
                } else {
                    row.position.z
                };
                Some(actual - exact)
            }
            Law::Tap(line, spindle) => {
                let turned = row.angle(spindle);
                let angle = turned.set.unwrap_or(turned.truth.turns());
                let truth = turned.truth.near(angle, self.spindle_increments);
                row.tap = Some(TapPoint::new(&line, row.position, angle));
                Some(line.error(row.position, truth.turns()))
            }
            Law::Float(line) => {
                let meant = Delay {
                    whole: delay.whole.saturating_add(self.lag),
                    ..delay
                };
                let point = {
                    let angle = self.truth(meant).angles[0].turns() + ahead;
                    TapPoint::new(&line, row.position, angle)
                };
                row.tap = Some(point);
                Some(point.skew)
            }
        };
        Some(row)
    }

    /// The truth at the instant when the oldest row took effect, on an axis with this delay.
    fn truth(&self, delay: Delay) -> Instant {
        // The index counts back from the newest truth.
        let ago = self.wait().saturating_sub(delay.wait());
        let at = |ago| self.truths.iter().rev().nth(ago).copied();
        let now = at(ago).unwrap_or_default();
        if delay.rest_us == 0 {
            return now;
        }
        let earlier: Instant = at(ago.saturating_add(1)).unwrap_or_default();
        earlier.towards(now, delay.rest_us, self.tick_us)
    }

    /// Completes the rows that still wait for their truth: time goes on while the machine stands. Call this when the
    /// machine is not busy any more.
    pub fn last_rows(&mut self, mut each: impl FnMut(Row)) {
        // A machine that has run for less than the latency has a first row that is younger than the latency.
        for _ in self.pending.len()..self.wait() {
            self.advance();
        }
        while !self.pending.is_empty() {
            self.advance();
            if let Some(row) = self.complete() {
                each(row);
            }
        }
    }

    /// The true angle of spindle 1 at the last SYNC.
    #[must_use]
    pub fn spindle_angle(&self) -> Turns {
        let newest = self.truths.back().copied().unwrap_or_default();
        newest.angles[0].turns()
    }
}
