use leadscrew_core::link::{CutTally, Tally, ThreadKind, ThreadRecord, VERSION};
use leadscrew_core::units::Length;

use super::*;
use crate::record::Trouble;

const HOUR: u64 = 3_600_000;

fn met(tick: u64, newest_event: u32, last_event: Option<u64>) -> Met {
    Met {
        serial: 7,
        start: 0,
        firmware: "0.1.0".to_owned(),
        parameters: 5,
        tick,
        tick_us: 1000,
        newest_event,
        newest_thread: 0,
        last_event,
    }
}

fn thread(number: u32, state: ThreadState) -> (ThreadCertificate, Cut) {
    let certificate = ThreadCertificate {
        number,
        record: ThreadRecord {
            line: 9,
            kind: ThreadKind::Thread,
            state,
            tally: Tally {
                passes: 6,
                late: 0,
                measured: 4,
                largest: Length::from_nm(3000),
                squares: 16_000_000,
            },
            cut: CutTally::NONE,
        },
    };
    (certificate, Cut::Unknown(format!("of {number}")))
}

fn run(program: u32, ticks: u64) -> Certificate {
    Certificate {
        version: VERSION,
        program,
        ticks,
        setpoint_hash: Some(1),
        measured: 4,
        largest: Length::from_nm(3000),
        squares: 16_000_000,
        late: 0,
    }
}

/// A run that has ended.
fn ran(program: u32, ticks: u64) -> Ran {
    Ran {
        certificate: run(program, ticks),
        under_way: false,
    }
}

fn entry(number: u32, what: Option<What>) -> Entry {
    Entry {
        number,
        tick: u64::from(number) * 10,
        what,
    }
}

fn bodies(model: &mut Model, at: u64, seen: &Observation) -> Vec<Body> {
    model.take(Moment(at), seen)
}

/// A board that has been met at tick 5000, with a log of 20 entries that were read.
fn known() -> Model {
    let mut model = Model::default();
    model.take(Moment(HOUR), &Observation::Met(met(5000, 0, None)));
    model.take(Moment(HOUR), &Observation::Log(vec![entry(20, None)]));
    model
}

fn starts(model: &Model, at: u64, seen: Met) -> u32 {
    let mut model = model.clone();
    model.take(Moment(at), &Observation::Met(seen));
    model.memory().start.count
}

/// Numbers of the agent, where the board does not count: no moment of these tests is as late.
const FIRST: u32 = OWN_COUNTS;
const NEXT: u32 = OWN_COUNTS + 1;

#[test]
fn a_start_is_another_where_numbers_or_ticks_go_back() {
    let known = known();
    let later = HOUR + 1000;
    assert_eq!(starts(&known, later, met(6000, 20, Some(200))), FIRST);
    assert_eq!(starts(&known, later, met(4999, 20, Some(200))), NEXT);
    assert_eq!(starts(&known, later, met(6000, 19, None)), NEXT);
    // The same number of another entry.
    assert_eq!(starts(&known, later, met(6000, 20, Some(201))), NEXT);
    let other = Met {
        serial: 8,
        ..met(6000, 20, Some(200))
    };
    assert_eq!(starts(&known, later, other), NEXT);
}

#[test]
fn where_the_log_has_gone_on_the_clocks_say_it() {
    let known = known();
    // A day later, with a clock that is off by a second in a thousand.
    let day = 24 * HOUR;
    let (part, least) = DRIFT;
    let apart = day / part + least;
    for (tick, count) in [
        (5000 + day, FIRST),
        (5000 + day - apart, FIRST),
        (5000 + day - apart - 1, NEXT),
    ] {
        assert_eq!(
            starts(&known, HOUR + day, met(tick, 400, None)),
            count,
            "{tick}"
        );
    }
    // A clock that was set back changes nothing where the log still says it.
    assert_eq!(starts(&known, 0, met(6000, 20, Some(200))), FIRST);
}

