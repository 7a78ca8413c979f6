//! A table for people: numbers aligned on the point, what a move needs beyond its end point in words at the end.

use super::Row;
use crate::number;

/// Appends the header.
pub(super) fn header(out: &mut Vec<u8>) {
    out.extend_from_slice(
        b"     n  line  cycle pass stage     kind             X           Z          details\n",
    );
}

/// Appends one line.
pub(super) fn row(out: &mut Vec<u8>, row: &Row) {
    let mut line = format!(
        "{:>6} {:>5}  {:<5} {:>4} {:<9} {:<7} {} {}",
        row.n,
        row.line,
        row.cycle.unwrap_or_default(),
        row.pass.map(|n| n.to_string()).unwrap_or_default(),
        row.stage.unwrap_or_default(),
        row.kind,
        aligned(row.work[0]),
        aligned(row.work[1]),
    );
    let mut detail = |text: String| {
        line.push_str("  ");
        line.push_str(&text);
    };
    if row.work[2] != 0 {
        detail(format!("C{}", number::text::<6>(row.work[2])));
    }
    if let Some((i, k, direction)) = row.arc {
        detail(format!(
            "{direction} I{} K{}",
            number::text::<6>(i),
            number::text::<6>(k)
        ));
    }
    if let Some(depth) = row.depth {
        detail(format!("depth {}", number::text::<6>(depth)));
    }
    match (row.feed, row.feed_rev) {
        (_, Some(feed)) => detail(format!("F{} mm/rev", number::text::<6>(feed))),
        (Some(feed), None) => detail(format!("F{} mm/min", number::text::<6>(feed))),
        (None, None) => {}
    }
    if let Some(lead) = row.lead {
        detail(format!("lead {}", number::text::<6>(lead)));
    }
    if let Some(angle) = row.start_udeg {
        detail(format!("at {}°", number::text::<6>(i64::from(angle))));
    }
    if let Some(start) = row.start.filter(|start| *start > 1) {
        detail(format!("start {start}"));
    }
    if let Some(rev) = row.rev {
        detail(format!("{} turns", number::text::<6>(rev)));
    }
    if let Some(rpm) = row.rpm {
        detail(format!("{} rpm", number::text::<6>(rpm)));
    }
    if let Some("rigid") = row.mode {
        detail("rigid".to_string());
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

/// A coordinate in twelve characters, the point always in the same column.
fn aligned(value: i64) -> String {
    let text = number::text::<6>(value);
    let whole = text.find('.').unwrap_or(text.len());
    let (whole, fraction) = text.split_at(whole);
    format!("{whole:>5}{fraction:<7}")
}
