//! `mdi`: a line that is typed, checked and carried out as a program is, after the lines typed before.
//!
//! Each line is a program of its own for the board. What the lines before have left in force is kept by this side, in a
//! file for each board, with the number that the last line had as a program: where the board names another program, or
//! another parameter set, something else has happened since, and it begins anew [D283].

use std::fs;
use std::io::{self, BufRead as _, ErrorKind, IsTerminal as _};
use std::path::PathBuf;

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{LengthUnit, Position};
use leadscrew_core::link::Status;
use leadscrew_core::program::{Carried, CarriedFeed};
use leadscrew_core::units::{Angle, Feed, FeedPerTurn, Length};
use rustyline::DefaultEditor;
use rustyline::error::ReadlineError;
use serde_json::{Value, json};

use super::run::{Work, end, perform};
use crate::cli::{Global, Run};
use crate::failure::{Doing, Failure, Outcome};
use crate::json::Json;
use crate::number;
use crate::output;
use crate::program::Program;
use crate::replace::replace;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::state;
use crate::words::{both, pick};

/// Name of a typed line in messages.
const NAME: &str = "mdi";

/// Carries out a line, or asks for lines until there are no more.
pub fn mdi(global: &Global, line: Option<&str>) -> Outcome {
    if let Some(line) = line {
        return carry_out(global, line);
    }
    if global.json {
        return Err(Failure::Usage(both!(
            "`mdi --json` gives one result: type the line after it, as in `leadscrew mdi \"G0 X50\" --json`",
            "`mdi --json` 只给出一个结果：请在后面写上程序行，如 `leadscrew mdi \"G0 X50\" --json`"
        )));
    }
    prompt(global)
}

/// Asks for lines until there are no more: a person at a terminal, who may type a refused line again, or a pipe.
fn prompt(global: &Global) -> Outcome {
    if io::stdin().is_terminal() && io::stdout().is_terminal() {
        return ask(global);
    }
    for line in io::stdin().lock().lines() {
        let line = line.map_err(|error| Failure::file(Doing::Read, "stdin", &error))?;
        if !line.trim().is_empty() {
            carry_out(global, &line)?;
        }
    }
    Ok(())
}

/// The same with a person: the arrow keys bring the lines before.
fn ask(global: &Global) -> Outcome {
    let failed = |error: ReadlineError| {
        let words = error.to_string();
        Failure::Usage(both!(
            "this terminal cannot be read: {words}; `leadscrew mdi LINE` needs none",
            "无法读取此终端：{words}；`leadscrew mdi LINE` 不需要终端"
        ))
    };
    let mut editor = DefaultEditor::new().map_err(failed)?;
    loop {
        let line = match editor.readline("mdi> ") {
            Ok(line) => line,
            Err(ReadlineError::Eof | ReadlineError::Interrupted) => return Ok(()),
            Err(error) => return Err(failed(error)),
        };
        if line.trim().is_empty() {
            continue;
        }
        // A line that is not kept is typed again.
        let _ = editor.add_history_entry(&line);
        match carry_out(global, &line) {
            Ok(()) => {}
            // From here on every line would be interrupted.
            Err(Failure::Interrupted) => return Err(Failure::Interrupted),
            Err(failure) => {
                let _ = failure.report(global.lang(), false);
            }
        }
    }
}

