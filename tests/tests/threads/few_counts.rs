//! Whole programs on encoders of few counts: a thread waits until the spindle is learned, and is as true as was said.

use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::call::{Call, CallKind};
use leadscrew_core::cycle;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Lead, Length, Rpm, Turns};
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::{calls, run_calls};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

/// Once ready and little learned yet, an axis may be as far beside the helix as is said, and a micrometre more, or as much
/// as this part of what the swing moves it.
const BESIDE_NM: i64 = 1_000;
const UNLEARNED: f64 = 0.03;

/// A thread by an encoder of few counts.
#[derive(Debug)]
struct Case {
    counts: i64,
    timed: bool,
    rpm: i64,
    /// The speed at which the spindle was learned before, and for how long in milliseconds; 0 where it stood.
    before: (i64, i64),
    lead_um: i64,
    /// Where the tool stands before it, in micrometres of Z: the spindle starts on the way there.
    from_um: i64,
    /// Swing of the spindle once a turn, in thousandths of a percent of its speed.
    swing: u32,
    angle: i64,
}

impl Case {
    fn random(random: &mut Random) -> Self {
        let timed = random.chance(50);
        let counts = random.within(16, if timed { 59 } else { 1023 });
        let rpm = if random.chance(30) {
            random.within(1, 80)
        } else {
            random.within(20, 700)
        };
        let lead_um = random.within(300, 4_000).min(5_000_000 / rpm);
        // The axis can follow it: what goes after the angle has a third of the jerk, of which this takes a half.
        let turns = rpm as f64 / 60.0;
        let jerk = lead_um as f64 * 1e-6 * turns * (core::f64::consts::TAU * turns).powi(2);
        let most = (10.0 / jerk * 100_000.0) as u32;
        // A little more or less is within the tolerance at once.
        let others = [
            0,
            0,
            random.within(60, 1_500),
            rpm * random.within(80, 120) / 100,
        ];
        Self {
            counts,
            timed,
            rpm,
            before: (random.of(&others), random.within(9_000, 12_000)),
            lead_um,
            from_um: random.within(5_000, 40_000),
            swing: random.of(&[0, 0, 2_000, 10_000]).min(most),
            angle: random.within(-(1 << 31), 1 << 31),
        }
    }

    fn params(&self) -> Params {
        with(&[("3720", self.counts), ("9006.0", self.timed.into())])
    }

    fn text(&self) -> String {
        let mm = |um: i64| format!("{}.{:03}", um / 1000, um % 1000);
        let (first, second) = match self.before {
            (0, _) => (format!("M3 S{}", self.rpm), String::new()),
            (rpm, ms) => (
                format!("M3 S{rpm}\nG4 P{ms}"),
                format!("M3 S{}\n", self.rpm),
            ),
        };
        format!(
            "G18 G40 G97 G98\n{first}\nG0 X40 Z{}\n{second}G76 P010000 Q500 R0.05\nG76 X38. Z-15. P5000 Q3000 F{}\nM5\nM30\n",
            mm(self.from_um),
            mm(self.lead_um)
        )
    }
}

/// Whether a check lets the calls pass.
fn judged(calls: &[Call], params: &Params) -> Result<(), Alarm> {
    for call in calls {
        if let CallKind::Thread(thread) = &call.kind {
            cycle::thread_report(thread, call.span, params)?;
        }
    }
    Ok(())
}

/// Cuts the thread of a case, and compares it with what was said.
fn cut(case: &Case, calls: Vec<Call>, params: &Params) {
    let options = PlantOptions {
        angle: Turns::from_raw(case.angle),
        ripple: Ripple::new(case.swing, (case.rpm * 1000 / 60) as u32),
        ..PlantOptions::default()
    };
    let ran = run_calls(calls, params, &options, |_, _| ());
    assert_eq!(ran.alarm, None, "{case:?}");
    let errors = ran.rows.iter().filter_map(|row| row.error);
    let worst = errors.map(|error| error.nm().abs()).max();
    let lead = Lead::new(case.lead_um * 1000, 1).expect("a lead");
    let said = params
        .resolution()
        .uncertainty(lead, Rpm::new(case.rpm as i32));
    let said = said.unwrap_or(Length::ZERO).nm();
    let swing = case.lead_um as f64 * 1e3 / core::f64::consts::TAU * f64::from(case.swing) / 1e5;
    let beside = BESIDE_NM.max((UNLEARNED * swing) as i64);
    assert!(
        worst.is_some_and(|worst| worst <= said + beside),
        "{case:?}: {worst:?} nm beside the helix, said were {said}, and {beside} more"
    );
    assert_eq!(first_excess(&ran.rows, params), None, "{case:?}");
}

#[test]
fn a_thread_that_a_check_lets_pass_is_cut_as_true_as_was_said() {
    leadscrew_seed::volume(1, |seed| {
        let mut random = Random(seed);
        let mut ran = 0;
        while ran < leadscrew_seed::amount(20, 120) {
            let case = Case::random(&mut random);
            let params = case.params();
            let calls = calls(&case.text(), &params);
            if judged(&calls, &params).is_err() {
                continue;
            }
            ran += 1;
            cut(&case, calls, &params);
        }
    });
}

