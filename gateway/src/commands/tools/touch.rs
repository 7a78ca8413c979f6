//! `touch`: the machine stands where a tool touches a known place of the work; what follows is an offset.
//!
//! ```text
//! M = P + W + S + G + V        G = M − W − value, V := 0        W = M − S − G − V − value
//! ```
//!
//! M is the commanded position, X in diameter: now, or where `--mark` was given. S is the shift of the table; that of G50
//! ends with its program.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::bus::BoardState;
use leadscrew_core::link::Status;
use leadscrew_core::offsets::Offsets;
use leadscrew_core::units::Axis;

use super::home::Home;
use crate::cli::{AxisName, Global, SystemName, Touch};
use crate::commands::ending;
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::tools::{self, Change, Field, Key, Raw, changes, decimal_point};
use crate::words::{Both, both, one_line};

/// Touches off.
pub fn touch(global: &Global, args: &Touch) -> Outcome {
    let mut home = Home::open(global)?;
    if args.mark {
        let (axis, at) = mark(&mut home, args, global.dry_run)?;
        return tell_mark(global, axis, at);
    }
    let made = Made::of(&mut home, args)?;
    if !global.dry_run {
        made.write(&mut home)?;
    }
    tell(global, &home, &made)
}

/// Remembers where an axis stands; with `dry`, says where alone. Each axis has one mark; a touch takes it.
///
/// # Errors
/// No board; it moves, or knows no reference of the axis.
pub fn mark(home: &mut Home, args: &Touch, dry: bool) -> Outcome<(Axis, Raw)> {
    let axis = args.axis.of();
    let now = stand(home, axis)?;
    if !dry {
        let link = &mut home.board()?.link;
        link.set_mark(axis, i32::try_from(now).ok())?;
    }
    home.board()?.keep()?;
    Ok((axis, now))
}

/// Where an axis of a machine at rest stands, which knows its place.
fn stand(home: &mut Home, axis: Axis) -> Outcome<Raw> {
    home.is_whole()?;
    let status = home.board()?.link.status()?;
    stands(&status)?;
    knows_where(&status, axis)?;
    Ok(place(&status, axis))
}

/// What a touch comes to; not written yet.
pub struct Made {
    touched: Touched,
    /// It counts from the mark.
    marked: bool,
    key: Key,
    table: Offsets,
    /// What it changes.
    pub changes: Vec<Change>,
}

impl Made {
    /// Looks at the machine.
    ///
    /// # Errors
    /// As [`mark`]; no coordinate, no tool and no work offset, or a result out of its range.
    pub fn of(home: &mut Home, args: &Touch) -> Outcome<Self> {
        let axis = args.axis.of();
        let now = stand(home, axis)?;
        let Some(value) = &args.value else {
            return Err(Failure::Usage(both!(
                "`touch` needs the coordinate of the place that the tool touches, or `--mark`",
                "`touch` 需要刀具所碰位置的坐标，或 `--mark`"
            )));
        };
        let marked = home.board()?.link.mark(axis)?.map(Raw::from);
        let touched = Touched {
            axis,
            machine: marked.unwrap_or(now),
            value: coordinate(axis, value).map_err(Failure::Usage)?,
            system: args.system.code(),
        };
        let mut table = home.table;
        let key = match (args.work, args.tool) {
            (Some(work), tool) => touched.work(&mut table, work.code(), tool.unwrap_or(0)),
            (None, Some(tool)) => touched.tool(&mut table, tool),
            (None, None) => {
                return Err(Failure::Usage(both!(
                    "`touch` needs `--tool N`, whose geometry is to be set, or `--work G54` for the work offset",
                    "`touch` 需要 `--tool N`（设定其几何偏置），或 `--work G54`（设定工件零点）"
                )));
            }
        }
        .map_err(Failure::WrongBecause)?;
        Ok(Self {
            touched,
            marked: marked.is_some(),
            key,
            changes: changes(&home.table, &table),
            table,
        })
    }

    /// The board stores it, and the mark has gone.
    ///
    /// # Errors
    /// The board refuses.
    pub fn write(&self, home: &mut Home) -> Outcome {
        if !self.changes.is_empty() {
            home.commit(&self.table)?;
        }
        if self.marked {
            home.board()?.link.set_mark(self.touched.axis, None)?;
        }
        Ok(())
    }

    /// Which place of the work is where on the machine.
    pub fn words(&self) -> Both {
        let letter = char::from(self.touched.axis.letter());
        let (name, new) = (
            one_line(&self.key.to_string()),
            mm(self.key.get(&self.table)),
        );
        let (machine, value) = (mm(self.touched.machine), mm(self.touched.value));
        both!(
            "{name} = {new}: {letter} {value} of the work is at {machine} of the machine",
            "{name} = {new}：工件 {letter} {value} 位于机床坐标 {machine}"
        )
    }

