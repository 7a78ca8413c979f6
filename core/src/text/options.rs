//! The options for reading a program, set by the operator's panel or the command line.

use crate::call::Position;
use crate::offsets::Offsets;

/// The family of controls that gives its meaning to a word which both families have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Dialect {
    /// GSK 980TD: P and Q of G75 and G76 by parameter 182.7; the run-out of G76 has 45°.
    #[default]
    Gsk980td,
    /// GSK 988: P and Q of G75 and G76 in mm or inches; the run-out of G76 by 5130 and 5131.
    Gsk988,
}

/// How to read a program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The control's family.
    pub dialect: Dialect,
    /// Block skip: blocks with `/` in front are passed over.
    pub skip: bool,
    /// M01 stops; otherwise it is passed over and makes no call.
    pub optional_stop: bool,
    /// Cuts other than threads run at the dry-run feed.
    pub dry_run: bool,
    /// G99 and not G98 is in force at power-on.
    pub per_turn: bool,
    /// S of G50 limits the speed under G97, too.
    pub limits_every_speed: bool,
    /// M codes that switch something of a machine which is not there are passed over with a warning: a simulation does it.
    pub passes_machine_codes: bool,
    /// Where the machine stands before the first block.
    pub position: Position,
    /// The table of offsets and tools; without one the parameters of old count.
    pub offsets: Option<Offsets>,
    /// The gear that is in before the first block, from 1; 0: nobody knows.
    pub gear: u8,
}
