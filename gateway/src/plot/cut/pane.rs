//! A box with a grid of its own scales: what a view of the cut is drawn into.

use svg::Node as _;
use svg::node::element::{ClipPath, Group, Rectangle};

use crate::number::measured;
use crate::plot::frame::{label, line};
use crate::plot::scale::Scale;
use crate::plot::{px, text};

/// A place on the page, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

/// What a view has upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// X as a diameter, and Z to the right: what goes along Z.
    X,
    /// Z, and X as a diameter to the right: what goes along X, or into the face.
    Z,
}

impl Across {
    /// How many millimetres are written for one, to the right and upwards.
    pub(in crate::plot) const fn written(self) -> (f64, f64) {
        match self {
            Self::X => (1.0, 2.0),
            Self::Z => (2.0, 1.0),
        }
    }

    /// A point, Z and radius, as the view has it: to the right, upwards.
    pub const fn of(self, (z, radius): (f64, f64)) -> (f64, f64) {
        match self {
            Self::X => (z, radius),
            Self::Z => (radius, z),
        }
    }

    /// A place to the right, in words.
    pub(super) fn right(self, mm: f64) -> String {
        match self {
            Self::X => format!("Z{}", measured(mm)),
            Self::Z => format!("X{}", measured(2.0 * mm)),
        }
    }

    /// A height as a size of the part.
    pub fn size(self, mm: f64) -> String {
        match self {
            Self::X => format!("⌀{}", measured(2.0 * mm)),
            Self::Z => self.up(mm),
        }
    }

    /// A height, in words.
    pub(super) fn up(self, mm: f64) -> String {
        match self {
            Self::X => format!("X{}", measured(2.0 * mm)),
            Self::Z => format!("Z{}", measured(mm)),
        }
    }
}

/// What the axes of a box are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    /// What is written for one, to the right and upwards.
    pub(super) written: (f64, f64),
    /// What stands at them, to the right and upwards.
    pub(super) labels: (&'static str, &'static str),
    /// What a page calls a place under the pointer.
    pub(super) names: (&'static str, &'static str),
    /// More is lower.
    pub(super) is_down: bool,
    /// To the right things are counted.
    pub(super) is_count: bool,
}

impl From<Across> for Axes {
    fn from(across: Across) -> Self {
        let (labels, names) = match across {
            Across::X => (("Z", "⌀"), ("Z", "X")),
            Across::Z => (("⌀", "Z"), ("X", "Z")),
        };
        Self {
            written: across.written(),
            labels,
            names,
            is_down: false,
            is_count: false,
        }
    }
}

/// From the lowest to the highest value to the right and upwards, in millimetres: Z and radius where X is upwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) z: (f64, f64),
    pub(super) r: (f64, f64),
}

impl Range {
    /// That of points; `None` without any.
    pub(super) fn of(points: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        points
            .into_iter()
            .map(|(z, r)| Self {
                z: (z, z),
                r: (r, r),
            })
            .reduce(|a, b| Self {
                z: (a.z.0.min(b.z.0), a.z.1.max(b.z.1)),
                r: (a.r.0.min(b.r.0), a.r.1.max(b.r.1)),
            })
    }

    /// With room on each side: shares of its own lengths.
    pub(super) fn with_room(self, along: f64, across: f64) -> Self {
        let open = |(low, high): (f64, f64), share: f64| {
            let room = share * (high - low).max(0.05);
            (low - room, high + room)
        };
        Self {
            z: open(self.z, along),
            r: open(self.r, across),
        }
    }
}

/// A box with its scales.
#[derive(Debug)]
pub(super) struct Pane {
    pub(super) area: Area,
    axes: Axes,
    z: Scale,
    x: Scale,
    id: String,
}