fn carry_out(global: &Global, line: &str) -> Outcome {
    let source = SourceFile::text(NAME, format!("{line}\n"));
    let mut memory = Memory::load(global)?;
    let (mut before, mut behind) = (None, None);
    let done = perform(
        global,
        &source,
        &Run::default(),
        Work::Typed,
        &mut |setup, status| {
            behind = memory.behind(status);
            let place = Place::at_start(setup, behind, status)?;
            setup.carried = Some(place.carried);
            if !global.json {
                output::write(
                    place
                        .text(pick(global.lang(), "before", "之前"), global.lang())
                        .as_bytes(),
                )?;
            }
            before = Some(place);
            Ok(())
        },
    )?;
    let mut link = done.link;
    let status = link.status()?;
    // One that the board has refused has changed nothing. A line that did not come to its end leaves nothing behind: nobody
    // knows how far it came.
    let left = match (&done.verdict, done.ran.refused) {
        (_, true) => behind,
        (Ok(()), false) => done.ran.carried,
        (Err(_), false) => None,
    };
    memory.keep(left, done.ran.program, &status)?;
    let after = Place::at_start(&done.setup, left, &status)?;
    if global.json {
        output::json(|json| {
            match &done.kept {
                Err(lost) if done.verdict.is_ok() => lost.fields(global.lang(), json),
                _ => json.flag("ok", done.verdict.is_ok()),
            }
            json.number("moves", done.ran.moves);
            if let Some(before) = &before {
                json.object_at("before", |json| before.fields(json));
            }
            json.object_at("after", |json| after.fields(json));
            for (key, told) in [
                ("alarms", &done.ran.alarms),
                ("warnings", &done.ran.warnings),
            ] {
                json.array_at(key, |json| {
                    for diagnostic in told {
                        json.object(|json| diagnostic.fields(json, true));
                    }
                });
            }
        })?;
    } else {
        output::write(
            after
                .text(pick(global.lang(), "after ", "之后"), global.lang())
                .as_bytes(),
        )?;
    }
    end(done.verdict, done.kept, global.lang())
}

/// What is in force, and where the machine stands.
#[derive(Clone, Copy, Debug)]
struct Place {
    carried: Carried,
    /// Machine coordinates.
    position: Position,
    /// Machine coordinates of the work zero.
    origin: Position,
}

impl Place {
    /// What a text begins with; `None`: as at power-on. The board says whether the spindle turns.
    fn at_start(setup: &Setup, carried: Option<Carried>, status: &Status) -> Outcome<Self> {
        let open = |carried| {
            let mut begin = setup.begin();
            begin.carried = carried;
            let empty = SourceFile::text(NAME, String::new());
            Program::open(&empty, &setup.params, begin)
                .map(|program| (program.carried(), program.origin()))
                .map_err(|error| Failure::file(Doing::Read, NAME, &error))
        };
        let (mut carried, origin) = open(carried)?;
        let command = status.command;
        carried.direction = command.get().signum() as i8;
        if carried.speed == 0 && !carried.in_surface {
            // Somebody else has started it: S without the override.
            let percent = u32::from(status.spindle_percent).max(1);
            carried.speed = command.abs().saturating_mul(100) / percent;
        }
        Ok(Self {
            carried,
            position: status.position,
            origin,
        })
    }

    /// X as a diameter, and Z, by the work zero and by the machine's.
    fn places(&self) -> [String; 4] {
        let (at, zero) = (self.position, self.origin);
        let x = |length: Length| number::text::<6>(length.nm().saturating_mul(2));
        let z = |length: Length| number::text::<6>(length.nm());
        [x(at.x - zero.x), z(at.z - zero.z), x(at.x), z(at.z)]
    }

    fn text(&self, when: &str, lang: Lang) -> String {
        let words = modal_words(&self.carried);
        let [x, z, mx, mz] = self.places();
        let told = both!(
            "{when}  {words}   X {x}  Z {z}   (machine X {mx}  Z {mz})\n",
            "{when}  {words}   X {x}  Z {z}   （机床坐标 X {mx}  Z {mz}）\n"
        );
        told.get(lang).to_owned()
    }

    fn fields(&self, json: &mut Json) {
        let (at, zero) = (self.position, self.origin);
        json.text("modal", &modal_words(&self.carried));
        json.decimal::<6>("x", (at.x - zero.x).nm().saturating_mul(2));
        json.decimal::<6>("z", (at.z - zero.z).nm());
        json.decimal::<6>("mx", at.x.nm().saturating_mul(2));
        json.decimal::<6>("mz", at.z.nm());
    }
}

