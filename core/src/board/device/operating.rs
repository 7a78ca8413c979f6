//! How the machine is operated: its mode, its beat, and who moves it by hand.
//!
//! ```text
//! RPDO1 ─► order ─► (fresh?) ─► (does the mode let it in?) ─► command to the tick
//! RPDO2, 3, 4 ─► press, step, wheel ─► (fresh? whose? the mode?) ─► Asked, planned by the owner ─► tick
//! ```
//!
//! A refusal says why: in the event log, in 5002h:06 and in TPDO5. What is refused stays refused: the renewals of a refused
//! press move nothing, whatever the mode is by then.
//!
//! Must not know how an axis moves. The tick watches the deadline of a press by itself.

use super::mode::{Doing, Request, admit};
use super::steps::Steps;
use super::values::ObjectValues;
use super::wheel::WheelWay;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::board::guard::Guard;
use crate::bus::{Beat, BoardBeat, JogRequest, Order, Periods, StepRequest, WheelRequest};
use crate::call::Position;
use crate::cycle::Forbidden;
use crate::link::Event;
use crate::offsets::image::tip_of;
use crate::operating::{Interlock, Led, OperatingMode, PressState, Towards};
use crate::params::Params;
use crate::tick::{AxisEnd, Command, State, interlocked};
use crate::units::{Axes, Axis, Length, Rpm};
use crate::zones::Zones;

/// A step of this length or less is made whole, though nobody renews it.
const SHORT: Length = Length::from_nm(1_000_000);

/// What is asked of the axes, or of the spindle, by hand, before it is planned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Number of the press, as the board counts.
    pub number: u8,
    /// Which way X is to go.
    pub x: Option<Towards>,
    /// Which way Z is to go.
    pub z: Option<Towards>,
    /// At rapid.
    pub rapid: bool,
    /// Speed of the slide in mm/min; `None`: 9041. It means nothing where the spindle turns.
    pub speed: Option<u16>,
    /// How the spindle is to turn; at rest: not by this.
    pub spindle: Rpm,
    /// A step of this length; how far a handwheel has been turned since its claim.
    pub way: Option<Length>,
    /// A handwheel leads the axis.
    pub wheel: bool,
    /// The last tick in which the press is alive.
    pub until: Option<u32>,
    /// No press: back to where the program was left.
    pub returns: bool,
}

/// The mode, the beat and the presses.
#[derive(Debug, Default)]
pub struct Operating {
    mode: OperatingMode,
    /// The board's time since power-up.
    time_us: u64,
    /// The alarm for which the last request was refused.
    refused: Option<Code>,
    /// The count of the order that was told to be too old.
    told_old: Option<u8>,
    /// The session that moves, or has moved, the machine by hand; 0: nobody.
    session: u8,
    /// Its last press or step.
    press: u8,
    /// That press was not let in.
    denied: bool,
    /// The number of that press for the tick: presses of all sessions are counted on.
    number: u8,
    /// How long the axes have stood since.
    stood: Periods,
    steps: Steps,
    wheel: WheelWay,
    /// The last press is the claim of a wheel that leads a program.
    on_path: bool,
    /// 5002h:07: the next program, or the one under way, follows a handwheel.
    by_wheel: bool,
    asked: Option<Asked>,
    /// Where a program was left, until it goes on or another one is under way. The axes stand there when the tick first
    /// says so, for nobody moves them before.
    point: Option<Position>,
}

impl Operating {
    /// The mode.
    pub const fn mode(&self) -> OperatingMode {
        self.mode
    }

    /// The beat.
    pub const fn beat(&self) -> Beat {
        Beat::new((self.time_us / 1000) as u16)
    }

    /// Where a program was left last.
    pub const fn point(&self) -> Option<Position> {
        self.point
    }

    /// The next program, or the one under way, follows a handwheel.
    pub const fn by_wheel(&self) -> bool {
        self.by_wheel
    }

    /// No program follows a handwheel any more.
    pub const fn end_by_wheel(&mut self) {
        self.by_wheel = false;
    }

    /// How far a handwheel has been turned that leads a program, once.
    pub fn take_turned(&mut self) -> Option<Length> {
        if !self.on_path || !self.by_wheel {
            return None;
        }
        Some(self.wheel.take()).filter(|way| *way != Length::ZERO)
    }