impl Pane {
    /// Both axes to one scale, the range in the middle.
    pub(super) fn true_to_scale(
        area: Area,
        axes: impl Into<Axes>,
        range: Range,
        id: String,
    ) -> Self {
        let (width, height) = (area.right - area.left, area.bottom - area.top);
        let (length, depth) = (range.z.1 - range.z.0, range.r.1 - range.r.0);
        let mm = (width / length.max(1e-3)).min(height / depth.max(1e-3));
        let middle = |(low, high): (f64, f64), pixels: f64| {
            let (at, half) = (f64::midpoint(low, high), pixels / mm / 2.0);
            (at - half, at + half)
        };
        let range = Range {
            z: middle(range.z, width),
            r: middle(range.r, height),
        };
        Self::filled(area, axes, range, id)
    }

    /// Each axis as large as the box allows.
    pub(super) fn filled(area: Area, axes: impl Into<Axes>, range: Range, id: String) -> Self {
        let axes = axes.into();
        let (along, up) = axes.written;
        let (least, most) = if axes.is_down {
            (area.top, area.bottom)
        } else {
            (area.bottom, area.top)
        };
        Self {
            area,
            axes,
            z: Scale::new(along * range.z.0, along * range.z.1, area.left, area.right),
            x: Scale::new(up * range.r.0, up * range.r.1, least, most),
            id,
        }
    }

    /// The pixels of a point: to the right, upwards.
    pub(super) fn place(&self, (z, radius): (f64, f64)) -> (f64, f64) {
        let (along, up) = self.axes.written;
        (self.z.px(along * z), self.x.px(up * radius))
    }

    /// What is written at a pixel.
    fn value(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.z.value(x), self.x.value(y))
    }

    /// How much more is drawn upwards than to the right.
    pub(super) fn stretch(&self) -> f64 {
        let ((z0, r0), (z1, r1)) = (self.place((0.0, 0.0)), self.place((1.0, 1.0)));
        ((r1 - r0) / (z1 - z0)).abs()
    }

    /// Draws the box, its grid and its labels, and returns the group for what is inside.
    pub(super) fn frame(&self, document: &mut Group) -> Group {
        let Area {
            left,
            right,
            top,
            bottom,
        } = self.area;
        document.append(self.edge().set("class", "panel"));
        let (ticks, decimals) = self.z.ticks(((right - left) / 80.0).max(2.0));
        let decimals = if self.axes.is_count { 0 } else { decimals };
        let is_shown = |tick: &f64| !self.axes.is_count || (tick - tick.round()).abs() < 1e-6;
        for tick in ticks.into_iter().filter(is_shown) {
            let at = self.z.px(tick);
            line(document, "grid", [(at, top), (at, bottom)]);
            document.append(text(at, bottom + 18.0, "below", &label(tick, decimals)));
        }
        let (ticks, decimals) = self.x.ticks(((bottom - top) / 36.0).max(2.0));
        for tick in ticks {
            let at = self.x.px(tick);
            line(document, "grid", [(left, at), (right, at)]);
            document.append(text(left - 8.0, at + 4.5, "left", &label(tick, decimals)));
        }
        let (right_name, up_name) = self.axes.labels;
        document.append(text(left - 8.0, top - 8.0, "left name", up_name));
        document.append(text(right + 8.0, bottom + 18.0, "right name", right_name));
        document.append(ClipPath::new().set("id", self.id.as_str()).add(self.edge()));
        let corners = [left, top, right, bottom].map(px).join(" ");
        let (low, high) = (self.value((left, bottom)), self.value((right, top)));
        let values = [low.0, high.0, low.1, high.1].map(|mm| format!("{mm:.6}"));
        Group::new()
            .set("clip-path", format!("url(#{})", self.id))
            .set("data-pane", format!("{corners} {}", values.join(" ")))
            .set(
                "data-names",
                format!("{} {}", self.axes.names.0, self.axes.names.1),
            )
    }

    fn edge(&self) -> Rectangle {
        let area = self.area;
        Rectangle::new()
            .set("x", px(area.left))
            .set("y", px(area.top))
            .set("width", px(area.right - area.left))
            .set("height", px(area.bottom - area.top))
    }
}
