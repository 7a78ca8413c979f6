//! Simulated machines that stay: `up` starts one, `down` ends it, `sim` is what happens around it.
//!
//! The machine itself is `leadscrew_desk`. What the three commands share: whose machine is meant, and how it is told.

mod sim;
mod up;

use std::time::{Duration, Instant};

use leadscrew_can::{Address, Desk, MachineName};
use leadscrew_core::alarm::Lang;
use leadscrew_desk::control::{Answer, Door, Request, View, ask};

use crate::cli::Global;
use crate::commands::{contact_numbers, or_none};
use crate::failure::{Failure, Outcome};
use crate::number;
use crate::output;
use crate::words::{Both, both, pick};

pub use sim::sim;
pub use up::up;

/// The longest time that a machine takes to end.
const END: Duration = Duration::from_secs(10);

/// Time between two looks whether it has ended.
const LOOK: Duration = Duration::from_millis(5);

/// The machine that is meant: the one named, else the one of the bus, else the usual one.
fn name(global: &Global, named: Option<&MachineName>) -> Outcome<MachineName> {
    match (named, &global.bus) {
        (Some(name), _) => Ok(name.clone()),
        (None, Address::Machine(name)) => Ok(name.clone()),
        (None, bus) if *bus != Address::Sim && global.typed_bus.is_some() => {
            Err(Failure::Usage(both!(
                "behind `--bus {bus}` is no machine of `leadscrew up`: name one with `--name NAME` or `--bus sim:NAME`",
                "`--bus {bus}` 后面不是 `leadscrew up` 的机床：请用 `--name NAME` 或 `--bus sim:NAME` 指定"
            )))
        }
        (None, _) => Ok(MachineName::default()),
    }
}

/// Asks a machine; what it refuses is a failure.
fn asked(name: &MachineName, request: &Request) -> Outcome<Answer> {
    let answer = ask(name, request).map_err(Failure::bus)?;
    match answer.error {
        Some(why) => Err(Failure::WrongBecause(why.into())),
        None => Ok(answer),
    }
}

/// Ends a machine, and waits until it has ended.
pub fn down(global: &Global, named: Option<&MachineName>) -> Outcome {
    let name = name(global, named)?;
    let desk = Desk::find().map_err(Failure::bus)?;
    asked(&name, &Request::Down)?;
    let end = Instant::now() + END;
    while desk.is_running(&name) {
        if Instant::now() >= end {
            return Err(Failure::Bus(both!(
                "machine `{name}` does not end; `leadscrew sim state --name {name}` tells its process",
                "机床 `{name}` 未能结束；可用 `leadscrew sim state --name {name}` 查看其进程"
            )));
        }
        std::thread::sleep(LOOK);
    }
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.text("name", name.as_str());
        });
    }
    let told = both!("machine `{name}` has ended\n", "机床 `{name}` 已结束\n");
    output::write(told.get(global.lang()).as_bytes())
}

/// An answer as one line of JSON.
fn json(answer: &Answer) -> Outcome {
    let mut line = serde_json::to_vec(answer).unwrap_or_default();
    line.push(b'\n');
    output::write(&line)
}

/// Which inputs and outputs are on, for people.
fn contact_words(view: &View, lang: Lang) -> String {
    let list = |on: &[u8]| or_none(contact_numbers(on.iter().copied()), lang);
    let (inputs, outputs) = (list(&view.inputs), list(&view.outputs));
    both!(
        "inputs on: {inputs}\noutputs on: {outputs}\n",
        "接通的输入：{inputs}\n接通的输出：{outputs}\n"
    )
    .get(lang)
    .to_owned()
}

/// How a machine is, for people.
fn words(view: &View, lang: Lang) -> String {
    let View {
        name,
        pid,
        node,
        slips,
        lost_ticks,
        clients,
        dropped,
        ..
    } = view;
    let power = match view.power {
        true => both!("on", "已接通"),
        false => both!("off", "已断开"),
    };
    let door = match view.door {
        Door::Open => both!("open", "打开"),
        Door::Close => both!("closed", "关闭"),
    };
    let contact = |pressed| match pressed {
        true => both!("pressed", "按下"),
        false => both!("released", "松开"),
    };
    let (estop, hold) = (contact(view.estop), contact(view.hold));
    let us = view.ticks.saturating_mul(view.tick_us.into());
    let time = number::text::<3>(i64::try_from(us / 1000).unwrap_or(i64::MAX));
    let speed = number::text::<3>(view.speed.into());
    let mut text = both!(
        "machine `{name}`   process {pid}, node {node}\n\
         power {power}, door {door}, emergency stop {estop}, feed hold {hold}\n\
         machine time {time} s at {speed} times real time\n\
         clients on the bus: {clients}\n",
        "机床 `{name}`   进程 {pid}，节点 {node}\n\
         电源{power_zh}，门{door_zh}，急停{estop_zh}，进给保持{hold_zh}\n\
         机床时间 {time} s，为真实时间的 {speed} 倍\n\
         总线上的客户端：{clients}\n",
        power = power.en,
        door = door.en,
        estop = estop.en,
        hold = hold.en,
        power_zh = power.zh,
        door_zh = door.zh,
        estop_zh = estop.zh,
        hold_zh = hold.zh
    )
    .get(lang)
    .to_owned();
    if *slips > 0 {
        let line = both!(
            "this computer was too slow {slips} times: {lost_ticks} ticks of machine time were left out\n",
            "计算机有 {slips} 次太慢：共略去 {lost_ticks} 个机床周期\n"
        );
        text.push_str(line.get(lang));
    }
    if *dropped > 0 {
        let line = both!(
            "clients dropped because they did not read: {dropped}\n",
            "因不读取而断开的客户端：{dropped}\n"
        );
        text.push_str(line.get(lang));
    }
    if view.outdated {
        text.push_str(pick(
            lang,
            "the parameters have changed since power-up: drives and spindle follow with `leadscrew sim power cycle`\n",
            "上电后参数已改变：执行 `leadscrew sim power cycle` 后，驱动器和主轴才会采用新参数\n",
        ));
    }
    text
}

/// A machine that runs already.
fn runs_already(name: &MachineName) -> Failure {
    Failure::Usage(both!(
        "machine `{name}` is running already: `leadscrew status --bus sim:{name}` looks at it, `leadscrew down --name {name}` \
         ends it, `leadscrew up --name OTHER` starts another one",
        "机床 `{name}` 已在运行：`leadscrew status --bus sim:{name}` 可查看，`leadscrew down --name {name}` 可结束，`leadscrew up \
         --name OTHER` 可另外启动一台"
    ))
}

/// The words for a note of a machine.
fn note(answer: &Answer) -> Option<Both> {
    answer.note.clone().map(Both::from)
}