/// A board that counts its starts is met in this one, at tick 5000 and with a log of 20 entries that were read.
fn counted(start: u32) -> Model {
    let mut model = Model::default();
    let seen = Met {
        start,
        ..met(5000, 0, None)
    };
    model.take(Moment(HOUR), &Observation::Met(seen));
    model.take(Moment(HOUR), &Observation::Log(vec![entry(20, None)]));
    model
}

#[test]
fn a_board_that_counts_its_starts_says_which_one_it_is() {
    let known = counted(12);
    assert_eq!(known.memory().start.count, 12);
    let seen = |start, met| Met { start, ..met };
    // The log has lost the entry, and the computer's clock was set by a month: the start goes on all the same.
    for at in [0, 31 * 24 * HOUR] {
        assert_eq!(starts(&known, at, seen(12, met(6000, 400, None))), 12);
    }
    // The count says so, and nothing else does.
    assert_eq!(
        starts(&known, HOUR + 1000, seen(13, met(6000, 20, Some(200)))),
        13
    );
    // It need not have been met in each.
    assert_eq!(starts(&known, HOUR, seen(20, met(3, 1, None))), 20);
}

#[test]
fn no_number_of_a_start_comes_again_where_the_flash_was_erased_or_cannot_count() {
    let mut model = counted(12);
    let mut numbers = vec![12];
    let month = 31 * 24 * HOUR;
    // Erased, so it counts from 1; then once more; then the flash fails; then it has counted to 13.
    for (tick, start) in [1, 2, 1, 0, 2, 12, 13].into_iter().enumerate() {
        let seen = Met {
            start,
            ..met(100 - tick as u64, 0, None)
        };
        model.take(Moment(month + tick as u64), &Observation::Met(seen));
        let count = model.memory().start.count;
        assert!(!numbers.contains(&count), "{count} in {numbers:?}");
        assert_eq!(count < OWN_COUNTS, start == 13, "{start}: {count}");
        numbers.push(count);
    }
}

#[test]
fn the_agents_own_numbers_go_by_the_clock() {
    let mut model = Model::default();
    let now = Moment(1_795_000_000_123);
    model.take(now, &Observation::Met(met(10, 0, None)));
    assert_eq!(model.memory().start.count, 1_795_000_000);
    // Twice in a second.
    model.take(now, &Observation::Met(met(5, 0, None)));
    assert_eq!(model.memory().start.count, 1_795_000_001);
}

#[test]
fn what_an_earlier_version_counted_is_not_counted_again() {
    let mut memory = counted(0).memory().clone();
    memory.start.count = 3;
    let model = Model::new(memory);
    let seen = |start| Met {
        start,
        ..met(10, 0, None)
    };
    assert_eq!(starts(&model, HOUR, seen(3)), OWN_COUNTS);
    assert_eq!(starts(&model, HOUR, seen(4)), 4);
}

#[test]
fn threads_are_told_once_they_have_ended_and_gaps_are_counted() {
    use ThreadState::{CutShort, Finished, UnderWay};
    let mut model = known();
    let start = model.memory().start;
    let tell = |number, state| {
        let (certificate, cut) = thread(number, state);
        Body::Thread(Thread::of(start, 3, &certificate, cut))
    };
    let mut told = |threads: &[(ThreadCertificate, Cut)]| {
        let seen = Observation::Certificates(ran(3, 8), threads.to_vec());
        bodies(&mut model, HOUR, &seen)
    };
    assert_eq!(told(&[thread(1, UnderWay)]), []);
    assert_eq!(
        told(&[thread(2, UnderWay), thread(1, Finished)]),
        [tell(1, Finished)]
    );
    assert_eq!(told(&[thread(2, UnderWay), thread(1, Finished)]), []);
    assert_eq!(told(&[thread(2, CutShort)]), [tell(2, CutShort)]);
    let gap = Gap {
        start,
        of: Missing::Threads,
        first: 3,
        last: 4,
    };
    assert_eq!(
        told(&[
            thread(7, UnderWay),
            thread(6, Finished),
            thread(5, Finished)
        ]),
        [Body::Gap(gap), tell(5, Finished), tell(6, Finished)]
    );
}

