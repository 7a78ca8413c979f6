//! One machine and its day: programs, parameters, cuts of power, taps brought out of their holes.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{DriveOptions, Flash, PlantOptions, Ripple, ServoOptions};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::State;
use leadscrew_core::bus::{Abort, BoardState, Object, Order, SdoError};
use leadscrew_core::call::{Call, Position, TapAxis};
use leadscrew_core::link::identity;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Length, Turns};

use super::bench::{Bench, Counts, End, Wire};
use super::by_hand;
use super::drives;
use super::encoder;
use super::operator::{Mood, Operator};
use super::programs::{self, Program};
use super::script::Draws;
use super::watch::Judged;
use crate::gateway::{BATCH, Upload};
use crate::params::set;

/// A program undisturbed, and any stop, is over within so many ticks: two threads of a fine lead by a slow spindle have
/// been seen to take 180 000.
pub(super) const LONGEST: u64 = 1_000_000;

/// What was wrong shows within so many ticks of being put right: three statuses that were lost before, and the turn of a
/// spindle that is looked after in every fourth period.
const AFTERMATH: u64 = 40;

/// A shift.
pub struct Shift {
    pub(super) bench: Bench,
    /// The set that the board has of its own.
    pub(super) built_in: Params,
    /// Number of the last job.
    job: u32,
    /// Number of the last program, and its text.
    program: u32,
    text: String,
}

/// A machine that is not like the built-in one, with a spindle that swings so often (thousandths of a hertz), and its
/// drives of X and Z.
fn machine(r: &mut Draws, swing_mhz: u32) -> (Params, [Option<ServoOptions>; 2]) {
    let mut params = Params::sheets();
    set(&mut params, "9000", r.of(&[1000, 1000, 2000]));
    let latency = r.of(&[0, 0, 1000, 1700, 3000]);
    set(&mut params, "9003.X", latency);
    set(&mut params, "9003.Z", latency);
    // Latency and lag of the drives are no following error here.
    for (axis, limit) in [("X", 6_000_000), ("Z", 6_000_000), ("C", 60_000_000)] {
        set(&mut params, &format!("1828.{axis}"), limit);
    }
    set(&mut params, "9021", r.of(&[4, 4, 8]));
    set(&mut params, "9014", r.of(&[1, 2, 4]));
    encoder::draw(r, &mut params, swing_mhz);
    let servos = drives::draw(r, &mut params);
    (changed(r, &params), servos)
}

/// Other values of what a plant does not depend on.
pub(super) fn changed(r: &mut Draws, params: &Params) -> Params {
    let mut changed = params.clone();
    for axis in ["X", "Z"] {
        set(
            &mut changed,
            &format!("1620.{axis}"),
            r.within(1_500, 4_000) * 1_000_000,
        );
        set(
            &mut changed,
            &format!("1622.{axis}"),
            r.within(30, 120) * 1_000_000_000,
        );
    }
    set(&mut changed, "9008.0", r.within(0, 1));
    set(&mut changed, "5200.5", r.within(0, 1));
    set(&mut changed, "5200.6", r.within(0, 1));
    set(&mut changed, "5261", r.within(100, 800));
    set(&mut changed, "5382", r.within(0, 3_000) * 1000);
    set(&mut changed, "9025", r.within(0, 2));
    if changed.validate().is_ok() {
        changed
    } else {
        params.clone()
    }
}

impl Shift {
    /// Switches a machine on.
    pub fn begin(mut random: Draws) -> Self {
        let size = random.of(&[0, 0, 1]) * random.within(0, 3_000) as u32;
        let ripple = Ripple::new(size, random.within(2_000, 12_000) as u32);
        let (params, servos) = machine(&mut random, ripple.map_or(0, Ripple::milli_hertz));
        let ideal = servos == [None; 2];
        let lag = random.of(&[0, 0, 3]);
        let options = PlantOptions {
            angle: Turns::from_raw(random.within(-(1 << 31), 1 << 31)),
            counter: random.within(-100_000, 100_000) as i32,
            ripple,
            drives: DriveOptions {
                transmission: params.drive_status_syncs() as u8,
                settling: random.within(0, 20) as u16,
                // Of ideal drives.
                lag: if ideal { lag } else { 0 },
                ..DriveOptions::default()
            },
            servos,
            ..PlantOptions::default()
        };
        let wire = random.of(&[
            Wire::default(),
            Wire::default(),
            Wire { lost: 1, twice: 1 },
            Wire { lost: 4, twice: 2 },
        ]);
        let sim = Sim::new(&params, &options).expect("the machine starts");
        Self {
            built_in: params.clone(),
            bench: Bench::new(random, sim, params, options, wire),
            job: 0,
            program: 0,
            text: String::new(),
        }
    }

