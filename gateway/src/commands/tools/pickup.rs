//! `pickup`: the tip of a tool stands in the groove of a thread that was cut before; all threads follow that groove.
//!
//! What is kept is where the tip is by the machine (its slide less geometry and wear of the tool), and the angle of the
//! spindle there. What follows from it for a thread is worked out where programs are read.

use std::time::Duration;

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::link::Status;
use leadscrew_core::offsets::{Offsets, PickedUp};
use leadscrew_core::signals::Signals;
use leadscrew_core::units::{Angle, Axis, Turns};

use super::home::Home;
use super::touch::{knows_where, offset, place, stands};
use crate::cli::{Global, Pickup};
use crate::commands::ending;
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::link::Link;
use crate::output;
use crate::tools::{self, Change, Groove, Key, changes, value};
use crate::words::{Both, both};

/// Two readings of a spindle that stands are so far apart in time,
const STILL: Duration = Duration::from_millis(200);

/// and differ by no more than this: a count of an encoder of 4096, or 0.08 rpm.
const STANDS_UDEG: i64 = 100_000;

/// Picks a thread up, or lets it go.
pub fn pickup(global: &Global, args: &Pickup) -> Outcome {
    let mut home = Home::open(global)?;
    home.is_whole()?;
    let mut table = home.table;
    if args.clear {
        home.board()?;
        table.thread = PickedUp::default();
    } else if let Some(tool) = args.tool {
        let link = &mut home.board()?.link;
        let (_, first) = at_rest(link)?;
        link.idle(STILL)?;
        let (status, angle) = at_rest(link)?;
        if !is_still(first, angle) {
            return Err(turns(&status));
        }
        for axis in [Axis::X, Axis::Z] {
            let tip = place(&status, axis) - offset(&table, tool, axis);
            let key = Key::Thread(Groove::Tip(axis));
            key.set(&mut table, tip).map_err(Failure::WrongBecause)?;
        }
        table.thread.angle = Some(angle);
    } else {
        home.warn(global);
        return tell(global, &home, &table, &[]);
    }
    let changes = changes(&home.table, &table);
    if !global.dry_run && !changes.is_empty() {
        home.commit(&table)?;
    }
    tell(global, &home, &table, &changes)
}

/// The machine, which stands and knows its place, and the angle of its spindle.
fn at_rest(link: &mut Link) -> Outcome<(Status, Angle)> {
    let status = link.status()?;
    stands(&status)?;
    for axis in [Axis::X, Axis::Z] {
        knows_where(&status, axis)?;
    }
    let angle = angle(&status)?;
    Ok((status, angle))
}

/// The angle of the spindle, where it stands and counts from its index.
fn angle(status: &Status) -> Outcome<Angle> {
    let rpm = status.speed.rpm();
    if rpm.get() != 0 || status.command.get() != 0 {
        return Err(turns(status));
    }
    if status.signals & Signals::INDEXED == 0 {
        let alarm = Alarm::of(Code::PickupNoIndex, &[]);
        return Err(Failure::WrongBecause(alarm_words(&alarm)));
    }
    Ok(within_a_turn(status.spindle))
}

fn turns(status: &Status) -> Failure {
    let alarm = Alarm::of(Code::PickupTurning, &[Arg::Rpm(status.speed.rpm())]);
    Failure::WrongBecause(alarm_words(&alarm))
}

/// A spindle that runs out or is turned by hand is at 0 rpm, rounded, before it stands. One whose encoder trembles over a
/// count stands.
fn is_still(before: Angle, after: Angle) -> bool {
    const TURN: i64 = 360_000_000;
    let way = (after.udeg() - before.udeg()).rem_euclid(TURN);
    way.min(TURN - way) <= STANDS_UDEG
}

/// An angle in whole steps of a table, within one turn.
fn within_a_turn(turns: Turns) -> Angle {
    let part = u64::from(turns.raw() as u32);
    let steps = u64::from(Offsets::ANGLE_STEPS);
    let step = (part * steps + (1 << 31)) >> 32;
    Angle::from_udeg((step % steps) as i64 * Offsets::ANGLE_STEP_UDEG)
}

fn tell(global: &Global, home: &Home, table: &Offsets, changes: &[Change]) -> Outcome {
    let revision = home.table.revision.0;
    let keys = Groove::ALL.map(Key::Thread);
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            o.flag("done", !global.dry_run);
            o.integer("revision", revision.into());
            o.flag("picked_up", table.thread.angle.is_some());
            if table.thread.angle.is_some() {
                for (name, key) in ["x", "z", "angle"].into_iter().zip(keys) {
                    value(o, name, key, key.get(table));
                }
            }
            tools::fields(o, changes);
        });
    }
    let lang = global.lang();
    let head = if table.thread.angle.is_some() {
        let [x, z, angle] = keys.map(|key| key.shown(key.get(table)));
        both!(
            "threads follow the groove with the tip at X {x}, Z {z} of the machine and the spindle at {angle}°; \
             `leadscrew pickup --clear` ends that\n",
            "螺纹将沿此牙槽切削：刀尖位于机床坐标 X {x}、Z {z}，主轴 {angle}°；`leadscrew pickup --clear` 可取消\n"
        )
    } else {
        both!(
            "no thread is picked up: every thread begins at its own start angle\n",
            "未拾取螺纹：各螺纹从自身的起始角开始\n"
        )
    };
    let end = match changes {
        [] => Both::default(),
        _ => ending(global, &both!("revision {revision}", "修订号 {revision}")),
    };
    let text = [head.get(lang), &tools::text(changes), end.get(lang)].concat();
    output::write(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spindle_stands_that_is_twice_in_one_place() {
        for (before, after, still) in [
            (0, 0, true),
            (0, 100_000, true),
            (100_000, 0, true),
            (359_950_000, 40_000, true),
            (40_000, 359_950_000, true),
            // At 0.4 rpm.
            (10_000_000, 10_480_000, false),
            (359_900_000, 100_000, false),
            (0, 180_000_000, false),
        ] {
            let [before, after] = [before, after].map(Angle::from_udeg);
            assert_eq!(is_still(before, after), still, "{before:?} {after:?}");
        }
    }

    #[test]
    fn an_angle_is_that_of_its_turn_to_the_nearest_step() {
        for (raw, udeg) in [
            (0, 0),
            (1 << 30, 90_000_000),
            (-(1_i64 << 30), 270_000_000),
            ((7 << 32) + (1 << 31), 180_000_000),
            // Half a step is 1193.05/2 parts.
            (596, 0),
            (597, 100),
            (-596, 0),
            (-597, 359_999_900),
        ] {
            assert_eq!(within_a_turn(Turns::from_raw(raw)).udeg(), udeg, "{raw}");
        }
    }
}
