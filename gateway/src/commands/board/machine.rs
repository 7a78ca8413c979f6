//! The machine behind the bus: its parameter set counts for everything that is done with a board.

use leadscrew_core::params::Params;

use super::open;
use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::link::Link;
use crate::setup::Setup;
use crate::words::both;

/// A board that has been greeted, and what is known of it.
#[derive(Debug)]
pub struct Machine {
    /// The link to it.
    pub link: Link,
    /// Its parameter set.
    pub params: Params,
    identity: u32,
}

impl Machine {
    /// Meets the board of the options and reads its parameter set.
    ///
    /// # Errors
    /// No bus, no board, another version.
    pub fn meet(global: &Global) -> Outcome<Self> {
        let mut link = open(global)?;
        link.greet()?;
        let set = link.parameters()?;
        Ok(Self {
            link,
            params: set.params,
            identity: set.identity,
        })
    }

    /// Refuses options that say otherwise than the board: it would be another machine that is checked than the one that
    /// moves.
    ///
    /// # Errors
    /// [`Failure::WrongBecause`].
    pub fn agrees_with(&self, setup: &Setup) -> Outcome {
        if leadscrew_core::link::identity(&setup.params) == self.identity {
            return Ok(());
        }
        let node = self.link.node().get();
        Err(Failure::WrongBecause(both!(
            "`--params` and `--set` make another machine than the one behind node {node} (object 1020h): leave them out, or \
             change the board's parameters first",
            "`--params` 和 `--set` 给出的机床与节点 {node} 上的不同（对象 1020h）：请去掉这些选项，或先修改控制板的参数"
        )))
    }
}

/// The set that files and options are laid over: the board's where a real bus is named.
///
/// # Errors
/// No bus, no board, another version.
pub fn base(global: &Global) -> Outcome<Option<Params>> {
    if global.bus == leadscrew_can::Address::Sim {
        return Ok(None);
    }
    Ok(Some(Machine::meet(global)?.params))
}