    /// What is asked of the axes, once.
    pub const fn take(&mut self) -> Option<Asked> {
        self.asked.take()
    }

    /// A hold: axes that are about to go back to where a program was left stay.
    pub(super) fn hold_back(&mut self) {
        if self.asked.is_some_and(|asked| asked.returns) {
            self.forget();
        }
    }

    /// Nobody presses any more: what is asked and not planned is forgotten.
    const fn forget(&mut self) {
        self.asked = None;
        self.denied = true;
    }
}

impl ObjectValues {
    /// Lets time pass.
    pub(super) fn elapse(&mut self, by: Periods, params: &Params) {
        let us = u64::from(by.get()).saturating_mul(params.tick_us().into());
        let operating = &mut self.operating;
        operating.time_us = operating.time_us.wrapping_add(us);
        if self.snapshot.has_left {
            let here = self.snapshot.setpoint.position;
            operating.point.get_or_insert(here);
        } else if self.snapshot.in_program {
            operating.point = None;
        }
        // The tick has refused it: the machine was no more what the device had known of it.
        if operating.number == self.snapshot.jog.0
            && !operating.denied
            && let Some(code) = self.snapshot.jog_refused
        {
            operating.forget();
            operating.refused = Some(code);
        }
        if self.snapshot.state == State::ByHand || operating.asked.is_some() {
            operating.stood = Periods::new(0);
        } else {
            operating.stood = operating.stood.plus(by);
            operating.steps = Steps::default();
        }
    }

    /// TPDO5.
    pub(super) fn told_beat(&self) -> BoardBeat {
        let operating = &self.operating;
        BoardBeat {
            beat: operating.beat(),
            mode: operating.mode,
            session: operating.session,
            press: operating.press,
            state: self.press_state(),
            refused: operating.refused.map_or(0, Code::number),
        }
    }

    /// What became of the last press.
    fn press_state(&self) -> PressState {
        let operating = &self.operating;
        let (number, state) = self.snapshot.jog;
        if operating.session == 0 {
            PressState::None
        } else if operating.denied {
            PressState::Refused
        } else if operating.on_path {
            match operating.by_wheel {
                true => PressState::Runs,
                false => PressState::Ended,
            }
        } else if number == operating.number {
            state
        } else {
            // On its way to the tick.
            PressState::Runs
        }
    }

    /// An order of RPDO1 or 5000h that needs no echo, or whose echo is young enough. An old order is told once, and is not
    /// taken: its sender may give it again.
    pub(super) fn is_fresh(
        &mut self,
        (count, order): (u8, Order),
        echo: Option<Beat>,
        params: &Params,
    ) -> bool {
        let most = params.order_age_ms();
        let age = echo.and_then(|echo| self.operating.beat().age_of(echo));
        if most == 0 || !order.needs_echo() || age.is_some_and(|age| u32::from(age) <= most) {
            self.operating.told_old = None;
            return true;
        }
        if self.operating.told_old != Some(count) {
            self.operating.told_old = Some(count);
            self.deny(&Alarm::of(Code::OrderTooOld, &[]));
        }
        false
    }

    /// Refuses a request, in the event log and in 5002h:06.
    pub(super) fn deny(&mut self, alarm: &Alarm) {
        self.operating.refused = Some(alarm.code);
        self.log.push(self.tick, &Event::Warning(*alarm));
    }

    /// Asks the mode whether a request may come in.
    pub(super) fn let_in(&self, request: Request) -> Result<(), Alarm> {
        admit(self.operating.mode, request, Doing::of(&self.snapshot))
    }

    /// Lets a program begin, if every axis that it needs has its reference. The way out of a hole needs none: nothing else
    /// is let out of it.
    pub(super) fn let_in_referenced(&self) -> Result<(), Alarm> {
        let missing = self.snapshot.unreferenced;
        if missing.is_empty() || self.snapshot.tap.is_some_and(|tap| tap.in_hole) {
            return Ok(());
        }
        Err(not_referenced(missing))
    }

    /// A request has been let in.
    pub(super) const fn accept(&mut self) {
        self.operating.refused = None;
    }

