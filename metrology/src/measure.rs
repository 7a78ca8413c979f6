//! A thread measured as an inspector does: diameters across the part, over wires, flanks, lead, gauge.

use crate::designation::{Designation, Series};
use crate::gauge::{Counterpart, Functional};
use crate::groove::{Course, Groove, Grooves};
use crate::helix::{Drunkenness, Helix, Lead};
use crate::limits::Limits;
use crate::units::{Degrees, Mm, Side};
use crate::work::Work;

/// Mean, smallest and largest of what was measured at many places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// The smallest.
    pub low: f64,
    /// The largest.
    pub high: f64,
}

impl Spread {
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (mut n, mut sum) = (0.0, 0.0);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            n += 1.0;
            sum += value;
            (low, high) = (low.min(value), high.max(value));
        }
        (n > 0.0).then(|| Self {
            mean: sum / n,
            low,
            high,
        })
    }
}

/// Over three wires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wires {
    /// Diameter of the wires.
    pub wire: Mm,
    /// What the micrometer shows.
    pub over: Mm,
    /// The pitch diameter that follows.
    pub pitch: Mm,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Outer surface or inner one.
    pub side: Side,
    /// Major diameter, millimetres, at the face where the thread has a taper.
    pub major: Spread,
    /// Pitch diameter where groove and ridge are alike, likewise.
    pub pitch: Spread,
    /// Minor diameter, likewise.
    pub minor: Spread,
    /// Over wires, of a bolt without a taper.
    pub wires: Option<Wires>,
    /// Angles of the flanks towards −Z and +Z from the normal of the axis, degrees.
    pub flanks: [Spread; 2],
    /// Radius of the root that touches both flanks and the floor.
    pub root: Mm,
    /// Where the nominal helix has the middle of a groove at angle 0: the first full one from the face.
    pub groove: Mm,
    /// The lead.
    pub lead: Lead,
    /// The sway within a turn.
    pub drunkenness: Drunkenness,
    /// Where each start lies from where it should.
    pub starts: Vec<Mm>,
    /// The gauge; none without a norm.
    pub functional: Option<Functional>,
    /// Change of the pitch diameter per millimetre of Z.
    pub taper: f64,
    /// Length over which grooves have their full depth, from the middle of the first to that of the last.
    pub full: Mm,
    /// Length behind that until the tool has left the part.
    pub run_out: Mm,
    /// Whole turns from the face on whose pitch diameter is beyond its limit of least material: what a NO-GO gauge enters.
    pub loose_turns: f64,
}

/// There is nothing to measure: no groove has both flanks and its full depth over a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoThread;

