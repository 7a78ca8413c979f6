//! Programs with macros, jumps and calls: read from the whole text, and from a text that gives a few bytes at a time.

use std::io;

use leadscrew_core::alarm::Alarm;
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::program::{Event, Events, Options};
use leadscrew_language::dialect::Control;
use leadscrew_language::flow::{Passes, Rules, Trouble};
use leadscrew_language::lines::{Lines, Place, Source};
use leadscrew_language::outline::behind_leader;
use leadscrew_language::reader::Reader;
use leadscrew_language::text::{Glance, glance};
use leadscrew_language::value::Value;
use leadscrew_language::variables::Kept;

/// Statements without a motion until a loop is given up.
const BUDGET: u32 = 300;

/// Steps of one program that are looked at; a loop with motions may go on for ever.
const STEPS: u32 = 3000;

/// Gives a few bytes at a time.
struct Slow<'t>(&'t [u8], usize);

impl Source for Slow<'_> {
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let most = buffer.len().min(self.1);
        self.0.read(at, &mut buffer[..most])
    }
}

/// The first byte chooses the dialect, what numbers without a point are, the block skip, the repeat and the pieces of the
/// text. The rest is text.
///
/// # Panics
/// Where the pieces change the result, an alarm stands outside of the text, a variable is no number, a program does not
/// end, or one that has nothing to calculate is another program than to the core alone.
pub fn language(data: &[u8]) {
    let Some((choice, text)) = data.split_first() else {
        return;
    };
    let mut params = Params::sheets();
    if choice >> 4 > 10 {
        // Numbers without a point count increments.
        let entry = Entry::find_text("3401.0").expect("the parameter exists");
        params.set(entry, 0).expect("within its range");
    }
    let control = match choice & 1 {
        0 => Control::Gsk980td,
        _ => Control::ALL[1 + usize::from(choice >> 4) % 5],
    };
    let options = Options {
        dialect: control.family(),
        skip: choice & 2 != 0,
        optional_stop: choice & 4 != 0,
        ..Options::default()
    };
    let rules = Rules {
        control,
        passes: if choice & 8 == 0 {
            Passes::Once
        } else {
            Passes::UntilStopped
        },
        budget: BUDGET,
        turns: STEPS / 2,
        ..Rules::default()
    };
    let whole = read(text, &params, options, rules);
    let size = usize::from(choice >> 4) + 1;
    let again = read(Slow(text, size), &params, options, rules);
    assert_eq!(whole, again, "pieces make a difference");
    let (events, end) = whole;
    for event in &events {
        if let Event::Warning(warning) = event {
            lies_within(warning, text);
        }
    }
    if let Some(alarm) = &end {
        lies_within(alarm, text);
    }
    if control.is_gsk()
        && params.whole_units()
        && is_plain(text)
        && events.len() < STEPS as usize / 2
    {
        let mut alone = Vec::new();
        let mut alarm = None;
        for event in Events::new(text, &params, options) {
            match event {
                Ok(event) => alone.push(event),
                Err(error) => alarm = Some(error),
            }
        }
        assert_eq!(
            (events, end),
            (alone, alarm),
            "the core alone reads it otherwise"
        );
    }
}

fn read(
    source: impl Source,
    params: &Params,
    options: Options,
    rules: Rules,
) -> (Vec<Event>, Option<Alarm>) {
    let mut events = Vec::new();
    let mut kept = Kept::default();
    kept.set(500, Value::Number(1.5));
    let mut reader = Reader::new(source, params, options, kept, rules);
    let mut end = None;
    for _ in 0..STEPS {
        if reader.is_over() {
            break;
        }
        match reader.step(&mut |event| events.push(event)) {
            Ok(()) => {}
            Err(Trouble::Alarm(alarm)) => end = Some(alarm),
            Err(Trouble::Unreadable(error)) => panic!("{error}"),
        }
    }
    assert!(
        end.is_none() || reader.is_over(),
        "it goes on after {end:?}"
    );
    for (number, value) in reader.variables().kept().values() {
        assert!(value.number().is_finite(), "#{number} is {value:?}");
    }
    (events, end)
}

/// True for a text without a leader in which no line has anything that the core does not read.
fn is_plain(text: &[u8]) -> bool {
    let front = behind_leader(&mut Lines::new(text), Place::START);
    if !matches!(front, Ok(Place::START)) {
        return false;
    }
    let mut depth = 0;
    let mut lines = text.split(|byte| *byte == b'\n');
    let short = text
        .split(|byte| *byte == b'\n')
        .all(|line| line.len() < 1000);
    // A return within a line is refused by both, in front of a `%` at another column.
    let inside = |line: &[u8]| matches!(line, [front @ .., _] if front.contains(&b'\r'));
    let returns = text.split(|byte| *byte == b'\n').any(inside);
    short && !returns && lines.all(|line| glance(line, &mut depth) == Glance::Plain(line.len()))
}

/// An alarm must name an existing line and columns in order.
fn lies_within(alarm: &Alarm, text: &[u8]) {
    let lines = text.iter().filter(|byte| **byte == b'\n').count() + 1;
    let span = alarm.span;
    assert!(span.line as usize <= lines, "{alarm:?} of {lines} lines");
    assert!(span.column <= span.end, "{alarm:?}");
}
