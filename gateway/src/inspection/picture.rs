//! From a thread that was cut to its picture.

use leadscrew_core::alarm::Lang;
use leadscrew_inspection::Cut;
use leadscrew_metrology::{Band, Designation, Inspection, Measured, Mm, Series, Side, Turns, Work};

use super::sheet;
use crate::number;
use crate::plot::{Across, Along, Chip, Course, Curve, Line, Sheet};
use crate::words::both;

/// Pitches that are shown near by.
const NEAR: f64 = 2.5;

/// The picture of each thread.
#[must_use]
pub fn sheets(cuts: &[Cut], lang: Lang) -> Vec<Sheet> {
    cuts.iter().map(|cut| one(cut, lang)).collect()
}

fn one(cut: &Cut, lang: Lang) -> Sheet {
    let chips = cut.work.chips().iter().map(|(pass, chip)| Chip {
        pass: *pass,
        minus: chip.minus.0,
        plus: chip.plus.0,
    });
    let stock = cut.work.stock();
    let mut curves = vec![Curve {
        line: Line::Cut,
        points: surface(&cut.work),
    }];
    let mut near = (stock.from.0, stock.face.0);
    let mut course = None;
    let mut figures = String::new();
    if let Ok((measured, inspection)) = &cut.found {
        let pitch = cut.job.thread.pitch.0;
        let back = (measured.full.0 / 2.0 / pitch).round();
        let middle = measured.groove.0 - back * pitch;
        near = (middle - NEAR / 2.0 * pitch, middle + NEAR / 2.0 * pitch);
        curves.extend(profiles(&cut.job.thread, measured, inspection, middle));
        let points = measured.lead.course.iter();
        course = Some(Course {
            along: Along::Helix,
            points: points.map(|(turn, off)| (turn.0, off.um())).collect(),
        });
        figures = self::figures(measured, inspection, lang);
    }
    Sheet {
        name: sheet::name(&cut.job).get(lang).to_owned(),
        figures,
        across: Across::X,
        curves,
        near,
        course,
        chips: chips.collect(),
    }
}

fn surface(work: &Work) -> Vec<(f64, f64)> {
    let stock = work.stock();
    let points = work.section(Turns(0.0), stock.from, stock.face);
    points.map(|(z, radius)| (z.0, radius.0)).collect()
}

fn figures(measured: &Measured, inspection: &Inspection, lang: Lang) -> String {
    let mm = |value: f64| number::text::<3>((value * 1e3).round() as i64);
    let um = |value: Mm| number::text::<1>((value.um() * 10.0).round() as i64);
    let verdict = match inspection.verdict() {
        Some(true) => both!("within tolerance", "合格"),
        Some(false) => both!("out of tolerance", "超差"),
        None => both!("not judged", "未判定"),
    };
    let (pitch, cumulative, sway) = (
        mm(measured.pitch.mean),
        um(measured.lead.cumulative),
        um(measured.drunkenness.worst),
    );
    let told = both!(
        "pitch diameter {pitch} mm · lead error {cumulative} µm · drunkenness {sway} µm · {verdict}",
        "中径 {pitch} mm · 累积导程误差 {cumulative} µm · 周期误差 {sway} µm · {verdict_zh}",
        verdict = verdict.en,
        verdict_zh = verdict.zh
    );
    told.get(lang).to_owned()
}

/// The profiles that the norm names, about a groove.
fn profiles(
    thread: &Designation,
    measured: &Measured,
    inspection: &Inspection,
    middle: f64,
) -> Vec<Curve> {
    if matches!(thread.series, Series::Free | Series::Pipe { .. }) {
        return Vec::new();
    }
    let limits = &inspection.limits;
    let basic = (thread.major, thread.pitch_diameter(), thread.minor());
    let end = |band: Band, is_most: bool, other: Mm| {
        let wanted = if is_most == (thread.side == Side::External) {
            band.high
        } else {
            band.low
        };
        wanted.unwrap_or(other)
    };
    // Where the norm leaves the root open, the profile ends where the tool did.
    let limit = |is_most: bool| {
        (
            end(limits.major, is_most, Mm(measured.major.high)),
            end(limits.pitch, is_most, thread.pitch_diameter()),
            end(limits.minor, is_most, Mm(measured.minor.low)),
        )
    };
    let kinds = [
        (Line::Basic, basic),
        (Line::Most, limit(true)),
        (Line::Least, limit(false)),
    ];
    kinds
        .into_iter()
        .map(|(line, diameters)| Curve {
            line,
            points: profile(thread, diameters, middle),
        })
        .collect()
}

/// Three grooves with straight flanks.
fn profile(
    thread: &Designation,
    (major, pitch, minor): (Mm, Mm, Mm),
    middle: f64,
) -> Vec<(f64, f64)> {
    let side = thread.side;
    let tan = (thread.angle.0.to_radians() / 2.0).tan();
    let half = |diameter: Mm| {
        let above = side.height(diameter.0 / 2.0) - side.height(pitch.0 / 2.0);
        (thread.pitch.0 / 4.0 + above * tan).clamp(0.0, thread.pitch.0 / 2.0)
    };
    let (floor, crest) = match side {
        Side::External => (minor, major),
        Side::Internal => (major, minor),
    };
    let mut points = Vec::new();
    for n in -2..=2 {
        let at = middle + f64::from(n) * thread.pitch.0;
        let ends = [
            (-half(crest), crest),
            (-half(floor), floor),
            (half(floor), floor),
            (half(crest), crest),
        ];
        points.extend(ends.map(|(off, diameter)| (at + off, diameter.0 / 2.0)));
    }
    points
}
