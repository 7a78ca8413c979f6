//! Somebody at the machine who presses anything at any time, and a machine things happen to.

use leadscrew_board_sim::plant::{PlantOptions, Trouble};
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::bus::{BoardCommand, CobId, Frame, NmtCommand, Object, Order, Service};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use super::bench::{Bench, End};
use super::encoder;
use super::script::Luck;
use super::trouble::{OF_BUS, OF_DRIVES, break_something, mend_wire};
use crate::gateway::NODE;

/// How much happens: the mean number of ticks between two things done, 0 for none, and what they may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mood {
    /// Ticks between two of them.
    pub every: i64,
    /// Reset, emergency stop and what ends a program otherwise may be among them.
    pub ends: bool,
    /// So may faults of drives, spindle and encoder.
    pub breaks: bool,
    /// And the loss of power.
    pub cuts: bool,
}

impl Mood {
    /// Nobody is there.
    pub const AWAY: Self = Self {
        every: 0,
        ends: false,
        breaks: false,
        cuts: false,
    };
}

impl Default for Mood {
    fn default() -> Self {
        Self::AWAY
    }
}

/// Room for all causes at once: those of drives, spindle and bus, and what else is named one by one.
const CAUSES: usize = 64;
const _: () = assert!(
    OF_DRIVES.len() + OF_SPINDLE.len() + OF_FAST_SPINDLE.len() + OF_BUS.len() + 16 <= CAUSES
);

/// The operator, and what is broken.
#[derive(Debug, Default)]
pub struct Operator {
    /// How much happens.
    pub mood: Mood,
    /// Causes of alarms since everything was well.
    causes: heapless::Vec<Code, CAUSES>,
    /// The spindle swings in a way that its encoder cannot learn.
    swings: bool,
    /// Until this tick the node is left as it is.
    quiet_until: u64,
    /// NMT reset node is on its way, or done.
    resets_node: bool,
    now: u64,
    /// Drives, spindle, encoder or wire are not as they should be.
    pub(super) broken: bool,
    /// What turns the spindle or tells of it is not as it should be.
    spindle_broken: bool,
    /// Until this tick of the machine its wire is bad; 0: by chance, until somebody mends it.
    pub(super) spoilt: Option<u64>,
}

/// Alarms of a spindle that does not turn as the program tells it.
pub(super) const OF_SPINDLE: [Code; 11] = [
    Code::EncoderUncertain,
    Code::LeadForEncoder,
    Code::SpeedForEncoder,
    Code::SpindleSwings,
    Code::SpindleNotSteady,
    Code::SpindleNotArrived,
    Code::SpindleNotStopped,
    Code::SpindleStopped,
    Code::SpindleTooFast,
    Code::FloatSpindleRuns,
    Code::NoIndex,
];

/// Alarms of a spindle that turns faster than the program tells it: what fits at its S may not at more.
pub(super) const OF_FAST_SPINDLE: [Code; 6] = [
    Code::LeadTooFast,
    Code::RunOutTooFast,
    Code::RunInTooFast,
    Code::StrokeTooShortForSpeed,
    Code::StrokeTooShortInChain,
    Code::LeadChangeTooFast,
];

impl Operator {
    /// The node is stopped or pre-operational on purpose.
    pub fn leaves_node_alone(&self) -> bool {
        self.now < self.quiet_until
    }

    /// NMT reset node is on its way.
    pub fn resets_node(&self) -> bool {
        self.resets_node
    }

    /// The node has begun anew because it was told to; it was told once.
    pub fn took_node_reset(&mut self) -> bool {
        core::mem::take(&mut self.resets_node)
    }

    /// This alarm has a cause.
    pub fn explains(&self, alarm: &Alarm) -> bool {
        let code = alarm.code;
        let swings = matches!(code, Code::SpindleSwings | Code::SpindleNotSteady);
        self.causes.contains(&code) || self.swings && swings
    }

    /// Somebody at a machine where everything is well.
    pub fn of(params: &Params, options: &PlantOptions) -> Self {
        Self {
            swings: encoder::is_unknown(params, encoder::swing_mhz(options)),
            ..Self::default()
        }
    }

