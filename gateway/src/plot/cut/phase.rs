//! How far Z is from the helix over the spindle's angle: all turns of all passes one upon the other, since the angle is
//! taken modulo a turn and Z modulo the lead. For a tap the same, stroke by stroke.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Group, Path, Rectangle};

use crate::plot::frame::{self, label, line};
use crate::plot::scale::Scale;
use crate::plot::{polyline, px, text};
use crate::words::pick;

/// Parts of a turn: each is met in a turn at 600 rpm and a tick of a millisecond.
const BINS: usize = 60;

/// Lowest and highest distance in each part of a turn, micrometres.
type Turn = [Option<(f64, f64)>; BINS];

/// The distances of a thread.
#[derive(Clone, Debug)]
pub struct Phase {
    all: Turn,
    first: Turn,
    last: Turn,
    /// Number of the pass under way.
    passes: u32,
    is_locked: bool,
}

impl Default for Phase {
    fn default() -> Self {
        Self {
            all: [None; BINS],
            first: [None; BINS],
            last: [None; BINS],
            passes: 0,
            is_locked: false,
        }
    }
}

impl Phase {
    /// The tool is away from the helix.
    pub fn interrupt(&mut self) {
        self.is_locked = false;
    }

    /// Adds a tick: the spindle's angle in millionths of a turn, and the distance in micrometres.
    pub fn push(&mut self, urev: i64, micrometres: f64) {
        if !std::mem::replace(&mut self.is_locked, true) {
            self.passes += 1;
            self.last = [None; BINS];
        }
        let part = usize::try_from(urev.rem_euclid(1_000_000)).unwrap_or(0) * BINS / 1_000_000;
        let into = |turn: &mut Turn| {
            if let Some(span) = turn.get_mut(part) {
                let (low, high) = span.unwrap_or((micrometres, micrometres));
                *span = Some((low.min(micrometres), high.max(micrometres)));
            }
        };
        into(&mut self.all);
        into(&mut self.last);
        if self.passes == 1 {
            into(&mut self.first);
        }
    }

    /// Number of passes.
    pub const fn passes(&self) -> u32 {
        self.passes
    }

