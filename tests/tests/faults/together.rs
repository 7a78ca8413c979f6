//! Two boards on one wire, each with its drives, its spindle and its program: one gives the beat, the other follows.

use leadscrew_core::alarm::Arg;
use leadscrew_core::board::{Command, State};
use leadscrew_core::bus::{Frame, is_sync};
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::Gateway;
use leadscrew_tests::limits::first_excess;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm};
use leadscrew_tests::params::with;

/// Another thread than in `WORK`, at another speed.
const OTHER: &str =
    "M3 S450\nG0 X50 Z4\nG76 P010060 Q600 R0.1\nG76 X46 Z-9 P6000 Q3000 F1.5\nG0 X60 Z10\nM30\n";

/// Both boards on a bus where there is room for both.
fn params() -> [Params; 2] {
    let tick = ("9000", 2_000);
    let others = ("9030", 33);
    let first = with(&[tick, others]);
    let second = with(&[
        tick,
        others,
        ("9029", 1),
        ("9015.X", 48),
        ("9015.Z", 49),
        ("9015.C", 50),
        ("9016", 64),
        ("9014", 1),
    ]);
    [first, second]
}

/// Two machines.
struct Two([Box<Bench>; 2]);

impl Two {
    fn at_work(texts: [&str; 2]) -> Self {
        let [first, second] = params();
        let mut two = Self([&first, &second].map(|params| Box::new(Bench::new(params))));
        for (bench, text) in two.0.iter_mut().zip(texts) {
            bench.load(text);
        }
        two
    }

    /// A tick of both: what one tells its drives is on the wire of the other.
    fn tick(&mut self) {
        let Self([first, second]) = self;
        first.tick();
        let (syncs, rest): (Vec<Frame>, Vec<Frame>) = first.sent.iter().partition(|f| is_sync(f));
        assert_eq!(syncs.len(), 1);
        for frame in &rest {
            second.sim.receive(frame);
        }
        second.sim.beat(&syncs);
        second.tick();
        for frame in &second.sent {
            first.sim.receive(frame);
        }
    }

    fn is_busy(&self) -> bool {
        let mut benches = self.0.iter();
        benches.any(|bench| !bench.waiting.is_empty() || bench.sim.is_busy())
    }
}

#[test]
fn each_of_two_does_what_it_does_alone() {
    let [first, second] = params();
    for texts in [[WORK, OTHER], [OTHER, TAP], [TAP, WORK]] {
        let mut two = Two::at_work(texts);
        while two.is_busy() {
            two.tick();
        }
        let Two(benches) = two;
        for ((bench, params), text) in benches.iter().zip([&first, &second]).zip(texts) {
            assert_eq!(bench.alarm, None);
            // The beat by which its drives came up had other counters.
            let seam = u32::from(params == &second);
            assert_eq!(bench.gateway.status.late, seam);
            let alone = calm(params, text);
            assert!(alone.len() > 1_000);
            // Positions, spindle, what is done, the error of the synchronism: all of a row.
            assert!(bench.rows[..alone.len()] == alone[..], "{text}");
            assert_eq!(first_excess(&bench.rows, params), None);
        }
    }
}

/// The one that gives the beat loses its power while the other is in a stroke of its thread, and has it again later.
#[test]
fn a_board_without_power_takes_the_beat_from_the_other_and_nothing_jumps() {
    let [first, second] = params();
    let rows = calm(&second, OTHER);
    let locked = rows.iter().filter(|row| row.error.is_some());
    let stroke: Vec<u64> = locked.map(|row| row.tick).collect();
    for off in [1, 40, 2_000] {
        let mut two = Two::at_work([WORK, OTHER]);
        let cut = stroke[stroke.len() / 3];
        while two.0[1].ticks < cut {
            two.tick();
        }
        let [giver, follower] = &mut two.0;
        giver.waiting.clear();
        // Periods without a beat, two of them before it is noticed; the drives stand meanwhile.
        let from = follower.stood.len() - 1;
        for _ in 0..off + 2 {
            follower.sim.beat(&[]);
            follower.tick();
        }
        let alarm = follower.alarm.expect("an alarm");
        assert_eq!(alarm.number(), 4379);
        assert_eq!(alarm.args[..3], [3, 8, 2_000].map(Arg::Int));
        let stood = follower.drives();
        giver
            .sim
            .restart_board(&first, off)
            .expect("it starts again");
        giver.gateway = Gateway::connect(&mut giver.sim);
        giver.alarm = None;
        for _ in 0..500 {
            two.tick();
        }
        let follower = &mut two.0[1];
        assert!(matches!(follower.state(), State::Alarm(_)));
        assert_eq!(follower.drives(), stood, "off for {off}");
        follower.never_jumps("without a beat", from, 1);
        // It goes on with the beat that is there now.
        follower.sim.command(Command::Reset);
        follower.alarm = None;
        for _ in 0..200 {
            two.tick();
        }
        let follower = &mut two.0[1];
        assert_eq!((follower.state(), follower.alarm), (State::Idle, None));
        assert_eq!(follower.drives(), stood);
    }
}
