//! The sheet of grooves and contours, for a person.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use leadscrew_metrology::{Element, Mm, Side, Size, Spread, Turned};

use super::{CutGroove, CutOutline, Found, Piece};
use crate::inspection::sheet::{angle, fixed, line, um};
use crate::number::measured;
use crate::place::SourceLine;
use crate::plot::Across;
use crate::words::{Both, both, pick};

/// The most cuts that are listed.
const LISTED: usize = 60;

/// All of them.
pub fn text(found: &Found, lang: Lang) -> String {
    let mut text = String::new();
    for (n, groove) in (1..).zip(&found.grooves) {
        one_groove(&mut text, n, groove, lang);
    }
    for (n, outline) in (1..).zip(&found.outlines) {
        one_outline(&mut text, n, outline, lang);
    }
    text
}

/// `, T2`.
fn tool(number: u32) -> Both {
    match number {
        0 => Both::default(),
        tool => both!(", T{tool}", "，T{tool}"),
    }
}

/// A name in a column of so many letters; Chinese ones are twice as wide.
fn column(name: &str, letters: usize) -> String {
    let width = |c: char| if c.is_ascii() || c == '⌀' { 1 } else { 2 };
    let room = letters.saturating_sub(name.chars().map(width).sum());
    format!("{name}{:room$}", "")
}

/// A place across a groove as it is written.
pub(super) fn across(across: Across, mm: Mm) -> f64 {
    match across {
        Across::X => 2.0 * mm.0,
        Across::Z => mm.0,
    }
}

/// A place along a groove as it is written.
pub(super) fn along(along: Across, mm: Mm) -> f64 {
    match along {
        Across::X => mm.0,
        Across::Z => 2.0 * mm.0,
    }
}

/// A row: name, programmed, mean, from, to.
fn row(text: &mut String, name: &str, programmed: f64, found: &Spread) {
    let cells = [programmed, found.mean, found.low, found.high].map(|value| fixed(value, 4));
    let _ = write!(text, "  {}", column(name, 18));
    for cell in cells {
        let _ = write!(text, "{cell:>12}");
    }
    let off = um(Mm(found.mean - programmed));
    let _ = writeln!(text, "{off:>10}");
}

fn one_groove(text: &mut String, n: usize, cut: &CutGroove, lang: Lang) {
    let groove = &cut.groove;
    let cycle = groove.code();
    let tool = tool(groove.tool);
    let told = both!(
        "groove {n}, line {line}{tool}: {cycle}",
        "槽 {n}，第 {line} 行{tool_zh}：{cycle}",
        line = SourceLine(groove.line),
        tool = tool.en,
        tool_zh = tool.zh
    );
    line(text, lang, &told);
    let Some((walls, width)) = groove.walls().zip(groove.width) else {
        let told = both!(
            "  not measured: the width of the tool is not known, add `--tool-width T{tool}=MM`",
            "  未测量：刀宽未知，请加 `--tool-width T{tool}=MM`",
            tool = groove.tool
        );
        return line(text, lang, &told);
    };
    let Some(found) = &cut.found else {
        let told = both!(
            "  nothing was cut while the spindle turned",
            "  主轴旋转期间没有切削"
        );
        return line(text, lang, &told);
    };
    let told = both!(
        "  tool {width} mm wide",
        "  刀宽 {width} mm",
        width = measured(width.0)
    );
    line(text, lang, &told);
    text.push_str(pick(
        lang,
        "                      programmed    measured        from          to    off µm\n",
        "                            编程        实测        最小        最大   偏差 µm\n",
    ));
    let scaled = |spread: &Spread, written: &dyn Fn(Mm) -> f64| Spread {
        mean: written(Mm(spread.mean)),
        low: written(Mm(spread.low)),
        high: written(Mm(spread.high)),
    };
    let up = |mm: Mm| across(groove.across, mm);
    let right = |mm: Mm| along(groove.across, mm);
    let name = match groove.across {
        Across::X => pick(lang, "floor ⌀", "槽底 ⌀"),
        Across::Z => pick(lang, "floor Z", "槽底 Z"),
    };
    row(text, name, up(groove.floor), &scaled(&found.floor, &up));
    row(
        text,
        pick(lang, "width", "槽宽"),
        (walls[1] - walls[0]).0,
        &found.width,
    );
    let names = match groove.across {
        Across::X => ["Z-", "Z+"],
        Across::Z => ["⌀-", "⌀+"],
    };
    for (n, name) in names.into_iter().enumerate() {
        let name = format!("{} {name}", pick(lang, "wall", "槽壁"));
        row(
            text,
            &name,
            right(walls[n]),
            &scaled(&found.walls[n], &right),
        );
    }
}

