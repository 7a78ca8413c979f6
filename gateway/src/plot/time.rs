//! The panels over time: speeds, and how far a thread is from its exact helix.

use svg::Node as _;
use svg::node::element::Group;

use super::frame::{self, LEFT, RIGHT};
use super::scale::Scale;
use super::series::{Channel, Envelope};
use super::{simplified, text};

const SPEEDS: f64 = 150.0;
const SYNCHRONISM: f64 = 110.0;

/// Both panels, the second only where something was locked; returns the lower edge with its labels.
pub(super) fn draw(document: &mut Group, top: f64, series: &Envelope) -> f64 {
    let locked = series.range(Channel::Error).is_some();
    let mut bottom = speeds(document, top, series, !locked);
    if locked {
        bottom = synchronism(document, bottom + 22.0, series);
    }
    document.append(text(RIGHT + 14.0, bottom + 18.0, "right name", "s"));
    bottom
}

/// Axis speeds on the left scale, the spindle on the right one; returns the lower edge.
fn speeds(document: &mut Group, top: f64, series: &Envelope, last: bool) -> f64 {
    let bottom = top + SPEEDS;
    let time = time_scale(series);
    let ranges =
        [Channel::X, Channel::Z].map(|channel| series.range(channel).unwrap_or((0.0, 0.0)));
    let reach = |range: (f64, f64)| range.0.abs().max(range.1.abs());
    // Symmetric, so that both scales have their zero at one height; in metres a minute.
    let feed = ranges.into_iter().map(reach).fold(0.1, f64::max) / 1000.0;
    let turns = reach(series.range(Channel::Rpm).unwrap_or((0.0, 0.0))).max(10.0);
    let left = Scale::new(-feed, feed, bottom - 8.0, top + 8.0);
    let right = Scale::new(-turns, turns, bottom - 8.0, top + 8.0);

    frame::panel(document, top, bottom);
    frame::columns(document, &time, top, bottom, last);
    frame::rows(document, &left, 8.0);
    frame::rows_right(document, &right, 8.0);
    frame::line(
        document,
        "zero",
        [(LEFT, left.px(0.0)), (RIGHT, left.px(0.0))],
    );
    for (channel, class) in [(Channel::Rpm, "rpm"), (Channel::Z, "z"), (Channel::X, "x")] {
        for curve in series.curves(channel) {
            let place = |(t, v): (f64, f64)| match channel {
                Channel::Rpm => (time.px(t), right.px(v)),
                _ => (time.px(t), left.px(v / 1000.0)),
            };
            frame::line(
                document,
                &format!("line {class}"),
                curve.into_iter().map(place),
            );
        }
    }
    document.append(text(LEFT - 8.0, top - 8.0, "left name", "m/min"));
    document.append(text(RIGHT + 8.0, top - 8.0, "right name", "rpm"));
    let mut x = LEFT + 4.0;
    for (class, name) in [("x", "X speed"), ("z", "Z speed"), ("rpm", "spindle speed")] {
        x = frame::key(document, x, top - 8.0, class, name);
    }
    bottom
}

/// Setpoint minus exact helix while locked; returns the lower edge.
fn synchronism(document: &mut Group, top: f64, series: &Envelope) -> f64 {
    let top = top + 18.0;
    let bottom = top + SYNCHRONISM;
    let time = time_scale(series);
    let (low, high) = series.range(Channel::Error).unwrap_or((0.0, 0.0));
    let reach = low.abs().max(high.abs()).max(0.1);
    let scale = Scale::new(-reach, reach, bottom - 6.0, top + 6.0);

    frame::panel(document, top, bottom);
    frame::columns(document, &time, top, bottom, true);
    frame::rows(document, &scale, 4.0);
    frame::line(
        document,
        "zero",
        [(LEFT, scale.px(0.0)), (RIGHT, scale.px(0.0))],
    );
    for curve in series.curves(Channel::Error) {
        let points = curve.into_iter().map(|(t, v)| (time.px(t), scale.px(v)));
        curve_line(document, "error", points);
    }
    document.append(text(LEFT - 8.0, top - 8.0, "left name", "µm"));
    frame::key(
        document,
        LEFT + 4.0,
        top - 8.0,
        "error",
        "synchronism error: setpoint against the exact helix, while locked",
    );
    bottom
}

/// A curve with no more points than its picture needs.
fn curve_line(document: &mut Group, class: &str, points: impl Iterator<Item = (f64, f64)>) {
    let points: Vec<_> = points.collect();
    frame::line(
        document,
        &format!("line {class}"),
        simplified(&points, 0.15),
    );
}

fn time_scale(series: &Envelope) -> Scale {
    Scale::new(0.0, series.duration().max(1e-3), LEFT, RIGHT)
}
