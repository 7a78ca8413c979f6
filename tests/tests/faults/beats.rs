//! The SYNC that a board follows goes missing, comes twice, or with another period.

use leadscrew_board_sim::plant::{FineTurns, Power, Trouble};
use leadscrew_core::alarm::Arg;
use leadscrew_core::board::{Command, State};
use leadscrew_core::bus::{
    CobId, Frame, MilliRpm, NmtCommand, NodeId, Service, SyncConsumer, SyncProducer,
};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm, places};
use leadscrew_tests::params::with;

/// A machine whose board follows, and whoever gives the beat.
pub struct Followed {
    pub bench: Bench,
    other: SyncProducer,
}

/// The built-in machine with a board that follows.
fn followers() -> Params {
    with(&[("9029", 1)])
}

impl Followed {
    fn at_work(text: &str) -> Self {
        let mut bench = Bench::new(&followers());
        bench.load(text);
        let other = SyncProducer::new();
        let mut followed = Self { bench, other };
        // Another counter than the one before: one gap.
        followed.tick(1);
        followed
    }

    /// Late setpoints, but for that one.
    fn late(&self) -> u32 {
        self.bench.gateway.status.late - 1
    }

    /// A tick in which so many SYNCs come.
    fn tick(&mut self, count: usize) {
        let syncs: Vec<Frame> = (0..count).map(|_| self.other.next()).collect();
        self.bench.sim.beat(&syncs);
        self.bench.tick();
    }

    fn ticks(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick(1);
        }
    }

    /// The same without a SYNC.
    fn ticks_without(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick(0);
        }
    }

    fn until_tick(&mut self, tick: u64) {
        while self.bench.ticks < tick {
            self.tick(1);
        }
    }

    /// To the end of the program.
    fn run_out(&mut self, what: &str) {
        while !self.bench.waiting.is_empty() || self.bench.sim.is_busy() {
            self.tick(1);
            assert!(self.bench.ticks < 60_000, "{what}");
        }
        self.ticks(5);
    }

    /// From now on another gives it, without a flaw.
    fn reset_and_next(&mut self, what: &str) {
        self.bench.sim.command(Command::Reset);
        self.bench.alarm = None;
        let drives = self.bench.drives();
        self.tick(1);
        let begun = self.bench.ticks;
        while self.bench.state() != State::Idle {
            self.tick(1);
            assert!(
                self.bench.ticks < begun + 400,
                "{what}: {:?}",
                self.bench.state()
            );
        }
        assert_eq!(
            self.bench.drives(),
            drives,
            "{what}: the reset moves a drive"
        );
        let (at, drives) = (self.bench.at(), self.bench.drives());
        for (said, is) in [at.x.nm(), at.z.nm()].into_iter().zip(drives) {
            assert!((said - is).abs() <= 1_000, "{what}: at {is}, says {said}");
        }
        self.bench.judge_from_here();
        self.bench.load(WORK);
        self.run_out(what);
        assert_eq!(self.bench.alarm, None, "{what}");
        self.bench.never_jumps(what, 0, 1);
        assert_eq!(self.bench.drives(), [35_000_000, 8_000_000], "{what}");
    }
}

/// The setpoints, from the first tick on.
fn setpoints(bench: &Bench) -> Vec<(i64, i64, i64, u32)> {
    let rows = bench.rows.iter();
    rows.map(|row| {
        let at = row.position;
        (at.x.nm(), at.z.nm(), at.c.udeg(), row.line)
    })
    .collect()
}

#[test]
fn a_board_that_follows_does_what_it_does_with_a_beat_of_its_own() {
    for text in [WORK, TAP] {
        let mut own = Bench::new(&Params::slant_bed());
        own.load(text);
        while !own.waiting.is_empty() || own.sim.is_busy() {
            own.tick();
        }
        own.ticks(5);
        assert!(own.sent.iter().any(leadscrew_core::bus::is_sync));
        let mut followed = Followed::at_work(text);
        followed.run_out(text);
        let bench = &followed.bench;
        assert!(!bench.sent.iter().any(leadscrew_core::bus::is_sync));
        assert_eq!(bench.alarm, None);
        assert!(setpoints(bench) == setpoints(&own));
    }
}

