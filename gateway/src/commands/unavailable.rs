//! What the contract names and cannot be done as it was typed: each is a usage error that says so, never ignored.

use leadscrew_can::Address;

use crate::cli::{Cli, Command};
use crate::failure::{Failure, Outcome};
use crate::words::{Both, both};

/// Refuses options that do not go with the command.
pub fn refuse(cli: &Cli) -> Outcome {
    let global = &cli.global;
    let option = if global.state.is_some() && !matches!(cli.command, Command::Status) {
        Some("--state")
    } else if global.cut_power.is_some() {
        Some("--cut-power")
    } else {
        None
    };
    if let Some(option) = option {
        return Err(Failure::Usage(both!(
            "`{option}` is not available yet",
            "`{option}` 尚未提供"
        )));
    }
    let bus = &global.bus;
    if *bus == Address::Sim {
        return Ok(());
    }
    match &cli.command {
        Command::Simulate(_) | Command::Plot(_) => {
            let name = name(&cli.command);
            Err(Failure::Usage(both!(
                "`{name}` computes in virtual time and talks to no board: leave out `--bus {bus}`, or let a board \
                 carry the program out with `run --bus {bus}`",
                "`{name}` 只在虚拟时间里计算，不与控制板通信：请去掉 `--bus {bus}`，或用 `run --bus {bus}` 让控制板执行程序"
            )))
        }
        _ => Ok(()),
    }
}

/// The command as it is typed.
const fn name(command: &Command) -> &'static str {
    match command {
        Command::Check(_) => "check",
        Command::Expand(_) => "expand",
        Command::Simulate(_) => "simulate",
        Command::Plot(_) => "plot",
        Command::Run(_) => "run",
        Command::Params { .. } => "params",
        Command::Status => "status",
        Command::Monitor => "monitor",
        Command::Hold => "hold",
        Command::Resume => "resume",
        Command::Reset => "reset",
        Command::Stop => "stop",
        Command::Override { .. } => "override",
        Command::Signal { .. } => "signal",
        Command::Retract { .. } => "retract",
        Command::Record(_) => "record",
        Command::Completions { .. } => "completions",
    }
}

/// Refuses a command that is not available, with the reason.
pub fn command(cli: &Cli) -> Outcome {
    let name = name(&cli.command);
    Err(Failure::Usage(match &cli.command {
        Command::Retract { .. } => {
            both!("`{name}` is not available yet", "`{name}` 尚未提供")
        }
        command => needs_a_board(name, command),
    }))
}

/// Why a command cannot be on a machine that lives inside one command.
fn needs_a_board(name: &str, command: &Command) -> Both {
    let instead = match command {
        Command::Signal { .. } => both!(
            "; `--signal NAME=0|1` sets an input from the start of `simulate` and `run`",
            "；`--signal NAME=0|1` 可在 `simulate` 和 `run` 开始时设置输入"
        ),
        Command::Record(_) => both!(
            "; `run --record FILE` writes the frames of the simulated bus",
            "；`run --record FILE` 可写出模拟总线上的报文"
        ),
        _ => Both::default(),
    };
    both!(
        "`{name}` needs a board that goes on running between commands, and `--bus sim` lives inside one command: \
         name the board's bus, as in `leadscrew {name} --bus can0`{en}",
        "`{name}` 需要一块在命令之间持续运行的控制板，而 `--bus sim` 只存在于一条命令之内；请指定控制板所在的总线，如 `leadscrew {name} --bus can0`{zh}",
        en = instead.en,
        zh = instead.zh
    )
}
