//! G71 and G72 over random contours, checked by another method: columns of material.
//!
//! No move may come below the shifted contour, no rapid may meet material, no cut may be deeper than Δd, and at the end
//! each column is as high as the shifted contour.

use super::case::{Case, Random, check_all};
use super::columns::{Columns, SLACK, Way, near, shifted};
use crate::contour::{Allowance, Contour, Cut};
use crate::plane::{Element, Point};

/// How many of the moves come before the last pass and the way home.
pub fn strokes(cuts: &[Cut]) -> usize {
    let home = cuts.iter().rev().take_while(|cut| cut.of.is_none()).count();
    let pass = cuts[..cuts.len() - home].iter().rev();
    cuts.len() - home - pass.take_while(|cut| cut.of.is_some()).count()
}

/// The moves of a case.
pub fn rough(case: &Case, contour: &Contour) -> Result<Vec<Cut>, String> {
    let cycle = contour.rough(case.along, &case.words());
    let cycle = cycle.map_err(|alarm| format!("refused: {alarm:?}"))?;
    Ok(cycle.take(20_000).collect())
}

fn check(case: &Case) -> Result<(), String> {
    let contour = case.contour();
    let cuts = rough(case, &contour)?;
    judge(case, &contour, &cuts, &[]).map(drop)
}

/// The columns that the moves of a case leave, some of them at the ends of the `next` cuts.
pub fn judge(
    case: &Case,
    contour: &Contour,
    cuts: &[Cut],
    next: &[Way],
) -> Result<Columns, String> {
    let words = case.words();
    let moved = |point| words.allowance.shift(point);
    let left = words.allowance.and(words.left);
    let start = left.shift(contour.start());
    let part = shifted(case, contour, &words.allowance);
    let mut from = contour.start();
    let mut moves = Vec::new();
    for cut in cuts {
        let way = Way::of(case, from, &cut.element);
        if let Some((centre, _)) = way.arc {
            let [a, b] = [way.from, way.to].map(|end| (end.0 - centre.0).hypot(end.1 - centre.1));
            // A steep end may advance by less than its places are rounded to.
            let radius = (a + b) / 2.0;
            let along = |end: (f64, f64)| (radius * radius - (end.0 - centre.0).powi(2)).sqrt();
            let stands = way.to.1.to_bits() == way.from.1.to_bits()
                && (along(way.to) - along(way.from)).abs() < 1.0;
            if (a - b).abs() > SLACK || (way.to.1 <= way.from.1 && !stands) {
                return Err(format!("a bad arc: {way:?}"));
            }
        }
        moves.push(way);
        from = cut.element.end;
    }
    if from != contour.start() {
        return Err("does not come home".into());
    }
    let top = case.place(start).0;
    // The last pass comes down there, at rapid in type I: no material is in front of it.
    let front = case.place(moved(contour.start())).1;
    let depth = case.depth as f64;
    // The way from A to A' is the caller's: the allowance may lead anywhere.
    let first = usize::from(start != contour.start());
    // Where the allowance moves the first block over A, A itself is in material, and so is the last move.
    let home = case.place(contour.start());
    let inside = home.0 < near(&part, home.1).1 && front < home.1;
    // The strokes stay away from the contour by what they leave, and the last pass takes that at once.
    let deepest = if words.left == Allowance::NONE {
        depth
    } else {
        let part = shifted(case, contour, &left);
        let mut columns = Columns::new(&part, &moves, (top, front), &mut Random(1));
        for way in &moves[first..strokes(cuts)] {
            columns
                .go(way, depth)
                .map_err(|what| format!("a stroke {what}: {way:?}"))?;
        }
        f64::INFINITY
    };
    let all = [&moves[..], next].concat();
    let mut columns = Columns::new(&part, &all, (top, front), &mut Random(1));
    for (cut, way) in cuts.iter().zip(&moves).skip(first) {
        let upright = way.from.1.to_bits() == way.to.1.to_bits();
        if inside && upright && way.to == home {
            continue;
        }
        columns
            .go(way, deepest)
            .map_err(|what| format!("{what}: {way:?}"))?;
        let level = way.from.0.to_bits() == way.to.0.to_bits();
        if cut.of.is_none() && !way.rapid && level {
            let down = (top - way.to.0) as i64;
            if down % case.depth != 0 || down == 0 {
                return Err(format!("not on a level: {way:?}"));
            }
        }
    }
    for (l, top, (low, high)) in &columns.all {
        if !(low - SLACK..=high + SLACK).contains(top) {
            return Err(format!("leaves {top} on {low}..{high} at {l}"));
        }
    }
    last_pass(contour, cuts, moved)?;
    Ok(columns)
}

/// The last cuts are the elements of the contour, moved exactly by the allowance.
fn last_pass(
    contour: &Contour,
    cuts: &[Cut],
    moved: impl Fn(Point) -> Point,
) -> Result<(), String> {
    let mut last = cuts.iter().rev().skip_while(|cut| cut.of.is_none());
    let elements = contour.elements();
    for (index, element) in elements.iter().enumerate().skip(1).rev() {
        if elements[index - 1].end == element.end {
            continue;
        }
        let wanted = Cut {
            element: Element {
                end: moved(element.end),
                ..*element
            },
            of: Some(index),
        };
        let cut = last.next();
        if cut != Some(&wanted) {
            return Err(format!(
                "the last pass has {cut:?} where {wanted:?} belongs"
            ));
        }
    }
    Ok(())
}

#[test]
fn random_contours_are_cut_down_to_their_allowance() {
    leadscrew_seed::volume(71, |seed| {
        let many = leadscrew_seed::amount(1_000, 3_000);
        check_all(seed, many, Case::random, Case::smaller, check);
    });
}
