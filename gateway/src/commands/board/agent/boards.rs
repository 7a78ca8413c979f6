//! Which boards an agent reads, and what they and it are called.

use std::fs;

use crate::cli::{Agent, Board, Global};
use crate::failure::{Failure, Outcome};
use crate::words::both;

/// Where the name of this computer stands.
const HOST: &str = "/proc/sys/kernel/hostname";
/// An agent on a computer that has no name.
const NOBODY: &str = "leadscrew";

/// A board that is read.
#[derive(Clone, Debug)]
pub struct Seat {
    /// Its machine, as a part of a topic.
    pub machine: String,
    /// The options that count for it.
    pub global: Global,
}

/// The boards that were asked for, each with options of its own.
///
/// # Errors
/// Two are one, or an option has no meaning with the others.
pub fn seats(global: &Global, wish: &Agent) -> Outcome<Vec<Seat>> {
    if wish.boards.is_empty() {
        let machine = match &wish.machine {
            Some(machine) => machine.clone(),
            None => machine(global)?,
        };
        global.bit_rate()?;
        return Ok(vec![Seat {
            machine,
            global: global.clone(),
        }]);
    }
    for (option, is_given) in [
        ("--bus", global.typed_bus.is_some()),
        ("--node", global.node.is_some()),
        ("--bitrate", global.bitrate.is_some()),
    ] {
        if is_given {
            return Err(Failure::Usage(both!(
                "`{option}` is of one board, and each `--board` has its own: `--board NAME=BUS,node=N,bitrate=KBIT`",
                "`{option}` 只用于一块控制板，而每个 `--board` 各有自己的：`--board NAME=BUS,node=N,bitrate=KBIT`"
            )));
        }
    }
    let mut seats: Vec<Seat> = Vec::new();
    for board in &wish.boards {
        let seat = seat(global, board);
        let number = seat.global.board()?;
        seat.global.bit_rate()?;
        if let Some(other) = seats.iter().find(|other| other.machine == seat.machine) {
            let name = &other.machine;
            return Err(Failure::Usage(both!(
                "two boards are called `{name}`: nobody could tell them apart; give each `--board` a name of its own",
                "有两块控制板都叫 `{name}`，无法区分：请为每个 `--board` 取不同的名称"
            )));
        }
        let is_same =
            |other: &&Seat| other.global.bus == seat.global.bus && other.global.node() == number;
        if let Some(other) = seats.iter().find(is_same) {
            let (one, two) = (&other.machine, &seat.machine);
            let (bus, node) = (&seat.global.bus, number.get());
            return Err(Failure::Usage(both!(
                "`{one}` and `{two}` are one board, node {node} on {bus}: leave one of them out",
                "`{one}` 和 `{two}` 是同一块控制板（{bus} 上的节点 {node}）：请去掉其中一个"
            )));
        }
        seats.push(seat);
    }
    Ok(seats)
}

fn seat(global: &Global, board: &Board) -> Seat {
    Seat {
        machine: board.machine.clone(),
        global: Global {
            bus: board.bus.clone(),
            node: board.node,
            bitrate: board.bitrate,
            ..global.clone()
        },
    }
}

/// The bus and the node, as a part of a topic.
fn machine(global: &Global) -> Outcome<String> {
    let bus = global.bus.to_string().replace(['/', '+', '#'], "-");
    Ok(format!("{bus}-{}", global.board()?.get()))
}

/// This computer, and the machine where there is one alone, as a part of a topic.
pub fn node(seats: &[Seat]) -> String {
    let host = fs::read_to_string(HOST).unwrap_or_default();
    match (host.trim(), seats) {
        ("", [seat]) => seat.machine.clone(),
        ("", _) => NOBODY.to_owned(),
        (host, [seat]) => format!("{host}-{}", seat.machine),
        (host, _) => host.to_owned(),
    }
}
