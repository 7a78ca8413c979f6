//! One file a command.

pub mod board;
mod broker;
mod check;
mod completions;
mod desk;
mod doctor;
mod drives;
mod expand;
mod explain;
mod fleet;
mod man;
mod measure;
mod params;
mod picture;
mod plot;
mod record;
mod retract;
pub mod run;
mod simulate;
mod status;
mod table;
mod tools;
mod tune;
mod unavailable;

use leadscrew_can::Address;
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::Order;

use crate::cli::{Cli, Command, Format, Global};
use crate::failure::Outcome;
use crate::setup::{Answer, Setup};
use crate::source::SourceFile;
use crate::words::{Both, both, pick};

/// Does what was typed.
pub fn dispatch(cli: &Cli) -> Outcome {
    unavailable::refuse(cli)?;
    match &cli.command {
        Command::Completions { shell } => completions::print(*shell),
        Command::Man { command, to } => man::run(command, to.as_deref(), cli.global.lang()),
        Command::Explain(args) => explain::run(&cli.global, args),
        Command::Params { command } => params::run(&cli.global, command),
        Command::Tools { command } => tools::tools(&cli.global, command),
        Command::Drives { command } => drives::run(&cli.global, command),
        Command::Offsets { command } => tools::offsets(&cli.global, command),
        Command::Touch(args) => tools::touch(&cli.global, args),
        Command::Pickup(args) => tools::pickup(&cli.global, args),
        Command::Check(args) => check::run(&cli.global, args),
        Command::Expand(args) => {
            let jsonl = args.format == Some(Format::Jsonl);
            let program = Some(&*args.program);
            expand::run(
                &Setup::new(&cli.global, program, Answer::Moves { jsonl })?,
                args,
            )
        }
        Command::Simulate(args) => {
            let program = SourceFile::new(&args.program);
            simulate::run(
                &Setup::with_drive(&cli.global, &args.drive, &program)?,
                args,
            )
        }
        Command::Plot(args) => {
            let format = picture::PictureFormat::of(&args.output)?;
            let program = SourceFile::new(&args.program);
            plot::run(
                &Setup::with_drive(&cli.global, &args.drive, &program)?,
                args,
                format,
            )
        }
        Command::Measure(args) => {
            let output = args.output.as_deref();
            let format = output.map(picture::Format::of).transpose()?;
            let program = SourceFile::new(&args.program);
            measure::run(
                &Setup::with_drive(&cli.global, &args.drive, &program)?,
                args,
                format.as_ref(),
            )
        }
        Command::Run(args) => run::run(&cli.global, args),
        Command::Status if is_real(cli) => board::status(&cli.global),
        Command::Status => status::run(&cli.global),
        Command::Record(args) if is_real(cli) => record::run(
            &Setup::over(&cli.global, None, None, Answer::Parameters)?,
            args,
        ),
        Command::Doctor(args) => doctor::run(&cli.global, args),
        Command::Retract { speed, discard } => retract::retract(
            &cli.global,
            retract::Wish {
                speed: *speed,
                discard: *discard,
            },
        ),
        Command::Mdi { line } if is_real(cli) => board::mdi(&cli.global, line.as_deref()),
        Command::Up(args) => desk::up(&cli.global, args),
        Command::Down { name } => desk::down(&cli.global, name.as_ref()),
        Command::Sim { name, command } => desk::sim(&cli.global, name.as_ref(), *command),
        Command::Monitor { watch } if is_real(cli) => board::monitor(&cli.global, *watch),
        Command::Panel {
            listen,
            hosts,
            look,
            programs,
        } if is_real(cli) => board::panel(&cli.global, *listen, hosts, *look, programs.as_deref()),
        Command::Agent(args) if is_real(cli) || !args.boards.is_empty() => {
            board::agent(&cli.global, args)
        }
        Command::Fleet { command } => fleet::run(&cli.global, command),
        Command::Hold if is_real(cli) => board::order(&cli.global, Order::Hold),
        Command::Resume if is_real(cli) => board::resume(&cli.global),
        Command::Reset if is_real(cli) => board::order(&cli.global, Order::Reset),
        Command::Stop if is_real(cli) => board::order(&cli.global, Order::Stop),
        Command::Mode { mode } if is_real(cli) => board::mode(&cli.global, *mode),
        Command::Jog(args) if is_real(cli) => board::jog(&cli.global, args),
        Command::Tune(args) if is_real(cli) => tune::run(&cli.global, args),
        Command::Handwheel(args) if is_real(cli) => board::handwheel(&cli.global, args),
        Command::Home { axes } if is_real(cli) => board::home(&cli.global, axes),
        Command::Override { what, percent } if is_real(cli) => {
            board::levels(&cli.global, *what, *percent)
        }
        Command::Io { command } if is_real(cli) => board::io(&cli.global, command),
        Command::Signal { signal } if is_real(cli) => board::signal(&cli.global, *signal),
        _ => unavailable::command(cli),
    }
}

/// A board on a real bus is meant.
fn is_real(cli: &Cli) -> bool {
    cli.global.bus != Address::Sim
}

/// Numbers of inputs or outputs as a list.
fn contact_numbers(numbers: impl Iterator<Item = u8>) -> String {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    numbers.join(" ")
}

/// A list as people read it, where it may be empty.
fn or_none(list: String, lang: Lang) -> String {
    match list.is_empty() {
        true => pick(lang, "none", "无").to_owned(),
        false => list,
    }
}

/// How a change has ended. `what` identifies what is in force.
fn ending(global: &Global, what: &Both) -> Both {
    if global.dry_run {
        return both!(
            "nothing has been changed (`--dry-run`)\n",
            "未作任何更改（`--dry-run`）\n"
        );
    }
    both!(
        "stored and in force, {en}\n",
        "已保存并生效，{zh}\n",
        en = what.en,
        zh = what.zh
    )
}
