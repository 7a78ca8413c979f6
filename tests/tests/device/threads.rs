//! A certificate for each thread and each hole [D169]: what counts as one, how many passes and ticks, what became of it.

use std::collections::BTreeMap;

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{DriveOptions, PlantOptions, Ripple};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::bus::{NmtState, NodeId, Object, Order, SdoProtocol};
use leadscrew_core::call::{Call, CallKind};
use leadscrew_core::cycle::ThreadMoves;
use leadscrew_core::link::ThreadKind::{self, FloatingTap, RigidTap, Thread};
use leadscrew_core::link::ThreadState::{self, CutShort, Finished, UnderWay};
use leadscrew_core::link::{
    Certificate, ImageWriter, ThreadCertificate, ThreadReader, ThreadRecord,
};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::Length;
use leadscrew_tests::gateway::{Gateway, Upload};
use leadscrew_tests::machine::{STANDING_TICKS, calls, machine};
use leadscrew_tests::random::Random;

/// Two rough passes and a finishing one.
const THREAD: &str = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nG0 X100 Z50\nM30\n";

fn with(number: &str, value: i64) -> Params {
    let mut params = Params::sheets();
    let entry = Entry::find_text(number).expect("a parameter");
    params.set(entry, value).expect("in its range");
    params
}

/// The result of running a program.
#[derive(Default)]
struct Cut {
    /// Every thread that was reported, by number.
    threads: BTreeMap<u32, ThreadRecord>,
    /// Locked ticks, by line.
    locked: BTreeMap<u32, u64>,
    run: Option<Certificate>,
}

impl Cut {
    /// Line, kind, state and passes of each.
    fn told(&self) -> Vec<(u32, ThreadKind, ThreadState, u16)> {
        let numbers: Vec<u32> = self.threads.keys().copied().collect();
        assert_eq!(numbers, (1..=numbers.len() as u32).collect::<Vec<_>>());
        self.threads
            .values()
            .map(|record| (record.line, record.kind, record.state, record.tally.passes))
            .collect()
    }

    /// All threads together must give the sums of the run.
    fn sums_agree(&self) {
        let run = self.run.expect("the certificate of the run");
        let tallies = || self.threads.values().map(|record| record.tally);
        let measured: u64 = tallies().map(|tally| u64::from(tally.measured)).sum();
        let squares: u64 = tallies().map(|tally| tally.squares).sum();
        let largest = tallies().map(|tally| tally.largest).max();
        assert_eq!(
            (measured, squares, largest.unwrap_or(Length::ZERO)),
            (run.measured, run.squares, run.largest)
        );
    }
}

fn look(sim: &Sim, cut: &mut Cut) {
    for thread in sim.board().device().threads() {
        cut.threads.insert(thread.number, thread.record);
    }
}

/// Cuts the program on a board on the bus, and reads what the board reports at its end.
fn cut_calls(
    calls: Vec<Call>,
    params: &Params,
    options: &PlantOptions,
    mut operate: impl FnMut(&mut Sim, u64),
) -> Cut {
    let mut sim = machine(params, options);
    let mut gateway = Gateway::connect(&mut sim);
    let mut waiting = calls.into_iter().peekable();
    let mut cut = Cut::default();
    let mut ticks = 0;
    let mut standing = 0;
    while standing < STANDING_TICKS {
        while waiting.peek().is_some_and(|call| sim.offer(call)) {
            waiting.next();
        }
        operate(&mut sim, ticks);
        if let Some(row) = sim.step()
            && row.error.is_some()
        {
            *cut.locked.entry(row.line).or_default() += 1;
        }
        gateway.listen(&mut sim);
        gateway.heard.clear();
        ticks += 1;
        assert!(ticks < 1_000_000, "the machine does not come to an end");
        let mut stopped = false;
        while let Some(event) = sim.event() {
            stopped |= matches!(event, Event::Alarm(_) | Event::Reset);
        }
        if stopped {
            waiting = Vec::new().into_iter().peekable();
        }
        if ticks % 50 == 0 {
            look(&sim, &mut cut);
        }
        let over = waiting.peek().is_none() && !sim.is_busy();
        standing = if over { standing + 1 } else { 0 };
    }
    look(&sim, &mut cut);
    let bytes = gateway
        .read(&mut sim, Object::new(0x5041, 0), SdoProtocol::Block)
        .expect("the certificates");
    cut.run = Some(Certificate::decode(&bytes).unwrap().unwrap());
    let told: Vec<_> = ThreadReader::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let last = cut.threads.iter().rev().take(5);
    assert!(last.eq(told.iter().map(|thread| (&thread.number, &thread.record))));
    let segmented = gateway.read(&mut sim, Object::new(0x5041, 0), SdoProtocol::Segmented);
    assert_eq!(segmented, Ok(bytes));
    cut.sums_agree();
    cut
}

