//! What one text leaves in force for the next: lines that are typed one by one, each a program of its own.
//!
//! A text begins as at power-on. What an operator has set with a line holds for the lines after it, so it is taken from the
//! reader of one text and given to the reader of the next. Giving it makes no call: nothing is told to the machine again.
//! Cycles, G61 and rigid mode end with their text.

use super::state::{Motion, State};
use crate::call::{LengthUnit, Position};
use crate::text::{ModalFeed, Scale};
use crate::units::{Feed, FeedPerTurn};

/// A feed that is in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CarriedFeed {
    /// None yet.
    None,
    /// Under G98.
    PerMinute(Feed),
    /// Under G99.
    PerTurn(FeedPerTurn),
}

/// What is in force between two texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carried {
    /// 0 to 3: G00 to G03. A cycle in force ends, and G00 is in force.
    pub motion: u8,
    /// G20 or G21.
    pub unit: LengthUnit,
    /// 17, 18 or 19.
    pub plane: u8,
    /// 54 to 59.
    pub system: u8,
    /// The tool offset, 0 for none.
    pub offset: u8,
    /// What G50 has added to every coordinate system.
    pub shift: Position,
    /// G99 and not G98.
    pub per_turn: bool,
    /// F.
    pub feed: CarriedFeed,
    /// S under G97, in turns a minute.
    pub speed: u32,
    /// G96.
    pub in_surface: bool,
    /// S under G96, once there was one.
    pub surface: Option<Feed>,
    /// S of G50.
    pub speed_limit: Option<u32>,
    /// The sense in which the spindle turns: −1, 0 or +1.
    pub direction: i8,
    /// M24 of a Haas: threads have no run-out.
    pub without_run_out: bool,
    /// G91 of the systems B and C. Whoever translates the text has it; it is handed on here.
    pub incremental: bool,
}

impl State<'_> {
    /// What is in force for the next text.
    pub(super) fn carried(&self) -> Carried {
        let modal = &self.modal;
        Carried {
            motion: match self.motion {
                Motion::Line => 1,
                Motion::Clockwise => 2,
                Motion::CounterClockwise => 3,
                _ => 0,
            },
            unit: modal.length_unit(),
            plane: modal.plane,
            system: modal.system.saturating_add(54),
            offset: modal.offset,
            shift: modal.shift,
            per_turn: modal.per_turn,
            feed: match modal.feed {
                ModalFeed::None => CarriedFeed::None,
                ModalFeed::PerMinute(feed) => CarriedFeed::PerMinute(feed),
                ModalFeed::PerTurn(feed) => CarriedFeed::PerTurn(feed),
            },
            speed: modal.speed,
            in_surface: modal.in_surface,
            surface: modal.surface,
            speed_limit: modal.speed_limit,
            direction: modal.direction.signum() as i8,
            without_run_out: modal.without_run_out,
            incremental: false,
        }
    }

    /// Puts in force what the text before has left.
    pub(super) fn carry(&mut self, carried: &Carried) {
        self.motion = match carried.motion {
            1 => Motion::Line,
            2 => Motion::Clockwise,
            3 => Motion::CounterClockwise,
            _ => Motion::Rapid,
        };
        let modal = &mut self.modal;
        let inch = carried.unit == LengthUnit::Inch;
        modal.scale = Scale::new(inch, modal.params.increment_is_c());
        modal.plane = carried.plane;
        modal.system = carried.system.saturating_sub(54);
        modal.offset = carried.offset;
        modal.shift = carried.shift;
        modal.per_turn = carried.per_turn;
        modal.feed = match carried.feed {
            CarriedFeed::None => ModalFeed::None,
            CarriedFeed::PerMinute(feed) => ModalFeed::PerMinute(feed),
            CarriedFeed::PerTurn(feed) => ModalFeed::PerTurn(feed),
        };
        modal.speed = carried.speed;
        modal.in_surface = carried.in_surface;
        modal.surface = carried.surface;
        modal.speed_limit = carried.speed_limit;
        modal.direction = carried.direction.into();
        modal.without_run_out = carried.without_run_out;
        modal.place_origin();
        // The spindle follows this law already.
        let law = self.modal.law().filter(|_| self.modal.direction != 0);
        self.told = law.map(|law| (law, self.modal.direction));
    }
}
