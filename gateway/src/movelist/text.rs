//! A table for people: numbers aligned on the point, what a move needs beyond its end point in words at the end.

use leadscrew_core::alarm::Lang;

use super::Row;
use crate::number;
use crate::place::SourceLine;
use crate::words::{both, pick};

/// Appends the header.
pub(super) fn header(lang: Lang, out: &mut Vec<u8>) {
    out.extend_from_slice(
        pick(
            lang,
            "     n  line  cycle pass stage     kind             X           Z          details\n",
            "  序号  行号  循环  刀次 阶段      类型             X           Z          说明\n",
        )
        .as_bytes(),
    );
}

/// Appends one line.
pub(super) fn row(lang: Lang, out: &mut Vec<u8>, row: &Row) {
    let mut line = format!(
        "{:>6} {:>5}  {:<5} {:>4} {} {} {} {}",
        row.n,
        SourceLine(row.line).to_string(),
        row.cycle.unwrap_or_default(),
        row.pass.map(|n| n.to_string()).unwrap_or_default(),
        column(row.stage.unwrap_or_default(), lang, 9),
        column(row.kind, lang, 7),
        aligned(row.work[0]),
        aligned(row.work[1]),
    );
    let mut detail = |text: String| {
        line.push_str("  ");
        line.push_str(&text);
    };
    let value = number::text::<6>;
    if row.work[2] != 0 {
        detail(format!("C{}", value(row.work[2])));
    }
    if let Some((i, k, direction)) = row.arc {
        let direction = match direction {
            "cw" => pick(lang, "cw", "顺圆"),
            _ => pick(lang, "ccw", "逆圆"),
        };
        detail(format!("{direction} I{} K{}", value(i), value(k)));
    }
    let mut both = |words: crate::words::Both| detail(words.get(lang).to_owned());
    if let Some(depth) = row.depth.map(value) {
        both(both!("depth {depth}", "深度 {depth}"));
    }
    let is_surface = row.mode == Some("surface");
    match (row.feed.map(value), row.feed_rev.map(value)) {
        (Some(speed), _) if is_surface => {
            both(both!("surface at {speed} mm/min", "线速 {speed} mm/min"));
        }
        (_, Some(feed)) => both(both!("F{feed} mm/rev", "F{feed} mm/r")),
        (Some(feed), None) => both(both!("F{feed} mm/min", "F{feed} mm/min")),
        (None, None) => {}
    }
    if let Some(lead) = row.lead.map(value) {
        both(both!("lead {lead}", "导程 {lead}"));
    }
    if let Some(change) = row.lead_change.map(value) {
        both(both!("changing by {change} a turn", "每转变化 {change}"));
    }
    if let Some(angle) = row.start_udeg.map(|angle| value(i64::from(angle))) {
        both(both!("at {angle}°", "起始角 {angle}°"));
    }
    if let Some(start) = row.start.filter(|start| *start > 1) {
        both(both!("start {start}", "第 {start} 头"));
    }
    if let Some(turns) = row.rev.map(value) {
        both(both!("{turns} turns", "{turns} 转"));
    }
    if let Some(rpm) = row.rpm.map(value) {
        both(both!("{rpm} rpm", "{rpm} r/min"));
    }
    if let Some("rigid") = row.mode {
        both(both!("rigid", "刚性"));
    }
    if let Some(m) = row.m {
        detail(format!("M{m:02}"));
    }
    if let Some(t) = row.t {
        detail(format!("T{t:04}"));
    }
    if let Some(ms) = row.ms {
        detail(format!("{ms} ms"));
    }
    out.extend_from_slice(line.trim_end().as_bytes());
    out.push(b'\n');
}

/// The name of a stage or a kind in so many columns; a Chinese character takes two.
fn column(name: &'static str, lang: Lang, width: usize) -> String {
    let word = match lang {
        Lang::En => name,
        Lang::Zh => chinese(name),
    };
    let taken: usize = word.chars().map(|c| if c.is_ascii() { 1 } else { 2 }).sum();
    format!("{word}{:1$}", "", width.saturating_sub(taken))
}

/// Stages and kinds as the trade calls them.
fn chinese(name: &'static str) -> &'static str {
    match name {
        "approach" => "趋近",
        "runin" => "切入段",
        "rough" => "粗车",
        "finish" => "精车",
        "runout" => "退尾",
        "retract" => "退刀",
        "return" => "返回",
        "peck" => "切削",
        "relief" => "让刀",
        "shift" => "移位",
        "clamp" => "夹紧",
        "rplane" => "到 R",
        "tap" => "攻丝",
        "reenter" => "再进入",
        "dwell" => "暂停",
        "extract" => "退出",
        "unclamp" => "松开",
        "rapid" => "快速",
        "feed" => "进给",
        "arc" => "圆弧",
        "thread" => "螺纹",
        "spindle" => "主轴",
        "aux" => "辅助",
        other => other,
    }
}

/// A coordinate in twelve characters, the point always in the same column.
fn aligned(value: i64) -> String {
    let text = number::text::<6>(value);
    let whole = text.find('.').unwrap_or(text.len());
    let (whole, fraction) = text.split_at(whole);
    format!("{whole:>5}{fraction:<7}")
}