fn cut(text: &str) -> Cut {
    let params = Params::sheets();
    let nothing = |_: &mut Sim, _: u64| {};
    cut_calls(
        calls(text, &params),
        &params,
        &PlantOptions::default(),
        nothing,
    )
}

fn example(name: &str) -> Cut {
    let path = format!("{}/../examples/{name}", env!("CARGO_MANIFEST_DIR"));
    cut(&std::fs::read_to_string(path).expect("the example"))
}

#[test]
fn a_cycle_with_all_its_passes_is_one_thread() {
    let cut = example("o0013-g76-m68x6.nc");
    assert_eq!(cut.told(), [(6, Thread, Finished, 6)]);
    let tally = cut.threads[&1].tally;
    // Every tick in which the axis is on the helix.
    assert_eq!(u64::from(tally.measured), cut.locked[&6]);
    assert_eq!(tally.late, 0);
    assert!(tally.largest < Length::from_nm(1000), "{tally:?}");
}

#[test]
fn each_start_is_a_pass() {
    let cut = example("g78-two-start.nc");
    let [(6, Thread, Finished, passes)] = cut.told()[..] else {
        panic!("{:?}", cut.told());
    };
    assert_eq!(passes % 2, 0);
    let depths = {
        let text = std::fs::read_to_string(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../examples/g78-two-start.nc"
        ))
        .expect("the example");
        let params = Params::sheets();
        calls(&text, &params)
            .iter()
            .filter_map(|call| match &call.kind {
                CallKind::Thread(thread) => ThreadMoves::new(thread, call.span).ok(),
                _ => None,
            })
            .map(|moves| moves.summary().passes)
            .sum::<u32>()
    };
    assert_eq!(u32::from(passes), 2 * depths);
}

#[test]
fn each_hole_is_one_however_it_is_pecked() {
    assert_eq!(
        example("g84-bolt-circle.nc").told(),
        [
            (5, RigidTap, Finished, 1),
            (6, RigidTap, Finished, 1),
            (7, RigidTap, Finished, 1),
            (8, RigidTap, Finished, 1),
        ]
    );
    assert_eq!(
        example("g84-floating.nc").told(),
        [(5, FloatingTap, Finished, 1)]
    );
    let text = "G98\nG0 X50 Z0\nM29 S1000\nG84 Z-50 Q4.0 P30 F2000\nG80\nM30\n";
    for deep in [0, 1] {
        let params = with("5200.5", deep);
        let cut = cut_calls(
            calls(text, &params),
            &params,
            &PlantOptions::default(),
            |_, _| {},
        );
        assert_eq!(cut.told(), [(4, RigidTap, Finished, 1)], "{deep}");
    }
    // K makes several holes from one block.
    let holes = cut("G98\nG0 X0 Z5\nM29 S600\nG84 Z-12 R-3 F600 K3\nG80\nM30\n");
    assert_eq!(holes.told(), [(4, RigidTap, Finished, 1); 3]);
}

