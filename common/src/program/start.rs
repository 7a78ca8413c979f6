//! A start in the middle of a program: the lines before are carried out without motion, and what they leave is told [D258].
//!
//! A line fits where it begins something of its own: no line before it has a part in its path. Must not know machines.

use std::collections::BTreeSet;
use std::io;

use leadscrew_core::alarm::Alarm;
use leadscrew_core::call::{Aux, Call, CallKind, Position, SpindleCall, SpindleMode};
use leadscrew_core::params::gear_of_code;
use leadscrew_core::program::{Carried, Event};
use leadscrew_language::flow::Trouble;

use super::Program;

/// What the lines before a start leave.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The line.
    pub line: u32,
    /// What is in force.
    pub carried: Carried,
    /// Machine coordinates of the work zero.
    pub origin: Position,
    /// Where the line begins, in machine coordinates.
    pub at: Position,
    /// The spindle, where a line has commanded it.
    pub spindle: Option<SpindleCall>,
    /// The latest T.
    pub tool: Option<u16>,
    /// The coolant is on (M08).
    pub coolant: bool,
    /// Other functions of the lines before, which are not given again.
    pub functions: BTreeSet<u16>,
    /// The latest of M41 to M44.
    pub gear: Option<u16>,
    /// G61.
    pub exact: bool,
    /// The first motion of the line itself.
    pub first: Option<CallKind>,
}

/// Why a program cannot be started at a line.
#[derive(Clone, Debug)]
pub enum Unfit {
    /// It is not carried out, or has no block.
    NotReached,
    /// It belongs to what lines before it have begun: a contour, a cycle of holes, a subprogram, a compensated path.
    Inside,
    /// It is the second block of a cycle, or a later pass of one that is in force.
    InCycle,
    /// A stroke that goes on from the one before.
    InChain,
    /// Its first move is an arc.
    Arc,
    /// U or W.
    Incremental,
    /// A spindle in position mode.
    Rigid,
    /// G50 before it counts from where the tool stood.
    Shift,
    /// G10 before it writes offsets, which the whole program would write again.
    Offsets,
    /// A line before it, or the line itself, is wrong.
    Wrong(Alarm),
}

/// What the skipped calls add up to.
#[derive(Debug, Default)]
struct Skipped {
    spindle: Option<SpindleCall>,
    coolant: bool,
    functions: BTreeSet<u16>,
    gear: Option<u16>,
    exact: bool,
    ended: bool,
    /// The last stroke is one that the next goes on from.
    in_chain: bool,
}

impl Skipped {
    fn take(&mut self, call: &Call) {
        match &call.kind {
            CallKind::Spindle(spindle) => self.spindle = Some(*spindle),
            CallKind::Aux(Aux::M(8)) => self.coolant = true,
            CallKind::Aux(Aux::M(9)) => self.coolant = false,
            // Stops have no effect later.
            CallKind::Aux(Aux::M(0 | 1) | Aux::T(_)) => {}
            CallKind::Aux(Aux::M(code)) => {
                if gear_of_code(*code).is_some() {
                    self.gear = Some(*code);
                }
                self.functions.insert(*code);
            }
            CallKind::ExactStop(exact) => self.exact = *exact,
            CallKind::End(_) => self.ended = true,
            CallKind::Thread(thread) => self.in_chain = thread.part.goes_on(),
            _ => {}
        }
    }
}

