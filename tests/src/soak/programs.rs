//! Programs at random: the cycles of the sheets, lines and arcs, in the text a user writes. The machine can carry out each.

use core::fmt::Write as _;

use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::cycle;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Events, Options};
use leadscrew_core::signals::Signals;

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

/// A thread without a shift of its starts: at the index of the spindle its axis is a whole number of leads from where
/// the cycle starts.
#[derive(Clone, Copy, Debug)]
pub struct Groove {
    /// Line of the cycle.
    pub line: u32,
    /// Where the cycle starts on Z, in nanometres.
    pub start: i64,
    /// Its lead in nanometres.
    pub lead: i64,
    /// Z per turn of the spindle as its encoder counts it: +1 or −1 leads.
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
    let mut calls = Vec::new();
    for event in Events::new(text.as_bytes(), params, options) {
        match event {
            Ok(Event::Call(call)) => calls.push(call),
            Ok(Event::Warning(_)) => {}
            Err(alarm) => panic!("{alarm:?} in\n{text}"),
        }
    }
    calls
}

/// The calls of a text, if the machine can do all of them.
fn fitting(text: &str, params: &Params, from: Position) -> Option<Vec<Call>> {
    let calls = read(text, params, from);
    let possible = calls.iter().all(|call| match &call.kind {
        CallKind::Thread(thread) => cycle::thread_report(thread, call.span, params).is_ok(),
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

    fn piece(&mut self) {
        match self.random.within(0, 9) {
            0 => self.lines(),
            1 => self.arc(),
            2 => self.groove(),
            3 | 4 => self.thread(),
            5 => self.enhanced_thread(),
            6 => self.face_tap(),
            7 => self.side_tap(),
            8 => self.deeper_tap(),
            _ => self.ordinary_tap(),
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

    fn groove(&mut self) {
        let (x, z) = (
            self.random.within(40_000, 70_000) / 2 * 2,
            self.random.within(-10_000, 2_000),
        );
        self.to((x, z));
        let depth = self.random.within(500, 3_000);
        let width = if self.random.chance(40) {
            0
        } else {
            self.random.within(200, 2_500) * self.random.sign()
        };
        // A diameter, in input increments of 0.1 µm.
        let peck = depth * 2 * 10 / self.random.within(1, 4);
        let step = width.abs() * 10 / self.random.within(1, 3);
        let feed = self.random.within(300, 2_000);
        let back = mm(self.random.within(100, 400));
        let bottom = mm(x - 2 * depth);
        self.line(&format!("G75 R{back}"));
        let wide = if width == 0 {
            String::new()
        } else {
            format!(" Z{} Q{step}", mm(z + width))
        };
        self.line(&format!("G75 X{bottom}{wide} P{peck} F{feed}"));
    }

    /// Lead in micrometres and speed, as Z can go.
    fn lead_and_speed(&mut self) -> (i64, i64) {
        let rpm = self.random.within(300, 1500);
        let lead = self.random.within(300, (5_000_000 / rpm).min(4_000));
        (lead, rpm)
    }

    fn turn(&mut self, rpm: i64) -> i64 {
        let way = if self.random.chance(70) { 1 } else { -1 };
        let code = if way > 0 { "M3" } else { "M4" };
        self.line(&format!("{code} S{rpm}"));
        way
    }

    fn thread(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        let way = self.turn(rpm);
        let height = self.random.within(300, 1_200);
        let core = self.random.within(30_000, 60_000) / 2 * 2;
        let (start, length) = (
            self.random.within(4_000, 10_000),
            self.random.within(8_000, 20_000),
        );
        let towards = if self.random.chance(85) { -1 } else { 1 };
        let clear = self.random.within(500, 4_000);
        self.to((core + 2 * (height + clear), start));
        let run_out = self.random.of(&[0, 5, 10]);
        let angle = self.random.of(&[0, 0, 55, 60]);
        let first = (height - 100).max(100) * 10 / self.random.within(1, 3);
        self.line(&format!(
            "G76 P01{run_out:02}{angle:02} Q{} R0.05",
            (first / 4).min(height * 5)
        ));
        if angle == 0 {
            self.grooves.push(Groove {
                line: self.next_line(),
                start: start * 1000,
                lead: lead * 1000,
                sign: towards * way,
            });
        }
        self.line(&format!(
            "G76 X{} Z{} P{} Q{first} F{}",
            mm(core),
            mm(start + towards * length),
            height * 10,
            mm(lead)
        ));
    }

    fn enhanced_thread(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        self.turn(rpm);
        let height = self.random.within(300, 1_200);
        let core = self.random.within(30_000, 60_000) / 2 * 2;
        let (start, length) = (
            self.random.within(5_000, 12_000),
            self.random.within(8_000, 20_000),
        );
        let clear = self.random.within(1_000, 4_000);
        self.to((core + 2 * (height + clear), start));
        let mode = self.random.within(0, 4);
        let angle = self.random.of(&[0, 55, 60]);
        let starts = self.random.of(&[1, 1, 2]);
        let decreasing = self.random.within(0, 1);
        self.line(&format!(
            "G78 P01{mode:02}{angle:02} Q0.08 R0.05 L{starts} D{decreasing}"
        ));
        let first = (height - 100) / self.random.within(1, 2);
        let mut words = format!(
            "G78 X{} Z{} P{} Q{} F{}",
            mm(core),
            mm(start - length),
            mm(height),
            mm(first),
            mm(lead)
        );
        if self.random.chance(60) {
            let run_out = mm(self.random.within(500, 1_500));
            let _ = write!(words, " J{run_out} K{run_out}");
        }
        if self.random.chance(40) {
            let _ = write!(words, " E{}", mm(self.random.within(300, 900)));
        }
        self.line(&words);
    }

    /// Lead in micrometres and speed of a tap.
    fn tap(&mut self) -> (i64, i64) {
        let rpm = self.random.within(300, 1500);
        (self.random.within(400, (3_500_000 / rpm).min(2_500)), rpm)
    }

    /// What a hole may have beside its depth.
    fn notes(&mut self, depth: i64) -> String {
        let mut words = String::new();
        if self.random.chance(50) {
            let infeed = depth / self.random.within(2, 4);
            let back = infeed * self.random.within(0, 100) / 100;
            let _ = write!(words, " Q{} D{}", mm(infeed), mm(back));
        }
        if self.random.chance(40) {
            let _ = write!(words, " P{}", self.random.within(1, 200));
        }
        words
    }

    fn rigid(&mut self, rpm: i64) {
        let hand = if self.random.chance(30) { "-" } else { "" };
        self.line(&format!("M29 S{hand}{rpm}"));
    }

    fn face_tap(&mut self) {
        let (lead, rpm) = self.tap();
        let initial = self.random.within(3_000, 8_000);
        let x = self.random.within(20_000, 60_000) / 2 * 2;
        self.to((x, initial));
        self.rigid(rpm);
        let level = self.random.within(1_000, 3_000);
        let depth = self.random.within(1_000, 8_000);
        let notes = self.notes(depth);
        let spindle = if self.random.chance(30) {
            format!(" E{}", self.random.within(1, 4))
        } else {
            String::new()
        };
        // Under G98 the feed is lead times speed: in whole micrometres a minute.
        self.line(&format!(
            "G84 Z{} R-{}{notes}{spindle} F{}",
            mm(initial - level - depth),
            mm(level),
            mm(lead * rpm)
        ));
        if self.random.chance(40) {
            self.at.0 = x + 10_000;
            self.line(&format!("X{}", mm(x + 10_000)));
        }
        if self.random.chance(20) {
            let c = self.random.within(-180, 180);
            self.line(&format!("C{c}."));
        }
        self.line("G80");
    }

    fn side_tap(&mut self) {
        let (lead, rpm) = self.tap();
        let (x, z) = (
            self.random.within(50_000, 70_000) / 2 * 2,
            self.random.within(-20_000, 0),
        );
        self.to((x, z));
        self.rigid(rpm);
        let level = self.random.within(1_000, 3_000);
        let depth = self.random.within(1_000, 6_000);
        let notes = self.notes(depth);
        self.line(&format!(
            "G88 X{} R-{}{notes} F{}",
            mm(x - 2 * (level + depth)),
            mm(level),
            mm(lead * rpm)
        ));
        self.line("G80");
    }

    /// Stays at the bottom, and goes deeper.
    fn deeper_tap(&mut self) {
        let (lead, rpm) = self.tap();
        let initial = self.random.within(3_000, 8_000);
        let x = self.random.within(20_000, 60_000) / 2 * 2;
        self.to((x, initial));
        self.rigid(rpm);
        let level = self.random.within(1_000, 3_000);
        let depth = self.random.within(1_000, 5_000);
        let feed = mm(lead * rpm);
        self.line(&format!(
            "G84 Z{} R-{} F{feed} K198",
            mm(initial - level - depth),
            mm(level)
        ));
        let ms = self.random.within(10, 300);
        self.line(&format!("G4 P{ms}"));
        let further = self.random.within(500, 3_000);
        self.line(&format!(
            "G84 Z{} F{feed}",
            mm(initial - level - depth - further)
        ));
        self.line("G80");
    }

    fn ordinary_tap(&mut self) {
        let (lead, rpm) = self.tap();
        let initial = self.random.within(3_000, 8_000);
        let x = self.random.within(20_000, 60_000) / 2 * 2;
        self.to((x, initial));
        self.turn(rpm);
        let level = self.random.within(2_000, 5_000);
        let depth = self.random.within(3_000, 12_000);
        let notes = self.notes(depth);
        self.line(&format!(
            "G99 G84 Z{} R-{}{notes} F{}",
            mm(initial - level - depth),
            mm(level),
            mm(lead)
        ));
        self.line("G80 G98");
    }
}