#[test]
fn the_same_block_twice_is_two_threads() {
    let params = Params::sheets();
    let mut twice = calls(THREAD, &params);
    let place = twice
        .iter()
        .position(|call| matches!(call.kind, CallKind::Thread(_)))
        .expect("a thread");
    twice.insert(place, twice[place]);
    let cut = cut_calls(twice, &params, &PlantOptions::default(), |_, _| {});
    assert_eq!(cut.told(), [(5, Thread, Finished, 3); 2]);
}

#[test]
fn a_program_behind_another_counts_on() {
    let params = Params::sheets();
    let mut two = calls(THREAD, &params);
    two.extend(calls(THREAD, &params));
    let cut = cut_calls(two, &params, &PlantOptions::default(), |_, _| {});
    assert_eq!(cut.told(), [(5, Thread, Finished, 3); 2]);
}

/// Waits for the middle of a stroke: 400 ticks in.
struct Stroke {
    pass: u16,
    ticks: u32,
}

impl Stroke {
    /// Of pass number `pass`, from 1.
    const fn of(pass: u16) -> Self {
        Self { pass, ticks: 0 }
    }

    /// True once.
    fn is_half(&mut self, sim: &Sim) -> bool {
        let newest = sim.board().device().threads().next();
        let cuts = |record: ThreadRecord| record.tally.passes == self.pass;
        if sim.board().helix().is_some() && newest.is_some_and(|thread| cuts(thread.record)) {
            self.ticks += 1;
        }
        self.ticks == 400 && {
            self.ticks += 1;
            true
        }
    }
}

#[test]
fn a_stroke_that_is_left_by_a_hold_is_done_again_and_counts_again() {
    for (retracts, passes) in [(0, 3), (1, 4)] {
        let params = with("9008.0", retracts);
        // In the last pass: all passes have begun, and not all are cut.
        let mut stroke = Stroke::of(3);
        let mut held = 0;
        let cut = cut_calls(
            calls(THREAD, &params),
            &params,
            &PlantOptions::default(),
            |sim, _| {
                if stroke.is_half(sim) {
                    sim.command(Command::Hold);
                }
                held += u64::from(sim.board().ticker().state() == State::Held);
                if held == 300 {
                    sim.command(Command::Resume);
                    held += 1;
                }
            },
        );
        assert!(held > 300);
        assert_eq!(cut.told(), [(5, Thread, Finished, passes)], "{retracts}");
    }
}

#[test]
fn a_thread_is_cut_short_by_a_reset_and_by_an_alarm() {
    let params = Params::sheets();
    for (pass, command) in [
        (1, Command::Reset),
        (3, Command::Reset),
        (2, Command::Stop),
        (3, Command::Stop),
    ] {
        let mut stroke = Stroke::of(pass);
        let cut = cut_calls(
            calls(THREAD, &params),
            &params,
            &PlantOptions::default(),
            |sim, _| {
                if stroke.is_half(sim) {
                    sim.command(command);
                }
            },
        );
        assert_eq!(
            cut.told(),
            [(5, Thread, CutShort, pass)],
            "{command:?} in pass {pass}"
        );
    }
    // A hold in the last pass retracts the tool, and then the program is given up.
    let params = with("9008.0", 1);
    let (mut stroke, mut held) = (Stroke::of(3), 0);
    let cut = cut_calls(
        calls(THREAD, &params),
        &params,
        &PlantOptions::default(),
        |sim, _| {
            if stroke.is_half(sim) {
                sim.command(Command::Hold);
            }
            held += u32::from(sim.board().ticker().state() == State::Held);
            if held == 100 {
                sim.command(Command::Reset);
            }
        },
    );
    assert_eq!(cut.told(), [(5, Thread, CutShort, 3)]);
}

