//! What was measured against the limits of the norm: the sheet that an inspector fills in.

use crate::designation::{Designation, Series};
use crate::limits::{Band, Limits};
use crate::measure::{Measured, Spread};
use crate::units::{Mm, Side};

/// A diameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// Major diameter.
    Major,
    /// Pitch diameter; of a pipe thread at its plane L1.
    Pitch,
    /// Minor diameter.
    Minor,
    /// Functional pitch diameter.
    Functional,
}

/// A line of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What it is about.
    pub feature: Feature,
    /// The basic value.
    pub nominal: Mm,
    /// Its limits.
    pub band: Band,
    /// What was found, millimetres.
    pub found: Spread,
    /// Within its limits; `None` where there is none.
    pub within: Option<bool>,
}

/// The sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// The limits.
    pub limits: Limits,
    /// The diameters.
    pub rows: Vec<Row>,
    /// The GO gauge goes on; `None` without a gauge.
    pub go: Option<bool>,
    /// The NO-GO gauge stays out but for two turns; `None` without a gauge.
    pub no_go: Option<bool>,
}

impl Inspection {
    /// Good, bad, or not judged, as there are no limits.
    #[must_use]
    pub fn verdict(&self) -> Option<bool> {
        let all = self.rows.iter().map(|row| row.within);
        let judged = all.chain([self.go, self.no_go]).flatten();
        judged.reduce(|a, b| a && b)
    }
}

/// Compares.
#[must_use]
pub fn inspect(measured: &Measured, thread: &Designation) -> Inspection {
    let limits = Limits::of(thread);
    let row = |feature, nominal, band: Band, found: Spread| Row {
        feature,
        nominal,
        band,
        found,
        within: band
            .exists()
            .then(|| band.holds(Mm(found.low), Mm(found.high))),
    };
    let at_plane = match (thread.series, thread.side) {
        (Series::Pipe { plane }, Side::External) => {
            let shift = measured.pitch_at(thread, plane).0 - measured.pitch.mean;
            Spread {
                mean: measured.pitch.mean + shift,
                low: measured.pitch.low + shift,
                high: measured.pitch.high + shift,
            }
        }
        _ => measured.pitch,
    };
    let mut rows = vec![
        row(Feature::Major, thread.major, limits.major, measured.major),
        row(
            Feature::Pitch,
            thread.pitch_diameter(),
            limits.pitch,
            at_plane,
        ),
        row(Feature::Minor, thread.minor(), limits.minor, measured.minor),
    ];
    let mut go = None;
    if let Some(functional) = measured.functional {
        let Mm(d) = functional.diameter;
        let found = Spread {
            mean: d,
            low: d,
            high: d,
        };
        let band = match thread.side {
            Side::External => Band {
                low: None,
                high: limits.pitch.high,
            },
            Side::Internal => Band {
                low: limits.pitch.low,
                high: None,
            },
        };
        let line = row(Feature::Functional, thread.pitch_diameter(), band, found);
        go = line.within;
        rows.push(line);
    }
    Inspection {
        limits,
        rows,
        go,
        no_go: go.map(|_| measured.loose_turns <= 2.0),
    }
}
