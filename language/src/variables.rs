//! The variables of macro B: local, common and kept ones, and the door to those of the system.
//!
//! | number | lives |
//! |---|---|
//! | `#0` | nowhere: it is always null |
//! | `#1`–`#33` | as long as the macro that was called |
//! | `#100`–`#199` | as long as the program runs |
//! | `#200`–`#231` | as long as the program runs, on a GSK 980TD alone |
//! | `#500`–`#999` | for ever: [`Kept`] is what the caller stores |
//! | from `#1000` on | in the machine, behind [`System`] |
//!
//! This module must not know what a system variable means, nor where kept values are stored.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use crate::expression::Lookup;
use crate::value::Value;

/// The values of `#1` … `#33`.
pub type Locals = [Value; 33];

/// No local variable has a value.
pub const NO_LOCALS: Locals = [Value::Null; 33];

const COMMON: i64 = 100;
const COMMONS: usize = 100;
const REGISTERS: i64 = 200;
const REGISTER_COUNT: usize = 32;
const KEPT: i64 = 500;
const KEPTS: usize = 500;

/// The variables `#500` … `#999`, which outlive the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    values: Box<[Value; KEPTS]>,
}

impl Default for Kept {
    fn default() -> Self {
        Self {
            values: Box::new([Value::Null; KEPTS]),
        }
    }
}

impl Kept {
    /// Each variable that has a value: its number and the value, in the order of the numbers.
    pub fn values(&self) -> impl Iterator<Item = (u16, Value)> {
        let all = (KEPT as u16..).zip(self.values.iter().copied());
        all.filter(|(_, value)| !value.is_null())
    }

    /// Gives a variable its stored value; false where `number` is none of these variables.
    pub fn set(&mut self, number: u16, value: Value) -> bool {
        let place = place(i64::from(number), KEPT, KEPTS);
        place.is_some_and(|place| {
            self.values[place] = value;
            true
        })
    }
}

/// The index of a variable in its table.
fn place(number: i64, first: i64, count: usize) -> Option<usize> {
    let place = usize::try_from(number - first).ok()?;
    (place < count).then_some(place)
}

/// What came of writing a system variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Written {
    /// It has the value.
    Done,
    /// It can only be read.
    ReadOnly,
    /// There is no such variable here.
    Unknown,
    /// It cannot have this value; the alarm has no place yet.
    Refused(Alarm),
}

/// The variables of the machine: from `#1000` on, but `#3000` and `#3006`, which are statements.
pub trait System {
    /// The value of a variable; `None` where there is none.
    ///
    /// # Errors
    /// Its value cannot be known here; the alarm has no place yet.
    fn read(&mut self, number: u32) -> Result<Option<Value>, Alarm>;

    /// Gives a variable a value.
    fn write(&mut self, number: u32, value: Value) -> Written;
}

/// All variables of a program that runs.
#[derive(Clone, Debug)]
pub struct Variables {
    /// Those of the program, and of each macro that has been called and has not returned.
    locals: Vec<Locals>,
    common: Box<[Value; COMMONS]>,
    /// `#200` … `#231`, where the control has them.
    registers: Option<Box<[Value; REGISTER_COUNT]>>,
    kept: Kept,
}

impl Variables {
    /// Before the first statement.
    #[must_use]
    pub fn new(kept: Kept) -> Self {
        Self {
            locals: vec![NO_LOCALS],
            common: Box::new([Value::Null; COMMONS]),
            registers: None,
            kept,
        }
    }

    /// With `#200` … `#231` of a GSK 980TD.
    #[must_use]
    pub fn with_registers(mut self) -> Self {
        self.registers = Some(Box::new([Value::Null; REGISTER_COUNT]));
        self
    }

    /// The variables to store.
    #[must_use]
    pub const fn kept(&self) -> &Kept {
        &self.kept
    }

    /// A macro begins: it has local variables of its own.
    pub fn open(&mut self, arguments: &Locals) {
        self.locals.push(*arguments);
    }

    /// The macro that began last ends.
    pub fn close(&mut self) {
        if self.locals.len() > 1 {
            self.locals.pop();
        }
    }

    /// The place of a variable that is not the system's.
    fn slot(&mut self, number: i64) -> Option<&mut Value> {
        if let Some(place) = place(number, 1, NO_LOCALS.len()) {
            return self.locals.last_mut().map(|locals| &mut locals[place]);
        }
        if let Some(place) = place(number, COMMON, COMMONS) {
            return Some(&mut self.common[place]);
        }
        if let Some(place) = place(number, REGISTERS, REGISTER_COUNT) {
            return Some(&mut self.registers.as_mut()?[place]);
        }
        place(number, KEPT, KEPTS).map(|place| &mut self.kept.values[place])
    }
}