/// After the last pass the thread is complete, whatever becomes of the program; what is cut after a reset is another
/// thread.
#[test]
fn a_thread_that_is_done_stays_done() {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let feed = |sim: &mut Sim, stop_on: Option<u32>| {
        let mut waiting = calls(THREAD, &params).into_iter().peekable();
        loop {
            while waiting.peek().is_some_and(|call| sim.offer(call)) {
                waiting.next();
            }
            sim.step();
            let mut over = waiting.peek().is_none() && !sim.is_busy();
            while let Some(event) = sim.event() {
                if let (Event::Started { line, .. }, Some(stop)) = (event, stop_on)
                    && line == stop
                {
                    sim.command(Command::Reset);
                    waiting = Vec::new().into_iter().peekable();
                }
                over |= event == Event::Reset;
            }
            if over {
                break;
            }
        }
    };
    // In the rapid after the thread.
    feed(&mut sim, Some(6));
    feed(&mut sim, None);
    let told: Vec<_> = sim
        .board()
        .device()
        .threads()
        .map(|thread| (thread.number, thread.record.line, thread.record.state))
        .collect();
    assert_eq!(told, [(2, 5, Finished), (1, 5, Finished)]);
}

#[test]
fn an_error_shows_in_the_thread_in_which_it_was() {
    let text = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nG0 X80 Z10\nG76 X76 Z-30 P20000 Q15000 F3\nG0 X80 Z10\nG76 X76 Z-30 P20000 Q15000 F3\nM30\n";
    let params = Params::sheets();
    let options = PlantOptions::default();
    let quiet = cut_calls(calls(text, &params), &params, &options, |_, _| {});
    let mut share = 100;
    let disturbed = cut_calls(calls(text, &params), &params, &options, |sim, tick| {
        let second = sim
            .board()
            .device()
            .threads()
            .next()
            .is_some_and(|thread| thread.number == 2 && thread.record.state == UnderWay);
        // A load that comes and goes takes a fifth of its speed.
        let now = if second && tick % 100 < 50 { 80 } else { 100 };
        if now != share {
            share = now;
            sim.plant().spindle().disturb(share);
        }
    });
    let expected = [
        (5, Thread, Finished, 3),
        (7, Thread, Finished, 3),
        (9, Thread, Finished, 3),
    ];
    assert_eq!(quiet.told(), expected);
    assert_eq!(disturbed.told(), expected);
    let largest = |cut: &Cut| [1, 2, 3].map(|number| cut.threads[&number].tally.largest.nm());
    assert_eq!(largest(&quiet), [0, 0, 0]);
    let [first, second, third] = largest(&disturbed);
    assert_eq!((first, third), (0, 0));
    assert!((300..1000).contains(&second), "{second}");
}

/// Threads and holes in any order: each has its own record, and together they give the run.
#[test]
fn random_programs_add_up() {
    leadscrew_seed::volume(0x5041, |seed| {
        let mut r = Random(seed);
        let params = Params::sheets();
        for program in 0..leadscrew_seed::amount(4, 12) {
            let mut text = String::from("G98\nG0 X80 Z10\n");
            let mut expected = Vec::new();
            let mut line = 2;
            for _ in 0..r.within(3, 10) {
                if r.chance(50) {
                    let (depth, first) = (r.within(3, 20), r.within(2, 9));
                    text.push_str(&format!(
                    "M3 S{}\nG0 X80 Z10\nG76 P010060 Q200 R0.05\nG76 X{} Z-{} P{}000 Q{}000 F{}\nM5\n",
                    r.within(200, 900),
                    80.0 - depth as f64 / 5.0,
                    r.within(5, 30),
                    depth,
                    first.min(depth),
                    r.of(&["1", "1.5", "3"]),
                ));
                    expected.push((line + 4, Thread));
                    line += 5;
                } else {
                    let holes = r.within(1, 3);
                    let rigid = r.chance(60);
                    let begin = if rigid { "M29" } else { "M3" };
                    text.push_str(&format!(
                        "G0 X0 Z5\n{begin} S{}\nG84 Z-{} R-3 F{} K{holes}\nG80\n",
                        r.within(200, 600),
                        r.within(4, 15),
                        r.within(200, 500),
                    ));
                    let kind = if rigid { RigidTap } else { FloatingTap };
                    expected.extend(std::iter::repeat_n((line + 3, kind), holes as usize));
                    line += 4;
                    if !rigid {
                        text.push_str("M5\n");
                        line += 1;
                    }
                }
            }
            text.push_str("M30\n");
            let options = PlantOptions {
                ripple: r.chance(50).then(|| Ripple::new(2_000, 5_000)).flatten(),
                ..PlantOptions::default()
            };
            let cut = cut_calls(calls(&text, &params), &params, &options, |_, _| {});
            let told: Vec<_> = cut.told().iter().map(|told| (told.0, told.1)).collect();
            assert_eq!(told, expected, "program {program}\n{text}");
            assert!(
                cut.told().iter().all(|told| told.2 == Finished),
                "{:?}",
                cut.told()
            );
        }
    });
}