    /// Changes the mode, which moves nothing and ends every press.
    pub(super) fn change_mode(&mut self, mode: OperatingMode) -> Result<(), Alarm> {
        if mode == self.operating.mode {
            return Ok(());
        }
        let now = self.operating.mode;
        let leaves = mode.by_hand() && now.runs();
        let request = match leaves || now.by_hand() && mode.runs() {
            true => Request::Leave,
            false => Request::Change,
        };
        self.let_in(request)?;
        self.end_press();
        if leaves && Doing::of(&self.snapshot) == Doing::Held {
            self.out_of_hole()?;
            self.command(Command::Leave);
        }
        self.operating.mode = mode;
        Ok(())
    }

    /// A held program goes on. One that was left first goes back to its point, and goes on by the next order.
    pub(super) fn resume(&mut self, params: &Params) -> Result<Command, Alarm> {
        self.let_in(Request::Resume)?;
        let snapshot = &self.snapshot;
        let Some(point) = self.operating.point.filter(|_| snapshot.has_left) else {
            let lost = self.operating.point.is_some() && !snapshot.in_program;
            // Where a hold is on, that is what it is for.
            if lost && !snapshot.operator.hold {
                return Err(Alarm::of(Code::WayBackLost, &[]));
            }
            if snapshot.takes_calls() {
                self.door_is_closed()?;
            }
            return Ok(Command::Resume);
        };
        if !self.operating.mode.runs() {
            return Ok(Command::Resume);
        }
        if snapshot.state != State::Held {
            return Err(Alarm::of(Code::NotAtRest, &[]));
        }
        self.door_is_closed()?;
        let here = snapshot.setpoint.position;
        if here == point {
            return Ok(Command::Return);
        }
        self.forbidden(params).hull(here, point)?;
        // Nobody presses: the axes go back by themselves.
        let operating = &mut self.operating;
        (operating.session, operating.denied) = (0, false);
        operating.number = operating.number.wrapping_add(1);
        operating.asked = Some(Asked {
            number: operating.number,
            // Which way each of them goes is known in the tick.
            x: Some(Towards::Plus),
            z: Some(Towards::Plus),
            rapid: true,
            returns: true,
            ..Asked::default()
        });
        // A feed hold by hand is over.
        Ok(Command::Resume)
    }

    /// Ends the press that is alive.
    pub(super) fn end_press(&mut self) {
        if self.operating.asked.is_some() {
            self.operating.forget();
        }
        self.command(Command::Release);
    }

    /// A press, its renewal or its release (RPDO2).
    pub(super) fn jog(&mut self, request: &JogRequest, params: &Params) {
        let Some(until) = self.deadline(request.echo, params) else {
            return;
        };
        let Some(is_new) = self.claim(request.session, request.press, params) else {
            return;
        };
        if request.is_release() {
            self.end_press();
            if is_new {
                self.bury(request.session, request.press);
            }
            return;
        }
        if is_new {
            let kind = match request.spindle {
                Some(_) => Request::Turn,
                None => Request::Jog,
            };
            let admitted = self
                .admit_by_hand(kind)
                .and_then(|()| self.off_limits(Axis::X, request.x))
                .and_then(|()| self.off_limits(Axis::Z, request.z));
            self.count_press(request.session, request.press, admitted);
        }
        if self.operating.denied {
            return;
        }
        self.operating.asked = Some(Asked {
            number: self.operating.number,
            x: request.x,
            z: request.z,
            rapid: request.rapid,
            speed: (request.speed != 0).then_some(request.speed),
            spindle: turns_of(request, params),
            until: Some(until),
            ..Asked::default()
        });
    }

    /// A release has overtaken its press: frames of that which come later renew a press that was not let in [D538]. A wheel
    /// that leads a program keeps its claim; no press is let in beside it.
    fn bury(&mut self, session: u8, press: u8) {
        let operating = &mut self.operating;
        if operating.on_path && operating.by_wheel {
            return;
        }
        (operating.session, operating.press) = (session, press);
        (operating.denied, operating.on_path) = (true, false);
        self.accept();
    }