/// All variables, those of the system included.
#[derive(Debug)]
pub struct Scope<'a, S> {
    /// Those of the program.
    pub variables: &'a mut Variables,
    /// Those of the machine.
    pub system: &'a mut S,
}

/// The first number of a system variable.
const SYSTEM: i64 = 1000;

impl<S: System> Scope<'_, S> {
    /// Gives variable `#number`, written at `span`, a value.
    ///
    /// # Errors
    /// There is no such variable, or it can only be read.
    pub fn assign(&mut self, number: i64, value: Value, span: Span) -> Result<(), Alarm> {
        if let Some(slot) = self.variables.slot(number) {
            *slot = value;
            return Ok(());
        }
        let written = match u32::try_from(number) {
            Ok(0) => Written::ReadOnly,
            Ok(system) if number >= SYSTEM => self.system.write(system, value),
            _ => Written::Unknown,
        };
        match written {
            Written::Done => Ok(()),
            Written::ReadOnly => Err(blame(Code::VariableReadOnly, number, span)),
            Written::Unknown => Err(blame(Code::VariableNumber, number, span)),
            Written::Refused(alarm) => Err(Alarm { span, ..alarm }),
        }
    }
}

impl<S: System> Lookup for Scope<'_, S> {
    fn look_up(&mut self, number: i64, span: Span) -> Result<Value, Alarm> {
        if let Some(slot) = self.variables.slot(number) {
            return Ok(*slot);
        }
        let read = match u32::try_from(number) {
            Ok(0) => Some(Value::Null),
            Ok(system) if number >= SYSTEM => {
                let placed = |alarm| Alarm { span, ..alarm };
                self.system.read(system).map_err(placed)?
            }
            _ => None,
        };
        read.ok_or_else(|| blame(Code::VariableNumber, number, span))
    }
}

fn blame(code: Code, number: i64, span: Span) -> Alarm {
    Alarm::new(code, span).with([Arg::Int(number)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `#5001` can be read, `#3002` can be written.
    struct Two(f64);

    impl System for Two {
        fn read(&mut self, number: u32) -> Result<Option<Value>, Alarm> {
            Ok(matches!(number, 5001 | 3002).then_some(Value::Number(self.0)))
        }

        fn write(&mut self, number: u32, value: Value) -> Written {
            match number {
                3002 => {
                    self.0 = value.number();
                    Written::Done
                }
                5001 => Written::ReadOnly,
                _ => Written::Unknown,
            }
        }
    }

    #[test]
    fn each_number_is_a_variable_of_its_kind_or_refused() {
        let (mut variables, mut system) = (Variables::new(Kept::default()), Two(7.5));
        let span = Span::default();
        let one = Value::Number(1.0);
        for number in -1..6000 {
            let mut scope = Scope {
                variables: &mut variables,
                system: &mut system,
            };
            let expected = match number {
                0 | 5001 => Some(116),
                1..=33 | 100..=199 | 500..=999 | 3002 => None,
                _ => Some(115),
            };
            let refused = scope.assign(number, one, span).err();
            assert_eq!(refused.map(|alarm| alarm.number()), expected, "{number}");
            let readable = expected != Some(115);
            assert_eq!(scope.look_up(number, span).is_ok(), readable, "{number}");
        }
        assert_eq!(variables.kept().values().count(), 500);
        assert_eq!(variables.kept().values().next(), Some((500, one)));
    }

    #[test]
    fn a_macro_has_local_variables_of_its_own() {
        let (mut variables, mut system) = (Variables::new(Kept::default()), Two(0.0));
        let mut read = |variables: &mut Variables, number| {
            let mut scope = Scope {
                variables,
                system: &mut system,
            };
            let value = scope.look_up(number, Span::default()).unwrap();
            scope
                .assign(number, Value::Number(9.0), Span::default())
                .unwrap();
            value
        };
        let mut arguments = NO_LOCALS;
        arguments[2] = Value::Number(5.0);
        assert_eq!(read(&mut variables, 3), Value::Null);
        variables.open(&arguments);
        assert_eq!(read(&mut variables, 3), Value::Number(5.0));
        assert_eq!(read(&mut variables, 100), Value::Null);
        variables.close();
        assert_eq!(read(&mut variables, 3), Value::Number(9.0));
        assert_eq!(read(&mut variables, 100), Value::Number(9.0));
    }

    #[test]
    fn kept_values_come_back() {
        let mut kept = Kept::default();
        assert!(kept.set(500, Value::Number(1.5)) && kept.set(999, Value::Increments(3.0)));
        assert!(!kept.set(499, Value::Null) && !kept.set(1000, Value::Null));
        let mut again = Kept::default();
        for (number, value) in kept.values() {
            assert!(again.set(number, value));
        }
        assert_eq!(again, kept);
    }
}