    /// From now on these may come.
    pub fn cause(&mut self, codes: &[Code]) {
        for code in codes {
            if !self.causes.contains(code) {
                self.causes.push(*code).expect("there are few causes");
            }
        }
    }

    /// Nothing is broken.
    pub fn is_well(&self) -> bool {
        !self.broken
    }

    /// The spindle turns as it is told, and its encoder tells how.
    pub fn is_spindle_well(&self) -> bool {
        !self.spindle_broken
    }

    /// From now on the spindle may turn in any way, for what turns it or tells of it is broken.
    pub fn break_spindle(&mut self) {
        self.spindle_broken = true;
        self.cause(&OF_SPINDLE);
        self.cause(&OF_FAST_SPINDLE);
    }

    /// Perhaps something is done now.
    pub fn act(bench: &mut Bench) {
        bench.operator.now = bench.now;
        let mood = bench.operator.mood;
        if mood.every == 0 || bench.random.luck(Luck::Act, 1, mood.every, |one| one == 1) != 1 {
            return;
        }
        let choice = bench.random.within(0, 99);
        match choice {
            0..=17 => bench.order(Order::Hold),
            18..=37 => bench.order(Order::Resume),
            38..=55 => overrides(bench),
            56..=62 => {
                let on = bench.random.chance(50);
                bench.levels(BoardCommand {
                    single_block: Some(on),
                    ..BoardCommand::default()
                });
            }
            63..=66 => inputs(bench),
            67..=70 if bench.sim.board().device().mode().runs() => bench.order(Order::Run),
            // In another mode it is refused, and drops a program that is just coming in [D316]. The shift would wait for
            // the end of that program.
            67..=70 => {}
            71..=73 => quiet(bench),
            74..=76 => refused_write(bench),
            77..=79 => hush(bench),
            80..=84 if mood.ends => bench.order(Order::Reset),
            85..=87 if mood.ends => {
                bench.operator.cause(&[Code::EmergencyStop]);
                bench.order(Order::Stop);
            }
            88 if mood.ends => network(bench),
            89..=97 if mood.breaks => break_something(bench),
            98 if mood.cuts => {
                bench.random.act(|| "the power goes".into());
                bench.sim.cut_power();
            }
            99 if mood.cuts => {
                // In the middle of what is written next.
                let bytes = bench.random.within(0, 120);
                bench
                    .random
                    .act(|| format!("the power goes after {bytes} bytes more"));
                bench.sim.flash_mut().cut_after(bytes as u32);
            }
            _ => {}
        }
    }

    /// Everything that is broken is mended, every switch and override is as it should be, and who is not there comes back.
    pub fn put_right(bench: &mut Bench) {
        bench.operator.mood = Mood::AWAY;
        bench.operator.quiet_until = 0;
        mend_wire(bench);
        bench.beats = true;
        bench.send(NmtCommand::Start.frame(Some(NODE)));
        let plant = bench.sim.plant();
        for axis in Axis::ALL {
            plant.drive(axis).trouble(Trouble::None);
        }
        plant.spindle_drive().trouble(Trouble::None);
        for tapper in plant.tappers() {
            tapper.drive().trouble(Trouble::None);
        }
        plant.spindle().disturb(100);
        plant.encoder().break_index(false);
        bench.sim.flash_mut().set_broken(false);
        bench.levels(BoardCommand {
            single_block: Some(false),
            feed: Some(100),
            rapid: Some(100),
            spindle: Some(100),
            ..BoardCommand::default()
        });
        // A write that was to be cut is not.
        if bench.sim.has_power() {
            bench.sim.flash_mut().power(true);
        }
    }

    /// What was wrong is over, and its alarms too; but for what shows only when the spindle turns again.
    pub fn forget_causes(&mut self, but: &[Code]) {
        self.broken = false;
        self.spindle_broken = false;
        self.causes.retain(|code| but.contains(code));
    }
}