/// A hole that is left at its bottom goes on with the next block; a way out by itself is on the line of the hole, too.
#[test]
fn a_hole_that_stays_locked_goes_on_as_the_same() {
    let text = "G98\nG0 X0 Z5\nM29 S600\nG84 Z-8 R-3 F600 K198\nG84 Z-14 F600\nG80\nG0 X0 Z5\nM29 S600\nG84 Z-8 R-3 F600\nG80\nM30\n";
    let holes = cut(text);
    assert_eq!(
        holes.told(),
        [(4, RigidTap, Finished, 1), (9, RigidTap, Finished, 1)]
    );
}

#[test]
fn a_way_out_belongs_to_its_hole_and_is_one_of_its_own_behind_a_reset() {
    let begun = "G98\nG0 X0 Z5\nM29 S600\nG84 Z-8 R-3 F600 K198\n";
    let whole = format!("{begun}G30 P99\nM30\n");
    let in_one = cut(&whole);
    assert_eq!(in_one.told(), [(4, RigidTap, Finished, 1)]);
    let params = Params::sheets();
    let mut told = Vec::new();
    let mut sim = machine(&params, &PlantOptions::default());
    for (text, resets) in [(&whole[..], true), ("G30 P99\nM30\n", false)] {
        let mut calls = calls(text, &params);
        if resets {
            // The program does not get so far.
            calls.retain(|call| !matches!(call.kind, CallKind::TapReturn(_) | CallKind::End(_)));
        }
        let mut waiting = calls.into_iter().peekable();
        for tick in 0..20_000 {
            while waiting.peek().is_some_and(|call| sim.offer(call)) {
                waiting.next();
            }
            if resets && tick == 15_000 {
                sim.command(Command::Reset);
            }
            sim.step();
            while sim.event().is_some() {}
        }
        let newest = sim.board().device().threads().next().expect("a hole");
        told.push((newest.number, newest.record.line, newest.record.state));
    }
    assert_eq!(told, [(1, 4, CutShort), (2, 1, Finished)]);
}

/// What is planned anew after a push is another thread.
#[test]
fn a_push_between_makes_no_one_thread_of_two() {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    feed_to(&mut sim, THREAD, &params, |_, _| {});
    let pushed = with("9007", 7);
    let mut image = vec![0; ImageWriter::BYTES as usize];
    ImageWriter::with_password(&pushed).read(0, &mut image);
    gateway
        .write(&mut sim, Object::new(0x5010, 1), &image, SdoProtocol::Block)
        .expect("it is taken");
    let mut ready = false;
    while !ready {
        sim.step();
        gateway.listen(&mut sim);
        while let Some(event) = sim.event() {
            ready |= event == Event::Ready;
        }
    }
    feed_to(&mut sim, THREAD, &pushed, |_, _| {});
    assert_eq!(kept(&sim), [(5, Thread, Finished, 3); 2]);
}

/// Line, kind, state and passes of the threads that the board keeps, the first thread first.
fn kept(sim: &Sim) -> Vec<(u32, ThreadKind, ThreadState, u16)> {
    let mut kept: Vec<_> = sim
        .board()
        .device()
        .threads()
        .map(|ThreadCertificate { record, .. }| {
            (record.line, record.kind, record.state, record.tally.passes)
        })
        .collect();
    kept.reverse();
    kept
}