impl Program<'_> {
    /// Carries out the lines before `line` without their events. What comes next are the events of that line.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn start_at(&mut self, line: u32) -> io::Result<Result<Start, Unfit>> {
        let shift = self.carried().shift;
        let mut skipped = Skipped::default();
        // The cycle that a line before has named without a call.
        let mut opened = None;
        loop {
            let fits = self.reader.is_between_parts();
            let (writes, _) = self.reader.interpreter().offsets_writes();
            let before = (
                self.carried(),
                self.origin(),
                self.reader.interpreter().position(),
                self.reader.tool(),
            );
            if let Some(alarm) = self.alarm.take() {
                return Ok(Err(Unfit::Wrong(alarm)));
            }
            if self.over || self.reader.is_over() || self.is_between_passes() || skipped.ended {
                return Ok(Err(Unfit::NotReached));
            }
            self.steps += 1;
            let mut events = Vec::new();
            match self.reader.step(&mut |event| events.push(event)) {
                Ok(()) => {}
                Err(Trouble::Alarm(alarm)) => self.alarm = Some(alarm),
                Err(Trouble::Unreadable(error)) => return Err(error),
            }
            let text = self.line();
            let cycle = cycle_of(&text);
            let is_here = self.reader.line() == line && has_words(&text);
            // A stroke comes out when the block after it is read.
            let waited = |event: &Event| matches!(event, Event::Call(Call { span, kind: CallKind::Thread(_), .. }) if span.line != line);
            let earlier = match is_here {
                true => events.iter().take_while(|event| waited(event)).count(),
                false => events.len(),
            };
            let own = events.split_off(earlier);
            for event in &events {
                if let Event::Call(call) = event {
                    skipped.take(call);
                }
            }
            if !is_here {
                let yields = events.iter().any(|event| matches!(event, Event::Call(_)));
                if has_words(&text) {
                    opened = cycle.filter(|_| !yields);
                }
                continue;
            }
            if let Some(alarm) = self.alarm.take() {
                return Ok(Err(Unfit::Wrong(alarm)));
            }
            self.queue.extend(own);
            let first = self.queue.iter().find_map(first_motion);
            let start = Start {
                line,
                carried: before.0,
                origin: before.1,
                at: before.2,
                spindle: skipped.spindle,
                tool: before.3,
                coolant: skipped.coolant,
                functions: skipped.functions,
                gear: skipped.gear,
                exact: skipped.exact,
                first,
            };
            let is_cycle = matches!(
                first,
                Some(CallKind::Thread(_) | CallKind::Groove(_) | CallKind::Tap(_))
            );
            let rigid = |spindle: SpindleCall| matches!(spindle.mode, SpindleMode::Rigid(_));
            let unfit = if !fits {
                Unfit::Inside
            } else if skipped.in_chain {
                Unfit::InChain
            } else if opened.is_some() && opened == cycle || is_cycle && !names_code(&text) {
                Unfit::InCycle
            } else if matches!(first, Some(CallKind::Arc(_))) {
                Unfit::Arc
            } else if cycle.is_none() && has_letter(&text, b"UW") {
                Unfit::Incremental
            } else if start.spindle.is_some_and(rigid)
                || matches!(first, Some(CallKind::TapReturn(_)))
            {
                Unfit::Rigid
            } else if start.carried.shift != shift {
                Unfit::Shift
            } else if writes > 0 {
                Unfit::Offsets
            } else {
                return Ok(Ok(start));
            };
            return Ok(Err(unfit));
        }
    }
}

fn first_motion(event: &Event) -> Option<CallKind> {
    match event {
        Event::Call(call) => match call.kind {
            CallKind::Dwell(_)
            | CallKind::Spindle(_)
            | CallKind::Aux(_)
            | CallKind::ExactStop(_)
            | CallKind::End(_)
            | CallKind::Over
            | CallKind::LineOver => None,
            kind => Some(kind),
        },
        Event::Warning(_) => None,
    }
}

/// The letters of a line with the byte that follows each, without comments.
fn words(text: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    let mut depth = 0_u32;
    let mut before = b' ';
    text.iter()
        .take_while(|&&byte| byte != b';')
        .enumerate()
        .filter_map(move |(at, &byte)| {
            let last = std::mem::replace(&mut before, byte);
            match byte {
                b'(' => depth += 1,
                b')' => depth = depth.saturating_sub(1),
                _ => {}
            }
            let is_word = depth == 0 && byte.is_ascii_alphabetic() && !last.is_ascii_alphabetic();
            let rest = text.get(at + 1..)?.trim_ascii_start();
            let valued = rest.first().is_some_and(|next| !next.is_ascii_alphabetic());
            (is_word && valued).then_some((byte.to_ascii_uppercase(), rest))
        })
}