    /// A step (RPDO3), or its renewal.
    pub(super) fn step(&mut self, request: &StepRequest, params: &Params) {
        let Some(until) = self.deadline(request.echo, params) else {
            return;
        };
        let Some(is_new) = self.claim(request.session, request.count, params) else {
            return;
        };
        // 0.1 µm are 100 nm; the way has 24 bits.
        let way = Length::from_nm(i64::from(request.way).saturating_mul(100));
        if is_new {
            let admitted = self.admit_by_hand(Request::Step).and_then(|()| {
                let axis = if request.on_z { Axis::Z } else { Axis::X };
                self.off_limits(axis, Some(Towards::of(way)))?;
                let position = &self.snapshot.setpoint.position;
                let forbidden = self.forbidden(params);
                self.operating.steps.admit(
                    request.on_z,
                    way,
                    position,
                    self.snapshot.referenced,
                    params,
                    &forbidden,
                )
            });
            self.count_press(request.session, request.count, admitted);
        }
        if self.operating.denied {
            return;
        }
        let towards = Towards::of(way);
        self.operating.asked = Some(Asked {
            number: self.operating.number,
            x: (!request.on_z).then_some(towards),
            z: request.on_z.then_some(towards),
            way: Some(way.abs()),
            until: (way.abs() > SHORT).then_some(until),
            ..Asked::default()
        });
    }

    /// A handwheel (RPDO4).
    pub(super) fn wheel(&mut self, request: &WheelRequest, params: &Params) {
        let Some(until) = self.deadline(request.echo, params) else {
            return;
        };
        let Some(is_new) = self.claim(request.session, request.claim, params) else {
            return;
        };
        if is_new {
            if request.leads == Led::Path {
                self.claim_path(request);
            } else {
                let admitted = self.admit_by_hand(Request::Wheel);
                self.count_press(request.session, request.claim, admitted);
            }
            self.operating.wheel = WheelWay::begin(request);
        }
        if self.operating.denied
            || !self.operating.wheel.turn(request, params)
            || request.leads == Led::Path
        {
            return;
        }
        self.operating.asked = Some(Asked {
            number: self.operating.number,
            x: (request.leads == Led::X).then_some(Towards::Plus),
            z: (request.leads == Led::Z).then_some(Towards::Plus),
            way: Some(self.operating.wheel.way()),
            wheel: true,
            until: Some(until),
            ..Asked::default()
        });
    }

    /// A new claim of a wheel that leads a program.
    fn claim_path(&mut self, request: &WheelRequest) {
        let operating = &mut self.operating;
        (operating.session, operating.press) = (request.session, request.claim);
        (operating.on_path, operating.denied) = (true, !operating.by_wheel);
        if operating.by_wheel {
            self.accept();
        } else {
            self.deny(&Alarm::of(Code::NothingFollows, &[]));
        }
    }

    /// What the tip of the tool in place has to keep out of. Nothing without the references of X and Z: where the tip is,
    /// nobody knows.
    pub(super) fn forbidden(&self, params: &Params) -> Forbidden {
        let number = self.in_place.number();
        let tip = tip_of(number, params, &self.offset_store.in_force);
        let mut forbidden = Forbidden::of(params, number, tip);
        let referenced = self.snapshot.referenced;
        if !referenced.contains(Axis::X) || !referenced.contains(Axis::Z) {
            forbidden.zones = Zones::default();
        }
        forbidden
    }

    /// The next program follows a handwheel, or does not.
    pub(super) fn set_by_wheel(&mut self, by_wheel: bool) -> Result<(), Alarm> {
        if self.snapshot.in_program {
            return Err(Alarm::of(Code::ProgramUnderWay, &[]));
        }
        self.operating.by_wheel = by_wheel;
        if self.operating.on_path {
            // What was turned while no program followed.
            self.operating.wheel.take();
        }
        self.command(Command::ByWheel(by_wheel));
        Ok(())
    }

    /// The last tick in which a frame with this echo moves anything; `None` for an echo that is too old or of the future.
    fn deadline(&self, echo: Beat, params: &Params) -> Option<u32> {
        let age = self.operating.beat().age_of(echo)?;
        let left_ms = params.dead_man_ms().checked_sub(age.into())?;
        let left = Periods::from_ms(left_ms, params.tick_us())?;
        // Ticks wrap.
        Some((self.tick as u32).wrapping_add(left.get()))
    }

    /// Whose turn it is: `Some(true)` for a new press, `Some(false)` for a renewal, `None` for a frame that does nothing.
    fn claim(&mut self, session: u8, press: u8, params: &Params) -> Option<bool> {
        let operating = &self.operating;
        if operating.session == session {
            let ahead = press.wrapping_sub(operating.press) as i8;
            return (ahead >= 0).then_some(ahead > 0);
        }
        let window = Periods::from_ms(params.dead_man_ms(), params.tick_us()).unwrap_or_default();
        if operating.session != 0 && operating.stood < window {
            if operating.refused != Some(Code::AnotherOperator) {
                self.deny(&Alarm::of(Code::AnotherOperator, &[]));
            }
            return None;
        }
        Some(true)
    }

