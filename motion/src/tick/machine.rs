//! The machine's inputs and outputs: which are on, what they mean for people, and what answers for what.
//!
//! Inputs mean what the parameters say; an input that nobody has told counts as the worse value [D271]. The first sixteen
//! are the board's pins, the others those of a block on the bus [D422]. Must not know what follows from it: the ticker
//! does.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::bus::NodeId;
use crate::operating::Interlock;
use crate::params::{Answer, Contact, FIRST_OF_BLOCK, FunctionAction, FunctionRow, Params};

/// The place of the block's first contact in a word of all of them.
const BLOCK: u32 = FIRST_OF_BLOCK as u32 - 1;

/// The contacts of the board.
const OF_BOARD: u32 = (1 << BLOCK) - 1;

/// The inputs of the block as it has told them; bit 0 is input 17.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockInputs {
    /// Their levels.
    pub levels: u16,
    /// Those that it has told. None: it is lost, or has not been heard yet.
    pub known: u16,
}

/// The block is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockLoss {
    /// How.
    pub code: Code,
    /// Its node.
    pub node: NodeId,
    /// The longest silence in milliseconds.
    pub ms: u32,
}

impl BlockLoss {
    pub(super) fn alarm(self) -> Alarm {
        Alarm::of(
            self.code,
            &[Arg::Int(self.node.get().into()), Arg::Int(self.ms.into())],
        )
    }
}

/// What a parameter set says about inputs and outputs; a bit each, 0 for none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wiring {
    inverted: u32,
    /// Outputs that a reset switches off.
    reset: u32,
    /// Outputs of the block that are on while it is lost.
    safe: u32,
    door: u32,
    chuck: u32,
    chuck_pressure: u32,
    tailstock_pressure: u32,
    tailstock_output: u32,
    enable: u32,
    /// The M code that opens the chuck; 0: none.
    pub chuck_open_code: u16,
}

impl Wiring {
    pub(super) fn of(params: &Params) -> Self {
        let bit = Contact::bit_of;
        Self {
            inverted: params.inputs_inverted(),
            reset: params.reset_outputs(),
            safe: params.block_safe_outputs() << BLOCK,
            door: bit(params.door_input()),
            chuck: bit(params.chuck_input()),
            chuck_pressure: bit(params.chuck_pressure_input()),
            tailstock_pressure: bit(params.tailstock_pressure_input()),
            tailstock_output: bit(params.tailstock_output()),
            enable: bit(params.enable_input()),
            chuck_open_code: params.chuck_open_code() as u16,
        }
    }
}

/// A set of interlocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Interlocks(u8);

impl Interlocks {
    const DOOR: u8 = 1 << Interlock::Door as u8;
    const ENABLE: u8 = 1 << Interlock::Enable as u8;

    /// True where `interlock` is one of them.
    #[must_use]
    pub const fn contains(self, interlock: Interlock) -> bool {
        self.0 & 1_u8.wrapping_shl(interlock as u32) != 0
    }

    /// The door is open.
    #[must_use]
    pub const fn has_door(self) -> bool {
        self.0 & Self::DOOR != 0
    }

    /// The first one that keeps a program from starting and the spindle from turning.
    #[must_use]
    pub fn against_start(self) -> Option<Interlock> {
        Self(self.0 & !Self::ENABLE).first()
    }

    /// The first one of what holds the work.
    #[must_use]
    pub fn of_clamping(self) -> Option<Interlock> {
        Self(self.0 & !(Self::ENABLE | Self::DOOR)).first()
    }

    /// What keeps an axis from being moved by hand.
    #[must_use]
    pub const fn against_hand(self) -> Option<Interlock> {
        match self.has_door() && self.0 & Self::ENABLE != 0 {
            true => Some(Interlock::Enable),
            false => None,
        }
    }

    /// As bits, each at the place of its number.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Those of such bits; what has no meaning is left out.
    #[must_use]
    pub const fn from_bits(bits: u8) -> Self {
        Self(bits)
    }

    /// All of them.
    pub fn each(self) -> impl Iterator<Item = Interlock> {
        Interlock::ALL
            .into_iter()
            .filter(move |interlock| self.contains(*interlock))
    }

    fn first(self) -> Option<Interlock> {
        self.each().next()
    }

    const fn with(self, interlock: Interlock, active: bool) -> Self {
        match active {
            true => Self(self.0 | 1_u8.wrapping_shl(interlock as u32)),
            false => self,
        }
    }
}

/// What was asked for is kept from happening by this.
#[cold]
#[inline(never)]
pub fn interlocked(by: Interlock, span: Span) -> Alarm {
    Alarm::new(Code::Interlocked, span).with([Arg::Interlock(by)])
}

/// A change that somebody has to look at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Change {
    /// The door has been opened.
    pub opened: bool,
    /// The enabling switch has been released with the door open.
    pub released: bool,
}