    /// Ticks so far.
    pub fn ticks(&self) -> u64 {
        self.bench.now
    }

    /// What was done so far.
    pub fn counts(&self) -> &Counts {
        &self.bench.counts
    }

    /// What was judged so far.
    pub fn judged(&self) -> &Judged {
        &self.bench.watch.judged
    }

    /// Number of the job under way, of the last program, and its text.
    pub fn under_way(&self) -> (u32, u32, &str) {
        (self.job, self.program, &self.text)
    }

    /// One program, or something between two of them, and the machine is ready again.
    pub fn work(&mut self) {
        self.job += 1;
        if !self.bench.random.job(self.job) {
            return;
        }
        let choice = self.bench.random.within(0, 99);
        let (name, job): (&str, fn(&mut Self)) = match choice {
            0..=78 => ("a program", Self::run),
            79..=84 => ("the axes by hand", |shift| by_hand::job(&mut shift.bench)),
            85..=92 => ("another set of parameters", Self::push),
            93..=94 => ("a set or value that is refused", Self::refused),
            95 => ("writing is locked", Self::locked),
            96..=97 => ("the power goes", Self::lose_power),
            _ => ("nothing", |shift| shift.bench.stands(50)),
        };
        self.bench.random.tell_job(name);
        job(self);
        self.compare();
        self.drives_stand();
    }

    /// The board has the parameters that the gateway thinks it has.
    fn compare(&mut self) {
        let theirs = self.bench.number(0x1020, 1).expect("the identity");
        assert_eq!(
            theirs,
            u64::from(identity(&self.bench.params)),
            "other parameters"
        );
    }

    /// The drives stand where the board thinks they do, so that the next motion begins where the axes are.
    fn drives_stand(&mut self) {
        let bench = &mut self.bench;
        // As long as it takes one that lags and was held to catch up; one with loops and friction gets there by itself.
        bench.stands(100);
        let near = |bench: &mut Bench| {
            let at = bench.position();
            let loads = bench.sim.plant().truth().loads;
            let mut axes = loads.iter().zip([at.x, at.z]).zip(bench.assumed);
            axes.all(|((load, told), assumed)| {
                let off = load.map_or(Length::ZERO, |load| load - told);
                assumed || off.nm().abs() <= drives::AT_REST_NM
            })
        };
        for _ in 0..100 {
            if near(bench) {
                break;
            }
            bench.stands(10);
        }
        assert!(
            near(bench),
            "the tool stands elsewhere: {:?}, told {:?}",
            bench.sim.plant().truth().loads,
            bench.position()
        );
        let ideal = bench.options.servos.map(|servo| servo.is_none());
        let at = bench.position();
        let truth = bench.sim.plant().truth();
        let told = [at.x.nm(), at.z.nm(), at.c.udeg()];
        for (place, (truth, told)) in truth.positions.into_iter().zip(told).enumerate() {
            // One increment is 100 nm, or as many millionths of a degree.
            let off = i64::from(truth.get()) * 100 - told;
            let ideal = ideal.get(place).copied().unwrap_or(true);
            assert!(
                !ideal || off.abs() <= 100 || bench.assumed[place],
                "axis {place} stands {off} beside where it is told to be"
            );
        }
    }

    fn lose_power(&mut self) {
        self.bench.sim.cut_power();
        self.power_up();
    }