    /// Nothing but the way out of its hole moves a tap.
    pub(super) fn out_of_hole(&self) -> Result<(), Alarm> {
        let refusal = Guard::of(self.snapshot.tap.as_ref()).refusal();
        refusal.map_or(Ok(()), Err)
    }

    /// A press that was let in may not have reached the tick: the machine stands, and is about to move.
    pub(super) fn is_about_to_move(&self) -> bool {
        let operating = &self.operating;
        let under_way = operating.number != self.snapshot.jog.0;
        operating.asked.is_some() || under_way && !operating.denied
    }

    /// What no mode lets in: a set of parameters that comes into force, a tap in its hole, a feed hold.
    fn admit_by_hand(&self, request: Request) -> Result<(), Alarm> {
        self.let_in(request)?;
        if self.is_changing() {
            return Err(Alarm::of(Code::NotAtRest, &[]));
        }
        self.out_of_hole()?;
        if let Some(interlock) = self.snapshot.interlocks.against_hand() {
            return Err(interlocked(interlock, Span::default()));
        }
        if self.snapshot.operator.hold || self.snapshot.contacts.hold {
            return Err(interlocked(Interlock::Hold, Span::default()));
        }
        Ok(())
    }

    /// An axis at its hard limit switch moves away from that only.
    fn off_limits(&self, axis: Axis, towards: Option<Towards>) -> Result<(), Alarm> {
        let end = towards.map(|towards| AxisEnd::new(axis, towards));
        match end.filter(|end| self.snapshot.hard_limits.contains(*end)) {
            Some(end) => Err(end.alarm()),
            None => Ok(()),
        }
    }

    /// No program moves an axis off its hard limit switch.
    pub(super) fn let_in_off_limits(&self) -> Result<(), Alarm> {
        let end = self.snapshot.hard_limits.first();
        match end.filter(|_| self.operating.mode == OperatingMode::Automatic) {
            Some(end) => Err(end.alarm()),
            None => Ok(()),
        }
    }

    /// Lets a program begin with the door closed and the work clamped. A line that was typed may close the chuck: the tick
    /// asks before the spindle turns.
    pub(super) fn let_in_guarded(&self) -> Result<(), Alarm> {
        let against = self.snapshot.interlocks.against_start();
        match against.filter(|_| self.operating.mode == OperatingMode::Automatic) {
            Some(interlock) => Err(interlocked(interlock, Span::default())),
            None => Ok(()),
        }
    }

    /// Nothing is resumed, and no reference is found, with the door open.
    pub(super) fn door_is_closed(&self) -> Result<(), Alarm> {
        match self.snapshot.interlocks.has_door() {
            true => Err(interlocked(Interlock::Door, Span::default())),
            false => Ok(()),
        }
    }

    /// A new press: refused or not, its renewals are no new ones.
    fn count_press(&mut self, session: u8, press: u8, admitted: Result<(), Alarm>) {
        let operating = &mut self.operating;
        (operating.session, operating.press) = (session, press);
        operating.denied = admitted.is_err();
        operating.on_path = false;
        match admitted {
            Ok(()) => {
                operating.number = operating.number.wrapping_add(1);
                self.accept();
            }
            Err(alarm) => self.deny(&alarm),
        }
    }
}

/// How a press is to turn the spindle.
fn turns_of(request: &JogRequest, params: &Params) -> Rpm {
    let rpm = match request.speed {
        0 => params.spindle_jog_rpm() as i32,
        speed => speed.into(),
    };
    match request.spindle {
        None => Rpm::STOPPED,
        Some(Towards::Plus) => Rpm::new(rpm),
        Some(Towards::Minus) => Rpm::new(rpm.saturating_neg()),
    }
}

/// What is asked needs the reference of these axes.
pub(super) fn not_referenced(missing: Axes) -> Alarm {
    let mut figures = [Arg::None; 3];
    for (figure, axis) in figures.iter_mut().zip(missing.each()) {
        *figure = Arg::Letter(axis.letter());
    }
    Alarm::of(Code::NotReferenced, &figures)
}
