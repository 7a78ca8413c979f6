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

/// Gives an order and tells what the machine does then.
pub fn order(global: &Global, order: Order) -> Outcome {
    let mut link = open(global)?;
    link.order(order)?;
    match order {
        Order::Reset => tell_cleared(global, &mut link),
        _ => tell(global, &link, &Ok(())),
    }
}

/// How often an alarm is looked at that should go.
const LOOK: Duration = Duration::from_millis(20);
/// A machine that stands leaves its alarm within this time, or not at all.
const CLEARS: Duration = Duration::from_secs(1);
/// The longest time for coming to rest before that.
const BRAKES: Duration = Duration::from_secs(20);

/// The status once an alarm has gone, or once the machine has stood on it for a while: a reset waits until the axes stand.
fn cleared(link: &mut Link) -> Outcome<Status> {
    let (begun, mut still) = (Instant::now(), Instant::now());
    let mut status = link.status()?;
    loop {
        let waits = still.elapsed() < CLEARS && begun.elapsed() < BRAKES;
        if status.state != BoardState::Alarm || !waits {
            return Ok(status);
        }
        link.idle(LOOK)?;
        let before = status.position;
        status = link.status()?;
        if status.position != before {
            still = Instant::now();
        }
    }
}

/// The state after an order that an alarm must not outlast.
///
/// # Errors
/// An alarm that stands: the order has done nothing.
pub(super) fn tell_cleared(global: &Global, link: &mut Link) -> Outcome {
    let status = cleared(link)?;
    let verdict = match status.alarm.filter(|_| status.state == BoardState::Alarm) {
        Some(alarm) => Err(Failure::MachineBecause(alarm_words(&alarm))),
        None => Ok(()),
    };
    tell(global, link, &verdict)?;
    verdict
}

/// The state after an order, and whether that is how the order ends well.
fn tell(global: &Global, link: &Link, verdict: &Outcome) -> Outcome {
    let status = link.seen.status.unwrap_or_default();
    let line = link.seen.place.map(|place| place.line);
    if global.json {
        return output::json(|json| {
            match verdict {
                Ok(()) => json.flag("ok", true),
                Err(failure) => failure.fields(global.lang(), json),
            }
            json.integer("node", i64::from(link.node().get()));
            json.text("state", status.state.name());
            match status.alarm {
                Some(number) => json.integer("alarm", i64::from(number)),
                None => json.null("alarm"),
            }
            SourceLine(line.unwrap_or(0)).fields(json);
        });
    }
    let lang = global.lang();
    let state = state_words(status.state, lang);
    let place = match line {
        Some(line) if line > 0 => both!(", line {line}", "，第 {line} 行", line = SourceLine(line)),
        _ => both!("", ""),
    };
    let alarm = match status.alarm {
        Some(number) if status.state == BoardState::Alarm => both!(" {number:04}", " {number:04}"),
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
    output::write(text.get(lang).as_bytes())
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
