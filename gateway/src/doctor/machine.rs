//! What should be on the wire: the board, its drives, and profiles of drives.

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::NodeId;
use leadscrew_core::params::Params;

use crate::params::drives::DriveName;
use crate::words::{Both, both};

/// Whose clock the stamps of the frames are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The kernel's, at the moment of arrival.
    Kernel,
    /// That of a program which reads an adapter or a simulated machine: later by milliseconds, and in bunches.
    Program,
}

/// What is known of a drive from its profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// The window around SYNC in µs.
    pub window_us: Option<u32>,
    /// Setpoints that wait in its buffer.
    pub buffer: Option<u32>,
}

/// A drive that the parameters name.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    /// Its name.
    pub name: DriveName,
    /// Its node.
    pub node: NodeId,
    /// What its profile says, where one is named.
    pub known: Option<Known>,
}

/// The machine behind the bus, as it should be.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The board's set.
    pub params: Params,
    /// The set is that of the board or of a file, not the built-in one in its place.
    pub told: bool,
    /// The board.
    pub board: NodeId,
    /// Its drives, in the order of a frame with all setpoints.
    pub drives: Vec<Expected>,
    /// Its block of inputs and outputs (9461), where it has one.
    pub block: Option<NodeId>,
    /// Whose clock the stamps are.
    pub clock: Clock,
}

impl Machine {
    /// The machine of this set.
    #[must_use]
    pub fn new(params: Params, told: bool, board: NodeId, clock: Clock) -> Self {
        let nodes = DriveNodes::of(&params);
        let there = |name: &DriveName| nodes.letter(name.among(&nodes).node).is_some();
        let drives = DriveName::ALL
            .into_iter()
            .filter(there)
            .map(|name| Expected {
                name,
                node: name.among(&nodes).node,
                known: None,
            });
        Self {
            drives: drives.collect(),
            block: NodeId::new(params.block_node()),
            params,
            told,
            board,
            clock,
        }
    }

    /// A node in words: `X (node 16)`, `the board (node 1)`.
    #[must_use]
    pub fn called(&self, node: NodeId) -> Both {
        let number = node.get();
        if node == self.board {
            return both!("the board (node {number})", "控制板（节点 {number}）");
        }
        if Some(node) == self.block {
            return both!(
                "the I/O block (node {number})",
                "输入输出模块（节点 {number}）"
            );
        }
        match self.drives.iter().find(|drive| drive.node == node) {
            Some(drive) => both!(
                "drive {name} (node {number})",
                "驱动器 {name}（节点 {number}）",
                name = drive.name
            ),
            None if node == NodeId::GATEWAY => {
                both!("the gateway (node {number})", "网关（节点 {number}）")
            }
            None => both!("node {number}", "节点 {number}"),
        }
    }
}