/// Runs the program until it ends or is stopped; `note` is told every event.
fn feed_to(
    sim: &mut Sim,
    text: &str,
    params: &Params,
    mut note: impl FnMut(&mut Sim, Option<&Event>),
) {
    let mut waiting = calls(text, params).into_iter().peekable();
    for _ in 0..100_000 {
        while waiting.peek().is_some_and(|call| sim.offer(call)) {
            waiting.next();
        }
        note(sim, None);
        sim.step();
        let mut over = waiting.peek().is_none() && !sim.is_busy();
        while let Some(event) = sim.event() {
            over |= event == Event::Reset;
            note(sim, Some(&event));
        }
        over |= matches!(sim.board().ticker().state(), State::Alarm(_));
        if over {
            // What the last tick has brought.
            sim.step();
            while sim.event().is_some() {}
            return;
        }
    }
    panic!("the machine does not come to an end");
}

#[test]
fn a_hole_that_is_left_is_whole_whatever_comes() {
    let params = Params::sheets();
    let cases = [
        ("M29 S1000", "F2000", RigidTap),
        ("M3 S300", "F300", FloatingTap),
    ];
    for (begin, feed, kind) in cases {
        let hole = format!("G98\nG0 X50 Z0\n{begin}\nG84 Z-20 P30 {feed}\n");
        // The machine stops after the hole, and the program is given up there.
        let mut sim = machine(&params, &PlantOptions::default());
        let mut held = 0;
        let text = format!("{hole}G80\nG0 X60\nM30\n");
        feed_to(&mut sim, &text, &params, |sim, event| {
            if let Some(Event::Started { line: 4, .. }) = event {
                sim.command(Command::SingleBlock(true));
            }
            held += u32::from(sim.board().ticker().state() == State::Held);
            if held == 50 {
                held += 1;
                sim.command(Command::Reset);
            }
        });
        assert!(held > 50);
        assert_eq!(kept(&sim), [(4, kind, Finished, 1)]);
        // The next block is refused.
        let mut sim = machine(&params, &PlantOptions::default());
        let text = format!("{hole}G84 Z-9000 P30 {feed}\nM30\n");
        feed_to(&mut sim, &text, &params, |_, _| {});
        assert!(matches!(sim.board().ticker().state(), State::Alarm(_)));
        assert_eq!(kept(&sim), [(4, kind, Finished, 1)]);
        // In the hole, at its beginning and nearer to its end: that one is not.
        for command in [Command::Reset, Command::Stop] {
            for at in [1, 100, 400, 700, 1000] {
                let mut sim = machine(&params, &PlantOptions::default());
                feed_to(&mut sim, &hole, &params, |sim, event| {
                    let newest = sim.board().device().threads().next();
                    let measured = newest.map_or(0, |thread| thread.record.tally.measured);
                    if event.is_none() && measured == at {
                        sim.command(command);
                    }
                });
                assert_eq!(kept(&sim), [(4, kind, CutShort, 1)], "{command:?} {at}");
            }
        }
    }
}

/// A block that is refused after a hole or a thread may have the same line number: a subprogram called again, another file.
#[test]
fn what_is_refused_on_the_same_line_cuts_nothing_short() {
    let params = Params::sheets();
    let cases = [
        (
            "M29 S1000",
            "G84 Z-20 P30 F2000",
            "G84 Z-9000 P30 F2000",
            RigidTap,
        ),
        (
            "M3 S300",
            "G84 Z-20 P30 F300",
            "G84 Z-9000 P30 F300",
            FloatingTap,
        ),
        (
            "M3 S300\nG4 P500\nG76 P010560 Q1500 R0.1",
            "G76 X46 Z-30 P20000 Q15000 F3",
            "G76 X46 Z-9000 P20000 Q15000 F3",
            Thread,
        ),
    ];
    for (begin, good, bad, kind) in cases {
        let text = format!("G98\nG0 X50 Z0\n{begin}\n{good}\n{bad}\nM30\n");
        let mut told = calls(&text, &params);
        let lines: Vec<u32> = told.iter().map(|call| call.span.line).collect();
        let of = |line: &str| text.lines().position(|of| of == line).unwrap() as u32 + 1;
        let (first, second) = (of(good), of(bad));
        assert!(lines.contains(&second), "{lines:?}");
        for call in told.iter_mut().filter(|call| call.span.line == second) {
            call.span.line = first;
        }
        let cut = cut_calls(told, &params, &PlantOptions::default(), |_, _| {});
        let passes = if kind == Thread { 3 } else { 1 };
        assert_eq!(cut.told(), [(first, kind, Finished, passes)]);
    }
}

