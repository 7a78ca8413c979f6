//! What stands between the strokes of G71 and G72, before the last pass takes it: measured in columns, for a pointed tool
//! and for a round nose, whose compensation has no part in these cycles.
//!
//! From each place of the contour the level above it is at most Δd away, and a stroke on that level has been there. So a
//! tool leaves in no column more than Δd above what the same tool leaves that follows the contour itself. That holds for
//! each nose and each place of its centre. A stroke that is missing, too high or too short leaves more.

use super::case::{Case, Random, check_all};
use super::check::{rough, strokes};
use super::columns::{ASIDE, SLACK, Way, near, shifted};

/// A case and its tool.
#[derive(Clone, Debug)]
struct Tool {
    case: Case,
    /// The radius of the nose, nm; 0 for a point.
    radius: f64,
    /// The centre of the nose is behind the tip, over it or before it: −1, 0, 1.
    side: f64,
}

impl Tool {
    fn random(random: &mut Random) -> Self {
        let case = Case::random(random);
        let radius = match random.within(0, 2) {
            0 => 0,
            1 => random.within(1, case.depth),
            _ => random.within(1, 2_000_000),
        };
        Self {
            case,
            radius: radius as f64,
            side: random.within(-1, 1) as f64,
        }
    }

    fn smaller(&self) -> Vec<Self> {
        let cases = self.case.smaller().into_iter();
        let cases = cases.map(|case| Self {
            case,
            ..self.clone()
        });
        cases.collect()
    }

    /// Where a column must be for the lowest place of the nose to be on it.
    fn below(&self, l: f64) -> f64 {
        self.side.mul_add(self.radius, l)
    }

    /// How high the nose passes a column at this distance from its centre, above its tip.
    fn rise(&self, away: f64) -> f64 {
        let square = (self.radius - away) * (self.radius + away);
        self.radius - square.max(0.0).sqrt()
    }

    /// What the nose leaves in a column that follows the contour. Of the places from which it reaches the column, some are
    /// enough: between two of them it leaves less, and what is compared with it is then smaller.
    fn after_all(&self, part: &[Way], l: f64) -> f64 {
        let reach = (-16..=16).map(|step| f64::from(step) / 16.0 * self.radius);
        let on = reach.filter_map(|away| {
            let place = l + away - self.side * self.radius;
            let on = part.iter().filter_map(|way| way.height(place));
            let highest = on.reduce(f64::max)?;
            Some(highest + self.rise(away.abs()))
        });
        on.fold(f64::INFINITY, f64::min)
    }

    /// The height that a stroke on a level leaves in a column.
    fn after(&self, stroke: &Way, l: f64) -> Option<f64> {
        let (from, to) = (self.below(stroke.from.1), self.below(stroke.to.1));
        // Rounding has made it shorter by a nanometre at either end.
        let away = ((from - l).max(l - to) - ASIDE).max(0.0);
        (away <= self.radius).then(|| stroke.from.0 + self.rise(away))
    }
}

/// Where a way is at a height.
fn crossing(way: &Way, h: f64) -> Option<f64> {
    let ((h0, l0), (h1, l1)) = (way.from, way.to);
    match way.arc {
        Some(((ch, cl), _)) => {
            let (a, b) = (h0 - ch, l0 - cl);
            let across = a.mul_add(a, b * b) - (h - ch) * (h - ch);
            let across = (across >= 0.0).then(|| across.sqrt())?;
            let places = [cl - across, cl + across].into_iter();
            let mut on = places.filter(|l| {
                *l > l0
                    && *l < l1
                    && way
                        .height(*l)
                        .is_some_and(|there| (there - h).abs() < 100.0)
            });
            on.next()
        }
        None if (h0 - h) * (h1 - h) < 0.0 => Some(l0 + (l1 - l0) * (h - h0) / (h1 - h0)),
        None => None,
    }
}

/// The columns to look at: by chance, beside the ends of the contour's pieces, and where some of the levels meet it.
fn columns(tool: &Tool, part: &[Way], random: &mut Random) -> Vec<f64> {
    let (top, front) = part[0].from;
    let end = part[part.len() - 1].to.1;
    let mut places: Vec<f64> = part.iter().map(|way| way.to.1).collect();
    let lowest = part.iter().map(|way| way.to.0).fold(top, f64::min);
    let depth = tool.case.depth as f64;
    let levels = ((top - lowest) / depth) as i64;
    let few = if tool.radius > 0.0 { 3 } else { 8 };
    for _ in 0..few.min(levels) {
        let level = top - depth * random.within(1, levels) as f64;
        places.extend(part.iter().filter_map(|way| crossing(way, level)));
    }
    let mut all: Vec<f64> = places
        .iter()
        .flat_map(|l| [-5.3, 5.3].map(|aside| l + aside))
        .collect();
    for _ in 0..60 {
        all.push(front + (end - front) * random.within(1, 999_999) as f64 / 1e6);
    }
    if tool.radius > 0.0 {
        let moved: Vec<f64> = all.iter().map(|l| tool.below(*l)).collect();
        all.extend(moved);
    }
    all.retain(|l| *l > front && *l < end);
    all
}

fn check(tool: &Tool) -> Result<(), String> {
    let case = &tool.case;
    let contour = case.contour();
    let cuts = rough(case, &contour)?;
    let words = case.words();
    let part = shifted(case, &contour, &words.allowance.and(words.left));
    let top = part[0].from.0;
    let mut from = contour.start();
    let mut levels = Vec::new();
    for cut in &cuts[..strokes(&cuts)] {
        let way = Way::of(case, from, &cut.element);
        from = cut.element.end;
        let level = way.from.0.to_bits() == way.to.0.to_bits();
        if cut.of.is_none() && !way.rapid && level && way.to.1 > way.from.1 {
            levels.push(way);
        }
    }
    let depth = case.depth as f64;
    for l in columns(tool, &part, &mut Random(1)) {
        let (_, high) = near(&part, l);
        let stands = levels
            .iter()
            .filter_map(|stroke| tool.after(stroke, l))
            .fold(top.max(high), f64::min);
        let followed = if tool.radius > 0.0 {
            tool.after_all(&part, l)
        } else {
            high
        };
        if stands > followed + depth + SLACK {
            return Err(format!(
                "{stands} stands at {l}, {} above {followed}, with strokes of {depth}",
                stands - followed
            ));
        }
    }
    Ok(())
}

#[test]
fn no_more_than_a_stroke_stands_between_the_strokes() {
    leadscrew_seed::volume(7_172, |seed| {
        let many = leadscrew_seed::amount(1_000, 3_000);
        check_all(seed, many, Tool::random, Tool::smaller, check);
    });
}