    fn run(&mut self) {
        let bench = &mut self.bench;
        let (from, params) = (bench.position(), &bench.params);
        let program = bench.random.program(
            |random| programs::random(random, params, from),
            |text| programs::again(text, params, from),
        );
        bench.counts.programs += 1;
        bench.watch.expect(&program.grooves);
        self.program += 1;
        self.text.clone_from(&program.text);
        let r = &mut bench.random;
        let patience = r.within(500, 12_000) as u64;
        let away = Mood::AWAY;
        bench.operator.mood = match r.within(0, 9) {
            0 | 1 => away,
            2 | 3 => Mood {
                every: r.within(50, 1_000),
                ..away
            },
            4 => Mood {
                every: r.within(20, 400),
                cuts: true,
                ..away
            },
            5 => Mood {
                every: r.within(50, 600),
                ends: true,
                ..away
            },
            6 | 7 => Mood {
                every: r.within(50, 800),
                ends: true,
                breaks: true,
                ..away
            },
            8 => Mood {
                every: r.within(100, 2_000),
                breaks: true,
                ..away
            },
            _ => Mood {
                every: r.within(20, 600),
                ends: true,
                breaks: true,
                cuts: true,
            },
        };
        let calm_from = bench.now + patience;
        bench.end = None;
        let mut upload = Upload::new(self.program, &program.calls);
        upload.most = bench.random.of(&[u32::MAX, u32::MAX, 3, 1]);
        let (mut begun, mut ordered, mut calm) = (false, false, false);
        while bench.end.is_none() {
            if !calm && bench.now >= calm_from {
                calm = true;
                Operator::put_right(bench);
            }
            if calm && bench.now.is_multiple_of(64) {
                carry_on(bench);
            }
            assert!(
                bench.now < calm_from + LONGEST,
                "it does not come to an end: {:?} {:?}, begun {begun}, ordered {ordered}, {} calls not sent",
                bench.state(),
                bench.status,
                upload.waiting()
            );
            match feed(bench, &mut upload) {
                // A reset before the program had begun. Or the operator has ordered "run" for the first calls of a program
                // whose gateway is gone: nobody sends the rest.
                Fed::Closed if !ordered => {
                    if matches!(bench.state(), State::Running | State::Held) {
                        bench.ordered(Order::Reset);
                    }
                    break;
                }
                Fed::Taken => begun = true,
                _ => {}
            }
            let run = begun && !ordered && (upload.is_done() || bench.random.chance(30));
            if run && bench.end.is_none() {
                bench.ordered(Order::Run);
                ordered = true;
            }
            bench.tick();
        }
        self.after(&program);
        self.text = String::new();
    }

    /// Behind a program: whatever became of it, the machine is ready for the next.
    fn after(&mut self, program: &Program) {
        let bench = &mut self.bench;
        bench.operator.mood = Mood::AWAY;
        match bench.end {
            Some(End::Finished) => {
                bench.counts.finished += 1;
                let at = bench.position();
                assert_eq!((at.x.nm(), at.z.nm()), program.end, "not where it ends");
            }
            Some(End::PowerCut) => {
                self.power_up();
                return;
            }
            _ => {}
        }
        self.recover();
    }

    /// Out of whatever the machine is in, until it is idle; a tap that is in its hole comes out.
    fn recover(&mut self) {
        let bench = &mut self.bench;
        bench.until("a stop", LONGEST, |bench| {
            matches!(bench.state(), State::Idle | State::Alarm(_)) || bench.operator.is_well()
        });
        bench.until("a stop", LONGEST, |bench| {
            matches!(bench.state(), State::Idle | State::Alarm(_))
        });
        if matches!(bench.state(), State::Alarm(alarm) if alarm.code == Code::NetworkStop) {
            // A node that is reset stops on this alarm first, and begins anew once its drives stand (9003).
            bench.until("a node that begins anew", LONGEST, |bench| {
                !bench.sim.is_busy()
            });
        }
        let pause = bench.random.within(20, 200) as u64;
        bench.stands(pause);
        if !bench.sim.has_power() {
            // With what was to be stored of the stop.
            self.power_up();
            return;
        }
        let whole = bench.operator.is_well();
        let stood = bench.position();
        settle(bench);
        // They are sent again, but a program would still miss them before one has arrived.
        bench.until("a heartbeat", LONGEST, |bench| !bench.misses_beat());
        bench.until("an order before", LONGEST, |bench| !bench.is_ordering());
        if !whole {
            bench.stands(AFTERMATH);
            axes_stand(bench);
            bench.until("a stop", LONGEST, |bench| {
                matches!(bench.state(), State::Idle | State::Alarm(_))
            });
        }
        while matches!(bench.state(), State::Alarm(_)) {
            bench.ordered(Order::Reset);
            bench.until("a reset", LONGEST, |bench| {
                matches!(bench.state(), State::Idle | State::Alarm(_))
            });
        }
        if whole {
            bench.keeps(stood);
        }
        forget_causes(bench);
        bench.until("the drives", LONGEST, |bench| {
            bench.state() == State::Idle && bench.says(BoardState::Idle)
        });
        if bench.in_hole() {
            self.bring_out();
        }
    }
}