fn has_words(text: &[u8]) -> bool {
    words(text).any(|(letter, _)| !b"NO".contains(&letter))
}

fn has_letter(text: &[u8], letters: &[u8]) -> bool {
    words(text).any(|(letter, _)| letters.contains(&letter))
}

/// A G of the line that is more than a setting: of the cycles, or of a stroke.
fn names_code(text: &[u8]) -> bool {
    words(text).any(|(letter, rest)| letter == b'G' && code(rest) >= 32)
}

/// The cycle with two blocks that a line names.
fn cycle_of(text: &[u8]) -> Option<u32> {
    let codes = words(text).filter(|(letter, _)| *letter == b'G');
    codes
        .map(|(_, rest)| code(rest))
        .find(|code| (71..=78).contains(code))
}

fn code(digits: &[u8]) -> u32 {
    let digits = digits.iter().take_while(|byte| byte.is_ascii_digit());
    digits.fold(0, |number, byte| {
        (number * 10_u32 + u32::from(byte - b'0')).min(10_000)
    })
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use leadscrew_core::offsets::Offsets;
    use leadscrew_core::params::Params;
    use leadscrew_core::program::Options;

    use super::*;
    use crate::program::Begin;
    use crate::source::SourceFile;

    fn open<'p>(source: &SourceFile, params: &'p Params) -> Program<'p> {
        let options = Options {
            passes_machine_codes: true,
            offsets: Some(Offsets::default()),
            ..Options::default()
        };
        let begin = Begin {
            options,
            ..Begin::default()
        };
        Program::open(source, params, begin).unwrap()
    }

    /// The calls that come next; `None` where the text is wrong.
    fn calls(program: &mut Program<'_>) -> Option<Vec<Call>> {
        let mut calls = Vec::new();
        while let Some(event) = program.next_event().unwrap() {
            if let Event::Call(call) = event.ok()? {
                calls.push(call);
            }
        }
        Some(calls)
    }

    fn programs(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                programs(&path, found);
            } else if path.extension().is_some_and(|ending| ending == "nc") {
                found.push(path);
            }
        }
    }

    /// From every line of every example: the calls of the rest, and nothing else.
    #[test]
    fn what_follows_is_what_follows_in_the_whole_program() {
        let params = Params::sheets();
        let mut found = Vec::new();
        programs(
            &Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples"),
            &mut found,
        );
        let (mut fit, mut unfit) = (0, 0);
        for path in found {
            let source = SourceFile::new(&path);
            let Some(whole) = calls(&mut open(&source, &params)) else {
                continue;
            };
            let lines = std::fs::read(&path).unwrap().split(|&b| b == b'\n').count();
            for line in 1..=lines as u32 {
                let mut program = open(&source, &params);
                let Ok(start) = program.start_at(line).unwrap() else {
                    unfit += 1;
                    continue;
                };
                let rest = calls(&mut program).unwrap();
                assert!(whole.ends_with(&rest), "{} {line}", path.display());
                let before = &whole[..whole.len() - rest.len()];
                let is_before = |call: &Call| call.span.line < line;
                assert!(
                    before.last().is_none_or(is_before),
                    "{} {line}",
                    path.display()
                );
                let spindle = before.iter().rev().find_map(|call| match call.kind {
                    CallKind::Spindle(spindle) => Some(spindle),
                    _ => None,
                });
                assert_eq!(start.spindle, spindle, "{} {line}", path.display());
                fit += 1;
            }
        }
        assert!(fit > 100 && unfit > 100, "{fit} {unfit}");
    }

    fn at(text: &str, line: u32) -> Result<Start, Unfit> {
        let params = Params::sheets();
        let source = SourceFile::text("part", text.to_owned());
        open(&source, &params).start_at(line).unwrap()
    }

    #[test]
    fn every_reason_is_given() {
        let why = |text, line| match at(text, line) {
            Ok(_) => "fit",
            Err(Unfit::NotReached) => "not reached",
            Err(Unfit::Inside) => "inside",
            Err(Unfit::InCycle) => "cycle",
            Err(Unfit::InChain) => "chain",
            Err(Unfit::Arc) => "arc",
            Err(Unfit::Incremental) => "incremental",
            Err(Unfit::Rigid) => "rigid",
            Err(Unfit::Shift) => "shift",
            Err(Unfit::Offsets) => "offsets",
            Err(Unfit::Wrong(_)) => "wrong",
        };
        const THREAD: &str = "M3 S300\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\n\
            G76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nG0 X100\nM30\n";
        const CHAIN: &str = "M3 S300\nG0 X40 Z5\nG32 Z-10 F2\nX44 Z-20\nG0 X60\nG92 X38 Z-20 F2\nX37.5\nG0 X80\nM30\n";
        const CONTOUR: &str = "M3 S300\nG0 X60 Z2\nG98\nG71 U2 R1\nG71 P10 Q20 U0.4 W0.1 F200\nN10 G0 X30\nG1 Z-20\n\
            N20 X60\nG70 P10 Q20\nG0 X80\nM30\n";
        const OTHER: &str = "G98 G0 X40 Z2\nG42 G0 X30 T0101\nG1 Z-10 F100\nG40 G0 X60\nG1 W-1\nG2 X64 Z-13 R2\nM98 P20\n\
            M29 S100\nG84 Z-30 F200\nG80\nM30\nO20\nG0 X90\nM99\n";
        for (text, line, wanted) in [
            (THREAD, 2, "fit"),
            (THREAD, 3, "fit"),
            (THREAD, 4, "cycle"),
            (THREAD, 5, "fit"),
            (THREAD, 6, "cycle"),
            (THREAD, 7, "fit"),
            (THREAD, 9, "not reached"),
            (CHAIN, 3, "fit"),
            (CHAIN, 4, "chain"),
            (CHAIN, 5, "fit"),
            (CHAIN, 6, "fit"),
            (CHAIN, 7, "cycle"),
            (CONTOUR, 4, "fit"),
            (CONTOUR, 5, "cycle"),
            (CONTOUR, 6, "not reached"),
            (CONTOUR, 7, "not reached"),
            (CONTOUR, 8, "not reached"),
            (CONTOUR, 9, "fit"),
            (CONTOUR, 10, "fit"),
            (OTHER, 3, "inside"),
            (OTHER, 5, "incremental"),
            (OTHER, 6, "arc"),
            (OTHER, 7, "fit"),
            (OTHER, 9, "inside"),
            (OTHER, 13, "inside"),
            ("G0 X1 Z1\nG50 X50 Z50\nG0 X2\nM30\n", 3, "shift"),
            ("G0 X1 Z1\nG10 P1 X0.1\nG0 X2\nM30\n", 2, "fit"),
            ("G0 X1 Z1\nG10 P1 X0.1\nG0 X2\nM30\n", 3, "offsets"),
            ("G0 X1 Z1 Q\nG0 X2\nM30\n", 2, "wrong"),
        ] {
            assert_eq!(why(text, line), wanted, "{text}{line}");
        }
    }

    #[test]
    fn what_the_lines_before_leave() {
        let text = "G98 G97 S500 M3\nT0102 M8\nM25\nG61\nG0 X80 Z5\nM9\nM8\nG1 X70 F200\nM30\n";
        let start = at(text, 8).unwrap();
        assert_eq!((start.at.x.nm(), start.at.z.nm()), (40_000_000, 5_000_000));
        assert_eq!(start.spindle.map(|spindle| spindle.rpm.get()), Some(500));
        assert_eq!(
            (start.tool, start.coolant, start.exact),
            (Some(102), true, true)
        );
        assert_eq!(start.functions, BTreeSet::from([25]));
        assert_eq!(start.carried.offset, 2);
        assert!(!at(text, 7).unwrap().coolant);
    }
}
