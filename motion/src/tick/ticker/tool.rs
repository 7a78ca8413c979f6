//! T: somebody at the machine changes the tool, or a turret indexes to its station.
//!
//! A turret is asked where it stands, unclamped, turned until its code is that of the station, and clamped; then code and
//! clamp have to stay for a moment. No segment begins meanwhile. Must not know what a tool is.

use super::functions::Pending;
use super::{Ends, Ticker, emit};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::motion::Motion;
use crate::tick::Event;
use crate::tick::turret::ToolChange;

/// What is known of the tool that is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ToolIn {
    /// Nobody has said.
    Unknown,
    /// The tool of this station.
    Station(u8),
    /// Somebody has been asked for the tool of this station and has not pressed start yet.
    Asked(u8),
    /// The turret was stopped on its way: T first.
    Between,
}

/// For this part of a second code and clamp have to stay.
const SETTLED: u32 = 20;

/// What a turret does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Unclamping,
    Turning,
    Clamping,
}

/// A turret on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Indexing {
    station: u8,
    stage: Stage,
    /// Ticks that are left, and those since code and clamp have changed.
    left: u32,
    settled: u32,
    /// What the inputs told last.
    seen: (u8, bool),
    number: u32,
    span: Span,
}

/// The station of T as written: T0101 is 101.
const fn station_of(tool: u16) -> u8 {
    (tool / 100) as u8
}

impl Ticker {
    /// Why T cannot be carried out here.
    #[cold]
    #[inline(never)]
    pub(super) fn refuses_tool(&self, tool: u16, span: Span) -> Option<Alarm> {
        let changer = &self.given.changer;
        let station = station_of(tool);
        if changer.kind != ToolChange::Turret || station == 0 {
            return None;
        }
        if station > changer.stations {
            let figures = [station, changer.stations].map(|figure| Arg::Int(figure.into()));
            return Some(Alarm::new(Code::StationMissing, span).with(figures));
        }
        let axis = changer.in_the_way(self.executor.position())?;
        let args = [Arg::Letter(axis.letter())];
        Some(Alarm::new(Code::OutsideChange, span).with(args))
    }

    /// True where nothing may move before T: a turret stands between its stations.
    pub(super) const fn needs_tool(&self) -> bool {
        matches!(self.tool, ToolIn::Between)
    }

    /// Carries out T for the move `number`.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_tool(&mut self, tool: u16, number: u32, span: Span, ends: &mut Ends<'_>) {
        let changer = &self.given.changer;
        let station = station_of(tool);
        if station == 0 || changer.kind == ToolChange::None {
            return;
        }
        if changer.kind == ToolChange::ByHand {
            if self.tool != ToolIn::Station(station) {
                self.tool = ToolIn::Asked(station);
                let warning = Alarm::new(Code::ToolByHand, span).with([Arg::Int(station.into())]);
                emit(&mut ends.events, Event::Warning(warning));
                self.course.pause();
            }
            return;
        }
        let ticks = changer.time_ms.saturating_mul(self.given.second) / 1000;
        let here = self.turret_tells();
        // A turret that stands there already stays as it is, once that is sure.
        let stage = match self.tool != ToolIn::Between && here == Some((station, true)) {
            true => Stage::Clamping,
            false => Stage::Unclamping,
        };
        if stage == Stage::Unclamping {
            self.tool = ToolIn::Between;
            self.machine.drive(changer.unclamp, true);
        }
        self.function = Some(Pending::Turret(Indexing {
            station,
            stage,
            left: ticks,
            settled: 0,
            seen: here.unwrap_or_default(),
            number,
            span,
        }));
    }

    /// Station and clamp by the inputs; `None` where nobody has told them.
    fn turret_tells(&self) -> Option<(u8, bool)> {
        let changer = &self.given.changer;
        let on = self.machine.inputs(changer.inputs())?;
        Some((changer.station(on), changer.is_locked(on)))
    }

    /// Number and line of the T that still waits for its turret.
    pub(super) fn await_turret(
        &mut self,
        mut turret: Indexing,
        ends: &mut Ends<'_>,
    ) -> Option<(u32, u32, Motion)> {
        let changer = self.given.changer;
        let (number, line) = (turret.number, turret.span.line);
        let tells = self.turret_tells();
        let (code, locked) = tells.unwrap_or_default();
        turret.settled = match tells == Some(turret.seen) {
            true => turret.settled.saturating_add(1),
            false => 0,
        };
        turret.seen = (code, locked);
        let is_sure = turret.settled > self.given.second / SETTLED;
        let wanted = turret.station;
        let mut fault = None;
        match turret.stage {
            // Where no output unclamps it, turning does.
            Stage::Unclamping if !locked || changer.unclamp == 0 => {
                self.machine.drive(changer.index, true);
                turret.stage = Stage::Turning;
            }
            Stage::Turning if code == wanted => {
                self.machine.drive(changer.index | changer.unclamp, false);
                turret.stage = Stage::Clamping;
            }
            Stage::Clamping if is_sure && locked => {
                if code == wanted {
                    self.function = None;
                    self.tool = ToolIn::Station(wanted);
                    return None;
                }
                fault = Some(Code::WrongStation);
            }
            _ => {}
        }
        match turret.left.checked_sub(1) {
            Some(left) => turret.left = left,
            None if turret.stage == Stage::Clamping => fault = Some(Code::NotClamped),
            None => fault = Some(Code::TurretLate),
        }
        self.function = Some(Pending::Turret(turret));
        if let Some(fault) = fault {
            let figures = [wanted.into(), i64::from(code), changer.time_ms.into()].map(Arg::Int);
            self.raise(&Alarm::new(fault, turret.span).with(figures), ends);
        }
        Some((number, line, Motion::Wait))
    }

    /// The program is given up: a turret on its way stops where it is, and who was asked for a tool is asked again.
    pub(super) fn give_up_tool(&mut self, is_on_its_way: bool) {
        if is_on_its_way {
            let changer = self.given.changer;
            self.machine.drive(changer.index | changer.unclamp, false);
        }
        if let ToolIn::Asked(_) = self.tool {
            self.tool = ToolIn::Unknown;
        }
    }

    /// Start was pressed: the tool that was asked for is in.
    pub(super) const fn take_tool(&mut self) {
        if let ToolIn::Asked(station) = self.tool {
            self.tool = ToolIn::Station(station);
        }
    }
}
