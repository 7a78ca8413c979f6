//! `hold`, `resume`, `reset`, `stop`, `override`, `signal`: what an operator does while a program runs. An order goes by
//! process data, so it waits behind nothing.

use std::time::{Duration, Instant};

use leadscrew_core::bus::{BoardCommand, BoardState, Object, Order};
use leadscrew_core::link::Status;

use super::{open, state_words};
use crate::cli::{Global, OverrideName};
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::link::Link;
use crate::output;
use crate::place::SourceLine;
use crate::values::{Percent, SetSignal};
use crate::words::both;

/// How the machine is after an order.
struct After {
    state: BoardState,
    alarm: Option<u16>,
    line: u32,
    /// How the order has ended.
    verdict: Outcome,
}

/// Gives an order and tells what the machine does then.
pub fn order(global: &Global, order: Order) -> Outcome {
    let mut link = open(global)?;
    link.order(order)?;
    if order == Order::Reset {
        return tell_cleared(global, &mut link);
    }
    let status = link.seen.status.unwrap_or_default();
    let after = After {
        state: status.state,
        alarm: status.alarm,
        line: link.seen.place.map_or(0, |place| place.line),
        verdict: Ok(()),
    };
    tell(global, &link, after)
}

/// How often an alarm is looked at that should go.
const LOOK: Duration = Duration::from_millis(20);
/// A machine that stands leaves its alarm within so many ticks, or not at all. Its time need not be that of this side.
const CLEARS: u64 = 200;
/// The longest time for all of it.
const LONGEST: Duration = Duration::from_secs(20);

/// The status once an alarm has gone, or once the machine has stood on it for a while: a reset waits until the axes stand.
fn cleared(link: &mut Link) -> Outcome<Status> {
    let end = Instant::now() + LONGEST;
    let mut now = link.status()?;
    let mut moved = now;
    loop {
        if now.position != moved.position {
            moved = now;
        }
        let over = now.tick >= moved.tick + CLEARS || Instant::now() >= end;
        if now.state != BoardState::Alarm || over {
            return Ok(now);
        }
        link.idle(LOOK)?;
        now = link.status()?;
    }
}

/// The state after an order that an alarm must not outlast.
///
/// # Errors
/// The alarm that stands.
pub(super) fn tell_cleared(global: &Global, link: &mut Link) -> Outcome {
    let status = cleared(link)?;
    let verdict = match status.alarm.filter(|_| status.state == BoardState::Alarm) {
        Some(alarm) => Err(Failure::MachineBecause(alarm_words(&alarm))),
        None => Ok(()),
    };
    let after = After {
        state: status.state,
        alarm: status.alarm.map(|alarm| alarm.number()),
        line: status.line,
        verdict,
    };
    tell(global, link, after)
}

/// Tells it.
fn tell(global: &Global, link: &Link, after: After) -> Outcome {
    if global.json {
        output::json(|json| {
            match &after.verdict {
                Ok(()) => json.flag("ok", true),
                Err(failure) => failure.fields(global.lang(), json),
            }
            json.integer("node", i64::from(link.node().get()));
            json.text("state", after.state.name());
            match after.alarm {
                Some(number) => json.integer("alarm", i64::from(number)),
                None => json.null("alarm"),
            }
            SourceLine(after.line).fields(json);
        })?;
        return after.verdict;
    }
    let lang = global.lang();
    let state = state_words(after.state, lang);
    let place = match after.line {
        0 => both!("", ""),
        line => both!(", line {line}", "，第 {line} 行", line = SourceLine(line)),
    };
    let alarm = match after.alarm {
        Some(number) if after.state == BoardState::Alarm => both!(" {number:04}", " {number:04}"),
        _ => both!("", ""),
    };
    let text = both!(
        "node {node}: {state}{alarm}{en}\n",
        "节点 {node}：{state}{alarm}{zh}\n",
        node = link.node().get(),
        alarm = alarm.en,
        en = place.en,
        zh = place.zh
    );
    output::write(text.get(lang).as_bytes())?;
    after.verdict
}

/// Sets an override.
pub fn levels(global: &Global, what: OverrideName, percent: Percent) -> Outcome {
    let (low, high) = what.range();
    let (name, sub) = match what {
        OverrideName::Feed => ("feed", 4),
        OverrideName::Rapid => ("rapid", 5),
        OverrideName::Spindle => ("spindle", 6),
    };
    let wanted = percent.0;
    let within = u8::try_from(wanted).ok();
    let Some(wanted) = within.filter(|wanted| (low..=high).contains(wanted)) else {
        return Err(Failure::Usage(both!(
            "`override {name} {wanted}`: the {name} override goes from {low} to {high} %",
            "`override {name} {wanted}`：{name} 倍率的范围是 {low} 到 {high} %"
        )));
    };
    let mut link = open(global)?;
    let mut command = BoardCommand::default();
    match what {
        OverrideName::Feed => command.feed = Some(wanted),
        OverrideName::Rapid => command.rapid = Some(wanted),
        OverrideName::Spindle => command.spindle = Some(wanted),
    }
    link.set_levels(command)?;
    // A level has no count: the board itself says what it is now.
    let now = link.read_number(Object::new(0x5000, sub))?;
    if global.json {
        return output::json(|json| {
            json.flag("ok", now == u64::from(wanted));
            json.integer("node", i64::from(link.node().get()));
            json.text("override", name);
            json.number("percent", now);
        });
    }
    let text = both!(
        "node {node}: {name} override {now} %\n",
        "节点 {node}：{name} 倍率 {now} %\n",
        node = link.node().get()
    );
    output::write(text.get(global.lang()).as_bytes())
}

/// Sets an input; the others stay.
pub fn signal(global: &Global, set: SetSignal) -> Outcome {
    let mut link = open(global)?;
    link.greet()?;
    let mut signals = link.signals()?;
    signals.set(set.signal, set.level);
    link.set_signals(signals)?;
    let level = u8::from(set.level);
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.integer("node", i64::from(link.node().get()));
            json.text("signal", set.signal.name());
            json.integer("level", i64::from(level));
        });
    }
    let text = both!(
        "node {node}: {name}={level}\n",
        "节点 {node}：{name}={level}\n",
        node = link.node().get(),
        name = set.signal.name()
    );
    output::write(text.get(global.lang()).as_bytes())
}