/// Measures the thread on a part. `thread` says what it should be.
///
/// # Errors
/// There is no thread.
pub fn measure(work: &Work, thread: &Designation) -> Result<Measured, NoThread> {
    let side = thread.side;
    let course = Course {
        pitch: thread.pitch.0,
        starts: f64::from(thread.starts),
        taper: side.height(thread.taper),
    };
    let face = work.stock().face.0;
    let grooves = Grooves::find(work, &course).ok_or(NoThread)?;
    let starts = i64::from(thread.starts);
    let half_pitch = course.pitch / 2.0;
    // Heights of the pitch line, taken to the face.
    let pitch_height = |groove: &Groove| {
        let height = groove.height_of_width(half_pitch);
        height - course.taper * (groove.middle(height) - face)
    };
    let across = |height: &dyn Fn(&Groove) -> f64| {
        Spread::of(grooves.list.iter().filter_map(|groove| {
            let other = grooves.opposite(groove, starts)?;
            Some(side.height(height(groove) + height(other)))
        }))
        .ok_or(NoThread)
    };
    let pitch = across(&pitch_height)?;
    let crest = across(&|groove| groove.crest)?;
    let floor = across(&|groove| groove.floor)?;
    let (major, minor) = match side {
        Side::External => (crest, floor),
        Side::Internal => (floor, crest),
    };
    let angle = |lean: f64| lean.atan().to_degrees();
    let flank =
        |pick: &dyn Fn(&Groove) -> f64| Spread::of(grooves.list.iter().map(pick)).ok_or(NoThread);
    let flanks = [
        flank(&|groove| angle(-groove.minus.lean))?,
        flank(&|groove| angle(groove.plus.lean))?,
    ];
    let helix = Helix::of(
        &grooves,
        &course,
        work.course(),
        side.height(pitch.mean / 2.0),
        face,
    );
    let limits = Limits::of(thread);
    let root = grooves.list.iter().map(|groove| {
        // The flanks are lines over true heights.
        let apex = groove.height_of_width(0.0);
        let floor = groove.floor + course.taper * (groove.middle(apex) - face);
        root_radius(groove, floor)
    });
    let root = Spread::of(root).map_or(0.0, |root| root.mean);
    let (full, run_out) = lengths(work, &grooves, &course);
    Ok(Measured {
        side,
        major,
        pitch,
        minor,
        wires: (side == Side::External && course.taper == 0.0)
            .then(|| wires(&grooves, thread, &pitch))
            .flatten(),
        flanks,
        root: Mm(root),
        groove: Mm(grooves.reference),
        lead: helix.lead(thread.lead().0),
        drunkenness: helix.drunkenness(),
        starts: helix.starts(),
        functional: functional(work, &grooves, &course, thread, &limits, pitch.mean),
        taper: slope(grooves.list.iter().map(|groove| {
            let height = groove.height_of_width(half_pitch);
            (groove.middle(height), side.height(2.0 * height))
        })),
        full: Mm(full),
        run_out: Mm(run_out),
        loose_turns: loose(&grooves, thread, &limits, &pitch_height),
    })
}

/// Radius of the circle that touches both flanks and the floor.
fn root_radius(groove: &Groove, floor: f64) -> f64 {
    let [minus, plus] = [-groove.minus.lean, groove.plus.lean].map(f64::atan);
    let apex = groove.height_of_width(0.0);
    let across = ((minus + plus) / 2.0).sin();
    let lean = ((plus - minus) / 2.0).cos();
    (floor - apex) / (lean / across - 1.0)
}

/// The usual wires, which touch at the pitch line, laid into the grooves of both sides.
fn wires(grooves: &Grooves, thread: &Designation, pitch: &Spread) -> Option<Wires> {
    let half = thread.angle.0.to_radians() / 2.0;
    let wire = thread.pitch.0 / (2.0 * half.cos());
    let height = |groove: &Groove| {
        let [minus, plus] = [-groove.minus.lean, groove.plus.lean].map(f64::atan);
        let apex = groove.height_of_width(0.0);
        let from_apex = wire / 2.0 / ((minus + plus) / 2.0).sin();
        apex + from_apex * ((plus - minus) / 2.0).cos()
    };
    let across = Spread::of(grooves.list.iter().filter_map(|groove| {
        let other = grooves.opposite(groove, i64::from(thread.starts))?;
        Some(height(groove) + height(other))
    }))?;
    // A wire lies along the helix, not in the axial plane: it stands out by this.
    let rise = thread.lead().0 / (std::f64::consts::PI * pitch.mean);
    let correction = wire / 2.0 * rise * rise * half.cos() / half.tan();
    let over = across.mean + wire + correction;
    let follows = over - wire * (1.0 + 1.0 / half.sin()) + thread.pitch.0 / 2.0 / half.tan();
    Some(Wires {
        wire: Mm(wire),
        over: Mm(over),
        pitch: Mm(follows - correction),
    })
}

