//! What each mode of the machine lets in: one table, without state.
//!
//! Must not know how a request comes, or how it is carried out. `docs/operating.md` has the table for people.

use crate::alarm::{Alarm, Arg, Code};
use crate::operating::OperatingMode;
use crate::tick::{Outcome, Snapshot, State};

/// What somebody asks of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Move axes while a press is alive.
    Jog,
    /// Move an axis by a length.
    Step,
    /// Lead an axis by handwheel.
    Wheel,
    /// Turn the spindle while a press is alive.
    Turn,
    /// Find the reference.
    Home,
    /// Begin the program, or the line.
    Run,
    /// Go on after a hold.
    Resume,
    /// Change the mode.
    Change,
    /// Change it between one by hand and one for programs.
    Leave,
    /// Write offsets and tools, or mark where an axis stands for a touch.
    Offsets,
}

/// What the machine is doing, as far as a request has to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// The drives are up, and nothing moves or is about to.
    Nothing,
    /// The drives are being enabled.
    Starting,
    /// Axes are moved by hand.
    ByHand,
    /// Axes find their reference.
    Homing,
    /// A program is under way.
    Program,
    /// A program is held.
    Held,
    /// A held program has been left, and its axes may be moved by hand.
    Left,
    /// Coming to rest after a reset.
    Stopping,
    /// Coming to rest on an alarm.
    Failing,
    /// Standing on an alarm.
    Alarm,
}

impl Doing {
    /// What the machine was doing at this instant.
    pub const fn of(snapshot: &Snapshot) -> Self {
        match snapshot.state {
            State::Starting => Self::Starting,
            State::Idle if snapshot.in_program => Self::Program,
            State::Idle => Self::Nothing,
            State::Running => Self::Program,
            State::Held | State::ByHand if snapshot.has_left => Self::Left,
            State::Held => Self::Held,
            State::ByHand => Self::ByHand,
            State::Homing => Self::Homing,
            State::Stopping(Outcome::Reset) => Self::Stopping,
            State::Stopping(Outcome::Alarm(_)) => Self::Failing,
            State::Alarm(_) => Self::Alarm,
        }
    }
}

/// Lets a request in, or says why not.
///
/// # Errors
/// [`Code::WrongMode`], [`Code::ProgramUnderWay`], [`Code::OffsetsAtWork`], [`Code::AlarmStands`], [`Code::NotAtRest`].
pub fn admit(mode: OperatingMode, request: Request, doing: Doing) -> Result<(), Alarm> {
    use OperatingMode::{Automatic, Manual, Reference, Step, Wheel};
    let needed = match request {
        Request::Jog | Request::Turn => Manual,
        Request::Step => Step,
        Request::Wheel => Wheel,
        Request::Home => Reference,
        Request::Run if mode.runs() => mode,
        Request::Run => Automatic,
        // In every mode but one.
        Request::Offsets if mode == Reference => Manual,
        Request::Resume | Request::Change | Request::Leave | Request::Offsets => mode,
    };
    let refusal = match (request, doing) {
        (Request::Resume, _) => return Ok(()),
        (
            Request::Change | Request::Leave,
            Doing::Nothing | Doing::Starting | Doing::ByHand | Doing::Alarm,
        )
        | (Request::Leave, Doing::Held | Doing::Left) => return Ok(()),
        (Request::Offsets, Doing::Program | Doing::Held | Doing::Left) => Code::OffsetsAtWork,
        (Request::Jog | Request::Step | Request::Wheel, Doing::Left) if needed == mode => {
            return Ok(());
        }
        (Request::Jog | Request::Step | Request::Wheel, Doing::Left) => {
            return Err(wrong(needed, mode));
        }
        (_, Doing::Program | Doing::Held | Doing::Left) => Code::ProgramUnderWay,
        (Request::Offsets, Doing::Failing) => Code::NotAtRest,
        // A table moves nothing: neither an alarm nor drives that are off keep it from being written [D315].
        (Request::Offsets, Doing::Starting | Doing::Alarm) if needed == mode => return Ok(()),
        (Request::Offsets, Doing::Starting | Doing::Alarm) => return Err(wrong(needed, mode)),
        (_, Doing::Failing | Doing::Alarm) => Code::AlarmStands,
        (_, Doing::Starting | Doing::Stopping | Doing::Homing) => Code::NotAtRest,
        (_, _) if needed != mode => return Err(wrong(needed, mode)),
        // The next press, step or claim may come while the last one comes to rest.
        (Request::Jog | Request::Step | Request::Wheel | Request::Turn, Doing::ByHand)
        | (_, Doing::Nothing) => return Ok(()),
        (_, Doing::ByHand) => Code::NotAtRest,
    };
    Err(Alarm::of(refusal, &[]))
}