impl Shift {
    /// The power is back: what is stored is what the board knows. A tap that was below R is known to be there.
    pub(super) fn power_up(&mut self) {
        let bench = &mut self.bench;
        bench.counts.cuts += 1;
        let at = bench.position();
        let record = bench.sim.board().tap_record().copied();
        let inside = record
            .filter(|record| record.in_hole)
            .map(|record| record.hole)
            .filter(|hole| hole.depth(hole.axis.of(at)) > Length::ZERO);
        let r = &mut bench.random;
        // Drives that count absolutely, or from where they are switched on.
        bench.options.at = if r.chance(50) {
            at
        } else {
            Position::default()
        };
        bench.options.angle = Turns::from_raw(r.within(-(1 << 31), 1 << 31));
        let image = bench.sim.flash().image();
        let flash = Flash::from_image(&image).expect("an image");
        bench.sim = Sim::with_flash(&self.built_in, &bench.options, flash).expect("it starts");
        bench.slipped = false;
        bench.watch.set_slipped(false);
        // Where another set was being stored, it is the old one or the new one that the way out of a hole keeps to.
        bench.watch.set_params(bench.sim.board().params());
        bench.operator.spoilt = None;
        bench.connect();
        if let Some(hole) = inside {
            let stored = bench.sim.board().tap_record();
            // The entry of a deeper bottom may have been on its way, and the tap not further than the old one yet.
            let known = stored
                .filter(|record| record.in_hole)
                .is_some_and(|record| {
                    let same = (record.hole.axis, record.hole.level) == (hole.axis, hole.level);
                    let depth = record.hole.depth(hole.axis.of(at));
                    same && depth <= record.hole.depth(record.hole.bottom)
                });
            assert!(known, "a tap is forgotten in {hole:?}: {stored:?}");
        }
        bench.assumed = [false; 3];
        if let Some(record) = bench
            .sim
            .board()
            .tap_record()
            .filter(|record| record.in_hole)
        {
            // The bottom is taken for its place until the power goes again, or the entry is dropped.
            let place = match record.hole.axis {
                TapAxis::X => 0,
                TapAxis::Z => 1,
            };
            bench.assumed[place] = true;
        }
        self.recover();
    }

    /// G30 P99, or somebody says that there is no tap.
    fn bring_out(&mut self) {
        let bench = &mut self.bench;
        let record = bench.sim.board().tap_record().expect("a record");
        let hole = record.hole;
        if bench.random.chance(15) {
            self.is_refused();
        }
        let bench = &mut self.bench;
        if bench.random.chance(10) {
            let drop = Object::new(0x5030, 2);
            // The position of the drive counts again where it had been lost.
            bench.watch.set_replaces(true);
            // Where the answer was lost there is nothing left to drop at the second time.
            let _ = bench.write(drop, b"drop", &[Abort::State, Abort::NoData]);
            bench.ticks(3);
            bench.watch.set_replaces(false);
            bench.assumed = [false; 3];
            assert!(!bench.in_hole(), "it was dropped");
            return;
        }
        let from = bench.position();
        let calls = programs::read(
            "G30 P99
M30
",
            &bench.params,
            from,
        );
        let end = self.carry_out(&calls);
        let bench = &mut self.bench;
        assert_eq!(end, End::Finished, "a return");
        let beyond = bench.params.tap_return_extra().times(hole.inward());
        let at = bench.position();
        // A drive that stood where it was not told to stand may have left the tap further out than that.
        let end = hole.level - beyond;
        let out = hole.depth(hole.axis.of(from)) <= hole.depth(end);
        let end = if out { hole.axis.of(from) } else { end };
        assert_eq!(hole.axis.of(at), end, "R and 5382 beyond");
        let others = |position| hole.axis.with(position, Length::ZERO);
        assert_eq!(others(at), others(from), "the other axes");
        assert!(!bench.in_hole(), "the tap is out");
        bench.counts.returns += 1;
    }