/// Inputs and outputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Machine {
    wiring: Wiring,
    /// The board's inputs as they were told; `None`: nobody has.
    told: Option<u16>,
    block: BlockInputs,
    /// The inputs that somebody has told.
    known: u32,
    /// Those of them that are on.
    on: u32,
    outputs: u32,
    /// The block is lost, and nobody has looked at it.
    loss: Option<BlockLoss>,
    interlocks: Interlocks,
    /// What is demanded while an output is on.
    demanded: [Option<Answer>; CONTACTS],
    /// Something has changed that nobody has looked at.
    change: Option<Change>,
}

/// Outputs.
const CONTACTS: usize = crate::params::CONTACTS as usize;

impl Machine {
    pub(super) fn new(wiring: Wiring) -> Self {
        let mut machine = Self {
            wiring,
            told: None,
            block: BlockInputs::default(),
            known: 0,
            on: 0,
            outputs: wiring.safe,
            loss: None,
            interlocks: Interlocks(0),
            demanded: [None; CONTACTS],
            change: None,
        };
        machine.read();
        machine
    }

    /// Another parameter set. Outputs stay as they are: what is clamped stays so. Those of a block that is not there are
    /// what the new set says of such a block.
    pub(super) fn begin_anew(&mut self, wiring: Wiring) {
        self.wiring = wiring;
        if self.block.known == 0 {
            self.outputs = self.outputs & OF_BOARD | wiring.safe;
        }
        self.read();
    }

    /// Takes the inputs as the board sees them.
    #[inline]
    pub(super) fn hear(&mut self, told: Option<u16>) {
        if told != self.told {
            self.told = told;
            self.read();
        }
    }

    /// Takes the inputs of the block.
    #[cold]
    #[inline(never)]
    pub(super) fn hear_block(&mut self, block: BlockInputs) {
        self.block = block;
        self.read();
    }

    /// The block is lost: nobody knows its inputs, and its outputs are where it puts them by itself.
    #[cold]
    #[inline(never)]
    pub(super) fn lose_block(&mut self, loss: BlockLoss) {
        self.loss = Some(loss);
        self.outputs = self.outputs & OF_BOARD | self.wiring.safe;
        for output in Contact::of_bits(!OF_BOARD) {
            self.demand(output, None);
        }
        self.hear_block(BlockInputs::default());
    }

    /// The loss of the block, once.
    pub(super) const fn takes_loss(&mut self) -> Option<BlockLoss> {
        self.loss.take()
    }

    /// What has changed, once.
    pub(super) const fn takes_change(&mut self) -> Option<Change> {
        self.change.take()
    }

    /// Something has changed that nobody has looked at.
    #[inline]
    pub(super) const fn has_changed(&self) -> bool {
        self.change.is_some()
    }

    /// The inputs that are on; `None` where nobody has told one of those `needed`.
    pub(super) const fn inputs(&self, needed: u32) -> Option<u32> {
        match self.known & needed == needed {
            true => Some(self.on),
            false => None,
        }
    }

    /// The inputs that are on, as far as somebody has told them.
    pub(super) const fn on(&self) -> u32 {
        self.on
    }

    /// The inputs that somebody has told.
    pub(super) const fn known(&self) -> u32 {
        self.known
    }

    /// The outputs that are on.
    pub(super) const fn outputs(&self) -> u32 {
        self.outputs
    }

    /// What is open, or has no pressure.
    pub(super) const fn interlocks(&self) -> Interlocks {
        self.interlocks
    }

    /// The M code that opens the chuck; 0: none.
    pub(super) const fn chuck_open_code(&self) -> u16 {
        self.wiring.chuck_open_code
    }

    /// Begins a function: its output is switched, and what was demanded of it holds no longer.
    pub(super) fn begin(&mut self, row: &FunctionRow) {
        if let Some((output, action)) = row.switches {
            self.demand(output, None);
            self.switch(output, action != FunctionAction::Off);
        }
    }

    /// True where the answer of a function is there. A level that nobody has told is none.
    pub(super) const fn has_answered(&self, answer: Answer) -> bool {
        let bit = answer.input.bit();
        self.known & bit != 0 && (self.on & bit != 0) == answer.on
    }

    /// A function has been answered, or needs no answer.
    pub(super) fn finish(&mut self, row: &FunctionRow) {
        match row.switches {
            Some((output, FunctionAction::Pulse)) => self.switch(output, false),
            Some((output, FunctionAction::On)) => self.demand(output, row.answer),
            _ => {}
        }
    }

    /// A function is given up: a pulse does not stay on.
    pub(super) fn give_up(&mut self, row: &FunctionRow) {
        if let Some((output, FunctionAction::Pulse)) = row.switches {
            self.switch(output, false);
        }
    }

    /// Switches outputs that no row has.
    pub(super) fn drive(&mut self, outputs: u32, on: bool) {
        match on {
            true => self.outputs |= outputs,
            false => self.outputs &= !outputs,
        }
    }

    /// A reset: some outputs go off.
    pub(super) fn reset(&mut self) {
        self.outputs &= !self.wiring.reset;
        for output in Contact::of_bits(!self.outputs) {
            self.demand(output, None);
        }
        self.read();
    }

