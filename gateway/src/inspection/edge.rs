//! The shape of a tool as it is typed: `V60:r0.1`, `T3=V30/27:f0.2`.

use std::str::FromStr;

use leadscrew_inspection::Edge;
use leadscrew_metrology::{Degrees, Mm, Nose, Tool};

use crate::number::measured;
use crate::values::{Mistake, decimal, mistake};

/// A length in millimetres, to four decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Millimetres(f64);

impl From<Millimetres> for Mm {
    fn from(length: Millimetres) -> Self {
        Self(length.0)
    }
}

impl FromStr for Millimetres {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let units = decimal(text, 4)?;
        if units.abs() > 20_000_000 {
            return Err(mistake!("{text} mm is beyond 2 m", "{text} mm 超过 2 m"));
        }
        Ok(Self(units as f64 / 1e4))
    }
}

fn wrong(text: &str) -> Mistake {
    mistake!(
        "`{text}` is no edge: write V, the angle between the flanks (or both from the normal of the axis, that towards -Z \
         first: `V30/27`), and the tip: `:r` its radius or `:f` its width in mm; `V60:r0.1`, for one tool `T3=V60:r0.1`",
        "`{text}` 不是刀刃：请写 V、牙型角（或两侧牙型半角，-Z 侧在前：`V30/27`）以及刀尖：`:r` 圆角半径或 `:f` 宽度（mm）；\
         例如 `V60:r0.1`，指定刀具时写 `T3=V60:r0.1`"
    )
}

/// A decimal of at most four places.
fn value(text: &str) -> Option<f64> {
    let value = decimal(text, 4).ok()?;
    Some(value as f64 / 1e4)
}

/// An edge as it is typed.
///
/// # Errors
/// It is none.
pub fn edge(text: &str) -> Result<Edge, Mistake> {
    read(text).ok_or_else(|| wrong(text))
}

/// The shape of a tool as it is typed.
pub fn typed(tool: &Tool) -> String {
    let Tool { nose, minus, plus } = *tool;
    let flanks = if minus == plus {
        measured(minus.0 + plus.0)
    } else {
        format!("{}/{}", measured(minus.0), measured(plus.0))
    };
    let tip = match nose {
        Nose::Round(radius) => format!("r{}", measured(radius.0)),
        Nose::Flat(width) => format!("f{}", measured(width.0)),
    };
    format!("V{flanks}:{tip}")
}

fn read(text: &str) -> Option<Edge> {
    let (tool, shape) = match text.split_once('=') {
        None => (None, text),
        Some((tool, shape)) => (Some(tool.strip_prefix('T')?.parse().ok()?), shape),
    };
    let (flanks, tip) = shape.strip_prefix('V')?.split_once(':')?;
    let [minus, plus] = match flanks.split_once('/') {
        None => [value(flanks)? / 2.0; 2],
        Some((minus, plus)) => [value(minus)?, value(plus)?],
    };
    let is_flank = |angle: f64| (0.0..=80.0).contains(&angle);
    if !is_flank(minus) || !is_flank(plus) || minus + plus <= 0.0 {
        return None;
    }
    let (kind, size) = tip.split_at_checked(1)?;
    let size = Mm(value(size).filter(|size| (0.0..=50.0).contains(size))?);
    let nose = match kind {
        "r" => Nose::Round(size),
        "f" => Nose::Flat(size),
        _ => return None,
    };
    let shape = Tool {
        nose,
        minus: Degrees(minus),
        plus: Degrees(plus),
    };
    Some(Edge { tool, shape })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_as_they_are_typed() {
        let read = |text: &str| edge(text).ok();
        let named = read("T3=V30/27:f0.2").unwrap();
        assert_eq!(named.tool, Some(3));
        assert_eq!(
            (named.shape.minus, named.shape.plus),
            (Degrees(30.0), Degrees(27.0))
        );
        assert_eq!(named.shape.nose, Nose::Flat(Mm(0.2)));
        let all = read("V60:r0.1").unwrap();
        assert_eq!((all.tool, all.shape.minus), (None, Degrees(30.0)));
        assert_eq!(all.shape.nose, Nose::Round(Mm(0.1)));
        for shape in ["V60:r0.866", "V30/27:f0.2", "V55.5:f0"] {
            assert_eq!(typed(&read(shape).unwrap().shape), shape);
        }
        for wrong in [
            "",
            "V60",
            "60:r0.1",
            "V60:r",
            "V60:x1",
            "V0:r1",
            "V200:r1",
            "V60:r-1",
            "T=V60:r0.1",
            "3=V60:r1",
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
