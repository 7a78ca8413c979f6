//! The machine behind the bus: its parameter set counts for everything that is done with a board.

use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_board_sim::{Sim, SimError};
use leadscrew_can::Address;
use leadscrew_core::offsets::Offsets;
use leadscrew_core::params::Params;
use leadscrew_desk::machine::not_started;

use super::open;
use crate::cli::Global;
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::link::{Inside, Link};
use crate::setup::{self, Answer, Setup, alone_in};
use crate::state::{StateFile, stored_set};
use crate::words::both;

/// What files and options are laid over.
#[derive(Clone, Debug)]
pub struct Base {
    /// The parameters.
    pub params: Params,
    /// The offsets and tools.
    pub offsets: Table,
}

/// What is known of a board's table of offsets and tools.
#[derive(Clone, Debug)]
pub enum Table {
    /// Nothing: it was not asked.
    Unknown,
    /// This; `None` where it has none.
    Board(Option<Box<Offsets>>),
}

/// A machine inside the command, the file of its flash, and what that held.
type Kept = (Inside, StateFile, Flash);

/// A board that has been greeted. Nothing is known of it but that it is one, with this program's parameter table.
#[derive(Debug)]
pub struct Greeted {
    /// The link to it.
    pub link: Link,
    /// The simulated machine behind the link, the file of its flash, and what was in that.
    inside: Option<Box<Kept>>,
}

/// The same, and its parameter set.
#[derive(Debug)]
pub struct Machine {
    /// The link to it.
    pub link: Link,
    /// Its parameter set.
    pub params: Params,
    identity: u32,
    inside: Option<Box<Kept>>,
}

impl Greeted {
    /// Meets the board of the options. With `sim` it is the one whose flash is in `--state`.
    ///
    /// # Errors
    /// No bus, no board, another version.
    pub fn meet(global: &Global) -> Outcome<Self> {
        let (mut link, inside) = match (&global.bus, &global.state) {
            (Address::Sim, Some(path)) => {
                let state = StateFile::new(path);
                let flash = state.load_or_new()?;
                let inside = simulated(global, flash.clone())?;
                let link = Link::on(Box::new(inside.clone()), global.board()?);
                (link, Some(Box::new((inside, state, flash))))
            }
            _ => (open(global)?, None),
        };
        link.greet()?;
        link.check_table()?;
        Ok(Self { link, inside })
    }

    /// Meets the board behind this link.
    ///
    /// # Errors
    /// No board, another version.
    pub fn on(mut link: Link) -> Outcome<Self> {
        link.greet()?;
        link.check_table()?;
        Ok(Self { link, inside: None })
    }

    /// Reads its parameter set.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn read(mut self) -> Outcome<Machine> {
        let set = self.link.parameters()?;
        Ok(Machine {
            link: self.link,
            params: set.params,
            identity: set.identity,
            inside: self.inside,
        })
    }

    /// As [`Machine::keep`].
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep(&self) -> Outcome {
        keep(self.inside.as_deref())
    }
}

impl Machine {
    /// Meets the board of the options and reads its parameter set.
    ///
    /// # Errors
    /// As [`Greeted::meet`].
    pub fn meet(global: &Global) -> Outcome<Self> {
        Greeted::meet(global)?.read()
    }

    /// Its table of offsets and tools, for programs.
    ///
    /// # Errors
    /// The board does not answer, or has a damaged table.
    pub fn table(&mut self) -> Outcome<Table> {
        let resolving = self.link.offsets()?.resolving();
        let table = resolving.map_err(|alarm| Failure::WrongBecause(alarm_words(&alarm)))?;
        Ok(Table::Board(table.map(Box::new)))
    }

    /// What a simulated board has stored is in its file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep(&self) -> Outcome {
        keep(self.inside.as_deref())
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

fn keep(inside: Option<&Kept>) -> Outcome {
    let Some((inside, state, before)) = inside else {
        return Ok(());
    };
    let flash = inside.sim().flash().clone();
    if flash.image() == before.image() {
        Ok(())
    } else {
        state.save(&flash)
    }
}

/// A simulated board with this flash, on a bus of its own.
fn simulated(global: &Global, flash: Flash) -> Outcome<Inside> {
    let options = PlantOptions {
        at: setup::power_up(global),
        ..PlantOptions::default()
    };
    let mut sim = Sim::power_up(&Params::slant_bed(), &options, flash)
        .map(Box::new)
        .map_err(|error| not_started(&error))?;
    sim.join(global.board()?)
        .map_err(|alarm| not_started(&SimError::Board(alarm)))?;
    let tick_us = sim.tick_us();
    Ok(Inside::new(sim, tick_us))
}

/// The set that files and options are laid over: the board's where a real bus is named, what a simulated one has stored
/// where its flash is.
///
/// # Errors
/// No bus, no board, another version; a file that is no flash; files or options that are wrong over whatever set.
pub fn base(global: &Global, answer: Answer<'_>) -> Outcome<Option<Base>> {
    alone_in(global, &global.params, &global.set, answer)?;
    if global.bus == Address::Sim {
        let Some(path) = &global.state else {
            return Ok(None);
        };
        // The flash itself is read with it, and has the offsets.
        let stored = stored_set(&StateFile::new(path).load_or_new()?);
        return Ok(stored.map(|params| Base {
            params,
            offsets: Table::Unknown,
        }));
    }
    let mut machine = Machine::meet(global)?;
    let offsets = match answer {
        Answer::Parameters => Table::Unknown,
        _ => machine.table()?,
    };
    Ok(Some(Base {
        params: machine.params,
        offsets,
    }))
}