/// The worst places of a contour: least and most, with the place of each.
pub(super) fn worst(cut: &CutOutline) -> Option<[(Mm, (Mm, Mm)); 2]> {
    let parts = || staying(cut).filter_map(|(_, found)| found);
    let low = parts().min_by(|a, b| a.off.low.total_cmp(&b.off.low))?;
    let high = parts().max_by(|a, b| a.off.high.total_cmp(&b.off.high))?;
    Some([
        (Mm(low.off.low), low.worst[0]),
        (Mm(high.off.high), high.worst[1]),
    ])
}

/// The cuts that are the surface in the end.
pub(super) fn staying(cut: &CutOutline) -> impl Iterator<Item = (&Piece, Option<&Turned>)> {
    let all = cut.outline.pieces.iter().zip(&cut.found);
    all.filter(|(piece, _)| piece.stays)
        .map(|(piece, found)| (piece, found.as_ref()))
}

fn one_outline(text: &mut String, n: usize, cut: &CutOutline, lang: Lang) {
    let [a, b] = cut.outline.lines();
    let side = match cut.outline.side {
        Side::External => both!("outside", "外圆"),
        Side::Internal => both!("bore", "内孔"),
    };
    let tool = tool(cut.outline.tool);
    let told = both!(
        "contour {n}, lines {a}–{b}{tool}: {side}",
        "轮廓 {n}，第 {a}–{b} 行{tool_zh}：{side_zh}",
        tool = tool.en,
        tool_zh = tool.zh,
        side = side.en,
        side_zh = side.zh
    );
    line(text, lang, &told);
    let Some(worst) = worst(cut) else {
        let told = both!("  nothing was cut", "  没有切削");
        return line(text, lang, &told);
    };
    let place = |(z, r): (Mm, Mm)| format!("X{} Z{}", measured(2.0 * r.0), measured(z.0));
    let [(least, at_least), (most, at_most)] = worst;
    let (least, most) = (um(least), um(most));
    let (at_least, at_most) = (place(at_least), place(at_most));
    line(
        text,
        lang,
        &both!(
            "  from the programmed contour, square to it: {least} µm at {at_least}, {most} µm at {at_most} (+: material left)",
            "  与编程轮廓的法向偏差：{least} µm（{at_least}），{most} µm（{at_most}）（+：余料）"
        ),
    );
    text.push_str(pick(
        lang,
        "    line  element       programmed    measured        from          to  least µm   most µm\n",
        "    行号  要素                编程        实测        最小        最大   最小 µm   最大 µm\n",
    ));
    let all: Vec<_> = staying(cut).collect();
    for (piece, found) in all.iter().take(LISTED) {
        if let Some(found) = found {
            element(text, piece, found, lang);
        }
    }
    if all.len() > LISTED {
        let more = all.len() - LISTED;
        line(text, lang, &both!("  and {more} more", "  另有 {more} 段"));
    }
}

/// What an element is, and its size as programmed.
pub(super) fn programmed(element: &Element) -> (Both, f64) {
    let (dz, dr) = (
        (element.to.0 - element.from.0).0,
        (element.to.1 - element.from.1).0,
    );
    match element.arc {
        Some((centre, _)) => {
            let radius = (element.from.0 - centre.0)
                .0
                .hypot((element.from.1 - centre.1).0);
            (both!("arc R", "圆弧 R"), radius)
        }
        None if dr.abs() < 1e-6 => (both!("cylinder ⌀", "圆柱 ⌀"), 2.0 * element.from.1.0),
        None if dz.abs() < 1e-6 => (both!("face Z", "端面 Z"), element.from.0.0),
        None => (both!("cone", "锥面"), dr.abs().atan2(dz.abs()).to_degrees()),
    }
}

fn element(text: &mut String, piece: &Piece, found: &Turned, lang: Lang) {
    let (name, programmed) = programmed(&piece.element);
    let number = |value: f64| fixed(value, 4);
    let none = String::new;
    let (programmed, cells) = match found.size {
        None => (number(programmed), ["-".to_owned(), none(), none()]),
        Some(Size::Cylinder(spread) | Size::Face(spread)) => (
            number(programmed),
            [spread.mean, spread.low, spread.high].map(number),
        ),
        Some(Size::Cone(degrees)) => (angle(programmed), [angle(degrees.0), none(), none()]),
        Some(Size::Arc(radius)) => (number(programmed), [number(radius.0), none(), none()]),
    };
    let name = column(name.get(lang), 12);
    let at = SourceLine(piece.line).to_string();
    let _ = write!(text, "  {at:>6}  {name}{programmed:>12}");
    for cell in cells {
        let _ = write!(text, "{cell:>12}");
    }
    let off = [found.off.low, found.off.high].map(|value| um(Mm(value)));
    let _ = writeln!(text, "{:>10}{:>10}", off[0], off[1]);
}
