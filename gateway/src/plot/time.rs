//! The panels over time: speeds, how deep a tap is and how far its spindle has turned, and how far what is locked to the
//! spindle is from its exact line.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::Group;

use super::frame::{self, LEFT, RIGHT};
use super::scale::Scale;
use super::series::{Channel, Envelope};
use super::{simplified, text};
use crate::words::pick;

const SPEEDS: f64 = 150.0;
const TAPS: f64 = 170.0;
const SYNCHRONISM: f64 = 110.0;

/// The panels, each only where there is something to show; returns the lower edge with the labels of the last one.
pub(super) fn draw(document: &mut Group, top: f64, series: &Envelope, lang: Lang) -> f64 {
    let taps = series.range(Channel::Depth).is_some();
    let locked = series.range(Channel::Error).is_some();
    let mut bottom = speeds(document, top, series, !taps && !locked, lang);
    if taps {
        bottom = holes(document, bottom + 40.0, series, !locked, lang);
    }
    if locked {
        bottom = synchronism(document, bottom + 40.0, series, lang);
    }
    document.append(text(RIGHT + 14.0, bottom + 18.0, "right name", "s"));
    bottom
}

/// Axis speeds on the left scale, the spindle on the right one; returns the lower edge.
fn speeds(document: &mut Group, top: f64, series: &Envelope, last: bool, lang: Lang) -> f64 {
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
    document.append(text(
        RIGHT + 8.0,
        top - 8.0,
        "right name",
        pick(lang, "rpm", "r/min"),
    ));
    frame::keys(
        document,
        LEFT + 4.0,
        top - 8.0,
        [
            ("x", pick(lang, "X speed", "X 轴速度")),
            ("z", pick(lang, "Z speed", "Z 轴速度")),
            ("rpm", pick(lang, "spindle speed", "主轴转速")),
        ],
    );
    bottom
}

/// Depth on the left scale, downwards; turns since R on the right one. Both have their zero, the R plane, at one height,
/// and are as long as their largest values, so that with one lead the two curves are one line. Returns the lower edge.
fn holes(document: &mut Group, top: f64, series: &Envelope, last: bool, lang: Lang) -> f64 {
    let bottom = top + TAPS;
    let time = time_scale(series);
    let depth = series.range(Channel::Depth).unwrap_or((0.0, 0.0));
    let turned = series.range(Channel::Turned).unwrap_or((0.0, 0.0));
    let deepest = depth.0.abs().max(depth.1.abs()).max(1e-3);
    let most = turned.0.abs().max(turned.1.abs()).max(1e-3);
    // A tap above R, or holes of both hands in one picture, need room above the zero as well.
    let both_hands = turned.0 < -1e-9 && turned.1 > 1e-9;
    let above = if both_hands {
        1.0
    } else {
        (-depth.0 / deepest).clamp(0.0, 1.0)
    };
    // Left-hand taps turn backwards into the hole: their scale goes down to minus.
    let sign = if turned.1 > -turned.0 { 1.0 } else { -1.0 };
    let ends = (top + 8.0, bottom - 8.0);
    let left = Scale::new(-above * deepest, deepest, ends.0, ends.1);
    let right = if sign > 0.0 {
        Scale::new(-above * most, most, ends.0, ends.1)
    } else {
        Scale::new(-most, above * most, ends.1, ends.0)
    };

    frame::panel(document, top, bottom);
    frame::columns(document, &time, top, bottom, last);
    frame::rows(document, &left, 6.0);
    frame::rows_right(document, &right, 6.0);
    frame::line(
        document,
        "zero",
        [(LEFT, left.px(0.0)), (RIGHT, left.px(0.0))],
    );
    for (channel, class, scale) in [
        (Channel::Depth, "depth", &left),
        (Channel::Turned, "turned", &right),
    ] {
        for curve in series.curves(channel) {
            let points = curve.into_iter().map(|(t, v)| (time.px(t), scale.px(v)));
            curve_line(document, class, points);
        }
    }
    document.append(text(LEFT - 8.0, top - 8.0, "left name", "mm"));
    document.append(text(
        RIGHT + 8.0,
        top - 8.0,
        "right name",
        pick(lang, "turns", "转"),
    ));
    frame::keys(
        document,
        LEFT + 4.0,
        top - 8.0,
        [
            (
                "depth",
                pick(lang, "depth of the tap below R", "丝锥在 R 平面以下的深度"),
            ),
            (
                "turned",
                pick(lang, "spindle angle since R", "自 R 平面起的主轴转角"),
            ),
        ],
    );
    bottom
}

/// Setpoint minus exact line while locked; returns the lower edge.
fn synchronism(document: &mut Group, top: f64, series: &Envelope, lang: Lang) -> f64 {
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
        pick(
            lang,
            "synchronism error: setpoint against the spindle's true angle, while locked",
            "同步误差：锁定期间设定值与主轴实际角度之差",
        ),
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