    /// With a tap in its hole nothing but the return moves.
    fn is_refused(&mut self) {
        let bench = &mut self.bench;
        bench.operator.cause(&[Code::TapInHole]);
        let from = bench.position();
        let calls = programs::read(
            "G0 X77 Z33
M30
",
            &bench.params,
            from,
        );
        let end = self.carry_out(&calls);
        assert!(
            matches!(end, End::Alarm(alarm) if alarm.code == Code::TapInHole),
            "{end:?}"
        );
        let bench = &mut self.bench;
        assert_eq!(bench.position(), from, "it moved with a tap in its hole");
        bench.stands(20);
        bench.ordered(Order::Reset);
        bench.until("a reset", LONGEST, |bench| {
            bench.state() == State::Idle && bench.says(BoardState::Idle)
        });
        forget_causes(bench);
    }

    /// A program that nobody disturbs.
    fn carry_out(&mut self, calls: &[Call]) -> End {
        let bench = &mut self.bench;
        self.program += 1;
        let begun = bench.now;
        bench.end = None;
        let mut upload = Upload::new(self.program, calls);
        while !upload.is_done() && bench.end.is_none() {
            feed(bench, &mut upload);
            bench.tick();
        }
        bench.ordered(Order::Run);
        loop {
            if let Some(end) = bench.end {
                return end;
            }
            assert!(bench.now < begun + LONGEST, "it does not come to an end");
            if bench.now.is_multiple_of(64) {
                // A hold that came after the last program holds this one.
                carry_on(bench);
            }
            bench.tick();
        }
    }
}

/// Everything is put right, and the board knows: a frame that says so may be lost.
fn settle(bench: &mut Bench) {
    loop {
        Operator::put_right(bench);
        let operator = bench.sim.board().ticker().operator();
        let percents = [
            operator.feed_percent(),
            operator.rapid_percent(),
            operator.spindle_percent(),
        ];
        let well = bench.operator.spoilt.is_none();
        if percents == [100; 3] && !operator.single_block && well {
            return;
        }
        bench.tick();
    }
}

/// Waits until the axes stand, wherever that is. An axis that a second master has dragged away comes back by itself, and
/// whoever resets before that is told of the rest of its way.
fn axes_stand(bench: &mut Bench) {
    let loads = |bench: &mut Bench| bench.sim.plant().truth().loads;
    let mut still = 0;
    for _ in 0..100 {
        let before = loads(bench);
        bench.stands(10);
        // Where one turns round it stands for a moment.
        still = if loads(bench) == before { still + 1 } else { 0 };
        if still == 2 {
            return;
        }
    }
}

/// Everything is well, and has shown that it is; but for an encoder that has slipped and not been found out.
fn forget_causes(bench: &mut Bench) {
    let but: &[Code] = if bench.slipped {
        &[Code::IndexSlipped, Code::NoIndex]
    } else {
        &[]
    };
    bench.operator.forget_causes(but);
}

/// Who waits for a held program lets it go on.
fn carry_on(bench: &mut Bench) {
    Operator::put_right(bench);
    if bench.status.flags.hold || bench.says(BoardState::Hold) {
        bench.order(Order::Resume);
    }
}

/// What became of a batch.
enum Fed {
    /// The board has it.
    Taken,
    /// There is none, or no room for it now.
    Nothing,
    /// The board takes no more of this program.
    Closed,
}

/// Sends one batch where there is room for it.
fn feed(bench: &mut Bench, upload: &mut Upload) -> Fed {
    let credit = bench.status.credit.min(u16::MAX.into()) as u16;
    let Some((bytes, count)) = upload.batch(credit) else {
        return Fed::Nothing;
    };
    let expected = [Abort::State, Abort::OutOfMemory];
    match bench.write(BATCH, &bytes, &expected) {
        Ok(()) => {
            upload.taken(count);
            Fed::Taken
        }
        Err(SdoError::Refused(code)) if code == Abort::State.code() => Fed::Closed,
        // The credit was that of some ticks ago.
        Err(_) => Fed::Nothing,
    }
}