    /// It counts from where the axis was marked, and not from where it stands.
    pub const fn is_marked(&self) -> bool {
        self.marked
    }

    /// What it was made in: another text once the table, the mark or the place of the axis is another one.
    pub fn made_in(&self, home: &Home) -> String {
        let Touched { machine, .. } = self.touched;
        let mark = if self.marked { " marked" } else { "" };
        format!("{} {machine}{mark}", home.table.revision.0)
    }
}

/// The coordinate that was typed, which is no value of a table.
fn coordinate(axis: Axis, text: &str) -> Result<Raw, Both> {
    Key::Work(54, axis).parse(text).map_err(|_: Both| {
        let point = decimal_point(text);
        both!(
            "`{text}` is no coordinate of {axis}: millimetres to 0.0001, as 38.42 is one{en}",
            "`{text}` 不是 {axis} 坐标：应为毫米数，最多四位小数，如 38.42{zh}",
            text = one_line(text),
            axis = char::from(axis.letter()),
            en = point.en,
            zh = point.zh
        )
    })
}

/// Where a tool touched, and what is known there.
struct Touched {
    axis: Axis,
    /// Machine coordinate, 0.1 µm, X in diameter.
    machine: Raw,
    /// Coordinate of the work there.
    value: Raw,
    /// The work coordinate system that the coordinate is of.
    system: u8,
}

impl Touched {
    /// Geometry of a tool. Its wear becomes 0.
    fn tool(&self, table: &mut Offsets, tool: u8) -> Result<Key, Both> {
        let axis = self.axis;
        let zero = Key::Work(self.system, axis).get(table) + Key::Shift(axis).get(table);
        let key = Key::Tool(tool, Field::Geometry(axis));
        key.set(table, self.machine - zero - self.value)?;
        Key::Tool(tool, Field::Wear(axis)).set(table, 0)?;
        let measured = Key::Tool(tool, Field::Measured);
        let bit = if axis == Axis::X { 1 } else { 2 };
        measured.set(table, measured.get(table) | bit)?;
        Ok(key)
    }

    /// A work offset, by a tool whose offset is known; 0: none.
    fn work(&self, table: &mut Offsets, code: u8, tool: u8) -> Result<Key, Both> {
        let axis = self.axis;
        let offset = offset(table, tool, axis);
        let key = Key::Work(code, axis);
        let shift = Key::Shift(axis).get(table);
        key.set(table, self.machine - shift - offset - self.value)?;
        Ok(key)
    }
}

/// Refuses a machine that moves or is about to.
pub fn stands(status: &Status) -> Outcome {
    let at_rest = match status.state {
        BoardState::Idle | BoardState::Alarm | BoardState::Starting => !status.in_program,
        _ => false,
    };
    if at_rest {
        return Ok(());
    }
    let code = match status.in_program {
        true => Code::OffsetsAtWork,
        false => Code::NotAtRest,
    };
    Err(Failure::WrongBecause(alarm_words(&Alarm::of(code, &[]))))
}

/// Refuses an axis without the reference that a program would need: what follows from its place would be wrong.
pub fn knows_where(status: &Status, axis: Axis) -> Outcome {
    if !status.unreferenced.contains(axis) {
        return Ok(());
    }
    let alarm = Alarm::of(Code::NotReferenced, &[Arg::Letter(axis.letter())]);
    Err(Failure::WrongBecause(alarm_words(&alarm)))
}

/// Geometry and wear of a tool, in 0.1 µm; 0: no tool.
pub fn offset(table: &Offsets, tool: u8, axis: Axis) -> Raw {
    let of = |field| Key::Tool(tool, field).get(table);
    of(Field::Geometry(axis)) + of(Field::Wear(axis))
}

/// The commanded position in 0.1 µm, X in diameter, rounded.
pub fn place(status: &Status, axis: Axis) -> Raw {
    let nm = match axis {
        Axis::X => status.position.x.nm() * 2,
        _ => status.position.z.nm(),
    };
    (nm + nm.signum() * 50) / 100
}

/// A length for people: always with its thousandths.
fn mm(raw: Raw) -> String {
    format!("{:.4}", raw as f64 / 10_000.0)
}

/// A mark in words.
pub fn marked(axis: Axis, at: Raw) -> Both {
    both!(
        "{letter} marked at {at} (machine)",
        "{letter} 已记下机床坐标 {at}",
        letter = char::from(axis.letter()),
        at = mm(at)
    )
}

fn tell_mark(global: &Global, axis: Axis, at: Raw) -> Outcome {
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            o.text("axis", &char::from(axis.letter()).to_string());
            o.number("machine", Key::Work(54, axis).shown(at));
        });
    }
    let told = marked(axis, at);
    output::write(format!("{}\n", told.get(global.lang())).as_bytes())
}