fn overrides(bench: &mut Bench) {
    let r = &mut bench.random;
    let feed = r.of(&[0, 10, 50, 90, 100, 120, 150, 200]);
    let rapid = r.of(&[0, 25, 50, 100, 120]);
    let spindle = r.of(&[0, 50, 80, 100, 120, 150]);
    let mut chosen = |value| r.chance(50).then_some(value);
    let levels = [chosen(feed), chosen(rapid), chosen(spindle)];
    bench.operator.cause(&OF_SPINDLE);
    if levels[2].is_some_and(|percent| percent > 100) {
        bench.operator.cause(&OF_FAST_SPINDLE);
    }
    bench.levels(BoardCommand {
        feed: levels[0],
        rapid: levels[1],
        spindle: levels[2],
        ..BoardCommand::default()
    });
}

/// The gateway's messages of its own life stop or come again.
fn hush(bench: &mut Bench) {
    let beats = !bench.beats;
    bench.beat(beats);
    bench
        .random
        .act(|| format!("heartbeats of the gateway: {beats}"));
    bench.operator.cause(&[Code::GatewayLost]);
}

/// Inputs of the PLC change. Over the bus in one frame, so it needs no transfer of its own.
fn inputs(bench: &mut Bench) {
    let bits = (bench.random.within(0, 1) as u16).to_le_bytes();
    expedited(bench, Object::new(0x5060, 0), bits);
}

/// Somebody writes a parameter while the machine works: refused, unless it stands.
fn refused_write(bench: &mut Bench) {
    if bench.sim.board().ticker().in_program() {
        bench.counts.refused += 1;
        // What is in force is compared after every program.
        expedited(bench, Object::new(0x2000 + 9005, 0), 50_u16.to_le_bytes());
    }
}

/// One frame of somebody else's transfer: it breaks off what the gateway has under way.
fn expedited(bench: &mut Bench, object: Object, bytes: [u8; 2]) {
    let [low, high] = object.index.to_le_bytes();
    bench
        .random
        .act(|| format!("written: {object:?} {bytes:?}"));
    let request = [0x2B, low, high, object.sub, bytes[0], bytes[1], 0, 0];
    let frame = Frame::new(CobId::of(Service::SdoRequest, NODE), &request);
    bench.send(frame.expect("eight bytes"));
}

/// The node is pre-operational for a while.
fn quiet(bench: &mut Bench) {
    bench.operator.quiet_until = bench.now + bench.random.within(10, 500) as u64;
    let until = bench.operator.quiet_until - bench.now;
    bench
        .random
        .act(|| format!("the node is pre-operational for {until} ticks"));
    bench.send(NmtCommand::PreOperational.frame(Some(NODE)));
}

/// NMT commands that stop the machine.
fn network(bench: &mut Bench) {
    bench.operator.cause(&[Code::NetworkStop]);
    let command = bench.random.of(&[
        NmtCommand::Stop,
        NmtCommand::ResetNode,
        NmtCommand::ResetCommunication,
    ]);
    bench.random.act(|| format!("NMT: {command:?}"));
    bench.operator.quiet_until = bench.now + 100;
    let arrived = bench.send(command.frame(Some(NODE)));
    // One that is lost begins nothing anew: the next boot-up may be that of a reset of the communication alone.
    bench.operator.resets_node |= arrived && command == NmtCommand::ResetNode;
    if arrived && command == NmtCommand::Stop && !bench.sim.board().ticker().in_program() {
        // What has come of a program that had not begun is forgotten without an alarm.
        bench.end.get_or_insert(End::Reset);
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_board_sim::Sim;

    use super::super::bench::Wire;
    use super::super::script::Draws;
    use super::*;

    /// The boot-up that comes next may be that of a reset of the communication, and the program goes on.
    #[test]
    fn a_reset_of_the_node_that_is_lost_begins_nothing_anew() {
        let (params, options) = (Params::sheets(), PlantOptions::default());
        for (lost, resets) in [(100, false), (0, true)] {
            let sim = Sim::new(&params, &options).expect("the machine starts");
            let wire = Wire { lost, twice: 0 };
            let mut bench = Bench::new(Draws::live(1), sim, params.clone(), options, wire);
            // One in three of them is a reset of the node.
            for _ in 0..50 {
                network(&mut bench);
            }
            assert_eq!(bench.operator.took_node_reset(), resets);
        }
    }
}
