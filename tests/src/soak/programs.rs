//! Programs at random: all cycles, lines and arcs, in the text a user writes. The machine can carry out each.

mod taps;
mod threads;
mod turning;

use leadscrew_core::call::{Call, CallKind, ChainPart, Position};
use leadscrew_core::cycle;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options};
use leadscrew_core::signals::Signals;
use leadscrew_language::flow::Rules;
use leadscrew_language::reader::Reader;
use leadscrew_language::variables::Kept;

use super::script::Draws;

/// A program, and what is known of it.
pub struct Program {
    /// As a user writes it.
    pub text: String,
    /// Its calls.
    pub calls: Vec<Call>,
    /// X (radius) and Z in nanometres where it ends.
    pub end: (i64, i64),
    /// Its threads whose passes all fall into one groove that is known beforehand.
    pub grooves: Vec<Groove>,
}

/// A thread without a shift of its starts: at the index of the spindle its long axis is a whole number of leads from
/// `start`.
#[derive(Clone, Copy, Debug)]
pub struct Groove {
    /// The first of the lines without which it would be another one.
    pub first: u32,
    /// Line of the cycle, pass or stroke.
    pub line: u32,
    /// X has the lead, on its radius.
    pub on_x: bool,
    /// Where the cycle starts on the long axis, in nanometres; with a start angle, as far before that as the axis goes
    /// while the spindle turns by it; of a later stroke of a chain likewise.
    pub start: i64,
    /// Its lead in nanometres.
    pub lead: i64,
    /// The long axis per turn of the spindle as its encoder counts it: +1 or −1 leads.
    pub sign: i64,
}

/// A number of micrometres as a word's number in millimetres.
fn mm(um: i64) -> String {
    let sign = if um < 0 { "-" } else { "" };
    format!("{sign}{}.{:03}", um.abs() / 1000, um.abs() % 1000)
}

struct Writer<'a> {
    random: &'a mut Draws,
    text: String,
    grooves: Vec<Groove>,
    /// Diameter and Z in micrometres.
    at: (i64, i64),
}

/// A program for a machine with these parameters that stands at `from`.
///
/// # Panics
/// Where one comes out that the interpreter refuses: they are right as they are written here.
pub fn random(random: &mut Draws, params: &Params, from: Position) -> Program {
    loop {
        let mut writer = Writer {
            random,
            text: String::from("G18 G40 G97 G98\n"),
            grooves: Vec::new(),
            at: (0, 0),
        };
        let start = (
            writer.random.within(60_000, 100_000) / 2 * 2,
            writer.random.within(5_000, 20_000),
        );
        writer.to(start);
        for _ in 0..writer.random.within(1, 3) {
            writer.piece();
        }
        let end = (
            writer.random.within(60_000, 120_000) / 2 * 2,
            writer.random.within(5_000, 30_000),
        );
        writer.to(end);
        writer.line("M30");
        let Writer {
            text, grooves, at, ..
        } = writer;
        if let Some(calls) = fitting(&text, params, from) {
            return Program {
                text,
                calls,
                end: (at.0 * 500, at.1 * 1000),
                grooves,
            };
        }
    }
}

/// A program of a script, for a machine with these parameters that stands at `from`.
///
/// # Panics
/// Where it is none that this machine can carry out: too much of it was left out.
pub fn again(text: &str, params: &Params, from: Position) -> Program {
    let calls = fitting(text, params, from).expect("the machine can carry it out");
    Program {
        text: text.into(),
        calls,
        end: (0, 0),
        grooves: Vec::new(),
    }
}

/// The calls of a text.
///
/// # Panics
/// Where it is wrong.
pub fn read(text: &str, params: &Params, from: Position) -> Vec<Call> {
    let options = Options {
        position: from,
        ..Options::default()
    };
    let (kept, rules) = (Kept::default(), Rules::default());
    let mut reader = Reader::new(text.as_bytes(), params, options, kept, rules);
    let mut calls = Vec::new();
    while !reader.is_over() {
        let step = reader.step(&mut |event| {
            if let Event::Call(call) = event {
                calls.push(call);
            }
        });
        if let Err(trouble) = step {
            panic!("{trouble:?} in\n{text}");
        }
    }
    calls
}

/// The calls of a text, if the machine can do all of them.
fn fitting(text: &str, params: &Params, from: Position) -> Option<Vec<Call>> {
    let calls = read(text, params, from);
    let mut chain = Vec::new();
    let possible = calls.iter().all(|call| match &call.kind {
        CallKind::Thread(thread) if thread.part == ChainPart::Whole => {
            cycle::thread_report(thread, call.span, params).is_ok()
        }
        CallKind::Thread(thread) => {
            chain.push((*thread, call.span));
            let goes_on = thread.part.goes_on();
            let alone = cycle::thread_report(thread, call.span, params).is_ok();
            let fits = alone && (goes_on || cycle::chain_report(&chain, params).is_ok());
            if !goes_on {
                chain.clear();
            }
            fits
        }
        CallKind::Tap(tap) => cycle::tap_report(tap, Signals::default(), call.span, params).is_ok(),
        _ => true,
    });
    possible.then_some(calls)
}

