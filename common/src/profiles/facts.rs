//! The facts that a profile may state, and their values.

use crate::words::{Both, both};

/// Where a fact is from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reference {
    /// `manual`, `issue`, `table`, `theory` or `assumed`.
    pub kind: String,
    /// The page, the thread.
    pub place: String,
    /// The maker's own document says so. No fact of any profile has been seen on a drive.
    pub verified: bool,
}

impl Reference {
    /// The kinds of sources.
    pub(super) const KINDS: [&str; 5] = ["manual", "issue", "table", "theory", "assumed"];

    /// For a person.
    #[must_use]
    pub fn words(&self) -> Both {
        let (kind, place) = (&self.kind, &self.place);
        let source = if place.is_empty() {
            kind.clone()
        } else {
            format!("{kind}: {place}")
        };
        if self.verified {
            Both::same(source)
        } else {
            both!("{source}, not verified", "{source}，未核实")
        }
    }
}

/// A fact with its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// `mode.8.buffer.default`.
    pub path: String,
    /// What it says.
    pub value: Value,
    /// Who says so.
    pub source: Reference,
}

/// The value of a fact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// True or false.
    Flag(bool),
    /// A decimal number, as it is written.
    Number(String),
    /// A word.
    Text(String),
    /// Several numbers or words.
    List(Vec<String>),
}

impl Value {
    /// For a person.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Flag(flag) => if *flag { "yes" } else { "no" }.into(),
            Self::Number(text) | Self::Text(text) => text.clone(),
            Self::List(all) => all.join(" "),
        }
    }
}

/// Something odd about a drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quirk {
    /// Its name.
    pub id: String,
    /// What happens.
    pub note: String,
    /// The test of the simulation that shows it; `None` where it is not simulated.
    pub test: Option<String>,
    /// Who says so.
    pub source: Reference,
}

/// What may stand for a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Flag,
    /// A number with so many decimals at most, from and to the others, in units of the last decimal.
    Number(usize, i64, i64),
    /// One of these words.
    Word(&'static [&'static str]),
    Text,
    Numbers,
    Texts,
}

const MODES: [&str; 3] = ["mode.6.", "mode.7.", "mode.8."];
const FIGURES: [&str; 3] = ["figures.X.", "figures.Z.", "figures."];

/// What belongs to each mode.
const OF_MODE: [(&str, Kind); 9] = [
    ("supported", Kind::Flag),
    ("target", Kind::Text),
    ("start_bit", Kind::Number(0, 0, 15)),
    ("buffer.min", Kind::Number(0, 0, 16)),
    ("buffer.default", Kind::Number(0, 0, 16)),
    ("buffer.max", Kind::Number(0, 0, 16)),
    ("interpolation", Kind::Word(&["linear", "cubic", "pvt"])),
    ("late.extrapolate", Kind::Number(0, 0, 100)),
    ("late.fault", Kind::Number(0, 1, 200)),
];

/// Figures of loops and mechanics. The last decimal is the unit of the simulation's options.
const OF_FIGURES: [(&str, Kind); 17] = [
    ("kv_per_s", Kind::Number(3, 1, 500_000)),
    ("feed_forward", Kind::Number(3, 0, 1_500)),
    ("speed_loop_rad_s", Kind::Number(3, 1, 3_000_000)),
    ("integral_ms", Kind::Number(3, 0, 10_000_000)),
    ("current_loop_rad_s", Kind::Number(3, 0, 50_000_000)),
    ("speed_m_min", Kind::Number(9, 1, 240_000_000_000)),
    ("acceleration_m_s2", Kind::Number(9, 1, 50_000_000_000)),
    ("sticking_m_s2", Kind::Number(9, 0, 10_000_000_000)),
    ("sliding_m_s2", Kind::Number(9, 0, 10_000_000_000)),
    ("viscous_per_s", Kind::Number(3, 0, 100_000)),
    ("backlash_um", Kind::Number(3, 0, 1_000_000)),
    ("pitch_um_per_m", Kind::Number(3, -5_000_000, 5_000_000)),
    ("pitch_wave_um", Kind::Number(3, 0, 1_000_000)),
    ("pitch_wave_mm", Kind::Number(6, 0, 10_000_000_000)),
    ("count_um", Kind::Number(3, 0, 1_000_000)),
    ("following_mm", Kind::Number(6, 1, 1_000_000_000)),
    ("following_ms", Kind::Number(0, 0, 65_535)),
];

const OTHER: [(&str, Kind); 18] = [
    ("sync.period_us.min", Kind::Number(0, 1, 1_000_000)),
    ("sync.period_us.max", Kind::Number(0, 1, 1_000_000)),
    ("sync.period_us.step", Kind::Number(0, 1, 1_000_000)),
    ("sync.exponent", Kind::Numbers),
    ("sync.window_us", Kind::Number(0, 0, 10_000)),
    ("sync.set", Kind::Texts),
    ("actual.age_us", Kind::Number(0, 0, 100_000)),
    ("actual.age_pm_us", Kind::Number(0, 0, 100_000)),
    (
        "actual.following_error",
        Kind::Word(&["delayed", "undelayed"]),
    ),
    ("pdo.rpdo", Kind::Number(0, 0, 512)),
    ("pdo.tpdo", Kind::Number(0, 0, 512)),
    ("pdo.entries", Kind::Number(0, 0, 64)),
    ("pdo.dummy", Kind::Flag),
    ("pdo.remap", Kind::Text),
    ("feed_forward.velocity", Kind::Text),
    ("feed_forward.torque", Kind::Text),
    ("homing.methods", Kind::Numbers),
    ("bit_rates_kbit", Kind::Numbers),
];

const LOOP: [(&str, Kind); 2] = [
    ("loop.kv.object", Kind::Text),
    ("loop.kv.per_s", Kind::Text),
];

/// What may stand at this path; `None`: there is no such key.
pub(super) fn kind(path: &str) -> Option<Kind> {
    let of = |prefixes: &[&str], keys: &[(&str, Kind)]| {
        let rest = prefixes.iter().find_map(|of| path.strip_prefix(of))?;
        keys.iter().find(|key| key.0 == rest).map(|key| key.1)
    };
    of(&MODES, &OF_MODE)
        .or_else(|| of(&FIGURES, &OF_FIGURES))
        .or_else(|| of(&[""], &OTHER))
        .or_else(|| of(&[""], &LOOP))
}

/// Decimals of a figure's last digit.
pub(super) fn decimals(key: &str) -> usize {
    match OF_FIGURES.iter().find(|known| known.0 == key) {
        Some((_, Kind::Number(decimals, ..))) => *decimals,
        _ => 0,
    }
}
