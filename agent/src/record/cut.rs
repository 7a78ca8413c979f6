//! What is told of the cut of a thread, with its uncertainties, and where it is not known, why.
//!
//! It knows neither a drive nor a parameter: who reads the board judges, and says it in words and figures.

use serde::{Deserialize, Serialize};

use super::NM_IN_UM;

/// What the drive's own positions say of the cut of a thread.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cut {
    /// Nobody has looked. Records that an earlier version kept say nothing of the cut.
    #[default]
    NotRead,
    /// A hole, whose cut is not measured.
    Hole,
    /// Nothing is known, in words: why.
    Unknown(String),
    /// Figures.
    Measured(Measured),
}

/// The figures of a cut.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Measured {
    /// Letter of the long axis.
    pub axis: char,
    /// How old the positions of the drive are is known.
    pub age_known: bool,
    /// Positions that were judged.
    pub positions: u16,
    /// Passes whose groove is known.
    pub passes: u8,
    /// The lead in nm.
    pub lead_nm: i64,
    /// The lowest and the highest groove.
    pub grooves: Option<[Figure; 2]>,
    /// How far they are apart: from pass to pass.
    pub apart: Option<Figure>,
    /// The largest error of the lead, in a turn.
    pub slope: Option<Figure>,
    /// The largest error.
    pub worst: Figure,
    /// Each pass has its groove.
    pub complete: bool,
    /// What is not known and why, in words; empty where all is known.
    pub why: String,
}

/// A length and its uncertainty, plus or minus, in nm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Figure(pub i64, pub i64);

impl Figure {
    /// Both in µm.
    #[must_use]
    pub fn um(self) -> [f64; 2] {
        let Self(nm, u_nm) = self;
        [nm, u_nm].map(|nm| nm as f64 / NM_IN_UM)
    }
}

impl Cut {
    /// How much is known, in a word for programs.
    #[must_use]
    pub const fn known(&self) -> &'static str {
        match self {
            Self::NotRead => "not_read",
            Self::Hole => "hole",
            Self::Unknown(_) => "no",
            Self::Measured(Measured {
                complete: false, ..
            }) => "partly",
            Self::Measured(_) => "yes",
        }
    }

    /// What is not known and why, where something is not.
    #[must_use]
    pub fn why(&self) -> Option<&str> {
        let why = match self {
            Self::NotRead | Self::Hole => return None,
            Self::Unknown(why) | Self::Measured(Measured { why, .. }) => why,
        };
        Some(why.as_str()).filter(|why| !why.is_empty())
    }

    /// The figures, where there are any.
    #[must_use]
    pub const fn measured(&self) -> Option<&Measured> {
        match self {
            Self::Measured(measured) => Some(measured),
            Self::NotRead | Self::Hole | Self::Unknown(_) => None,
        }
    }
}
