//! The rules, in the order in which they are asked. A rule is a row: what is wrong, what mends it, what it needs before it
//! says so, and the function that looks for it in what was heard. One file a group.

mod block;
mod board;
mod drive;
mod network;
mod pdo;
mod sync;
mod wire;

use leadscrew_core::bus::NodeId;

use super::heard::Heard;
use super::hits::Hits;
use super::mend::Mend;
use crate::words::{Both, both};

/// What rules are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Error frames, load, error states.
    Wire,
    /// Nodes, NMT, heartbeats.
    Network,
    /// SYNC and periods.
    Sync,
    /// Process data and their settings.
    Pdo,
    /// Drives by CiA 402.
    Drive,
    /// What the board says of itself.
    Board,
}

/// The same words in English and Chinese.
pub type Words = (&'static str, &'static str);

/// A rule.
#[derive(Debug)]
pub struct Rule {
    /// Its number, from 1; the first that fires, in the order of [`all`], is the first cause.
    pub number: u8,
    /// What it is about.
    pub group: Group,
    /// What is wrong.
    pub fault: Words,
    /// What mends it.
    pub remedy: Words,
    /// What it needs, and what it does not take for a fault.
    pub guard: Words,
    /// Looks for it.
    pub judge: fn(&Heard) -> Verdict,
}

/// Why a rule says nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// These objects were not told on the wire.
    Objects(&'static str),
    /// It was not listened for long enough.
    Time,
    /// No profile of a drive says it (`--drive`).
    Profile,
    /// The time stamps are not those of the wire.
    Clock,
    /// The parameters are not known (`--params`).
    Parameters,
    /// An axis that moved did not rest before and behind.
    Rests,
    /// Something that is not about drives comes first.
    Earlier,
}

/// What a rule says.
#[derive(Debug)]
pub enum Verdict {
    /// Nothing of the kind.
    Clean,
    /// It cannot be judged.
    Not(Lack),
    /// It is so, at these nodes.
    Found(Vec<Found>),
}

/// A fault that a rule has found.
#[derive(Clone, Debug)]
pub struct Found {
    /// At this node; `None`: of the bus.
    pub node: Option<NodeId>,
    /// What shows it, in figures.
    pub evidence: Both,
    /// The sign.
    pub hits: Hits,
    /// What mends it, where one line does.
    pub mend: Option<Mend>,
}

impl Found {
    /// At a node.
    fn at(node: NodeId, hits: &Hits, evidence: Both) -> Self {
        Self {
            node: Some(node),
            evidence,
            hits: hits.clone(),
            mend: None,
        }
    }

    /// The board stands on an alarm that means the fault.
    fn alarm(heard: &Heard, alarm: u16, hits: &Hits) -> Self {
        Self::at(
            heard.machine.board,
            hits,
            both!(
                "the board stands on alarm {alarm}",
                "控制板停在报警 {alarm}"
            ),
        )
    }

    /// Of the whole bus.
    fn of_bus(hits: &Hits, evidence: Both) -> Self {
        Self {
            node: None,
            evidence,
            hits: hits.clone(),
            mend: None,
        }
    }

    fn mended_by(mut self, mend: Mend) -> Self {
        self.mend = Some(mend);
        self
    }
}

/// Clean where nothing was found.
fn found(all: impl IntoIterator<Item = Found>) -> Verdict {
    let all: Vec<Found> = all.into_iter().collect();
    match all.is_empty() {
        true => Verdict::Clean,
        false => Verdict::Found(all),
    }
}

/// Not judged where nothing was found and objects are missing.
fn found_or(all: impl IntoIterator<Item = Found>, known: bool, lack: Lack) -> Verdict {
    match found(all) {
        Verdict::Clean if !known => Verdict::Not(lack),
        verdict => verdict,
    }
}

/// All rules, in the order in which they are asked: what only the board can tell comes last.
pub fn all() -> impl Iterator<Item = &'static Rule> {
    [
        wire::RULES,
        network::RULES,
        sync::RULES,
        network::SILENT,
        pdo::RULES,
        block::RULES,
        drive::RULES,
        board::RULES,
    ]
    .into_iter()
    .flatten()
}