/// An alarm that comes between the end of a program and the next look at the log is not the program's.
#[test]
fn a_program_that_has_finished_stays_so_where_an_alarm_comes_after_it() {
    let ended = |ticks: u64, entries: Vec<Entry>| {
        let mut model = known();
        bodies(&mut model, HOUR, &Observation::Log(entries));
        let seen = Observation::Certificates(ran(3, ticks), Vec::new());
        let told = bodies(&mut model, HOUR, &seen);
        let [Body::Run(told)] = &told[..] else {
            panic!("{told:?}");
        };
        told.finished
    };
    let last = known().memory().last_event;
    let finish = entry(last + 1, Some(What::Finished));
    let alarm = |number| {
        let trouble = Trouble {
            number: 4300,
            line: 0,
            cause: "c".to_owned(),
            remedy: "r".to_owned(),
        };
        entry(number, Some(What::Alarm(trouble)))
    };
    assert!(ended(500, vec![finish.clone()]));
    assert!(ended(500, vec![finish.clone(), alarm(last + 2)]));
    assert!(!ended(500, vec![alarm(last + 1)]));
    // The alarm is 20 ticks after the end: a run of 15 is another one.
    assert!(!ended(15, vec![finish, alarm(last + 3)]));
}

#[test]
fn a_new_start_counts_its_threads_anew() {
    let mut model = known();
    let all = Observation::Certificates(ran(0, 0), vec![thread(1, ThreadState::Finished)]);
    assert_eq!(bodies(&mut model, HOUR, &all).len(), 1);
    let before = model.memory().start;
    let again = bodies(&mut model, HOUR, &Observation::Met(met(10, 1, None)));
    assert!(matches!(&again[..], [Body::Identity(identity)] if identity.start.count == NEXT));
    let told = bodies(&mut model, HOUR, &all);
    let [Body::Thread(told)] = &told[..] else {
        panic!("{told:?}");
    };
    assert_eq!(
        [before.key(1), told.start.key(told.number)],
        [format!("00000007/{FIRST}/1"), format!("00000007/{NEXT}/1")]
    );
}

#[test]
fn a_run_is_told_behind_its_end_and_once() {
    let mut model = known();
    let read = Observation::Certificates(ran(3, 800), Vec::new());
    assert_eq!(bodies(&mut model, HOUR, &read), []);
    let alarm = What::Alarm(Trouble {
        number: 4036,
        line: 3,
        cause: "c".to_owned(),
        remedy: "r".to_owned(),
    });
    let told = bodies(
        &mut model,
        HOUR,
        &Observation::Log(vec![entry(21, Some(alarm.clone()))]),
    );
    assert!(matches!(&told[..], [Body::Event(event)] if event.what == alarm));
    let start = model.memory().start;
    let result = Body::Run(Run::of(start, false, &run(3, 800)));
    assert_eq!(bodies(&mut model, HOUR, &read), [result]);
    // The reset behind it ends nothing any more.
    let reset = Observation::Log(vec![entry(22, Some(What::Reset))]);
    assert_eq!(bodies(&mut model, HOUR, &reset).len(), 1);
    assert_eq!(bodies(&mut model, HOUR, &read), []);
    let end = Observation::Log(vec![entry(23, Some(What::Finished))]);
    bodies(&mut model, HOUR, &end);
    let read = Observation::Certificates(ran(4, 90), Vec::new());
    let result = Body::Run(Run::of(start, true, &run(4, 90)));
    assert_eq!(bodies(&mut model, HOUR, &read), [result]);
}