    /// Lowest and highest distance of all passes.
    pub fn range(&self) -> Option<(f64, f64)> {
        let spans = self.all.iter().flatten().copied();
        spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

const HEIGHT: f64 = 120.0;

/// What the distances are of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Of<'a> {
    /// A thread with this long axis.
    Thread(&'a str),
    /// A tap along this axis; rigid, or with a floating holder.
    Tap { axis: &'a str, is_rigid: bool },
}

impl Of<'_> {
    /// What the panel shows, of so many passes or strokes.
    fn words(self, passes: u32, lang: Lang) -> String {
        match (self, lang) {
            (Self::Thread(axis), Lang::En) => format!(
                "{axis} modulo lead minus the helix, over the spindle angle: from lowest to highest; filled: all {passes} passes"
            ),
            (Self::Thread(axis), Lang::Zh) => format!(
                "{axis}（对导程取模）与螺旋线之差，沿主轴角度，最低至最高；填充：全部 {passes} 次走刀"
            ),
            (Self::Tap { axis, .. }, Lang::En) => format!(
                "{axis} minus its place in phase, over the spindle angle: from lowest to highest; filled: all {passes} strokes"
            ),
            (Self::Tap { axis, .. }, Lang::Zh) => {
                format!("{axis} 与同步位置之差，沿主轴角度，最低至最高；填充：全部 {passes} 个行程")
            }
        }
    }

    /// The first and the last of them.
    const fn ends(self, lang: Lang) -> [(&'static str, &'static str); 2] {
        let (first, last) = match self {
            Self::Thread(_) => (
                pick(lang, "first pass", "第一刀"),
                pick(lang, "last pass", "最后一刀"),
            ),
            Self::Tap { .. } => (
                pick(lang, "first stroke", "第一行程"),
                pick(lang, "last way out", "最后退出"),
            ),
        };
        [("peck", first), ("error", last)]
    }

    /// What is told where the spindle has no ripple.
    const fn ideal(self, lang: Lang) -> &'static str {
        match self {
            Self::Tap { is_rigid: true, .. } => pick(
                lang,
                "simulated spindle: in position mode it turns exactly as commanded",
                "仿真主轴：位置模式下完全按指令转动",
            ),
            _ => pick(
                lang,
                "ideal spindle: add `--spindle-ripple`",
                "理想主轴：请加 `--spindle-ripple`",
            ),
        }
    }
}

/// Draws the panel between `left` and `right`; returns its lower edge with labels. `ideal`: the spindle has no ripple.
pub(super) fn draw(
    document: &mut Group,
    (left, right): (f64, f64),
    top: f64,
    phase: &Phase,
    of: Of<'_>,
    ideal: bool,
    lang: Lang,
) -> f64 {
    let Some((low, high)) = phase.range() else {
        return top;
    };
    let bottom = top + HEIGHT;
    let reach = low.abs().max(high.abs()).max(0.1);
    let scale = Scale::new(-reach, reach, bottom - 6.0, top + 6.0);
    let angle = Scale::new(0.0, 360.0, left, right);
    document.append(
        Rectangle::new()
            .set("class", "panel")
            .set("x", px(left))
            .set("y", px(top))
            .set("width", px(right - left))
            .set("height", px(HEIGHT)),
    );
    for quarter in 0..=8 {
        let at = angle.px(45.0 * f64::from(quarter));
        line(document, "grid", [(at, top), (at, bottom)]);
        let degrees = (45 * quarter).to_string();
        document.append(text(at, bottom + 18.0, "below", &degrees));
    }
    let (ticks, decimals) = scale.ticks(5.0);
    for tick in ticks {
        let y = scale.px(tick);
        line(document, "grid", [(left, y), (right, y)]);
        document.append(text(left - 8.0, y + 4.5, "left", &label(tick, decimals)));
    }
    let middle = |part: usize| angle.px((part as f64 + 0.5) * 360.0 / BINS as f64);
    let spans = |turn: &Turn| -> Vec<(f64, f64, f64)> {
        let known = turn.iter().enumerate();
        let known = known.filter_map(|(part, span)| span.map(|(low, high)| (part, low, high)));
        known
            .map(|(part, low, high)| (middle(part), scale.px(low), scale.px(high)))
            .collect()
    };
    for (class, turn) in [
        ("band", &phase.all),
        ("line peck", &phase.first),
        ("line error", &phase.last),
    ] {
        let spans = spans(turn);
        let there = spans.iter().map(|(x, low, _)| (*x, *low));
        let back = spans.iter().rev().map(|(x, _, high)| (*x, *high));
        let data = polyline(there.chain(back)) + "Z";
        document.append(Path::new().set("class", class).set("d", data));
    }
    document.append(text(left - 8.0, top - 8.0, "left name", "µm"));
    document.append(text(right + 14.0, bottom + 18.0, "right name", "°"));
    let words = of.words(phase.passes, lang);
    document.append(text(left, top - 8.0, "key", &words));
    frame::keys(
        document,
        left + frame::width(&words) + 24.0,
        top - 8.0,
        of.ends(lang),
    );
    if ideal || matches!(of, Of::Tap { is_rigid: true, .. }) {
        document.append(text(left + 10.0, top + 18.0, "name", of.ideal(lang)));
    }
    bottom + 18.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_of_all_passes_lie_upon_each_other() {
        let mut phase = Phase::default();
        assert_eq!(phase.range(), None);
        // A quarter of a turn apart; the second pass begins turns later.
        for (begin, off) in [(0, 0.5), (7_000_000, -1.5)] {
            for n in 0..8 {
                phase.push(begin + n * 250_000, off * f64::from(n as i32 % 4));
            }
            phase.interrupt();
        }
        assert_eq!((phase.passes(), phase.range()), (2, Some((-4.5, 1.5))));
        let known = |turn: &Turn| -> Vec<_> {
            let parts = turn.iter().enumerate();
            parts
                .filter_map(|(n, span)| span.map(|span| (n, span)))
                .collect()
        };
        assert_eq!(
            known(&phase.all),
            [
                (0, (0.0, 0.0)),
                (15, (-1.5, 0.5)),
                (30, (-3.0, 1.0)),
                (45, (-4.5, 1.5))
            ]
        );
        assert_eq!(known(&phase.first)[3], (45, (1.5, 1.5)));
        assert_eq!(known(&phase.last)[3], (45, (-4.5, -4.5)));
        // A spindle that turns backwards comes by the same angles.
        phase.push(-250_000, 9.0);
        assert_eq!(known(&phase.all)[3], (45, (-4.5, 9.0)));
    }
}