fn tell(global: &Global, home: &Home, made: &Made) -> Outcome {
    let revision = home.table.revision.0;
    let key = made.key;
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            o.flag("done", !global.dry_run);
            o.integer("revision", revision.into());
            o.text("key", &key.to_string());
            tools::value(o, "value", key, key.get(&made.table));
            o.number("machine", key.shown(made.touched.machine));
            tools::fields(o, &made.changes);
        });
    }
    let end = ending(global, &both!("revision {revision}", "修订号 {revision}"));
    let (head, lang) = (made.words(), global.lang());
    let text = [
        head.get(lang),
        "\n",
        &tools::text(&made.changes),
        end.get(lang),
    ]
    .concat();
    output::write(text.as_bytes())
}

impl AxisName {
    /// The axis.
    const fn of(self) -> Axis {
        match self {
            Self::X => Axis::X,
            Self::Z => Axis::Z,
        }
    }
}

impl SystemName {
    /// The G code.
    const fn code(self) -> u8 {
        match self {
            Self::G54 => 54,
            Self::G55 => 55,
            Self::G56 => 56,
            Self::G57 => 57,
            Self::G58 => 58,
            Self::G59 => 59,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::bench;

    fn touched(axis: Axis, machine: Raw, value: Raw) -> Touched {
        Touched {
            axis,
            machine,
            value,
            system: 54,
        }
    }

    fn with(texts: &[&str]) -> Offsets {
        let mut table = Offsets::default();
        for text in texts {
            tools::assign(&mut table, text).unwrap();
        }
        table
    }

    #[test]
    fn the_geometry_of_a_tool_follows_from_a_diameter_and_from_the_face() {
        let mut table = with(&["G54.Z=-400", "T1.wear.X=-0.02", "T1.wear.Z=0.5"]);
        let x = touched(Axis::X, -2_123_400, 384_200);
        let key = x.tool(&mut table, 1).unwrap();
        assert_eq!(key.shown(key.get(&table)), "-250.76");
        let z = touched(Axis::Z, -3_051_250, 0);
        let key = z.tool(&mut table, 1).unwrap();
        assert_eq!(key.shown(key.get(&table)), "94.875");
        let expected = with(&[
            "G54.Z=-400",
            "T1.X=-250.76",
            "T1.Z=94.875",
            "T1.measured=XZ",
        ]);
        assert_eq!(table, expected);
    }

    #[test]
    fn the_work_offset_follows_by_a_known_tool() {
        let mut table = with(&["shift.Z=2", "T1.Z=94.875", "T1.wear.Z=-0.5", "G55.Z=1"]);
        let z = touched(Axis::Z, -3_051_250, 0);
        z.work(&mut table, 54, 1).unwrap();
        // -305.125 - 2 - 94.875 + 0.5
        assert_eq!(Key::Work(54, Axis::Z).get(&table), -4_015_000);
        z.work(&mut table, 55, 0).unwrap();
        assert_eq!(Key::Work(55, Axis::Z).get(&table), -3_071_250);
        assert!(!table.tools[0].measured_z);
    }

    #[test]
    fn the_tool_is_measured_in_the_system_that_is_named() {
        let mut table = with(&["shift.X=1", "G56.X=10"]);
        let system = 56;
        let x = Touched {
            system,
            ..touched(Axis::X, 500_000, 200_000)
        };
        let key = x.tool(&mut table, 3).unwrap();
        assert_eq!(key.shown(key.get(&table)), "19");
    }

    #[test]
    fn what_is_no_coordinate_is_refused_as_one() {
        assert_eq!(coordinate(Axis::X, "38.42"), Ok(384_200));
        let told = |text| coordinate(Axis::X, text).unwrap_err().en;
        let comma = told("38,42");
        assert!(
            comma.starts_with("`38,42` is no coordinate of X"),
            "{comma}"
        );
        assert!(comma.ends_with("write a point, not a comma"), "{comma}");
        assert!(told("0.00001").ends_with("38.42 is one"));
    }

    #[test]
    fn what_moves_without_a_program_is_told_apart_from_a_program() {
        let refused = |state, in_program| {
            let status = Status {
                state,
                in_program,
                ..bench::status()
            };
            match stands(&status) {
                Err(Failure::WrongBecause(words)) => words.en.get(..4).unwrap().to_owned(),
                other => format!("{other:?}"),
            }
        };
        assert_eq!(refused(BoardState::Run, false), "4507");
        assert_eq!(refused(BoardState::Run, true), "4580");
        assert_eq!(refused(BoardState::Idle, true), "4580");
        assert_eq!(refused(BoardState::Idle, false), "Ok(())");
    }

    #[test]
    fn a_result_out_of_range_changes_nothing() {
        let mut table = Offsets::default();
        let far = touched(Axis::X, -100_000_000, 0);
        let why = far.tool(&mut table, 1).unwrap_err();
        assert!(
            why.en.starts_with("4582: T1.X: `-10000` is outside"),
            "{}",
            why.en
        );
        assert_eq!(table, Offsets::default());
    }
}