fn wrong(needed: OperatingMode, mode: OperatingMode) -> Alarm {
    Alarm::of(Code::WrongMode, &[Arg::Mode(needed), Arg::Mode(mode)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const REQUESTS: [Request; 10] = [
        Request::Jog,
        Request::Step,
        Request::Wheel,
        Request::Home,
        Request::Run,
        Request::Resume,
        Request::Change,
        Request::Leave,
        Request::Offsets,
        Request::Turn,
    ];

    fn answer(mode: OperatingMode, request: Request, doing: Doing) -> u16 {
        admit(mode, request, doing).map_or_else(|alarm| alarm.number(), |()| 0)
    }

    /// Columns: jog, step, wheel, home, run, resume, change, leave, offsets, turn.
    #[test]
    fn the_table_at_rest() {
        use OperatingMode::{Automatic, Manual, Mdi, Reference, Step, Wheel};
        for (mode, wanted) in [
            (Manual, [0, 4501, 4501, 4501, 4501, 0, 0, 0, 0, 0]),
            (Step, [4501, 0, 4501, 4501, 4501, 0, 0, 0, 0, 4501]),
            (Wheel, [4501, 4501, 0, 4501, 4501, 0, 0, 0, 0, 4501]),
            (Reference, [4501, 4501, 4501, 0, 4501, 0, 0, 0, 4501, 4501]),
            (Mdi, [4501, 4501, 4501, 4501, 0, 0, 0, 0, 0, 4501]),
            (Automatic, [4501, 4501, 4501, 4501, 0, 0, 0, 0, 0, 4501]),
        ] {
            let told = REQUESTS.map(|request| answer(mode, request, Doing::Nothing));
            assert_eq!(told, wanted, "{mode:?}");
        }
    }

    #[test]
    fn the_table_while_something_goes_on() {
        use OperatingMode::{Automatic, Manual};
        for (doing, by_hand, by_program) in [
            (
                Doing::Program,
                [4502, 4502, 4502, 4502, 4502, 0, 4502, 4502, 4580, 4502],
                [4502, 4502, 4502, 4502, 4502, 0, 4502, 4502, 4580, 4502],
            ),
            (
                Doing::Held,
                [4502, 4502, 4502, 4502, 4502, 0, 4502, 0, 4580, 4502],
                [4502, 4502, 4502, 4502, 4502, 0, 4502, 0, 4580, 4502],
            ),
            (
                Doing::Left,
                [0, 4501, 4501, 4502, 4502, 0, 4502, 0, 4580, 4502],
                [4501, 4501, 4501, 4502, 4502, 0, 4502, 0, 4580, 4502],
            ),
            (
                Doing::ByHand,
                [0, 4501, 4501, 4501, 4501, 0, 0, 0, 4507, 0],
                [4501, 4501, 4501, 4501, 4507, 0, 0, 0, 4507, 4501],
            ),
            (
                Doing::Starting,
                [4507, 4507, 4507, 4507, 4507, 0, 0, 0, 0, 4507],
                [4507, 4507, 4507, 4507, 4507, 0, 0, 0, 0, 4507],
            ),
            (
                Doing::Homing,
                [4507, 4507, 4507, 4507, 4507, 0, 4507, 4507, 4507, 4507],
                [4507, 4507, 4507, 4507, 4507, 0, 4507, 4507, 4507, 4507],
            ),
            (
                Doing::Stopping,
                [4507, 4507, 4507, 4507, 4507, 0, 4507, 4507, 4507, 4507],
                [4507, 4507, 4507, 4507, 4507, 0, 4507, 4507, 4507, 4507],
            ),
            (
                Doing::Failing,
                [4504, 4504, 4504, 4504, 4504, 0, 4504, 4504, 4507, 4504],
                [4504, 4504, 4504, 4504, 4504, 0, 4504, 4504, 4507, 4504],
            ),
            (
                Doing::Alarm,
                [4504, 4504, 4504, 4504, 4504, 0, 0, 0, 0, 4504],
                [4504, 4504, 4504, 4504, 4504, 0, 0, 0, 0, 4504],
            ),
        ] {
            let told = |mode| REQUESTS.map(|request| answer(mode, request, doing));
            assert_eq!(told(Manual), by_hand, "{doing:?}");
            assert_eq!(told(Automatic), by_program, "{doing:?}");
        }
    }

    #[test]
    fn offsets_are_not_written_in_the_mode_that_finds_the_reference() {
        for (doing, wanted) in [
            (Doing::Nothing, 4501),
            (Doing::Starting, 4501),
            (Doing::Alarm, 4501),
            (Doing::Homing, 4507),
            (Doing::Program, 4580),
        ] {
            let told = answer(OperatingMode::Reference, Request::Offsets, doing);
            assert_eq!(told, wanted, "{doing:?}");
        }
    }

    #[test]
    fn a_refusal_names_both_modes() {
        let alarm = admit(OperatingMode::Mdi, Request::Jog, Doing::Nothing).unwrap_err();
        assert_eq!(
            alarm.args[..2],
            [
                Arg::Mode(OperatingMode::Manual),
                Arg::Mode(OperatingMode::Mdi)
            ]
        );
    }
}