impl Writer<'_> {
    fn line(&mut self, words: &str) {
        self.text.push_str(words);
        self.text.push('\n');
    }

    /// Number of the line that comes next.
    fn next_line(&self) -> u32 {
        self.text.lines().count() as u32 + 1
    }

    fn to(&mut self, at: (i64, i64)) {
        self.at = at;
        self.line(&format!("G0 X{} Z{}", mm(at.0), mm(at.1)));
    }

    /// Starts the spindle; the sign of its direction.
    fn turn(&mut self, rpm: i64) -> i64 {
        let way = if self.random.chance(70) { 1 } else { -1 };
        let code = if way > 0 { "M3" } else { "M4" };
        self.line(&format!("{code} S{rpm}"));
        way
    }

    fn piece(&mut self) {
        match self.random.within(0, 17) {
            0 => self.lines(),
            1 => self.arc(),
            2 => self.groove(),
            3 => self.thread(),
            4 => self.enhanced_thread(),
            5 | 6 => self.single_passes(),
            7 | 8 => self.strokes(),
            9 => self.variable(),
            10 => self.face_tap(),
            11 => self.side_tap(),
            12 => self.deeper_tap(),
            13 => self.ordinary_tap(),
            14 => self.face_groove(),
            15 => self.cuts(),
            16 => self.drill(),
            _ => self.contour(),
        }
        if self.random.chance(30) {
            let words = self.random.of(&["M8", "M9", "G4 P30", "G4 P300", "M5"]);
            self.line(words);
        }
    }

    fn lines(&mut self) {
        let per_turn = self.random.chance(30);
        if per_turn {
            let rpm = self.random.within(600, 2000);
            self.line(&format!("M3 S{rpm}\nG99"));
        }
        for _ in 0..self.random.within(1, 5) {
            let (x, z) = (
                self.random.within(30_000, 90_000) / 2 * 2,
                self.random.within(-20_000, 10_000),
            );
            let feed = if per_turn {
                mm(self.random.within(200, 800))
            } else {
                self.random.within(300, 5000).to_string()
            };
            let also_c = if self.random.chance(15) {
                format!(" C{}.", self.random.within(-90, 90))
            } else {
                String::new()
            };
            self.line(&format!("G1 X{} Z{}{also_c} F{feed}", mm(x), mm(z)));
            self.at = (x, z);
        }
        if per_turn {
            self.line("G98");
        }
    }

    fn arc(&mut self) {
        let (dx, dz) = (
            self.random.within(500, 6_000) * self.random.sign(),
            self.random.within(500, 6_000) * self.random.sign(),
        );
        let chord = ((dx * dx + dz * dz) as f64).sqrt();
        let radius = (chord * 0.5 * (1.01 + self.random.within(0, 300) as f64 / 100.0)) as i64 + 2;
        let code = self.random.of(&["G2", "G3"]);
        let feed = self.random.within(300, 3000);
        self.at = (self.at.0 + 2 * dx, self.at.1 + dz);
        let (x, z) = self.at;
        self.line(&format!(
            "{code} X{} Z{} R{} F{feed}",
            mm(x),
            mm(z),
            mm(radius)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of each kind of piece there are some that this machine can carry out, and grooves that are known.
    #[test]
    fn all_cycles_are_drawn() {
        let mut draws = Draws::live(475);
        let params = Params::sheets();
        let mut words: std::collections::BTreeMap<&str, usize> = [
            "G1 ", "G2 ", "G3 ", "G32 ", "G34 ", "G70 ", "G71 ", "G72 ", "G73 ", "G74 ", "G75 ",
            "G76 ", "G78 ", "G83 ", "G84 ", "G87 ", "G88 ", "G90 ", "G92 ", "G94 ",
        ]
        .map(|word| (word, 0))
        .into();
        let (mut on_x, mut later) = (0, 0);
        for _ in 0..300 {
            let program = random(&mut draws, &params, Position::default());
            for (word, count) in &mut words {
                *count += usize::from(program.text.contains(word));
            }
            on_x += program.grooves.iter().filter(|groove| groove.on_x).count();
            let chained = |call: &&Call| match &call.kind {
                CallKind::Thread(thread) => thread.part.is_joined(),
                _ => false,
            };
            later += program.calls.iter().filter(chained).count();
        }
        assert!(words.values().all(|count| *count > 3), "{words:?}");
        assert!(on_x > 10 && later > 10, "{on_x} on X, {later} joined");
    }
}
