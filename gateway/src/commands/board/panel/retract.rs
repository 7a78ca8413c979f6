//! The way out of a hole, for the page: what the board has written down of the tap. Nothing moves by it.

use leadscrew_core::alarm::Lang;
use leadscrew_core::journal::TapRecord;

use super::super::open;
use super::tables::said;
use super::{desk, object};
use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::tapping;
use crate::words::{Both, both};

/// The record in words, as JSON; or why there is none.
pub fn shown(global: &Global) -> String {
    let read = read(global).map_err(said);
    object(|json| match read {
        Ok(record) => {
            json.flag("ok", true);
            json.text("en", &tapping::text(&record, Lang::En));
            json.text("zh", &tapping::text(&record, Lang::Zh));
        }
        Err(words) => desk::fields(json, &Err(words)),
    })
}

fn read(global: &Global) -> Outcome<TapRecord> {
    let mut link = open(global)?;
    link.greet()?;
    let record = TapRecord::decode(&link.journal()?).map_err(|_| {
        Failure::WrongBecause(both!(
            "the record of the tap cannot be read; look where the tap is, and see `leadscrew retract`",
            "丝锥记录无法读取；请查看丝锥位置，并参阅 `leadscrew retract`"
        ))
    })?;
    record
        .filter(|record| record.in_hole)
        .ok_or_else(|| Failure::WrongBecause(none()))
}

fn none() -> Both {
    both!(
        "no tap is in a hole, as far as the board knows; nothing has to be brought out",
        "控制板没有丝锥在孔中的记录；无需退出"
    )
}
