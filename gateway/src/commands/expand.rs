//! `expand`: the move list, streamed.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::call::{Call, Position};
use leadscrew_core::cycle;
use leadscrew_core::program::Event;
use leadscrew_verification::Hole;

use crate::cli::{Expand, Format};
use crate::diagnostics::{self, Diagnostic};
use crate::failure::{Doing, Failure, Outcome};
use crate::json::Json;
use crate::movelist;
use crate::output;
use crate::program::Program;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::words::both;

/// Bytes collected before they are written.
const CHUNK: usize = 1 << 16;
/// Of a step whose moves take more than this, and nothing else, a part is written before all of it is known to be good.
const LONGEST: usize = 1 << 24;

/// Prints the moves of a program.
pub fn run(setup: &Setup, args: &Expand) -> Outcome {
    list(setup, &SourceFile::new(&args.program), args.format)
}

/// The same of any text.
pub fn list(setup: &Setup, source: &SourceFile, format: Option<Format>) -> Outcome {
    let format = match (format, setup.global.json) {
        (None, true) => Format::Jsonl,
        (None, false) => Format::Text,
        (Some(format), false) | (Some(format @ Format::Jsonl), true) => format,
        (Some(_), true) => {
            return Err(Failure::Usage(both!(
                "`--json` is `--format jsonl`; it cannot be another format too",
                "`--json` 就是 `--format jsonl`，不能再指定别的格式"
            )));
        }
    };
    let options = setup.options();
    let mut program = Program::open(source, &setup.params, setup.begin())
        .map_err(|error| Failure::file(Doing::Read, source.name(), &error))?;
    let mut list = List {
        setup,
        source,
        format,
        buffer: Vec::with_capacity(CHUNK + 1024),
        step: 0,
        begins: Vec::new(),
        warnings: Vec::new(),
        moves: 0,
        at: options.position,
        hole: Hole::new(setup.tap),
    };
    movelist::header(format, setup.lang, &mut list.buffer);
    let result = list.all(&mut program);
    list.flush()?;
    result
}

/// The list being printed.
struct List<'a> {
    setup: &'a Setup<'a>,
    source: &'a SourceFile,
    format: Format,
    buffer: Vec<u8>,
    /// The step of the program that made the latest call: a line, or a block of one.
    step: u64,
    /// The calls of that step: they may still be taken back.
    begins: Vec<Begin>,
    /// What is to be said behind the list so far, and has no place in it.
    warnings: Vec<Diagnostic>,
    moves: u64,
    at: Position,
    hole: Hole,
}

/// Where a call begins.
#[derive(Clone, Copy, Debug)]
struct Begin {
    /// In its line.
    column: u16,
    /// In the buffer.
    byte: usize,
    /// Moves before it.
    moves: u64,
}

