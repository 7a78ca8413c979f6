//! `up`: starts a simulated machine in a process of its own, or is that process.
//!
//! ```text
//! up ── starts ──► up --foreground --detached --json ── one line: it runs, or why not ──► up tells it and comes back
//! ```
//!
//! The second process has the log as its standard error and nothing of the terminal.

use std::fs::{self, File, OpenOptions};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use leadscrew_can::{Address, Desk, MachineName};
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Angle, Length};
use leadscrew_desk::clock::Speed;
use leadscrew_desk::control::{Answer, View};
use leadscrew_desk::hand::{Handled as _, wrong_speed};
use leadscrew_desk::machine::{Machine, Recipe, Turning};
use leadscrew_desk::server::Server;
use serde_json::Value;

use super::{json, name, runs_already};
use crate::cli::{BUS, Global, Up};
use crate::failure::{Doing, Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::itself;
use crate::machine::ripple;
use crate::output;
use crate::params;
use crate::profiles::Chosen;
use crate::setup::told_good;
use crate::state;
use crate::words::{self, Both, both};

/// Starts a machine.
pub fn up(global: &Global, args: &Up) -> Outcome {
    refuse(global)?;
    let name = name(global, args.name.as_ref())?;
    let speed = match args.speed {
        None => Speed::REAL,
        Some(factor) => {
            let speed = Speed::of_thousandths(factor.0);
            speed.ok_or_else(|| Failure::Usage(wrong_speed()))?
        }
    };
    let params = wanted(global, args)?;
    let drives = Chosen::of(&args.drives.drive, global.lang())?;
    let spindle = Turning {
        ripple: ripple(args.spindle_ripple)?,
        ramp_ms: args.spindle_ramp,
    };
    let desk = Desk::make().map_err(Failure::bus)?;
    let home = Home::make(&name)?;
    if !args.foreground {
        return start(global, &desk, &name, &home);
    }
    if args.detached {
        // It fails for the leader of a group, which this process is not: then the terminal's end would reach it, no more.
        let _ = nix::unistd::setsid();
    }
    let claim = desk.claim(&name).map_err(Failure::bus)?;
    let claim = claim.ok_or_else(|| runs_already(&name))?;
    interrupt::defer(UnderWay::Machine);
    let machine = Machine::new(&Recipe {
        flash: &home.file("flash"),
        params,
        new: args.new,
        node: global.board()?,
        serial: name.serial(),
        at: at(global),
        drives,
        spindle,
    })?;
    let mut server = Server::open(&desk, &name, claim, machine, global.lang())?;
    server.set_speed(speed);
    if args.detached {
        // All that is relative has been read; a folder that the user wants to remove is not held.
        let _ = std::env::set_current_dir("/");
    }
    tell(global, &server.view(), &home, args.foreground)?;
    server.run()
}

/// Refuses what would be ignored.
fn refuse(global: &Global) -> Outcome {
    if !matches!(global.bus, Address::Sim | Address::Machine(_)) && global.typed_bus.is_some() {
        let bus = &global.bus;
        return Err(Failure::Usage(both!(
            "`up` starts a simulated machine, whose bus is `sim:NAME`: leave out `--bus {bus}`",
            "`up` 启动的是模拟机床，其总线为 `sim:NAME`：请去掉 `--bus {bus}`"
        )));
    }
    let option = if global.state.is_some() {
        "--state"
    } else if !global.signal.is_empty() {
        "--signal"
    } else {
        return Ok(());
    };
    Err(Failure::Usage(both!(
        "`{option}` is not for `up`: the machine keeps its flash in a folder of its own, and `leadscrew signal` sets its inputs",
        "`{option}` 不能用于 `up`：机床在自己的文件夹里保存闪存，输入信号用 `leadscrew signal` 设置"
    )))
}

/// The parameters that the options name; `None` where they name none.
fn wanted(global: &Global, args: &Up) -> Outcome<Option<Params>> {
    let files: Vec<PathBuf> = args.machine.iter().chain(&global.params).cloned().collect();
    if files.is_empty() && global.set.is_empty() {
        return Ok(None);
    }
    let loaded = params::load(&files, &global.set, global.lang())?;
    Ok(Some(told_good(global, loaded)?.params))
}

/// Where the axes stand.
fn at(global: &Global) -> Position {
    let at = global.at.unwrap_or_default();
    Position {
        x: Length::from_nm(at.x_nm),
        z: Length::from_nm(at.z_nm),
        c: Angle::from_udeg(at.c_udeg),
    }
}

/// The folder with what a machine keeps.
struct Home(PathBuf);

impl Home {
    fn make(name: &MachineName) -> Outcome<Self> {
        let folder = state::folder().ok_or_else(|| {
            Failure::Usage(both!(
                "there is no folder for what the machine keeps: set HOME or XDG_STATE_HOME to an absolute path",
                "没有可保存机床状态的文件夹：请把 HOME 或 XDG_STATE_HOME 设为绝对路径"
            ))
        })?;
        let folder = folder.join(name.as_str());
        fs::create_dir_all(&folder)
            .map_err(|error| Failure::file(Doing::Write, folder.display(), &error))?;
        Ok(Self(folder))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// A new log; the one before is kept beside it.
    fn log(&self) -> Outcome<(PathBuf, File)> {
        let path = self.file("log");
        // There is none before the first time.
        let _ = fs::rename(&path, self.file("log.before"));
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let file = file.map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
        Ok((path, file))
    }
}

/// Starts the process of the machine, and waits until it runs or says why not.
fn start(global: &Global, desk: &Desk, name: &MachineName, home: &Home) -> Outcome {
    if desk.is_running(name) {
        return Err(runs_already(name));
    }
    let (log, errors) = home.log()?;
    let failed = |error: &std::io::Error| {
        let why = Both::same(error.to_string());
        Failure::Bus(both!(
            "the process of machine `{name}` cannot be started: {en}",
            "无法启动机床 `{name}` 的进程：{zh}",
            en = why.en,
            zh = why.zh
        ))
    };
    let mut command = itself::command();
    command
        .args(std::env::args_os().skip(1))
        .args(["--foreground", "--detached"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(errors);
    if !global.json {
        command.arg("--json");
    }
    let mut child = command.spawn().map_err(|error| failed(&error))?;
    let mut line = String::new();
    if let Some(said) = child.stdout.take() {
        let mut said = BufReader::new(said);
        said.read_line(&mut line).map_err(|error| failed(&error))?;
    }
    let answer: Option<Answer> = serde_json::from_str(&line).ok();
    match answer.and_then(|answer| answer.machine) {
        Some(view) => tell(global, &view, home, false),
        None => Err(refusal(&line, &log)),
    }
}

/// Why the process of the machine has ended, by its last words.
fn refusal(line: &str, log: &Path) -> Failure {
    let said: Value = serde_json::from_str(line).unwrap_or_default();
    let log = words::path(log);
    let Some(why) = said["error"].as_str() else {
        return Failure::Bus(both!(
            "the machine has ended before it ran; its log is `{log}`",
            "机床在运行之前已结束；日志为 `{log}`"
        ));
    };
    let why = Both::same(why);
    match said["exit"].as_u64() {
        Some(2) => Failure::Usage(why),
        Some(3) => Failure::Bus(why),
        _ => Failure::WrongBecause(why),
    }
}

/// Tells that it runs, and what to do with it.
fn tell(global: &Global, view: &View, home: &Home, stays: bool) -> Outcome {
    if global.json {
        return json(&Answer {
            ok: true,
            error: None,
            note: None,
            machine: Some(view.clone()),
        });
    }
    let (name, node) = (&view.name, view.node);
    let folder = words::path(&home.0);
    let end = match stays {
        true => "Ctrl-C".to_owned(),
        false if name == MachineName::USUAL => "leadscrew down".to_owned(),
        false => format!("leadscrew down --name {name}"),
    };
    let export = format!("export {BUS}=sim:{name}");
    let width = export.len().max(end.len());
    let told = both!(
        "machine `{name}` is running: node {node} on sim:{name}\n\
         \x20 {export:width$}   all commands of this terminal then mean it\n\
         \x20 {end:width$}   ends it; its flash and its log stay in {folder}\n",
        "机床 `{name}` 已运行：sim:{name} 上的节点 {node}\n\
         \x20 {export:width$}   此终端中的所有命令随后都指向它\n\
         \x20 {end:width$}   结束它；闪存和日志保存在 {folder}\n"
    );
    output::write(told.get(global.lang()).as_bytes())
}