#[test]
fn one_or_two_that_do_not_come_are_setpoints_late_for_their_sync() {
    for tick in places(&calm(&Params::slant_bed(), WORK)) {
        for gone in [1, 2] {
            let what = format!("{gone} missing at {tick}");
            let mut followed = Followed::at_work(WORK);
            followed.until_tick(tick);
            followed.ticks_without(gone);
            followed.run_out(&what);
            let bench = &followed.bench;
            assert_eq!(bench.alarm, None, "{what}");
            assert_eq!(followed.late(), gone, "{what}");
            // Behind it a drive is where it would have been.
            bench.never_jumps(&what, 0, i64::from(gone) + 1);
            assert!(setpoints(bench) == setpoints(&calm_bench()), "{what}");
        }
    }
}

fn calm_bench() -> Bench {
    let mut followed = Followed::at_work(WORK);
    followed.run_out("calm");
    followed.bench
}

#[test]
fn one_that_comes_twice_and_one_that_was_not_heard_count_as_well() {
    let tick = places(&calm(&Params::slant_bed(), WORK))[2];
    let mut followed = Followed::at_work(WORK);
    followed.until_tick(tick);
    followed.tick(2);
    followed.ticks(20);
    assert_eq!(followed.late(), 1);
    // By the counters alone: the period had one.
    followed.other.next();
    followed.ticks(20);
    assert_eq!(followed.late(), 2);
    followed.run_out("twice");
    assert_eq!(followed.bench.alarm, None);
    // More of it than 9027 says within a second.
    let mut followed = Followed::at_work(WORK);
    followed.until_tick(tick);
    for count in [2, 1].into_iter().cycle().take(21) {
        assert_eq!(followed.bench.alarm, None);
        followed.tick(count);
    }
    followed.ticks(3);
    let alarm = followed.bench.alarm.expect("too many");
    assert_eq!(alarm.number(), 4372);
    assert_eq!(alarm.args[..2], [Arg::Int(11), Arg::Int(10)]);
}

/// Nothing is latched any more while the board brakes on its path: nothing is pulled there when the beat is back.
#[test]
fn three_that_do_not_come_stop_the_machine_and_nothing_jumps_when_the_beat_is_back() {
    for text in [WORK, TAP] {
        let places = if text == WORK {
            places(&calm(&Params::slant_bed(), text))
        } else {
            vec![450, 900, 1_100]
        };
        for tick in places {
            for gone in [3, 4, 12, 300, 2_500] {
                let what = format!("{gone} missing at {tick}");
                let mut followed = Followed::at_work(text);
                followed.until_tick(tick);
                let from = followed.bench.stood.len() - 1;
                followed.tick(0);
                followed.tick(0);
                assert_eq!(followed.bench.alarm, None, "{what}");
                followed.tick(0);
                let alarm = followed.bench.alarm.expect("an alarm");
                assert_eq!(alarm.number(), 4379, "{what}");
                let figures = [3, 8, 1000].map(Arg::Int);
                assert_eq!(alarm.args[..3], figures, "{what}");
                let stood = followed.bench.drives();
                followed.ticks_without(gone - 3);
                followed.ticks(600);
                let bench = &mut followed.bench;
                assert_eq!(bench.drives(), stood, "{what}: a drive has moved");
                bench.never_jumps(&what, from, 1);
                for axis in Axis::ALL {
                    assert_ne!(
                        bench.power(axis),
                        Power::Enabled,
                        "{what}: {axis:?} has torque"
                    );
                }
                assert!(matches!(bench.state(), State::Alarm(_)), "{what}");
                if text == WORK {
                    followed.reset_and_next(&what);
                }
            }
        }
    }
}

