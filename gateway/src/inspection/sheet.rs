//! The sheet of an inspection, for a person.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use leadscrew_inspection::{Cut, Job};
use leadscrew_metrology::{
    Feature, Inspection, Measured, Mm, NoThread, Nose, Origin, Row, Side, Tool,
};

use crate::number::measured;
use crate::words::{Both, both};

/// A number with a fixed count of decimals, as columns need it.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|b| b"-0.".contains(&b));
    if is_zero {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

/// Micrometres to a tenth, with a sign.
pub(super) fn um(value: Mm) -> String {
    let text = fixed(value.um(), 1);
    if text.starts_with('-') || text == "0.0" {
        text
    } else {
        format!("+{text}")
    }
}

/// `30°02′`.
pub(super) fn angle(degrees: f64) -> String {
    let minutes = (degrees * 60.0).round() as i64;
    format!("{}°{:02}′", minutes / 60, minutes % 60)
}

pub(super) fn line(text: &mut String, lang: Lang, told: &Both) {
    text.push_str(told.get(lang));
    text.push('\n');
}

/// The name of a thread, or what it looks like.
pub fn name(job: &Job) -> Both {
    let thread = &job.thread;
    if thread.text.is_empty() {
        let (d, pitch, at) = (
            measured(thread.major.0),
            measured(thread.pitch.0),
            measured(thread.angle.0),
        );
        return both!(
            "{d} x {pitch}, {at}°, of no norm",
            "{d} x {pitch}，{at}°，非标准"
        );
    }
    Both::same(thread.text.clone())
}

fn edge(tool: &Tool) -> Both {
    let flanks = if tool.minus == tool.plus {
        measured(tool.minus.0 * 2.0)
    } else {
        format!("{}/{}", measured(tool.minus.0), measured(tool.plus.0))
    };
    match tool.nose {
        Nose::Round(Mm(r)) => both!(
            "V {flanks}°, tip radius {r} mm",
            "V 形 {flanks}°，刀尖圆角 {r} mm",
            r = measured(r)
        ),
        Nose::Flat(Mm(w)) => both!(
            "V {flanks}°, tip width {w} mm",
            "V 形 {flanks}°，刀尖宽 {w} mm",
            w = measured(w)
        ),
    }
}

/// All threads.
pub fn text(cuts: &[Cut], lang: Lang) -> String {
    let mut text = String::new();
    for (n, cut) in (1..).zip(cuts) {
        one(&mut text, n, cut, lang);
    }
    text
}

fn one(text: &mut String, n: usize, cut: &Cut, lang: Lang) {
    let job = &cut.job;
    let called = name(job);
    let guessed = if job.assumed.thread {
        both!(
            " (guessed; `--thread` says it)",
            "（推测；可用 `--thread` 指定）"
        )
    } else {
        Both::default()
    };
    line(
        text,
        lang,
        &both!(
            "thread {n}, line {line}: {en}{guess}",
            "螺纹 {n}，第 {line} 行：{zh}{guess_zh}",
            line = job.line,
            en = called.en,
            guess = guessed.en,
            zh = called.zh,
            guess_zh = guessed.zh
        ),
    );
    made(text, job, lang);
    match &cut.found {
        Err(NoThread) => line(
            text,
            lang,
            &both!(
                "  there is no full groove to measure: the surface or the face lies elsewhere, or the stroke is too short",
                "  没有可测量的完整牙槽：表面或端面位置不符，或行程太短"
            ),
        ),
        Ok((measured, inspection)) => {
            diameters(text, inspection, lang);
            details(text, job, measured, lang);
            gauges(text, measured, inspection, lang);
        }
    }
    chips(text, cut, lang);
    let verdict = match cut.verdict() {
        Some(true) => both!("  within tolerance", "  合格"),
        Some(false) => both!("  OUT OF TOLERANCE", "  超差"),
        None => both!("  not judged: there are no limits", "  未判定：没有公差"),
    };
    line(text, lang, &verdict);
}

/// How it was cut, and what was assumed.
fn made(text: &mut String, job: &Job, lang: Lang) {
    let of = |is_assumed: bool| {
        if is_assumed {
            both!(" (assumed)", "（假定）")
        } else {
            Both::default()
        }
    };
    let (tool, assumed) = (edge(&job.tool), &job.assumed);
    let number = if job.tool_number > 0 {
        format!(" T{}", job.tool_number)
    } else {
        String::new()
    };
    let by = of(assumed.tool);
    let (surface, face, side) = (of(assumed.surface), of(assumed.face), of(assumed.side));
    let what = match job.stock.side {
        Side::External => both!("bolt", "外螺纹"),
        Side::Internal => both!("nut", "内螺纹"),
    };
    let (d, z) = (
        measured(job.stock.radius.0 * 2.0),
        measured(job.stock.face.0),
    );
    line(
        text,
        lang,
        &both!(
            "  {what}{side}; tool{number}: {tool}{by}; surface before {d}{surface}; face at Z{z}{face}",
            "  {what_zh}{side_zh}；刀具{number}：{tool_zh}{by_zh}；切前直径 {d}{surface_zh}；端面 Z{z}{face_zh}",
            what = what.en,
            side = side.en,
            tool = tool.en,
            by = by.en,
            surface = surface.en,
            face = face.en,
            what_zh = what.zh,
            side_zh = side.zh,
            tool_zh = tool.zh,
            by_zh = by.zh,
            surface_zh = surface.zh,
            face_zh = face.zh
        ),
    );
}

fn feature(row: &Row) -> Both {
    match row.feature {
        Feature::Major => both!("major", "大径"),
        Feature::Pitch => both!("pitch", "中径"),
        Feature::Minor => both!("minor", "小径"),
        Feature::Functional => both!("functional", "作用中径"),
    }
}

/// Pads by columns as they are seen: a Chinese character takes two.
fn padded(text: &str, columns: usize) -> String {
    let seen: usize = text.chars().map(|c| if c.is_ascii() { 1 } else { 2 }).sum();
    format!("{text}{}", " ".repeat(columns.saturating_sub(seen)))
}

fn diameters(text: &mut String, inspection: &Inspection, lang: Lang) {
    let heads = match lang {
        Lang::En => [
            "diameter", "basic", "lowest", "highest", "measured", "from", "to",
        ],
        Lang::Zh => ["直径", "基本值", "下限", "上限", "实测", "最小", "最大"],
    };
    let _ = write!(text, "  {}", padded(heads[0], 12));
    for head in &heads[1..] {
        let seen: usize = head.chars().map(|c| if c.is_ascii() { 1 } else { 2 }).sum();
        let _ = write!(text, "{}{head}", " ".repeat(10usize.saturating_sub(seen)));
    }
    text.push('\n');
    for row in &inspection.rows {
        let limit = |limit: Option<Mm>| limit.map_or_else(|| "-".to_owned(), |Mm(v)| fixed(v, 4));
        let verdict = match row.within {
            Some(true) => both!("good", "合格"),
            Some(false) => both!("OUT", "超差"),
            None => both!("-", "-"),
        };
        let _ = writeln!(
            text,
            "  {}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}  {}",
            padded(feature(row).get(lang), 12),
            fixed(row.nominal.0, 4),
            limit(row.band.low),
            limit(row.band.high),
            fixed(row.found.mean, 4),
            fixed(row.found.low, 4),
            fixed(row.found.high, 4),
            verdict.get(lang)
        );
    }
    let origin = match inspection.limits.origin {
        Origin::Table => both!(
            "  limits: as the norm's table prints them",
            "  公差：按标准表"
        ),
        Origin::Formula => both!(
            "  limits: by the norm's formulas, within a step of its table",
            "  公差：按标准公式，与标准表相差不超过一级"
        ),
        Origin::None => both!("  limits: none are known", "  公差：无"),
    };
    line(text, lang, &origin);
}

fn details(text: &mut String, job: &Job, measured: &Measured, lang: Lang) {
    if let Some(wires) = measured.wires {
        line(
            text,
            lang,
            &both!(
                "  over wires of {w}: {over}, which makes a pitch diameter of {pitch}",
                "  三针 {w}：M 值 {over}，换算中径 {pitch}",
                w = fixed(wires.wire.0, 4),
                over = fixed(wires.over.0, 4),
                pitch = fixed(wires.pitch.0, 4)
            ),
        );
    }
    let [minus, plus] = measured.flanks.map(|flank| angle(flank.mean));
    line(
        text,
        lang,
        &both!(
            "  flanks: towards -Z {minus}, towards +Z {plus}; root radius {r}",
            "  牙侧角：-Z 侧 {minus}，+Z 侧 {plus}；牙底圆角 {r}",
            r = fixed(measured.root.0, 3)
        ),
    );
    let lead = &measured.lead;
    line(
        text,
        lang,
        &both!(
            "  lead {lead}: {error} µm a turn, {cumulative} µm over all turns; drunkenness {sway} µm",
            "  导程 {lead}：每转误差 {error} µm，累积误差 {cumulative} µm；周期误差 {sway} µm",
            lead = fixed(lead.lead.0, 5),
            error = um(lead.error),
            cumulative = fixed(lead.cumulative.um(), 1),
            sway = fixed(measured.drunkenness.worst.um(), 1)
        ),
    );
    if measured.starts.len() > 1 {
        let offs: Vec<String> = measured.starts.iter().skip(1).map(|off| um(*off)).collect();
        let offs = offs.join(", ");
        line(
            text,
            lang,
            &both!(
                "  starts against the first: {offs} µm",
                "  各线相对第一线：{offs} µm"
            ),
        );
    }
    if job.thread.taper != 0.0 {
        line(
            text,
            lang,
            &both!(
                "  taper on the diameter 1:{found}, asked 1:{asked}",
                "  锥度（直径）1:{found}，要求 1:{asked}",
                found = fixed(1.0 / measured.taper.abs(), 2),
                asked = fixed(0.5 / job.thread.taper.abs(), 2)
            ),
        );
    }
    line(
        text,
        lang,
        &both!(
            "  full thread {turns} turns, {full} mm; run-out {out} mm",
            "  完整螺纹 {turns} 圈，{full} mm；螺尾 {out} mm",
            turns = fixed(measured.full.0 / job.thread.lead().0, 1),
            full = fixed(measured.full.0, 2),
            out = fixed(measured.run_out.0, 2)
        ),
    );
}

fn gauges(text: &mut String, measured: &Measured, inspection: &Inspection, lang: Lang) {
    let Some((go, no_go)) = inspection.go.zip(inspection.no_go) else {
        return;
    };
    let go = if go {
        both!("GO goes on", "通规可以通过")
    } else {
        both!("GO does not go on", "通规不能通过")
    };
    let turns = fixed(measured.loose_turns, 1);
    let no_go = match (no_go, measured.loose_turns > 0.0) {
        (true, false) => both!("NO-GO stays out", "止规不能旋入"),
        (true, true) => both!(
            "NO-GO enters {turns} turns, two are allowed",
            "止规旋入 {turns} 圈，允许两圈"
        ),
        (false, _) => both!(
            "NO-GO ENTERS {turns} turns, two are allowed",
            "止规旋入 {turns} 圈，超过允许的两圈"
        ),
    };
    line(
        text,
        lang,
        &both!(
            "  gauges: {go}; {no_go}",
            "  量规：{go_zh}；{no_go_zh}",
            go = go.en,
            no_go = no_go.en,
            go_zh = go.zh,
            no_go_zh = no_go.zh
        ),
    );
}

/// The most passes that are listed.
const LISTED: usize = 60;

fn chips(text: &mut String, cut: &Cut, lang: Lang) {
    let chips = cut.work.chips();
    line(
        text,
        lang,
        &both!(
            "  chip {all} mm³; by pass, towards -Z and +Z of the tool's middle:",
            "  切屑 {all} mm³；各次走刀，刀具中线 -Z 侧与 +Z 侧：",
            all = fixed(cut.work.removed().0, 1)
        ),
    );
    for (pass, chip) in chips.iter().take(LISTED) {
        let _ = writeln!(
            text,
            "  {pass:>6}{:>10}{:>10}",
            fixed(chip.minus.0, 1),
            fixed(chip.plus.0, 1)
        );
    }
    if chips.len() > LISTED {
        let more = chips.len() - LISTED;
        line(text, lang, &both!("  and {more} more", "  另有 {more} 次"));
    }
}
