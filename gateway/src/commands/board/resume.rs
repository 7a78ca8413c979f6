//! `resume`: a held program goes on. One that was left for axes to be moved by hand first goes back to its point, and goes
//! on by the next `resume`.

use std::time::Duration;

use leadscrew_core::bus::{BoardState, Order};
use leadscrew_core::link::Status;
use leadscrew_core::operating::OperatingMode;

use super::{heard, operate, single_block};
use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::link::Link;
use crate::number;
use crate::output;
use crate::words::both;

/// How often the way back is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// Lets the program go on, or its axes go back to where it was left.
pub fn resume(global: &Global) -> Outcome {
    let mut link = heard(global)?;
    single_block(global, &mut link)?;
    let status = link.status()?;
    if status.left.is_some() && !link.mode()?.runs() {
        link.set_mode(OperatingMode::Automatic)?;
    }
    match status.left {
        Some(point) if point != status.position => go_back(global, &mut link, &status),
        _ => {
            link.order(Order::Resume)?;
            operate::tell_cleared(global, &mut link)
        }
    }
}

/// Says what will move, and stays until it has.
fn go_back(global: &Global, link: &mut Link, status: &Status) -> Outcome {
    let node = link.node().get();
    let point = status.left.unwrap_or_default();
    let x = point.x.nm().saturating_mul(2);
    let z = point.z.nm();
    if !global.json {
        let text = both!(
            "node {node}: back to machine X {x} Z {z}, slowly (9043), one axis at a time and last the one that left first; spindle \
             {rpm} rpm\n",
            "节点 {node}：返回机床坐标 X {x} Z {z}，低速（9043），逐轴移动，最先离开的轴最后返回；主轴 {rpm} r/min\n",
            x = number::text::<6>(x),
            z = number::text::<6>(z),
            rpm = status.command.get()
        );
        output::write(text.get(global.lang()).as_bytes())?;
    }
    link.order(Order::Resume)?;
    let now = rest(link)?;
    let there = now.left == Some(now.position);
    if global.json {
        output::json(|json| {
            json.flag("ok", there);
            json.integer("node", i64::from(node));
            json.flag("at_point", there);
            json.decimal::<6>("mx", now.position.x.nm().saturating_mul(2));
            json.decimal::<6>("mz", now.position.z.nm());
        })?;
    } else if there {
        let text = both!(
            "node {node}: at the point where the program was held; `leadscrew resume` goes on with it\n",
            "节点 {node}：已回到程序的保持点；再次 `leadscrew resume` 继续程序\n"
        );
        output::write(text.get(global.lang()).as_bytes())?;
    }
    if there {
        return Ok(());
    }
    Err(Failure::MachineBecause(match &now.alarm {
        Some(alarm) => crate::diagnostics::alarm_words(alarm),
        None => both!(
            "the axes have not come back to the point: a hold or another order has ended the motion",
            "各轴未回到保持点：进给保持或其他指令结束了移动"
        ),
    }))
}

/// The status once the axes stand.
fn rest(link: &mut Link) -> Outcome<Status> {
    loop {
        link.idle(LOOK)?;
        link.check_alive()?;
        let now = link.status()?;
        let moves = matches!(now.state, BoardState::Run | BoardState::Stopping);
        if now.left == Some(now.position) || !moves {
            return Ok(now);
        }
    }
}
