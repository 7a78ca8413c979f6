//! Where the table lives that a command is about: on a board, in a file, or in the parameters of old.

use leadscrew_can::Address;
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::params::Params;

use crate::cli::Global;
use crate::commands::board::Machine;
use crate::diagnostics::{alarm_words, say};
use crate::failure::{Failure, Outcome};
use crate::setup;
use crate::tools;
use crate::words::{self, Both, both};

/// The home of a table.
pub struct Home {
    /// The board, if it is one's.
    pub machine: Option<Machine>,
    /// The table in force.
    pub table: Offsets,
    /// The last revision that the board has given.
    last: Revision,
    /// The board's newest table is damaged: the one in force is an older one.
    damaged: bool,
    /// Whose it is.
    pub name: Both,
}

impl Home {
    /// Of the table that the options name.
    ///
    /// # Errors
    /// No bus, no board, another version; a file that cannot be read; parameters that no table can have.
    pub fn open(global: &Global) -> Outcome<Self> {
        if global.bus == Address::Sim && global.state.is_none() {
            return Self::without_board(global);
        }
        let mut machine = Machine::meet(global)?;
        let kept = machine.link.offsets()?;
        let is_none = kept.whole && kept.table.revision == Revision::default();
        let board = both!(
            "node {node} on {bus}",
            "{bus} 上节点 {node} ",
            node = machine.link.node().get(),
            bus = machine.link.bus()
        );
        let (table, name) = if is_none {
            let name = both!(
                "the parameters of {en}, which has no tool table yet",
                "{zh}的参数（尚无刀具表）",
                en = board.en,
                zh = board.zh
            );
            (of_params(&machine.params)?, name)
        } else {
            (kept.table, board)
        };
        Ok(Self {
            machine: Some(machine),
            table,
            last: kept.last,
            damaged: !kept.whole,
            name,
        })
    }

    fn without_board(global: &Global) -> Outcome<Self> {
        let (table, name) = match &global.tools {
            Some(path) => (
                tools::read(path, global.lang())?,
                Both::same(words::path(path)),
            ),
            None => (
                of_params(&setup::load(global)?.params)?,
                both!("the machine's parameters", "机床参数"),
            ),
        };
        Ok(Self {
            machine: None,
            table,
            last: Revision::default(),
            damaged: false,
            name,
        })
    }

    /// Tells of a damaged table.
    pub fn warn(&self, global: &Global) {
        if self.damaged {
            say(&format!("{}\n", self.alarm().get(global.lang())));
        }
    }

    fn alarm(&self) -> Both {
        let figures = [Arg::Int(self.table.revision.0.into())];
        alarm_words(&Alarm::of(Code::OffsetsDamaged, &figures))
    }

    /// Refuses to change single values of a table that is not the newest.
    ///
    /// # Errors
    /// The newest table is damaged.
    pub fn is_whole(&self) -> Outcome {
        if self.damaged {
            return Err(Failure::WrongBecause(self.alarm()));
        }
        Ok(())
    }

    /// The board.
    ///
    /// # Errors
    /// There is none.
    pub fn board(&mut self) -> Outcome<&mut Machine> {
        self.machine.as_mut().ok_or_else(|| {
            Failure::Usage(both!(
                "this needs a board: name its bus (`--bus can0`), or the flash of a simulated one (`--state FILE`)",
                "这需要一块控制板：请指定总线（`--bus can0`），或模拟控制板的闪存（`--state FILE`）"
            ))
        })
    }

    /// The board stores a table; gives its revision.
    ///
    /// # Errors
    /// There is no board, or it refuses.
    pub fn commit(&mut self, table: &Offsets) -> Outcome<Revision> {
        let last = self.last;
        let machine = self.board()?;
        let committed = machine.link.commit_offsets(table, last);
        machine.keep()?;
        self.last = committed?;
        self.table = Offsets {
            revision: self.last,
            ..*table
        };
        Ok(self.last)
    }
}

/// The table that says the same as a parameter set.
///
/// # Errors
/// The set makes none.
pub fn of_params(params: &Params) -> Outcome<Offsets> {
    Offsets::of_params(params).map_err(|record| {
        let figures = [Arg::Int(record.number().into())];
        let why = alarm_words(&Alarm::of(Code::OffsetsOutOfRange, &figures));
        Failure::WrongBecause(both!(
            "parameters 1221 to 1226, 9101 to 9132, 9201 to 9216 and 9301 to 9316 make no tool table: {en}",
            "参数 1221 至 1226、9101 至 9132、9201 至 9216、9301 至 9316 无法构成刀具表：{zh}",
            en = why.en,
            zh = why.zh
        ))
    })
}