/// An alarm in the very tick after the last tick of a hole, and in the tick before: the hole's own end counts.
#[test]
fn a_hole_is_whole_from_its_last_tick_on() {
    let params = Params::sheets();
    let hole = "G98\nG0 X50 Z0\nM29 S1000\nG84 Z-20 P30 F2000\n";
    let (mut sim, mut tick, mut last) = (machine(&params, &PlantOptions::default()), 0, None);
    feed_to(
        &mut sim,
        &format!("{hole}G80\nM30\n"),
        &params,
        |sim, event| {
            if event.is_none() {
                tick += 1;
                if kept(sim).iter().any(|thread| thread.2 == Finished) {
                    last.get_or_insert(tick);
                }
            }
        },
    );
    let last = last.expect("an end");
    let mut states = Vec::new();
    for at in last - 40..last + 40 {
        let mut sim = machine(&params, &PlantOptions::default());
        let mut tick = 0;
        feed_to(&mut sim, hole, &params, |sim, event| {
            if event.is_none() {
                tick += 1;
                if tick == at {
                    sim.command(Command::Stop);
                }
            }
        });
        let [(4, RigidTap, state, 1)] = kept(&sim)[..] else {
            panic!("{:?}", kept(&sim));
        };
        // The journal knows it by another way.
        let out = sim.board().tap_record().is_none_or(|tap| !tap.in_hole);
        states.push(state);
        assert!(state == CutShort || out, "{at}: {state:?}");
    }
    let change = states.iter().position(|state| *state == Finished);
    assert!(change.is_some_and(|change| change > 0), "{states:?}");
    assert!(
        states.is_sorted_by_key(|state| *state != CutShort),
        "{states:?}"
    );
}

/// In lock-step a board waits for whoever takes them, and for nobody who took those there were before, nor for anybody who
/// reads.
#[test]
fn a_board_waits_for_whoever_takes_the_certificates_of_this_program() {
    let params = Params::sheets();
    let text = "G98\nG0 X0 Z5\nM29 S600\nG84 Z-6 R-3 F600 K12\nG80\nM30\n";
    for takes in [false, true] {
        let mut sim = machine(&params, &PlantOptions::default());
        let mut gateway = Gateway::connect(&mut sim);
        let certificates = Object::new(0x5041, 0);
        let read = |gateway: &mut Gateway, sim: &mut Sim| {
            let told = gateway.read(sim, certificates, SdoProtocol::Block);
            ThreadReader::new(&told.expect("the certificates"))
                .expect("threads")
                .count()
        };
        let take = |gateway: &mut Gateway, sim: &mut Sim, number: u32| {
            gateway.write(
                sim,
                Object::new(0x5042, 0),
                &number.to_le_bytes(),
                SdoProtocol::Block,
            )
        };
        take(&mut gateway, &mut sim, 0).expect("none are none");
        let mut upload = Upload::new(7, &calls(text, &params));
        upload.feed(&mut gateway, &mut sim);
        assert!(upload.is_done());
        if takes {
            take(&mut gateway, &mut sim, 0).expect("none are none");
        }
        gateway.order(&mut sim, Order::Run);
        sim.settle();
        let mut waited = 0;
        while sim.is_busy() {
            let beat = NmtState::Operational.frame(NodeId::GATEWAY);
            sim.receive(&beat);
            if sim.awaits_program() {
                waited += 1;
                // Somebody looks on: nothing is taken by that.
                assert_eq!(read(&mut gateway, &mut sim), 5);
                assert!(sim.awaits_program());
                let newest = sim.board().device().threads().next().expect("a hole");
                let whole = newest.number - u32::from(newest.record.state == UnderWay);
                assert!(take(&mut gateway, &mut sim, whole + 1).is_err());
                assert!(sim.awaits_program());
                take(&mut gateway, &mut sim, whole).expect("there are so many");
                assert!(!sim.awaits_program());
            } else if sim.board().device().threads().count() > 3 {
                // And whoever looks without end is not waited for.
                read(&mut gateway, &mut sim);
            }
            sim.step();
            while sim.event().is_some() {}
            gateway.listen(&mut sim);
        }
        assert_eq!(kept(&sim), [(4, RigidTap, Finished, 1); 5]);
        assert_eq!(waited > 0, takes, "{waited}");
    }
}

