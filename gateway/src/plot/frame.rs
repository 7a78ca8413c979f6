//! A panel: its box, grid, and labels.

use svg::Node as _;
use svg::node::element::{Group, Path, Rectangle};

use super::scale::Scale;
use super::{MARGIN, WIDTH, polyline, px, text};

/// Left and right edge of every panel.
pub(super) const LEFT: f64 = MARGIN;
pub(super) const RIGHT: f64 = WIDTH - MARGIN;

/// Draws the box.
pub(super) fn panel(document: &mut Group, top: f64, bottom: f64) {
    document.append(edge(top, bottom).set("class", "panel"));
}

/// The box itself.
pub(super) fn edge(top: f64, bottom: f64) -> Rectangle {
    Rectangle::new()
        .set("x", px(LEFT))
        .set("y", px(top))
        .set("width", px(RIGHT - LEFT))
        .set("height", px(bottom - top))
}

/// Draws vertical grid lines, with labels below where `labelled`.
pub(super) fn columns(document: &mut Group, scale: &Scale, top: f64, bottom: f64, labelled: bool) {
    let (ticks, decimals) = scale.ticks(12.0);
    for tick in ticks {
        let x = scale.px(tick);
        line(document, "grid", [(x, top), (x, bottom)]);
        if labelled {
            document.append(text(x, bottom + 18.0, "below", &label(tick, decimals)));
        }
    }
}

/// Draws horizontal grid lines with labels on the left.
pub(super) fn rows(document: &mut Group, scale: &Scale, most: f64) {
    let (ticks, decimals) = scale.ticks(most);
    for tick in ticks {
        let y = scale.px(tick);
        line(document, "grid", [(LEFT, y), (RIGHT, y)]);
        document.append(text(LEFT - 8.0, y + 4.5, "left", &label(tick, decimals)));
    }
}

/// Draws labels on the right without grid lines.
pub(super) fn rows_right(document: &mut Group, scale: &Scale, most: f64) {
    let (ticks, decimals) = scale.ticks(most);
    for tick in ticks {
        document.append(text(
            RIGHT + 8.0,
            scale.px(tick) + 4.5,
            "right",
            &label(tick, decimals),
        ));
    }
}

/// Draws a polyline of a class.
pub(super) fn line(
    document: &mut Group,
    class: &str,
    points: impl IntoIterator<Item = (f64, f64)>,
) {
    document.append(Path::new().set("class", class).set("d", polyline(points)));
}

/// A short sample of a line with its name; returns where the next one starts.
pub(super) fn key(document: &mut Group, x: f64, y: f64, class: &str, name: &str) -> f64 {
    line(
        document,
        &format!("line {class}"),
        [(x, y - 4.5), (x + 26.0, y - 4.5)],
    );
    document.append(text(x + 33.0, y, "key", name));
    x + 33.0 + width(name) + 24.0
}

/// Samples of lines with their names, one after the other; returns where the next one starts.
pub(super) fn keys<'a>(
    document: &mut Group,
    x: f64,
    y: f64,
    keys: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> f64 {
    keys.into_iter()
        .fold(x, |x, (class, name)| key(document, x, y, class, name))
}

/// About how wide a text is; there is no font to ask.
pub(super) fn width(text: &str) -> f64 {
    text.chars()
        .map(|c| if c.is_ascii() { 6.9 } else { 13.0 })
        .sum()
}

/// A tick's number, without a negative zero.
pub(super) fn label(value: f64, decimals: usize) -> String {
    format!(
        "{:.decimals$}",
        if value.abs() < 1e-12 { 0.0 } else { value }
    )
}