/// Counts without times shake the short axis too, at the slope of the line: that of a stroke, of a cycle with a taper, and
/// of a cycle whose long axis is X. With 1024 counts 1.62 m/s² along a lead of 2 mm.
#[test]
fn the_short_axis_is_checked_at_the_slope_of_the_line() {
    for (slow, text, is_quiet) in [
        ("1620.X", "G0 X40 Z0\nG32 X60 Z-20 F2", true),
        ("1620.X", "G0 X40 Z0\nG32 X70 Z-20 F2", false),
        ("1620.X", "G0 X60 Z0\nG92 X40 Z-20 R-8 F2 J0", true),
        ("1620.X", "G0 X60 Z0\nG92 X40 Z-20 R-16 F2 J0", false),
        ("1620.Z", "G0 X120 Z0\nG92 X40 Z-5 R-10 F2 J0", true),
        ("1620.Z", "G0 X120 Z0\nG92 X40 Z-8 R-10 F2 J0", false),
    ] {
        let params = with(&[("3720", 1024), ("9006.0", 0), (slow, 1_000_000_000)]);
        let calls = calls(
            &format!("G18 G40 G97 G98\nM3 S100\n{text}\nM5\nM30\n"),
            &params,
        );
        let judged = judged(&calls, &params).map_err(|alarm| alarm.code);
        let expected = if is_quiet {
            Ok(())
        } else {
            Err(Code::LeadForEncoder)
        };
        assert_eq!(judged, expected, "{slow}: {text}");
    }
}

#[test]
fn a_spindle_that_comes_up_to_speed_or_swings_is_waited_for_and_followed() {
    let even = Case {
        counts: 360,
        timed: false,
        rpm: 150,
        before: (0, 0),
        lead_um: 1_500,
        from_um: 5_000,
        swing: 0,
        angle: 0,
    };
    for case in [
        // The first tick in which its index is known is no wait yet.
        even,
        // Learning began at a thirtieth of the speed.
        Case {
            counts: 22,
            timed: true,
            rpm: 554,
            before: (0, 0),
            lead_um: 1_764,
            from_um: 12_142,
            swing: 2_000,
            angle: -221_842_248,
        },
        // Its speed is within the tolerance and beside it by turns.
        Case {
            counts: 927,
            timed: false,
            rpm: 31,
            before: (0, 0),
            lead_um: 786,
            from_um: 18_609,
            swing: 10_000,
            angle: 723_013_001,
        },
        // The spindle becomes faster where the pass begins: the follower has that acceleration from the start.
        Case {
            counts: 16,
            timed: false,
            rpm: 54,
            before: (0, 0),
            lead_um: 1_902,
            from_um: 33_803,
            swing: 10_000,
            angle: -1_241_853_606,
        },
        // It was learned at another speed, and is within the tolerance of this one before its ramp is over.
        Case {
            counts: 39,
            timed: true,
            rpm: 1_415,
            before: (384, 12_400),
            lead_um: 2_685,
            from_um: 4_266,
            swing: 0,
            angle: -1_246_441_745,
        },
    ] {
        let params = case.params();
        cut(&case, calls(&case.text(), &params), &params);
    }
}

/// A swing that is not once a turn is not learned where 9034 does not tell its frequency. Where an axis of low limits
/// cannot go after it, that is seen before the tool cuts.
#[test]
fn an_axis_that_is_not_on_the_thread_where_its_run_in_ends_does_not_cut() {
    let set = [
        ("1620.Z", 1_535_000_000),
        ("1622.Z", 33_000_000_000),
        ("3720", 167),
        ("9006.0", 0),
        ("9025", 1),
    ];
    let text = "G18 G40 G97 G98\nM3 S1338\nG0 X71.094 Z1.536\nG32 X51.778 Z1.536 F2.819 J0.847 K0.847 Q185440\n\
        X23.804 Z1.536 F2.819\nG0 X85.2 Z20.575\nM30\n";
    for (frequency, cuts) in [(0, false), (4883, true)] {
        let params = with(&[&set[..], &[("9034", frequency)]].concat());
        let calls = calls(text, &params);
        for angle in 0..12_i64 {
            let options = PlantOptions {
                angle: Turns::from_raw(angle << 28),
                ripple: Ripple::new(2_800, 4_883),
                ..PlantOptions::default()
            };
            let ran = run_calls(calls.clone(), &params, &options, |_, _| ());
            let alarm = ran.alarm.map(|alarm| alarm.code);
            assert_eq!(alarm, (!cuts).then_some(Code::SpindleSwings), "{angle}");
            // What 9035 allows, and for the milliseconds until it is seen, what a swing nobody knows does to the angle.
            let most = if cuts { 50_000 } else { 80_000 };
            let on_it = ran.rows.iter().filter_map(|row| row.error);
            let worst = on_it.map(|error| error.nm().abs()).max();
            assert!(worst.is_none_or(|nm| nm < most), "{angle}: {worst:?}");
            assert!(worst.is_some() || !cuts, "{angle}");
        }
    }
}
