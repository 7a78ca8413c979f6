//! System variables: what a macro may ask of the program's state.

use leadscrew_core::alarm::Span;
use leadscrew_core::call::FeedRate;
use leadscrew_core::program::InForce;
use leadscrew_core::units::Length;

use super::{Acting, Core};
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
    pub(super) fn system(&self, number: u32) -> Option<Value> {
        let now = self.interpreter.in_force();
        let at = self.interpreter.position();
        let (x, z, c) = (at.x, at.z, at.c.udeg());
        let zero = now.origin;
        let number = match number {
            4001 => now.motion.into(),
            4002 => 97.0 - f64::from(u8::from(now.surface.is_some())),
            4005 => 98.0 + f64::from(u8::from(now.per_turn)),
            4007 => self.path.code().into(),
            4006 => 21.0 - f64::from(u8::from(self.interpreter.is_inch())),
            4014 => now.system.into(),
            4016 => now.plane.into(),
            4109 => return Some(self.feed(&now).map_or(Value::Null, Value::Number)),
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
            _ => return Datum::of(number).map(|datum| Value::Number(self.datum(datum))),
        };
        Some(Value::Number(number))
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

impl System for Acting<'_, '_> {
    fn read(&mut self, number: u32) -> Option<Value> {
        self.core.system(number)
    }

    fn write(&mut self, number: u32, value: Value) -> Written {
        if let Some(datum) = Datum::of(number) {
            return self.core.write_datum(datum, value);
        }
        match self.core.system(number) {
            Some(_) => Written::ReadOnly,
            None => Written::Unknown,
        }
    }
}