/// The words that would set what is in force.
pub fn modal_words(carried: &Carried) -> String {
    let unit = match carried.unit {
        LengthUnit::Inch => 20,
        LengthUnit::Metric => 21,
    };
    let (feed_mode, speed_mode) = (
        98 + u8::from(carried.per_turn),
        97 - u8::from(carried.in_surface),
    );
    let mut words = format!(
        "G{:02} G{} G{unit} G{} G{feed_mode} G{speed_mode}",
        carried.motion, carried.plane, carried.system
    );
    match carried.feed {
        CarriedFeed::None => {}
        CarriedFeed::PerMinute(feed) => {
            words += &format!(" F{}", number::text::<6>(feed.nm_per_min()));
        }
        CarriedFeed::PerTurn(feed) => {
            words += &format!(" F{}", number::text::<6>(feed.nm()));
        }
    }
    let speed = match carried.surface {
        Some(surface) if carried.in_surface => number::text::<9>(surface.nm_per_min()),
        _ => carried.speed.to_string(),
    };
    let turns = match carried.direction {
        1 => 3,
        -1 => 4,
        _ => 5,
    };
    words += &format!(" S{speed} M{turns:02} T--{:02}", carried.offset);
    // Of controls that have them, and else never in force.
    if carried.incremental {
        words += " G91";
    }
    if carried.without_run_out {
        words += " M24";
    }
    words
}

/// What holds on a board for the next typed line; `None`: as at power-on, or something else has run since.
pub fn in_force(global: &Global, status: &Status) -> Option<Carried> {
    let mut carried = Memory::load(global).ok()?.behind(status)?;
    carried.direction = status.command.get().signum() as i8;
    Some(carried)
}

/// What the last line has left, and on which board.
struct Memory {
    /// `None` where there is no folder to keep it in.
    path: Option<PathBuf>,
    bus: String,
    node: u8,
    value: Value,
}

impl Memory {
    /// Reads it. A file that cannot be understood says nothing: all begins anew.
    fn load(global: &Global) -> Outcome<Self> {
        let (bus, node) = (global.bus.to_string(), global.board()?.get());
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let file: String = bus.chars().map(plain).collect();
        let path = state::folder().map(|folder| folder.join(format!("mdi-{file}-{node}.json")));
        let value = match path.as_ref().map(fs::read) {
            None => Value::Null,
            Some(Ok(text)) => serde_json::from_slice(&text).unwrap_or_default(),
            Some(Err(error)) if error.kind() == ErrorKind::NotFound => Value::Null,
            Some(Err(error)) => {
                let path = path.unwrap_or_default();
                return Err(Failure::file(Doing::Read, path.display(), &error));
            }
        };
        Ok(Self {
            path,
            bus,
            node,
            value,
        })
    }

    /// What holds now: what the last line has left, if nothing else has happened on this board since.
    fn behind(&self, status: &Status) -> Option<Carried> {
        let value = &self.value;
        let same = value["bus"] == *self.bus
            && value["program"] == status.program
            && value["parameters"] == status.parameters;
        if same { carried(&value["modal"]) } else { None }
    }

    /// Keeps what a line has left.
    fn keep(&mut self, left: Option<Carried>, program: u32, status: &Status) -> Outcome {
        self.value = json!({
            "bus": self.bus,
            "node": self.node,
            "program": program,
            "parameters": status.parameters,
            "modal": left.map(|left| value(&left)),
        });
        let Some(path) = &self.path else {
            return Ok(());
        };
        let mut text = self.value.to_string();
        text.push('\n');
        path.parent()
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| replace(path, text.as_bytes()))
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))
    }
}

