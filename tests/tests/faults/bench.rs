//! A machine on a network, the frames that are still to be handed over, and what the machine has done.

use std::ops::{Deref, DerefMut};
use std::sync::OnceLock;

use leadscrew_board_sim::line::{Faults, Span};
use leadscrew_board_sim::plant::Power;
use leadscrew_board_sim::{Direction, Row};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::bus::{Frame, Scale};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
pub use leadscrew_tests::bench::{Bench as AnyBench, WORK};
use leadscrew_tests::bench::{Lathe, NEXT, PATIENCE};
use leadscrew_tests::gateway::Gateway;
use leadscrew_tests::limits::first_excess_with;

/// A rigid tap in one stroke.
pub const TAP: &str = "G98 G0 X50 Z5\nM29 S1000\nG84 Z-12 R-5 F2000\nG80\nM30\n";

/// Ticks without an end.
pub const fn from(tick: u64) -> Span {
    Span {
        from: tick,
        to: u64::MAX,
    }
}

/// So many ticks.
pub const fn span(from: u64, ticks: u64) -> Span {
    Span {
        from,
        to: from + ticks,
    }
}

/// A lathe on a network.
pub struct Bench {
    pub lathe: Lathe,
    pub gateway: Gateway,
    /// Where the drives of X and Z are, by tick, in nm.
    pub stood: Vec<[i64; 2]>,
    /// What the board has sent in the last tick.
    pub sent: Vec<Frame>,
    scales: [Scale; 2],
    /// Rows since the last reset, which may have found the drives elsewhere.
    judged: usize,
}

impl Deref for Bench {
    type Target = Lathe;

    fn deref(&self) -> &Lathe {
        &self.lathe
    }
}

impl DerefMut for Bench {
    fn deref_mut(&mut self) -> &mut Lathe {
        &mut self.lathe
    }
}

impl AnyBench for Bench {
    fn lathe(&self) -> &Lathe {
        &self.lathe
    }

    fn tick(&mut self) {
        let (lathe, sent) = (&mut self.lathe, &mut self.sent);
        lathe.hand_over();
        sent.clear();
        let row = lathe.sim.step_on(&mut |direction, frame| {
            if direction == Direction::FromBoard {
                sent.push(*frame);
            }
        });
        lathe.rows.extend(row);
        lathe.ticks += 1;
        let drives = self.drives();
        self.stood.push(drives);
        self.lathe.listen();
        self.gateway.listen(&mut self.lathe.sim);
    }
}