/// A push or a reset of the board that gives it: others may be at work by it.
#[test]
fn a_board_that_is_begun_anew_goes_on_counting() {
    let mut own = Bench::new(&Params::slant_bed());
    let anew = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
    let mut ear = SyncConsumer::new();
    for tick in 0..700 {
        if tick % 300 == 200 {
            own.sim.receive(&anew);
        }
        own.tick();
        let syncs = own.sent.iter().filter_map(|frame| ear.receive(frame));
        let missed: Vec<u8> = syncs.map(|beat| beat.missed).collect();
        assert_eq!(missed, [0], "{tick}");
    }
}

/// What a spindle is told is latched at SYNC as well: without one it is stopped by network management.
#[test]
fn a_spindle_does_not_turn_on_without_a_beat() {
    for text in [WORK, TAP] {
        for tick in [450, 900, 1_100] {
            let what = format!("none from {tick} on");
            let mut followed = Followed::at_work(text);
            followed.until_tick(tick);
            let turning = followed.bench.sim.plant().truth();
            followed.ticks_without(3);
            assert_eq!(followed.bench.alarm.expect("an alarm").number(), 4379);
            // 600 rpm, by the ramp of a drive: a second is more than enough.
            followed.ticks_without(1_000);
            let (rest, stands): (MilliRpm, FineTurns) = {
                let truth = followed.bench.sim.plant().truth();
                (truth.speed, truth.angle)
            };
            assert_eq!(rest, MilliRpm::STOPPED, "{what}, it had {turning:?}");
            followed.bench.sim.command(Command::Stop);
            followed.ticks_without(20_000);
            assert_eq!(followed.bench.sim.plant().truth().angle, stands, "{what}");
            // Nor does it when the beat is back, before a reset.
            followed.ticks(600);
            assert_eq!(followed.bench.sim.plant().truth().angle, stands, "{what}");
            let spindle = followed.bench.sim.plant().spindle_drive().power();
            assert_eq!(spindle, Power::QuickStop, "{what}");
            if text == WORK {
                followed.reset_and_next(&what);
            }
        }
    }
}

/// By 6007h of its drive: 0 lets it turn until the reset, which is what a machine file is warned of (4974); of a fault
/// the first reset is told, and the second one acts.
#[test]
fn what_a_spindle_does_without_a_beat_is_what_its_drive_is_set_up_for() {
    for (option, power, turns_on) in [
        (0, Power::Enabled, true),
        (1, Power::Fault, false),
        (2, Power::Disabled, false),
        (3, Power::QuickStop, false),
    ] {
        let what = format!("6007h = {option}");
        let mut followed = Followed::at_work(WORK);
        let request = [0x2B, 0x07, 0x60, 0, option, 0, 0, 0];
        let at = CobId::of(Service::SdoRequest, NodeId::SPINDLE_1);
        let frame = Frame::new(at, &request).expect("eight bytes");
        followed.bench.sim.receive(&frame);
        followed.until_tick(900);
        followed.ticks_without(3);
        assert_eq!(followed.bench.alarm.expect("an alarm").number(), 4379);
        followed.ticks_without(1_000);
        let truth = followed.bench.sim.plant().truth();
        assert_eq!(truth.speed != MilliRpm::STOPPED, turns_on, "{what}");
        let drive = followed.bench.sim.plant().spindle_drive();
        assert_eq!(drive.power(), power, "{what}");
        followed.ticks(600);
        if option == 1 {
            followed.bench.sim.command(Command::Reset);
            followed.bench.alarm = None;
            followed.ticks(200);
            let alarm = followed.bench.alarm.expect("that it is in fault");
            assert_eq!((alarm.number(), alarm.args[0]), (4357, Arg::Letter(b'S')));
        }
        followed.reset_and_next(&what);
    }
}