/// While nobody read, a program ended and the next one began: the board has the figures of that one.
#[test]
fn a_run_is_not_told_by_the_figures_of_the_next_one() {
    let mut model = known();
    let start = model.memory().start;
    let last = model.memory().last_event;
    let end = |number| Observation::Log(vec![entry(number, Some(What::Finished))]);
    let lost = |number| {
        Body::Gap(Gap {
            start,
            of: Missing::Runs,
            first: number,
            last: number,
        })
    };
    let of = |number, program| {
        let (certificate, cut) = thread(number, ThreadState::Finished);
        Body::Thread(Thread::of(start, program, &certificate, cut))
    };
    bodies(&mut model, HOUR, &end(last + 1));
    let under_way = Ran {
        under_way: true,
        ..ran(4, 50)
    };
    let hole = thread(1, ThreadState::Finished);
    let seen = Observation::Certificates(under_way, vec![hole]);
    assert_eq!(bodies(&mut model, HOUR, &seen), [of(1, 0), lost(last + 1)]);
    // What is cut from then on is its own, and so is its end.
    let hole = thread(2, ThreadState::Finished);
    let seen = Observation::Certificates(under_way, vec![hole]);
    assert_eq!(bodies(&mut model, HOUR, &seen), [of(2, 4)]);
    bodies(&mut model, HOUR, &end(last + 2));
    let seen = Observation::Certificates(ran(4, 90), Vec::new());
    assert_eq!(
        bodies(&mut model, HOUR, &seen),
        [Body::Run(Run::of(start, true, &run(4, 90)))]
    );
    // Of two that have ended the last one has its figures.
    let both = vec![
        entry(last + 3, Some(What::Finished)),
        entry(last + 4, Some(What::Finished)),
    ];
    let told = bodies(&mut model, HOUR, &Observation::Log(both));
    assert!(told.contains(&lost(last + 3)), "{told:?}");
    let hole = thread(3, ThreadState::Finished);
    let seen = Observation::Certificates(ran(6, 70), vec![hole]);
    assert_eq!(
        bodies(&mut model, HOUR, &seen),
        [of(3, 0), Body::Run(Run::of(start, true, &run(6, 70)))]
    );
}

/// Nothing is kept of it: others may have read what was before.
#[test]
fn a_model_from_now_tells_nothing_of_the_time_before() {
    let mut model = Model::from_now();
    let end = |number| Observation::Log(vec![entry(number, Some(What::Finished))]);
    bodies(&mut model, HOUR, &Observation::Met(met(1_000, 20, None)));
    assert_eq!(bodies(&mut model, HOUR, &end(20)), []);
    let threads = vec![
        thread(8, ThreadState::UnderWay),
        thread(7, ThreadState::Finished),
    ];
    let seen = Observation::Certificates(ran(3, 500), threads);
    assert_eq!(bodies(&mut model, HOUR, &seen), []);
    // What was under way is told, and all that comes.
    let seen = Observation::Certificates(ran(3, 500), vec![thread(8, ThreadState::Finished)]);
    assert!(
        matches!(&bodies(&mut model, HOUR, &seen)[..], [Body::Thread(told)] if told.number == 8)
    );
    assert!(
        matches!(&bodies(&mut model, HOUR, &end(21))[..], [Body::Event(told)] if told.number == 21)
    );
    let seen = Observation::Certificates(ran(4, 600), Vec::new());
    assert!(matches!(&bodies(&mut model, HOUR, &seen)[..], [Body::Run(told)] if told.program == 4));
    // A board that has not logged anything yet has no past of that kind.
    let mut model = Model::from_now();
    bodies(&mut model, HOUR, &Observation::Met(met(10, 0, None)));
    assert_eq!(bodies(&mut model, HOUR, &end(1)).len(), 1);
}

#[test]
fn entries_of_the_log_that_nobody_read_are_counted() {
    let mut model = known();
    let log = Observation::Log(vec![entry(20, None), entry(24, Some(What::Held))]);
    let told = bodies(&mut model, HOUR, &log);
    let [Body::Gap(gap), Body::Event(event)] = &told[..] else {
        panic!("{told:?}");
    };
    assert_eq!((gap.of, gap.first, gap.last), (Missing::Events, 21, 23));
    assert_eq!((event.number, event.tick), (24, 240));
    assert_eq!(bodies(&mut model, HOUR, &log), []);
}