fn functional(
    work: &Work,
    grooves: &Grooves,
    course: &Course,
    thread: &Designation,
    limits: &Limits,
    pitch: f64,
) -> Option<Functional> {
    if matches!(thread.series, Series::Free | Series::Pipe { .. }) {
        return None;
    }
    let crest = match thread.side {
        Side::External => limits.minor.high.unwrap_or(thread.minor()),
        Side::Internal => limits.major.low.unwrap_or(thread.major),
    };
    // On a thread that is too thick the counterpart is as much larger: its flanks are asked, not its crest.
    let limit = thread.side.height(crest.0 / 2.0);
    let moved = thread
        .side
        .height((pitch - thread.pitch_diameter().0 + crest_of(thread)) / 2.0);
    let counterpart = Counterpart {
        side: thread.side,
        flank: thread.angle.0 / 2.0,
        crest: limit.max(moved),
        length: thread.engagement().0,
    };
    Functional::of(work, grooves, course, &counterpart)
}

/// Basic diameter of the counterpart's crest.
fn crest_of(thread: &Designation) -> f64 {
    match thread.side {
        Side::External => thread.minor().0,
        Side::Internal => thread.major.0,
    }
}

/// Slope of a regression line; zero for a single point.
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = points.clone().count() as f64;
    let mean = |pick: fn((f64, f64)) -> f64| points.clone().map(pick).sum::<f64>() / n;
    let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
    let above: f64 = points.clone().map(|(x, y)| (x - x0) * (y - y0)).sum();
    let below: f64 = points.map(|(x, _)| (x - x0) * (x - x0)).sum();
    if below > 0.0 { above / below } else { 0.0 }
}

/// Length of the full grooves, and from there to the end of what was cut.
fn lengths(work: &Work, grooves: &Grooves, course: &Course) -> (f64, f64) {
    let middle = |groove: &Groove| groove.middle(groove.height_of_width(course.pitch / 2.0));
    let middles = || grooves.list.iter().map(middle);
    let low = middles().fold(f64::INFINITY, f64::min);
    let high = middles().fold(f64::NEG_INFINITY, f64::max);
    let stock = work.stock();
    let uncut = |z: f64| {
        stock
            .side
            .height(stock.radius.0 + stock.taper * (z - stock.face.0))
    };
    let mut end = low;
    for angle in 0..work.grid().angles {
        let line = work.line(angle).iter().enumerate();
        let mut cut = line.filter(|(n, u)| f64::from(**u) / 1e6 < uncut(work.z(*n)) - 2e-6);
        if let Some((node, _)) = cut.next() {
            end = end.min(work.z(node));
        }
    }
    (high - low, low - end)
}

/// Turns from the face on that are looser than the limit of least material.
fn loose(
    grooves: &Grooves,
    thread: &Designation,
    limits: &Limits,
    height: &dyn Fn(&Groove) -> f64,
) -> f64 {
    let limit = match thread.side {
        Side::External => limits.pitch.low,
        Side::Internal => limits.pitch.high,
    };
    let Some(limit) = limit.filter(|_| !matches!(thread.series, Series::Pipe { .. })) else {
        return 0.0;
    };
    let least = thread.side.height(limit.0);
    let starts = i64::from(thread.starts);
    let mut all: Vec<(f64, bool)> = grooves
        .list
        .iter()
        .filter_map(|groove| {
            let other = grooves.opposite(groove, starts)?;
            let loose = height(groove) + height(other) < least - 1e-4;
            Some((groove.middle(height(groove)), loose))
        })
        .collect();
    // From the face on.
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let face = all.first().map_or(0.0, |first| first.0);
    let end = all.iter().find(|(_, loose)| !loose);
    let end = end.or(all.last()).map_or(face, |last| last.0);
    (face - end) / thread.lead().0
}

impl Measured {
    /// Pitch diameter at a distance behind the face.
    #[must_use]
    pub fn pitch_at(&self, thread: &Designation, behind: Mm) -> Mm {
        Mm(self.pitch.mean - 2.0 * thread.taper * behind.0)
    }

    /// The angle between the flanks, by their means.
    #[must_use]
    pub fn angle(&self) -> Degrees {
        Degrees(self.flanks[0].mean + self.flanks[1].mean)
    }
}
