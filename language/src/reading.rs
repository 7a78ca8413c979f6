//! For tests: machines with parameters of their own, and programs from their text to what they do.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::program::{Event, Options};

use crate::dialect::Control;
use crate::flow::{Rules, Trouble};
use crate::reader::Reader;
use crate::variables::Kept;

/// What a program does, and the alarm that ends it.
pub(crate) type Outcome = (Vec<Event>, Option<Alarm>);

/// A set with some parameters changed, each by its key or number.
pub(crate) fn with(mut params: Params, sets: &[(&str, i64)]) -> Params {
    for (key, raw) in sets {
        let entry = Entry::find_text(key).expect("the parameter exists");
        params.set(entry, *raw).expect("within its range");
    }
    params
}

/// Reads a program to its end or its alarm.
pub(crate) fn read(text: &str, params: &Params, options: Options, rules: Rules) -> Outcome {
    let mut events = Vec::new();
    let mut reader = Reader::new(text.as_bytes(), params, options, Kept::default(), rules);
    while !reader.is_over() {
        match reader.step(&mut |event| events.push(event)) {
            Ok(()) => {}
            Err(Trouble::Alarm(alarm)) => return (events, Some(alarm)),
            Err(Trouble::Unreadable(error)) => panic!("{error}"),
        }
    }
    (events, None)
}

/// The same for a control, with `;` between the lines.
pub(crate) fn read_on(params: &Params, control: Control, text: &str) -> Outcome {
    let rules = Rules {
        control,
        ..Rules::default()
    };
    let text = text.replace(';', "\n");
    read(&text, params, Options::default(), rules)
}