/// The board waits for a reader that is gone until it counts as missing, and no longer.
#[test]
fn nobody_is_waited_for_who_is_gone() {
    let params = with("9025", 2);
    let text = "G98\nG0 X0 Z5\nM29 S600\nG84 Z-6 R-3 F600 K12\nG80\nM30\n";
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut upload = Upload::new(7, &calls(text, &params));
    upload.feed(&mut gateway, &mut sim);
    let number = 0_u32.to_le_bytes();
    gateway
        .write(
            &mut sim,
            Object::new(0x5042, 0),
            &number,
            SdoProtocol::Segmented,
        )
        .expect("none are none");
    gateway.order(&mut sim, Order::Run);
    sim.settle();
    let mut waited = 0;
    let mut tick = 0;
    while sim.is_busy() {
        if tick < 2000 {
            sim.receive(&NmtState::Operational.frame(NodeId::GATEWAY));
        }
        waited += u32::from(sim.awaits_program());
        sim.step();
        while sim.event().is_some() {}
        gateway.listen(&mut sim);
        tick += 1;
    }
    assert_eq!(waited, 0);
    assert_eq!(kept(&sim), [(4, RigidTap, Finished, 1); 5]);
}

/// A tap that K198 has left in its hole is not through with it, though a program ends there that no reader would let pass.
#[test]
fn a_hole_in_which_the_program_ends_is_not_whole() {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let text = "G98\nG0 X0 Z5\nM29 S600\nG84 Z-8 R-3 F600 K198\nG30 P99\nM30\n";
    let mut waiting = calls(text, &params)
        .into_iter()
        .filter(|call| !matches!(call.kind, CallKind::TapReturn(_)))
        .peekable();
    for _ in 0..20_000 {
        while waiting.peek().is_some_and(|call| sim.offer(call)) {
            waiting.next();
        }
        sim.step();
        while sim.event().is_some() {}
    }
    assert!(!sim.is_busy());
    assert_eq!(kept(&sim), [(4, RigidTap, CutShort, 1)]);
}

/// Statuses that come once in 240 SYNCs say nothing of strokes of some hundred ticks.
#[test]
fn without_positions_of_the_drive_no_groove_is_known() {
    let text = THREAD.replace("Z-30", "Z0");
    let known = cut(&text);
    let params = with("9021", 240);
    let options = PlantOptions {
        drives: DriveOptions {
            transmission: 240,
            ..DriveOptions::default()
        },
        ..PlantOptions::default()
    };
    let unknown = cut_calls(calls(&text, &params), &params, &options, |_, _| {});
    assert_eq!(known.threads.len(), 1);
    for record in known.threads.values() {
        assert_eq!(u16::from(record.cut.passes), record.tally.passes);
        // An ideal drive is where its setpoint is, to a count of 0.1 µm.
        let [least, most] = record.cut.grooves();
        assert!(least.nm() >= -100 && most.nm() <= 100, "{record:?}");
    }
    for record in unknown.threads.values() {
        assert!(record.tally.passes > 1);
        assert_eq!(record.cut.passes, 0, "{record:?}");
    }
}