/// As it stands in the file; lengths in nanometres.
fn value(carried: &Carried) -> Value {
    let feed = match carried.feed {
        CarriedFeed::None => Value::Null,
        CarriedFeed::PerMinute(feed) => json!({"per_minute": feed.nm_per_min()}),
        CarriedFeed::PerTurn(feed) => json!({"per_turn": feed.nm()}),
    };
    let shift = carried.shift;
    json!({
        "motion": carried.motion,
        "inch": carried.unit == LengthUnit::Inch,
        "plane": carried.plane,
        "system": carried.system,
        "offset": carried.offset,
        "shift": [shift.x.nm(), shift.z.nm(), shift.c.udeg()],
        "per_turn": carried.per_turn,
        "feed": feed,
        "speed": carried.speed,
        "in_surface": carried.in_surface,
        "surface": carried.surface.map(Feed::nm_per_min),
        "speed_limit": carried.speed_limit,
        "without_run_out": carried.without_run_out,
        "incremental": carried.incremental,
    })
}

/// The same back; `None` where something is missing or impossible.
fn carried(value: &Value) -> Option<Carried> {
    let small = |key: &str, range: std::ops::RangeInclusive<u64>| {
        let number = value[key]
            .as_u64()
            .filter(|number| range.contains(number))?;
        u8::try_from(number).ok()
    };
    let count = |value: &Value| value.as_u64().and_then(|number| u32::try_from(number).ok());
    let maybe = |value: &Value| match value {
        Value::Null => Some(None),
        value => count(value).map(Some),
    };
    let feed = match &value["feed"] {
        Value::Null => CarriedFeed::None,
        feed => match (feed["per_minute"].as_i64(), feed["per_turn"].as_i64()) {
            (Some(nm), None) => CarriedFeed::PerMinute(Feed::from_nm_per_min(nm)),
            (None, Some(nm)) => CarriedFeed::PerTurn(FeedPerTurn::from_nm(nm)),
            _ => return None,
        },
    };
    let shift = &value["shift"];
    Some(Carried {
        motion: small("motion", 0..=3)?,
        unit: match value["inch"].as_bool()? {
            true => LengthUnit::Inch,
            false => LengthUnit::Metric,
        },
        plane: small("plane", 17..=19)?,
        system: small("system", 54..=59)?,
        offset: small("offset", 0..=32)?,
        shift: Position {
            x: Length::from_nm(shift[0].as_i64()?),
            z: Length::from_nm(shift[1].as_i64()?),
            c: Angle::from_udeg(shift[2].as_i64()?),
        },
        per_turn: value["per_turn"].as_bool()?,
        feed,
        speed: count(&value["speed"])?,
        in_surface: value["in_surface"].as_bool()?,
        surface: match &value["surface"] {
            Value::Null => None,
            surface => Some(Feed::from_nm_per_min(surface.as_i64()?)),
        },
        speed_limit: maybe(&value["speed_limit"])?,
        direction: 0,
        without_run_out: value["without_run_out"].as_bool()?,
        incremental: value["incremental"].as_bool()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_comes_back_and_what_is_damaged_does_not() {
        let first = Carried {
            motion: 1,
            unit: LengthUnit::Inch,
            plane: 17,
            system: 57,
            offset: 32,
            shift: Position {
                x: Length::from_nm(-1),
                z: Length::from_nm(2),
                c: Angle::from_udeg(3),
            },
            per_turn: true,
            feed: CarriedFeed::PerTurn(FeedPerTurn::from_nm(200_001)),
            speed: 600,
            in_surface: true,
            surface: Some(Feed::from_nm_per_min(120_000_000_000)),
            speed_limit: Some(2000),
            direction: 0,
            without_run_out: true,
            incremental: false,
        };
        let second = Carried {
            unit: LengthUnit::Metric,
            per_turn: false,
            feed: CarriedFeed::PerMinute(Feed::from_nm_per_min(1)),
            surface: None,
            speed_limit: None,
            without_run_out: false,
            incremental: true,
            ..first
        };
        let third = Carried {
            feed: CarriedFeed::None,
            ..second
        };
        for kept in [first, second, third] {
            let text = value(&kept).to_string();
            let read: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(carried(&read), Some(kept), "{text}");
            for key in read.as_object().unwrap().keys() {
                let mut damaged = read.clone();
                damaged[key] = json!("x");
                assert_eq!(carried(&damaged), None, "{key}");
            }
        }
    }
}