    /// An input that answers for an output that is on, and is gone: the two.
    #[inline(never)]
    pub(super) fn lost(&self) -> Option<(Contact, Contact)> {
        let mut demanded = Contact::all().zip(self.demanded);
        demanded.find_map(|(output, answer)| {
            let answer = answer.filter(|answer| !self.has_answered(*answer))?;
            Some((answer.input, output))
        })
    }

    fn demand(&mut self, output: Contact, answer: Option<Answer>) {
        let place = usize::from(output.number()).wrapping_sub(1);
        if let Some(demanded) = self.demanded.get_mut(place) {
            *demanded = answer;
        }
    }

    fn switch(&mut self, output: Contact, on: bool) {
        match on {
            true => self.outputs |= output.bit(),
            false => self.outputs &= !output.bit(),
        }
        self.read();
    }

    /// Reads the interlocks from inputs and outputs.
    #[inline(never)]
    fn read(&mut self) {
        let wiring = &self.wiring;
        let pins = self.told.map_or(0, |_| OF_BOARD);
        self.known = u32::from(self.block.known) << BLOCK | pins;
        let levels = u32::from(self.block.levels) << BLOCK | u32::from(self.told.unwrap_or(0));
        self.on = (levels ^ wiring.inverted) & self.known;
        let on = self.on;
        let fails = |input: u32| on & input != input;
        let tailstock = wiring.tailstock_output;
        let demanded = tailstock == 0 || self.outputs & tailstock != 0;
        let before = self.interlocks;
        self.interlocks = Interlocks::default()
            .with(Interlock::Door, fails(wiring.door))
            .with(Interlock::Chuck, fails(wiring.chuck))
            .with(Interlock::ChuckPressure, fails(wiring.chuck_pressure))
            .with(
                Interlock::TailstockPressure,
                demanded && fails(wiring.tailstock_pressure),
            )
            .with(Interlock::Enable, fails(wiring.enable));
        let now = self.interlocks;
        let change = self.change.unwrap_or_default();
        self.change = Some(Change {
            opened: change.opened || (now.has_door() && !before.has_door()),
            released: change.released
                || (now.against_hand().is_some() && before.against_hand().is_none()),
        });
    }
}

#[cfg(test)]
#[expect(
    clippy::inconsistent_digit_grouping,
    reason = "a row is written by its fields: CCC H OO A II TTTT"
)]
mod tests {
    use super::*;

    fn machine(values: &[(u16, i64)]) -> Machine {
        let mut params = Params::slant_bed();
        for (number, value) in values {
            let entry = crate::params::Entry::find(*number, None).unwrap();
            params.set(entry, *value).unwrap();
        }
        Machine::new(Wiring::of(&params))
    }

    fn names(machine: &Machine) -> heapless::Vec<&'static str, 8> {
        machine.interlocks().each().map(Interlock::name).collect()
    }

    const ALL: [(u16, i64); 6] = [
        (9423, 1),
        (9424, 2),
        (9425, 3),
        (9426, 4),
        (9427, 5),
        (9429, 6),
    ];

    #[test]
    fn an_input_that_nobody_has_told_counts_as_the_worse_value() {
        let mut machine = machine(&ALL);
        machine.hear(Some(0b10_1111));
        assert_eq!(names(&machine), [""; 0]);
        machine.hear(None);
        // The tailstock is not demanded: its output is off.
        assert_eq!(
            names(&machine),
            ["door", "chuck", "chuck_pressure", "enable"]
        );
        assert_eq!(machine.known(), 0);
        machine.hear(Some(0b10_1110));
        assert_eq!(names(&machine), ["door"]);
    }

    #[test]
    fn an_inverted_input_that_nobody_has_told_is_off_too() {
        let mut machine = machine(&[(9421, 1), (9423, 1)]);
        machine.hear(Some(0));
        assert_eq!((names(&machine).len(), machine.inputs(1)), (0, Some(1)));
        machine.hear(None);
        assert_eq!(names(&machine), ["door"]);
    }

    #[test]
    fn the_tailstock_needs_its_pressure_while_its_output_is_on() {
        let mut machine = machine(&ALL);
        machine.hear(Some(0b10_0111));
        assert_eq!(names(&machine), [""; 0]);
        machine.begin(&FunctionRow::of(78_1_05_0_00_0000).unwrap());
        assert_eq!(names(&machine), ["tailstock_pressure"]);
        machine.hear(Some(0b10_1111));
        assert_eq!(names(&machine), [""; 0]);
    }

    #[test]
    fn an_answer_is_demanded_until_its_output_goes_off() {
        let mut machine = machine(&[(9422, 1)]);
        let on = FunctionRow::of(8_1_01_1_03_0200).unwrap();
        machine.hear(Some(0));
        machine.begin(&on);
        assert_eq!((machine.outputs(), machine.lost()), (1, None));
        machine.hear(Some(4));
        machine.finish(&on);
        assert_eq!(machine.lost(), None);
        machine.hear(None);
        let lost = machine
            .lost()
            .map(|(input, output)| (input.number(), output.number()));
        assert_eq!(lost, Some((3, 1)));
        machine.reset();
        assert_eq!((machine.outputs(), machine.lost()), (0, None));
    }
}