#[test]
fn a_state_is_told_where_it_changes_by_more_than_its_noise() {
    let mut model = known();
    let state = |rpm, load, line| State {
        rpm,
        load_percent: Some(load),
        line,
        ..State::default()
    };
    let mut is_told =
        |state| !bodies(&mut model, HOUR, &Observation::State(state, 6000)).is_empty();
    assert!(is_told(state(1000, 30, 1)));
    assert!(!is_told(state(1020, 34, 1)));
    assert!(is_told(state(1021, 34, 1)));
    assert!(is_told(state(1021, 39, 1)));
    assert!(is_told(state(1021, 39, 2)));
    assert!(is_told(state(0, 39, 2)));
    assert!(!is_told(state(-5, 39, 2)));
}

#[test]
fn a_board_that_goes_and_comes_is_told_once_each() {
    let mut model = known();
    let gone = Observation::Gone("silent".to_owned());
    let [Body::Presence(told)] = &bodies(&mut model, HOUR, &gone)[..] else {
        panic!("not told");
    };
    assert_eq!((told.alive, told.why.as_str()), (false, "silent"));
    assert_eq!(bodies(&mut model, HOUR, &gone), []);
    let back = bodies(
        &mut model,
        HOUR,
        &Observation::Met(met(9000, 20, Some(200))),
    );
    assert!(matches!(&back[..], [Body::Presence(told)] if told.alive));
    // Its state is told anew.
    let state = Observation::State(State::default(), 9000);
    assert_eq!(bodies(&mut model, HOUR, &state).len(), 1);
    assert_eq!(bodies(&mut model, HOUR, &Observation::Parameters(5)), []);
    assert_eq!(
        bodies(&mut model, HOUR, &Observation::Parameters(6)).len(),
        1
    );
}

#[test]
fn since_when_a_set_is_in_force_is_known_as_well_as_the_agent_has_looked() {
    let of = |model: &Model| {
        let (_, set) = model.memory().in_force().unwrap();
        (
            set.parameters,
            set.since.0,
            set.after.map(|at| at.0),
            set.seen.0,
        )
    };
    let mut model = Model::default();
    assert_eq!(model.memory().in_force(), None);
    let begin = met(5000, 0, None);
    model.take(Moment(HOUR), &Observation::Met(begin.clone()));
    // It may have been in force for any time.
    assert_eq!(of(&model), (5, HOUR, None, HOUR));
    model.take(Moment(HOUR + 2000), &Observation::Parameters(5));
    assert_eq!(of(&model), (5, HOUR, None, HOUR + 2000));
    model.take(Moment(HOUR + 4000), &Observation::Parameters(6));
    let changed = (6, HOUR + 4000, Some(HOUR + 2000), HOUR + 4000);
    assert_eq!(of(&model), changed);
    // An agent that begins again knows nothing of the present before it has met the board.
    let mut again = Model::new(model.memory().clone());
    assert_eq!(again.memory().in_force(), None);
    let with = |parameters| Met {
        parameters,
        ..begin.clone()
    };
    again.take(Moment(2 * HOUR), &Observation::Met(with(6)));
    assert_eq!(of(&again), (6, HOUR + 4000, Some(HOUR + 2000), 2 * HOUR));
    // So for a board that has started again.
    let before = again.memory().start.count;
    again.take(
        Moment(3 * HOUR),
        &Observation::Met(Met { tick: 1, ..with(6) }),
    );
    assert_eq!(again.memory().start.count, before + 1);
    assert_eq!(of(&again).1, HOUR + 4000);
    // What changed while nobody looked.
    let mut away = Model::new(model.memory().clone());
    away.take(Moment(9 * HOUR), &Observation::Met(with(7)));
    assert_eq!(of(&away), (7, 9 * HOUR, Some(HOUR + 4000), 9 * HOUR));
    // Another board with the same set is another machine's board: it has not had it here.
    let other = Met {
        serial: 8,
        ..with(7)
    };
    away.take(Moment(10 * HOUR), &Observation::Met(other));
    assert_eq!(of(&away).1, 10 * HOUR);
}
