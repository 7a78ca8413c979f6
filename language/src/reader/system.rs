//! System variables: what a macro may ask of the program's state.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::call::FeedRate;
use leadscrew_core::program::InForce;
use leadscrew_core::units::Length;

use super::{Acting, Core};
use crate::flow::Modes;
use crate::value::Value;
use crate::variables::{System, Written};
use crate::word::{Given, Word};

impl Core<'_> {
    /// A length in the unit in force.
    fn shown(&self, length: Length) -> f64 {
        let unit = if self.interpreter.is_inch() {
            25_400_000.0
        } else {
            1_000_000.0
        };
        length.nm() as f64 / unit
    }

    /// F as it would be written.
    fn feed(&self, now: &InForce) -> Option<f64> {
        Some(match now.feed? {
            FeedRate::PerMinute(feed) => self.shown(Length::from_nm(feed.nm_per_min())),
            FeedRate::PerTurn(feed, _) => self.shown(Length::from_nm(feed.nm())),
        })
    }

    /// The value of a system variable.
    ///
    /// # Errors
    /// It is known on the machine alone, or this control has no such code.
    pub(super) fn system(&self, number: u32, modes: Modes) -> Result<Option<Value>, Alarm> {
        if let Some(code) = elsewhere(number) {
            return Err(unknown(code, number));
        }
        let now = self.interpreter.in_force();
        let at = self.interpreter.position();
        let (x, z, c) = (at.x, at.z, at.c.udeg());
        let zero = now.origin;
        let number = match number {
            INHIBIT_STEPS | INHIBIT_HOLDS => 0.0,
            4001..=4021 => {
                let code = self.modal_code(number - 4000, &now, modes);
                return match code {
                    Some(code) => Ok(Some(Value::Number(code))),
                    None => Err(unknown(Code::GroupVariable, number)),
                };
            }
            4102 | 4107 | 4108 | 4111 | 4130 => return Err(unknown(Code::GroupVariable, number)),
            4109 => return Ok(Some(self.feed(&now).map_or(Value::Null, Value::Number))),
            4113 => return Ok(Some(now.m.map_or(Value::Null, |m| Value::Number(m.into())))),
            4114 => self.interpreter.sequence_number().unwrap_or(0).into(),
            4115 => self.interpreter.program_number().unwrap_or(0).into(),
            4119 => match now.surface {
                // Metres or feet a minute.
                Some(speed) => {
                    self.shown(Length::from_nm(speed.nm_per_min()))
                        / if self.interpreter.is_inch() {
                            12.0
                        } else {
                            1000.0
                        }
                }
                None => now.speed.into(),
            },
            4120 => self.tool.unwrap_or(0).into(),
            // What comes next is read after the board has got there, so the present place is that of the block's end.
            5001 | 5041 => self.shown(x - zero.x) * 2.0,
            5002 | 5042 => self.shown(z - zero.z),
            5003 | 5043 => (c - zero.c.udeg()) as f64 / 1e6,
            5021 => self.shown(x) * 2.0,
            5022 => self.shown(z),
            5023 => c as f64 / 1e6,
            // The table has no wear of a radius.
            2201..=2232 => 0.0,
            _ => return Ok(Datum::of(number).map(|datum| Value::Number(self.datum(datum)))),
        };
        Ok(Some(Value::Number(number)))
    }

    /// The code of a group that is in force, as the control writes it; `None` where it has no such group.
    fn modal_code(&self, group: u32, now: &InForce, modes: Modes) -> Option<f64> {
        let control = self.control;
        let either = |of: bool, yes: u8, no: u8| if of { yes } else { no };
        let others = !control.is_gsk();
        // A Haas numbers its groups otherwise; these four are the same.
        if control == crate::dialect::Control::Haas && !matches!(group, 1 | 6 | 7 | 15) {
            return None;
        }
        let code = match group {
            1 => now.motion,
            2 => either(now.surface.is_some(), 96, 97),
            // G90 and G94 of system A are cycles, of group 01.
            3 if control.has_system_b() => {
                return Some(either(modes.incremental, 91, 90).into());
            }
            // What these controls may end, and this machine does not have [D442].
            4 if others => 69,
            5 => either(now.per_turn, 99, 98),
            6 => either(self.interpreter.is_inch(), 20, 21),
            7 => return Some(self.path.code().into()),
            8 if others => 25,
            9 if others => 23,
            10 => match &self.drill {
                Some((drill, _)) => return drill.kind.code()[1..].parse().ok(),
                None => now.tap_cycle.unwrap_or(80),
            },
            11 if control.has_system_b() => {
                return Some(either(modes.returns_to_r, 99, 98).into());
            }
            12 => either(modes.calls, 66, 67),
            14 => now.system,
            15 => either(now.exact_stop, 61, 64),
            16 => now.plane,
            21 if others => return Some(13.1),
            _ => return None,
        };
        Some(control.written(code.into()) as f64)
    }

    /// A value of the table of offsets.
    fn datum(&self, datum: Datum) -> f64 {
        let offsets = self.interpreter.offsets();
        let of_axis = |[x, z]: [Length; 2]| match datum.letter {
            b'X' => self.shown(x) * 2.0,
            _ => self.shown(z),
        };
        match (datum.place, datum.letter) {
            (Place::Geometry(number), b'R') => self.shown(offsets.nose(number).radius),
            (Place::Geometry(number), b'Q') => offsets.nose(number).tip.into(),
            (Place::Geometry(number), _) => of_axis(offsets.geometry(number)),
            (Place::Wear(number), _) => of_axis(offsets.wear(number)),
            (Place::Shift, _) => of_axis(offsets.shift()),
            (Place::Work(system), _) => of_axis(offsets.work(system)),
        }
    }

    /// Writes such a value, as a block with G10 does.
    fn write_datum(&mut self, datum: Datum, value: Value) -> Written {
        let (l, p) = match datum.place {
            Place::Shift => (None, 0),
            Place::Work(system) => (Some(2), u32::from(system) + 1),
            Place::Wear(number) => (None, number.into()),
            Place::Geometry(number) => (None, 10_000 + u32::from(number)),
        };
        let word = |letter, value| Word {
            letter,
            given: Given::Calculated(value),
            variable: None,
            // Any place: column 0 is none.
            span: Span {
                line: 0,
                column: 1,
                end: 2,
            },
        };
        let number = |letter, number: u32| word(letter, Value::Number(number.into()));
        let mut words = vec![number(b'G', 10), number(b'P', p), word(datum.letter, value)];
        words.extend(l.map(|l| number(b'L', l)));
        let numbers: Vec<_> = self.numbers(&words).collect();
        // Nothing else is in such a block, and it makes no call.
        match self.interpreter.words(0, numbers, &mut |_| {}) {
            Ok(()) => Written::Done,
            Err(alarm) => Written::Refused(alarm),
        }
    }
}

