//! From grooves and contours that were cut to their pictures.

use leadscrew_core::alarm::Lang;
use leadscrew_metrology::{Mm, Side, Turns};
use leadscrew_verification::arc;

use super::sheet::{across, staying, worst};
use super::{CutGroove, CutOutline, Found};
use crate::inspection::sheet::{fixed, um};
use crate::place::SourceLine;
use crate::plot::{Across, Along, Course, Curve, Line, Sheet};
use crate::words::{both, pick};

/// The picture of each; one that could not be measured has none.
#[must_use]
pub fn sheets(found: &Found, lang: Lang) -> Vec<Sheet> {
    let grooves = found.grooves.iter().filter_map(|cut| groove(cut, lang));
    let outlines = found.outlines.iter().filter_map(|cut| outline(cut, lang));
    grooves.chain(outlines).collect()
}

fn groove(cut: &CutGroove, lang: Lang) -> Option<Sheet> {
    let groove = &cut.groove;
    let (work, found, walls) = (cut.work.as_ref()?, cut.found.as_ref()?, groove.walls()?);
    let stock = work.stock();
    let section = work.section(Turns(0.0), stock.from, stock.face);
    let points: Vec<(f64, f64)> = section.map(|(z, radius)| (z.0, radius.0)).collect();
    let near = (points.first()?.0, points.last()?.0);
    let [low, high] = walls.map(|wall| wall.0);
    let (top, floor) = (groove.begin.0, groove.floor.0);
    let sharp = [
        (stock.from.0, top),
        (low, top),
        (low, floor),
        (high, floor),
        (high, top),
        (stock.face.0, top),
    ];
    let name = groove.code();
    let size = match groove.across {
        Across::X => "⌀",
        Across::Z => "Z",
    };
    let line = SourceLine(groove.line);
    let floor = fixed(across(groove.across, Mm(found.floor.mean)), 4);
    let width = fixed(found.width.mean, 4);
    Some(Sheet {
        name: both!("groove, line {line}: {name}", "槽，第 {line} 行：{name}")
            .get(lang)
            .to_owned(),
        figures: both!(
            "floor {size}{floor} · width {width} mm",
            "槽底 {size}{floor} · 槽宽 {width} mm"
        )
        .get(lang)
        .to_owned(),
        across: groove.across,
        curves: vec![
            Curve {
                line: Line::Cut,
                points,
            },
            Curve {
                line: Line::Programmed,
                points: sharp.to_vec(),
            },
        ],
        near,
        course: None,
        chips: Vec::new(),
    })
}

fn outline(cut: &CutOutline, lang: Lang) -> Option<Sheet> {
    let [(least, _), (most, _)] = worst(cut)?;
    let (mut way, mut points) = (0.0, Vec::new());
    let mut curves = Vec::new();
    for (piece, found) in staying(cut) {
        let Some(found) = found else { continue };
        let element = &piece.element;
        let [from, to] = [element.from, element.to].map(|(z, r)| (z.0, r.0));
        curves.push(Curve {
            line: Line::Programmed,
            points: match element.arc {
                Some((centre, clockwise)) => arc(from, to, (centre.0.0, centre.1.0), clockwise),
                None => vec![from, to],
            },
        });
        let course = found.course.iter();
        points.extend(course.map(|(share, off)| (way + share * found.length.0, off.um())));
        way += found.length.0;
    }
    let places = || {
        curves
            .iter()
            .flat_map(|curve| &curve.points)
            .map(|point| point.0)
    };
    let near = (
        places().fold(f64::MAX, f64::min),
        places().fold(f64::MIN, f64::max),
    );
    let [first, last] = cut.outline.lines();
    let side = match cut.outline.side {
        Side::External => pick(lang, "outside", "外圆"),
        Side::Internal => pick(lang, "bore", "内孔"),
    };
    let (least, most) = (um(least), um(most));
    Some(Sheet {
        name: both!(
            "contour, lines {first}–{last}: {side}",
            "轮廓，第 {first}–{last} 行：{side}"
        )
        .get(lang)
        .to_owned(),
        figures: both!(
            "from the programmed contour: {least} to {most} µm (+: material left)",
            "与编程轮廓的偏差：{least} 至 {most} µm（+：余料）"
        )
        .get(lang)
        .to_owned(),
        across: Across::X,
        curves,
        near,
        course: Some(Course {
            along: Along::Contour,
            points,
        }),
        chips: Vec::new(),
    })
}
