//! Commands that talk to a board on a real bus. What they share: opening the link, the words for a state, one result.

mod agent;
mod by_hand;
mod handwheel;
mod home;
mod io;
mod machine;
mod mdi;
mod monitor;
mod operate;
mod own;
mod panel;
mod resume;
mod run;
mod status;
mod watch;

use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::{BoardCommand, BoardState};

use crate::cli::Global;
use crate::failure::Outcome;
use crate::link::Link;
use crate::words::pick;

pub use agent::agent;
pub use by_hand::{ANSWER, Held, RENEWAL, jog, mode};
pub use handwheel::handwheel;
pub use home::{home, names};
pub use io::io;
pub use machine::{Base, Greeted, Machine, Table, base};
pub use mdi::{mdi, modal_words};
pub use monitor::monitor;
pub use operate::{levels, order, signal};
pub use panel::panel;
pub use resume::resume;
pub use run::{Work, no_figures, perform_on, run};
pub use status::status;

/// The bus and the number of the options; nothing has been said yet.
pub fn open(global: &Global) -> Outcome<Link> {
    Ok(Link::open(
        &global.bus,
        global.board()?,
        global.bit_rate()?,
    )?)
}

/// The same once it has answered and its status is heard. Its switches are left as they are.
fn heard(global: &Global) -> Outcome<Link> {
    let mut link = open(global)?;
    link.greet()?;
    link.hear_status()?;
    Ok(link)
}

/// Sets the switch of the machine where an option says so; else it stays as the operator has it [D513].
fn single_block(global: &Global, link: &mut Link) -> Outcome {
    if global.single_block.is_some() {
        link.set_levels(BoardCommand {
            single_block: global.single_block,
            ..BoardCommand::default()
        })?;
    }
    Ok(())
}

/// What the machine is doing, for people.
#[must_use]
pub const fn state_words(state: BoardState, lang: Lang) -> &'static str {
    match state {
        BoardState::Starting => pick(lang, "starting its drives", "正在启动驱动器"),
        BoardState::Idle => pick(lang, "idle", "空闲"),
        BoardState::Run => pick(lang, "running", "运行"),
        BoardState::Hold => pick(lang, "feed hold", "进给保持"),
        BoardState::Dwell => pick(lang, "dwell", "暂停延时"),
        BoardState::Wait => pick(lang, "waiting", "等待"),
        BoardState::Stopping => pick(lang, "stopping", "正在停止"),
        BoardState::Alarm => pick(lang, "alarm", "报警"),
    }
}
