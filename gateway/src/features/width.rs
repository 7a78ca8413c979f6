//! The width of a grooving tool as it is typed: `T2=4`.

use std::str::FromStr;

use crate::values::{Mistake, decimal, mistake};

/// The width of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width {
    /// Number of the tool; 0 for a program that names none.
    pub tool: u32,
    /// Millimetres from the programmed corner toward +Z.
    pub mm: f64,
}

impl FromStr for Width {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        read(text).ok_or_else(|| {
            mistake!(
                "`{text}` is no width: write the tool and its width in mm, `T2=4`, from 0.01 to 50 (`T0=4` where the program \
                 names no tool)",
                "`{text}` 不是刀宽：请写刀号和宽度（mm），例如 `T2=4`，范围 0.01 至 50（程序未指定刀具时写 `T0=4`）"
            )
        })
    }
}

fn read(text: &str) -> Option<Width> {
    let (tool, width) = text.strip_prefix('T')?.split_once('=')?;
    let units = decimal(width, 4).ok()?;
    (100..=500_000).contains(&units).then_some(())?;
    Some(Width {
        tool: tool.parse().ok()?,
        mm: units as f64 / 1e4,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_read_and_others_refused() {
        let width = |tool, mm| Some(Width { tool, mm });
        assert_eq!(read("T2=4"), width(2, 4.0));
        assert_eq!(read("T0=2.05"), width(0, 2.05));
        for wrong in [
            "4", "T=4", "T2=", "T2=0", "T2=-1", "T2=51", "t2=4", "T2=4mm",
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