impl Bench {
    /// A lathe that is switched on, on a network that has started it.
    pub fn new(params: &Params) -> Self {
        let mut lathe = Lathe::new(params);
        let gateway = Gateway::connect(&mut lathe.sim);
        let scale = |axis| {
            Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))
                .expect("a scale")
        };
        Self {
            lathe,
            gateway,
            stood: Vec::new(),
            sent: Vec::new(),
            scales: [scale(Axis::X), scale(Axis::Z)],
            judged: 0,
        }
    }

    /// The same lathe at work on a program, on a wire with these faults.
    pub fn at_work(params: &Params, text: &str, faults: Faults) -> Self {
        let mut bench = Self::new(params);
        bench.sim.spoil(faults);
        bench.load(text);
        bench
    }

    /// Where the drives of X and Z are, in nm.
    pub fn drives(&mut self) -> [i64; 2] {
        let positions = [Axis::X, Axis::Z].map(|axis| self.sim.plant().drive(axis).actual());
        let [x, z] = self.scales;
        [x.position(positions[0]), z.position(positions[1])]
    }

    /// The journal says that a tap is in its hole.
    pub fn has_tap_in_hole(&self) -> bool {
        let tap = self.sim.board().tap_record();
        tap.is_some_and(|tap| tap.in_hole)
    }

    pub fn power(&mut self, axis: Axis) -> Power {
        self.sim.plant().drive(axis).power()
    }

    /// Earlier rows are not judged again.
    pub fn judge_from_here(&mut self) {
        self.judged = self.rows.len();
        self.stood.clear();
    }

    /// The program has begun and ended.
    pub fn state_is_idle_again(&self) -> bool {
        self.events.contains(&Event::Finished)
    }

    /// Lines that have begun, in order.
    pub fn started(&self) -> Vec<u32> {
        let lines = self.events.iter().filter_map(|event| match event {
            Event::Started { line, .. } => Some(*line),
            _ => None,
        });
        lines.collect()
    }

    /// Waits for an alarm with this number, and until the machine stands on it. It keeps its limits all the time.
    pub fn stops_with(&mut self, what: &str, number: u16, within: u64) -> Alarm {
        self.until(what, within, |bench| bench.alarm.is_some());
        let alarm = self.alarm.expect("an alarm");
        assert_eq!(alarm.number(), number, "{what}");
        self.until_on_alarm(what, PATIENCE);
        assert_eq!(
            first_excess_with(&self.rows[self.judged..], &self.params, 2.0),
            None,
            "{what}"
        );
        self.stands(what);
        alarm
    }

    /// Nothing moves for so many ticks, whatever the board says.
    pub fn drives_stand(&mut self, what: &str, ticks: u64) {
        let at = self.drives();
        for _ in 0..ticks {
            self.tick();
            assert_eq!(self.drives(), at, "{what}: a drive moves");
        }
    }

    /// Clears an alarm and comes up again; no drive moves for it.
    pub fn clear(&mut self, what: &str) {
        self.sim.command(Command::Reset);
        self.alarm = None;
        let drives = self.drives();
        self.tick();
        self.until(what, 2_000, |bench| bench.state() == State::Idle);
        assert_eq!(self.alarm, None, "{what}");
        self.drives_stand(what, 20);
        assert_eq!(self.drives(), drives, "{what}: the reset moves a drive");
        self.judge_from_here();
    }

    /// The same; the machine is then where its drives are, to half an increment.
    pub fn reset(&mut self, what: &str) {
        self.clear(what);
        let (at, drives) = (self.at(), self.drives());
        for (said, is) in [(at.x.nm(), drives[0]), (at.z.nm(), drives[1])] {
            assert!(
                (said - is).abs() <= 1_000,
                "{what}: at {is} nm, says {said}"
            );
        }
    }

    /// A reset does not help: the same alarm comes again, and nothing moves.
    pub fn reset_is_in_vain(&mut self, what: &str) {
        let number = self.alarm.map(|alarm| alarm.number());
        self.alarm = None;
        self.sim.command(Command::Reset);
        self.tick();
        self.until(what, 5_000, |bench| bench.alarm.is_some());
        assert_eq!(self.alarm.map(|alarm| alarm.number()), number, "{what}");
        self.until_on_alarm(what, 5_000);
        self.drives_stand(what, 20);
    }

    /// Runs a program that must end well at `x`, `z` (nm), its drives too, and never jump on the way.
    pub fn runs(&mut self, what: &str, text: &str, x: i64, z: i64) {
        self.load(text);
        let from = self.stood.len();
        self.finish(what);
        self.ticks(5);
        assert_eq!(self.alarm, None, "{what}");
        assert_eq!((self.at().x.nm(), self.at().z.nm()), (x, z), "{what}");
        let drives = self.drives();
        assert!(
            (drives[0] - x).abs() <= 1_000 && (drives[1] - z).abs() <= 1_000,
            "{what}: {drives:?}"
        );
        self.never_jumps(what, from, 1);
    }

    /// Since this tick no drive has made a greater step than `periods` of its rapid rate.
    pub fn never_jumps(&self, what: &str, from: usize, periods: i64) {
        for (axis, which) in [(Axis::X, 0), (Axis::Z, 1)] {
            let rapid = self.params.rapid(axis).nm_per_min();
            let step = rapid * i64::from(self.params.tick_us()) / 60_000_000 + 2_000;
            for (tick, pair) in self.stood[from..].windows(2).enumerate() {
                let moved = (pair[1][which] - pair[0][which]).abs();
                assert!(
                    moved <= step * periods,
                    "{what}: {axis:?} jumps by {moved} nm at {}",
                    from + tick
                );
            }
        }
    }

    /// The next program, thread and all: on its helix, and where the index of the spindle says that this begins.
    pub fn next(&mut self, what: &str) {
        let from = self.rows.len();
        self.runs(what, NEXT, 40_000_000, 10_000_000);
        let expected = PHASES.get_or_init(|| {
            let rows = calm(&Params::sheets(), NEXT);
            rows.iter().filter_map(phase).collect()
        });
        let apart = |a: i64, b: i64| ((a - b + LEAD / 2).rem_euclid(LEAD) - LEAD / 2).abs();
        // Each pass begins a little farther along the flank.
        let nearest = |phase| expected.iter().map(|one| apart(*one, phase)).min();
        let phases = self.rows[from..].iter().filter_map(phase);
        let worst = phases.filter_map(nearest).max();
        let worst = worst.unwrap_or_else(|| panic!("{what}: no thread"));
        assert!(worst <= 1_000, "{what}: {worst} nm off the helix");
    }
}

/// Of the thread in `NEXT`, in nm.
const LEAD: i64 = 1_000_000;

static PHASES: OnceLock<Vec<i64>> = OnceLock::new();

/// Where Z would be at the index, of a row held to the helix; the same within whole leads for every row of a pass.
fn phase(row: &Row) -> Option<i64> {
    row.error?;
    let turned = i128::from(row.spindle.turns().raw()) * i128::from(LEAD);
    Some(row.position.z.nm() + (turned >> 32) as i64)
}

/// The rows of a program in which nothing goes wrong.
pub fn calm(params: &Params, text: &str) -> Vec<Row> {
    let mut bench = Bench::new(params);
    bench.load(text);
    bench.finish("calm");
    assert_eq!(bench.alarm, None);
    bench.lathe.rows
}

/// Places in `WORK` worth a fault: on the way, in the first stroke of the thread at three depths of it, in the groove.
pub fn places(rows: &[Row]) -> Vec<u64> {
    let locked: Vec<u64> = rows
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| row.tick)
        .collect();
    let in_line = |line: u32| {
        let ticks: Vec<u64> = rows
            .iter()
            .filter(|row| row.line == line)
            .map(|row| row.tick)
            .collect();
        ticks[ticks.len() / 2]
    };
    vec![
        in_line(2),
        locked[0],
        locked[locked.len() / 4],
        locked[locked.len() / 2],
        in_line(7),
        in_line(8),
    ]
}