impl List<'_> {
    fn all(&mut self, program: &mut Program) -> Outcome {
        loop {
            let next = program
                .next_event()
                .map_err(|error| Failure::file(Doing::Read, self.source.name(), &error))?;
            match next {
                None => return Ok(()),
                Some(Ok(Event::Call(call))) => self.call(&call, program)?,
                Some(Ok(Event::Warning(warning))) => {
                    if program.allows(&warning) {
                        continue;
                    }
                    self.begin_step(program)?;
                    self.tell(&warning, program.is_inch())?;
                }
                Some(Err(alarm)) => {
                    self.tell(&alarm, program.is_inch())?;
                    return Err(Failure::Wrong);
                }
            }
        }
    }

    /// What comes from here on is of this step; the one before is good, and can be written.
    fn begin_step(&mut self, program: &Program) -> Outcome {
        if self.step == program.steps() {
            return Ok(());
        }
        self.step = program.steps();
        self.begins.clear();
        if self.buffer.len() >= CHUNK || !self.warnings.is_empty() {
            self.flush()?;
        }
        Ok(())
    }

    fn call(&mut self, call: &Call, program: &mut Program) -> Outcome {
        self.begin_step(program)?;
        self.begins.push(Begin {
            column: call.span.column,
            byte: self.buffer.len(),
            moves: self.moves,
        });
        let moves = match cycle::expand(call, &self.setup.context(self.at, &self.hole)) {
            Ok(moves) => moves,
            Err(alarm) => return self.refuse(call, &alarm, program),
        };
        if let Err(alarm) = self.hole.admit(call, &moves) {
            return self.refuse(call, &alarm, program);
        }
        if let Some(warning) = moves.warning() {
            self.tell(&warning, program.is_inch())?;
        }
        let in_one_block = program.is_in_one_block(call.span);
        for mut step in moves {
            movelist::name_as_written(&mut step, in_one_block);
            self.moves += 1;
            movelist::push(
                self.format,
                self.setup.lang,
                &mut self.buffer,
                self.moves,
                &step,
                &call.origin,
            );
            self.hole.push(&step);
            self.at = step.to;
            if self.buffer.len() >= LONGEST {
                self.flush()?;
                self.begins.clear();
            }
        }
        Ok(())
    }

    /// An alarm of a call. It comes before any move of its block, also before what the block does ahead of its motion.
    fn refuse(&mut self, call: &Call, alarm: &Alarm, program: &mut Program) -> Outcome {
        let block = block_begin(&program.line(), call.span.column);
        if let Some(begin) = self.begins.iter().find(|begin| begin.column >= block) {
            self.buffer.truncate(begin.byte);
            self.moves = begin.moves;
        }
        self.tell(alarm, program.is_inch())?;
        Err(Failure::Wrong)
    }

    /// An alarm or a warning in its place: as a line of the list where the format has room for one.
    fn tell(&mut self, alarm: &Alarm, inch: bool) -> Outcome {
        let diagnostic = Diagnostic::new(alarm, self.source, self.setup.lang, inch);
        if self.format == Format::Jsonl {
            let key = if diagnostic.warning {
                "warning"
            } else {
                "alarm"
            };
            let mut json = Json::new();
            json.object(|json| json.object_at(key, |json| diagnostic.fields(json, false)));
            self.buffer.extend_from_slice(&json.into_bytes());
            self.buffer.push(b'\n');
        } else if diagnostic.warning {
            self.warnings.push(diagnostic);
        } else {
            if self.format == Format::Text && self.moves == 0 {
                // A table without a line needs no heading.
                self.buffer.clear();
            }
            // What has happened before comes first, also where both go to one terminal.
            self.flush()?;
            diagnostics::print(&diagnostic, self.setup.colour);
        }
        Ok(())
    }

    /// Writes the list so far, and what is to be said behind it.
    fn flush(&mut self) -> Outcome {
        if !self.buffer.is_empty() {
            let written = output::part(&self.buffer);
            self.buffer.clear();
            written?;
        }
        for warning in self.warnings.drain(..) {
            diagnostics::print(&warning, self.setup.colour);
        }
        Ok(())
    }
}

/// The column at which the block begins that has a word at `column`: behind the last `;` before it that is in no comment.
fn block_begin(line: &[u8], column: u16) -> u16 {
    let (mut begin, mut depth) = (1, 0_u32);
    for (column, at) in (1..column).zip(0..line.len()) {
        match &line[at..] {
            [b'(', ..] => depth += 1,
            [b')', ..] => depth = depth.saturating_sub(1),
            text if text.starts_with("（".as_bytes()) => depth += 1,
            text if text.starts_with("）".as_bytes()) => depth = depth.saturating_sub(1),
            [b';', ..] if depth == 0 => begin = column + 1,
            _ => {}
        }
    }
    begin
}

#[cfg(test)]
mod tests {
    use super::block_begin;

    #[test]
    fn a_block_begins_behind_the_semicolon_that_is_in_no_comment() {
        for (line, column, begin) in [
            ("M3 S100 G76 X1", 9, 1),
            ("M3 S100; G76 X1", 10, 9),
            ("M3;S100 G76 X1;M5", 9, 4),
            ("M3 (a; b) G76 X1", 11, 1),
            ("M3; (a; (b;) c;) M8 G76 X1", 21, 4),
            ("M3 （a; b） G76 X1", 15, 1),
            ("M3 （a） ; G76 X1", 14, 13),
        ] {
            assert_eq!(block_begin(line.as_bytes(), column), begin, "{line}");
        }
    }
}