/// A drive that nobody reaches when it is told to stop is told so again.
#[test]
fn a_spindle_that_has_not_heard_of_it_hears_it_later() {
    let mut followed = Followed::at_work(WORK);
    followed.until_tick(900);
    followed
        .bench
        .sim
        .plant()
        .spindle_drive()
        .trouble(Trouble::CutOff);
    followed.ticks_without(20);
    assert_eq!(followed.bench.alarm.expect("an alarm").number(), 4379);
    let drive = followed.bench.sim.plant().spindle_drive();
    assert_eq!(drive.power(), Power::Enabled);
    drive.trouble(Trouble::None);
    followed.ticks_without(16);
    let drive = followed.bench.sim.plant().spindle_drive();
    assert_eq!(drive.power(), Power::QuickStop);
    followed.ticks(1_000);
    followed.reset_and_next("told again");
}

/// A drive that was in fault when the beat ended is out of NMT operational: the reset starts it before it resets the fault.
#[test]
fn a_drive_in_fault_is_reset_behind_the_loss_of_the_beat() {
    let mut followed = Followed::at_work(WORK);
    followed.until_tick(900);
    followed
        .bench
        .sim
        .plant()
        .drive(Axis::X)
        .trouble(Trouble::Fault(0x7305));
    followed.ticks(20);
    assert_eq!(followed.bench.alarm.expect("an alarm").number(), 4357);
    followed.ticks_without(20);
    followed
        .bench
        .sim
        .plant()
        .drive(Axis::X)
        .trouble(Trouble::None);
    followed.ticks(1_000);
    followed.reset_and_next("a fault");
}

/// A board that has come off the beat has drives that still follow: they are braked on their path.
#[test]
fn a_board_that_comes_off_the_beat_brakes() {
    for tick in places(&calm(&Params::slant_bed(), WORK)) {
        let what = format!("off the beat at {tick}");
        let mut followed = Followed::at_work(WORK);
        followed.until_tick(tick);
        followed.bench.sim.unlock();
        followed.tick(1);
        let alarm = followed.bench.alarm.expect("an alarm");
        assert_eq!(alarm.number(), 4379, "{what}");
        let figures = [0, 8, 1000].map(Arg::Int);
        assert_eq!(alarm.args[..3], figures, "{what}");
        followed.ticks(1_000);
        let bench = &mut followed.bench;
        assert!(matches!(bench.state(), State::Alarm(_)), "{what}");
        assert_eq!(bench.power(Axis::X), Power::Enabled, "{what}");
        let (at, drives) = (bench.at(), bench.drives());
        for (said, is) in [at.x.nm(), at.z.nm()].into_iter().zip(drives) {
            assert!((said - is).abs() <= 1_000, "{what}: at {is}, says {said}");
        }
        bench.never_jumps(&what, 0, 1);
        followed.reset_and_next(&what);
    }
}

/// Switched on before the one that gives the beat: it says what it waits for, and a reset waits again.
#[test]
fn drives_are_not_brought_up_before_the_beat_is_steady() {
    for (what, pattern, heard) in [
        ("nothing", [0, 0], 0),
        ("half", [1, 0], 1_050),
        ("double", [2, 2], 4_200),
    ] {
        let mut followed = Followed::at_work("");
        let node = NodeId::BOARD;
        followed
            .bench
            .sim
            .receive(&NmtCommand::ResetNode.frame(Some(node)));
        let mut beat = pattern.into_iter().cycle();
        // To hear of the order takes a tick; what the board told its drives before is told then.
        followed.tick(1);
        followed.tick(1);
        for again in [false, true] {
            while followed.bench.alarm.is_none() {
                followed.tick(beat.next().expect("a beat"));
                assert_eq!(followed.bench.sent, [], "{what}");
            }
            let alarm = followed.bench.alarm.expect("an alarm");
            assert_eq!(alarm.number(), 4380, "{what}, again: {again}");
            let [Arg::Int(seen), periods, period, Arg::None] = alarm.args else {
                panic!("{what}: {alarm:?}");
            };
            assert_eq!((periods, period), (Arg::Int(2_100), Arg::Int(1_000)));
            assert!((seen - heard).abs() <= 2, "{what}: {seen}");
            followed.tick(beat.next().expect("a beat"));
            if !again {
                followed.bench.sim.command(Command::Reset);
                followed.bench.alarm = None;
            }
        }
        followed.ticks(20);
        followed.reset_and_next(what);
    }
}