/// What a variable stands for in the table of offsets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Datum {
    place: Place,
    /// The word of G10 that writes it.
    letter: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Shift,
    /// From 0.
    Work(u8),
    Wear(u8),
    Geometry(u8),
}

impl Datum {
    fn of(number: u32) -> Option<Self> {
        let tool = (number % 100) as u8;
        let (place, letter) = match number {
            2001..=2032 => (Place::Wear(tool), b'X'),
            2101..=2132 => (Place::Wear(tool), b'Z'),
            2301..=2332 => (Place::Geometry(tool), b'Q'),
            2701..=2732 => (Place::Geometry(tool), b'X'),
            2801..=2832 => (Place::Geometry(tool), b'Z'),
            2901..=2932 => (Place::Geometry(tool), b'R'),
            5201 => (Place::Shift, b'X'),
            5202 => (Place::Shift, b'Z'),
            5221..=5322 => {
                let (system, axis) = ((number - 5221) / 20, (number - 5221) % 20);
                let letter = match axis {
                    0 => b'X',
                    1 => b'Z',
                    _ => return None,
                };
                (Place::Work(system as u8), letter)
            }
            _ => return None,
        };
        Some(Self { place, letter })
    }
}

/// Single block, and feed hold, override and exact stop, as a program may take them from the operator.
const INHIBIT_STEPS: u32 = 3003;
const INHIBIT_HOLDS: u32 = 3004;

/// Why a variable has no value where the text is.
const fn elsewhere(number: u32) -> Option<Code> {
    Some(match number {
        3001 | 3002 | 3011 | 3012 => Code::ClockVariable,
        3901 | 3902 => Code::PartsVariable,
        1000..=1135 => Code::SignalVariable,
        _ => return None,
    })
}

/// The alarm of a variable, which gets its place from who asks for it.
fn unknown(code: Code, number: u32) -> Alarm {
    Alarm::new(code, Span::default()).with([Arg::Int(number.into())])
}

impl System for Acting<'_, '_> {
    fn read(&mut self, number: u32) -> Result<Option<Value>, Alarm> {
        self.core.system(number, self.modes)
    }

    fn write(&mut self, number: u32, value: Value) -> Written {
        if let Some(datum) = Datum::of(number) {
            return self.core.write_datum(datum, value);
        }
        if let INHIBIT_STEPS | INHIBIT_HOLDS = number {
            return match value.whole() {
                Some(0) => Written::Done,
                _ => Written::Refused(unknown(Code::InhibitVariable, number)),
            };
        }
        if let Some(code) = elsewhere(number) {
            return Written::Refused(unknown(code, number));
        }
        match self.core.system(number, self.modes) {
            Ok(None) => Written::Unknown,
            Ok(Some(_)) | Err(_) => Written::ReadOnly,
        }
    }
}
