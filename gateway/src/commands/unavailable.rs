//! What the contract names and cannot be done as it was typed: each is a usage error that says so, never ignored.

use leadscrew_can::Address;

use crate::cli::{Cli, Command};
use crate::failure::{Failure, Outcome};
use crate::words::{Both, both};

/// Refuses options that do not go with the command.
pub fn refuse(cli: &Cli) -> Outcome {
    let global = &cli.global;
    let runs = matches!(
        cli.command,
        Command::Simulate(_) | Command::Plot(_) | Command::Measure(_) | Command::Run(_)
    );
    if global.cut_power.is_some() && global.state.is_none() {
        return Err(Failure::Usage(both!(
            "`--cut-power` without `--state FILE` would forget what the board has stored: name a file for its flash",
            "`--cut-power` 没有 `--state FILE` 就会丢掉控制板存储的内容：请指定保存闪存的文件"
        )));
    }
    if global.cut_power.is_some() && !runs {
        let name = name(&cli.command);
        return Err(Failure::Usage(both!(
            "`--cut-power` goes with `simulate`, `plot`, `measure` and `run`, not with `{name}`",
            "`--cut-power` 只能与 `simulate`、`plot`、`measure`、`run` 一起用，不能用于 `{name}`"
        )));
    }
    if global.state.is_some() && global.bus != Address::Sim {
        let bus = &global.bus;
        return Err(Failure::Usage(both!(
            "`--state` is the flash of a simulated board; the one behind `--bus {bus}` keeps its own",
            "`--state` 是模拟控制板的闪存；`--bus {bus}` 后面的控制板自己保存"
        )));
    }
    let bus = &global.bus;
    if *bus == Address::Sim {
        return Ok(());
    }
    match &cli.command {
        Command::Simulate(_) | Command::Plot(_) | Command::Measure(_) => {
            let name = name(&cli.command);
            Err(Failure::Usage(both!(
                "`{name}` computes in virtual time and talks to no board: leave out `--bus {bus}`, or let a board \
                 carry the program out with `run --bus {bus}`",
                "`{name}` 只在虚拟时间里计算，不与控制板通信：请去掉 `--bus {bus}`，或用 `run --bus {bus}` 让控制板执行程序"
            )))
        }
        Command::Fleet { .. } => Err(Failure::Usage(both!(
            "`fleet` asks a broker and talks to no board: leave out `--bus {bus}`",
            "`fleet` 只向代理服务器查询，不与控制板通信：请去掉 `--bus {bus}`"
        ))),
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
        Command::Measure(_) => "measure",
        Command::Run(_) => "run",
        Command::Explain(_) => "explain",
        Command::Doctor(_) => "doctor",
        Command::Params { .. } => "params",
        Command::Tools { .. } => "tools",
        Command::Drives { .. } => "drives",
        Command::Offsets { .. } => "offsets",
        Command::Touch(_) => "touch",
        Command::Pickup(_) => "pickup",
        Command::Status => "status",
        Command::Monitor { .. } => "monitor",
        Command::Panel { .. } => "panel",
        Command::Agent(_) => "agent",
        Command::Fleet { .. } => "fleet",
        Command::Hold => "hold",
        Command::Resume => "resume",
        Command::Home { .. } => "home",
        Command::Reset => "reset",
        Command::Stop => "stop",
        Command::Mode { .. } => "mode",
        Command::Jog(_) => "jog",
        Command::Tune(_) => "tune",
        Command::Handwheel(_) => "handwheel",
        Command::Override { .. } => "override",
        Command::Io { .. } => "io",
        Command::Signal { .. } => "signal",
        Command::Retract { .. } => "retract",
        Command::Record(_) => "record",
        Command::Mdi { .. } => "mdi",
        Command::Up(_) => "up",
        Command::Down { .. } => "down",
        Command::Sim { .. } => "sim",
        Command::Completions { .. } => "completions",
        Command::Man { .. } => "man",
    }
}

/// Refuses a command that is not available, with the reason.
pub fn command(cli: &Cli) -> Outcome {
    let name = name(&cli.command);
    Err(Failure::Usage(needs_a_board(name, &cli.command)))
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
         name the board's bus, as in `leadscrew {name} --bus can0`, or let a simulated one go on running (`leadscrew up`, then \
         `--bus sim:desk`){en}",
        "`{name}` 需要一块在命令之间持续运行的控制板，而 `--bus sim` 只存在于一条命令之内；请指定控制板所在的总线，如 `leadscrew {name} --bus can0`，或让模拟机床持续运行（先 `leadscrew up`，再用 `--bus sim:desk`）{zh}",
        en = instead.en,
        zh = instead.zh
    )
}
