//! `retract`: brings a tap out of its hole in phase, as G30 P99 does; or shows how, or drops the entry.

use leadscrew_can::Address;
use leadscrew_core::call::LengthUnit;
use leadscrew_core::journal::TapRecord;
use leadscrew_store::{Region, Store};

use super::{board, expand, run};
use crate::cli::{Global, Run};
use crate::diagnostics;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::setup::{Answer, Setup};
use crate::source::SourceFile;
use crate::state::StateFile;
use crate::tapping;
use crate::words::{both, pick};

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Turns per minute.
    pub speed: Option<u32>,
    /// The entry is to be dropped.
    pub discard: bool,
}

/// Does what was typed.
pub fn retract(global: &Global, wish: Wish) -> Outcome {
    if global.bus != Address::Sim {
        return on_board(global, wish);
    }
    let Some(path) = &global.state else {
        return Err(Failure::Usage(both!(
            "`retract` with `--bus sim` needs what a simulated board has kept: name it with `--state FILE`",
            "`retract` 在 `--bus sim` 下需要模拟控制板保存的内容：请用 `--state FILE` 指定文件"
        )));
    };
    let state = StateFile::new(path);
    if wish.discard {
        return discard(global, &state);
    }
    // A file that is not there yet has no tap in a hole: that is said, and nothing is made.
    let record = state.journal(&state.load()?)?;
    let source = text(record.as_ref(), wish);
    if global.dry_run {
        let answer = Answer::Moves { jsonl: false };
        return show(global, &Setup::new(global, None, answer)?, &source);
    }
    run::carry_out(global, &source, &Run::default())
}

/// The same with a board on a real bus.
fn on_board(global: &Global, wish: Wish) -> Outcome {
    if wish.discard {
        let mut link = board::open(global)?;
        link.greet()?;
        if !link.drop_tap()? {
            return Err(no_entry());
        }
        return tell_dropped(global);
    }
    let (mut link, params) = {
        let machine = board::Machine::meet(global)?;
        (machine.link, machine.params)
    };
    let record = TapRecord::decode(&link.journal()?).ok().flatten();
    let source = text(record.as_ref(), wish);
    if global.dry_run {
        let status = link.status()?;
        let base = board::Base {
            params,
            offsets: board::Table::Unknown,
        };
        let mut setup = Setup::over(global, Some(base), None, Answer::Moves { jsonl: false })?;
        setup.position = Some(status.position);
        setup.tap = record;
        return show(global, &setup, &source);
    }
    drop(link);
    board::run(global, &source, &Run::default())
}

/// The program that does it, in the unit of the hole.
fn text(record: Option<&TapRecord>, wish: Wish) -> SourceFile {
    let unit = match record.map(|record| record.hole.notes.unit) {
        Some(LengthUnit::Inch) => "G20 ",
        _ => "",
    };
    let speed = wish.speed.map_or(String::new(), |rpm| format!(" S{rpm}"));
    SourceFile::text("retract", format!("{unit}G30 P99{speed}\n"))
}

/// What would move: the entry in words, then the moves as `expand` prints them.
fn show(global: &Global, setup: &Setup, source: &SourceFile) -> Outcome {
    if !global.json
        && let Some(record) = setup.tap.filter(|record| record.in_hole)
    {
        diagnostics::say(&tapping::text(&record, setup.lang));
    }
    expand::list(setup, source, None)
}

/// Drops the entry; one that cannot be read goes with everything else that is stored.
fn discard(global: &Global, state: &StateFile) -> Outcome {
    let flash = state.load()?;
    let flash = match state.journal(&flash) {
        Ok(Some(record)) if record.in_hole => {
            let out = TapRecord {
                sequence: record.sequence.wrapping_add(1),
                in_hole: false,
                ..record
            };
            let unwritable = |_| {
                Failure::WrongBecause(both!(
                    "the simulated flash cannot be written",
                    "模拟闪存无法写入"
                ))
            };
            let mut store = Store::new(flash).map_err(unwritable)?;
            store.recover().map_err(unwritable)?;
            let written = store.write(Region::TapJournal, &out.encode());
            written.map_err(unwritable)?;
            store.into_flash()
        }
        Ok(_) => {
            return Err(no_entry());
        }
        Err(_) => leadscrew_board_sim::plant::Flash::erased(),
    };
    state.save(&flash)?;
    tell_dropped(global)
}

fn no_entry() -> Failure {
    Failure::WrongBecause(both!(
        "no tap is in a hole: there is no entry to drop",
        "没有丝锥在孔里：没有可清除的记录"
    ))
}

fn tell_dropped(global: &Global) -> Outcome {
    if global.json {
        return output::json(|json| json.flag("ok", true));
    }
    output::write(
        pick(
            global.lang(),
            "dropped: no tap is in a hole any more, as far as the board knows\n",
            "已清除：控制板不再认为有丝锥在孔里\n",
        )
        .as_bytes(),
    )
}
