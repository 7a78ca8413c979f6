//! Separate tests of the law, the legs and the spindle's ramps.

extern crate std;

use super::course::{Course, Leg};
use super::law::Region;
use super::plan::{FloatPlan, float_ticks};
use super::run::{FloatRun, FloatTick};
use super::turner::Turner;
use core::num::NonZeroU8;

use crate::alarm::{At, Code, Span};
use crate::call::{
    Hand, HandChoice, Position, SpindleChoice, TapAxis, TapCall, TapCycle, TapForm, TapMode,
    TapNotes, TapPeck, TapRepeat, TapSpindle,
};
use crate::motion::executor::Arrival;
use crate::moves::TapMove;
use crate::params::Params;
use crate::signals::Signals;
use crate::spindle::{EncoderSample, Observer};
use crate::units::{CentiRpm, Lead, Length, Millis, Rpm, Ticks, TurnRatio, Turns};

fn nm(nm: i64) -> Length {
    Length::from_nm(nm)
}

fn at<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

/// G84 Z-20 R-5 F1.25 under G99 and M03 S500.
fn m8() -> TapCall {
    let speed = CentiRpm::new(50_000);
    TapCall {
        cycle: TapCycle::G84,
        mode: TapMode::Floating,
        axis: TapAxis::Z,
        start: Position::ZERO,
        hole: Position::ZERO,
        step: Position::ZERO,
        level: at(nm(-5_000_000)),
        bottom: at(nm(-20_000_000)),
        form: TapForm::Standard,
        dwell: Millis::default(),
        lead: at(Lead::new(1_250_000, 1).expect("a lead")),
        hand: HandChoice::Written(Hand::Right),
        speed,
        extract: speed,
        spindle: SpindleChoice::default(),
        repeat: TapRepeat::Holes(NonZeroU8::MIN),
        clamp: None,
        continues: false,
        notes: TapNotes::default(),
    }
}

/// The same with S3000, Q2 and a return of 1 mm.
fn fast_peck() -> TapCall {
    let speed = CentiRpm::new(300_000);
    TapCall {
        form: TapForm::HighSpeed(TapPeck {
            infeed: at(nm(2_000_000)),
            back: at(nm(1_000_000)),
        }),
        speed,
        extract: speed,
        ..m8()
    }
}

fn plan(call: &TapCall) -> FloatPlan {
    FloatPlan::new(
        call,
        Signals::default().hand(call.hand),
        Span::default(),
        &Params::sheets(),
    )
    .expect("a plan")
}

fn turns(turns: f64) -> Turns {
    Turns::from_raw((turns * 4_294_967_296.0) as i64)
}

#[test]
fn the_law_is_rest_helix_and_rest() {
    let plan = plan(&m8());
    let law = &plan.law;
    let at = |angle: f64| {
        let (way, region) = law.at(law.travel(turns(angle)));
        (way as f64 / 65536.0, region)
    };
    let lead_in = plan.lead_in().nm() as f64 / 1_250_000.0;
    assert_eq!(at(-30.0), (0.0, Region::Out));
    assert_eq!(at(-lead_in - 0.001), (0.0, Region::Out));
    assert_eq!(at(0.0).1, Region::Joining);
    assert!((at(0.0).0 - plan.ahead().nm() as f64).abs() < 1.0);
    for angle in [lead_in + 0.001, 1.0, 7.25, 11.99] {
        let (way, region) = at(angle);
        assert_eq!(region, Region::Locked, "{angle}");
        assert!((way - angle * 1_250_000.0).abs() < 0.001, "{angle}: {way}");
    }
    // 15 mm: the axis never goes beyond, and stands there from the rounding on.
    for angle in [12.0_f64, 12.001, 12.005, 12.01, 13.0, 1e6] {
        let (way, region) = at(angle);
        assert_eq!(region, Region::Bottom, "{angle}");
        assert!(way <= 15_000_000.0, "{angle}: {way}");
    }
    let past = plan.past_bottom().nm() as f64 / 1_250_000.0;
    assert_eq!(at(12.0 + past).0, 15_000_000.0);
    assert_eq!(
        law.position(Position::ZERO, 15_000_000 << 16).z,
        m8().bottom.value
    );
    assert_eq!(law.position(Position::ZERO, 0).z, m8().level.value);
}

#[test]
fn the_way_grows_with_the_angle_and_its_slope_with_it() {
    let plan = plan(&m8());
    let law = &plan.law;
    let step = Turns::from_raw(1 << 22);
    let mut angle = turns(-2.0);
    let (mut before, mut slope) = (0_i64, 0_i64);
    let tallest = 1_250_000 * 64;
    while angle < turns(13.0) {
        let (way, region) = law.at(law.travel(angle));
        let next = way - before;
        assert!((-1..=tallest + 1_000).contains(&next), "{angle:?}: {next}");
        if angle > turns(-1.9) && region != Region::Bottom {
            // Smooth: a thousandth of a turn changes the slope only a little.
            assert!((next - slope).abs() < tallest / 50, "{angle:?}");
        }
        (before, slope) = (way, next);
        angle += step;
    }
}

#[test]
fn a_left_hand_tap_is_the_mirror_image() {
    let right = plan(&m8());
    let left = plan(&TapCall {
        hand: HandChoice::Written(Hand::Left),
        ..m8()
    });
    for angle in [-1.0, 0.3, 5.0, 12.0] {
        let way = |plan: &FloatPlan, angle: f64| {
            plan.law.at(plan.law.travel(plan.law.inward(turns(angle))))
        };
        assert_eq!(way(&right, angle), way(&left, -angle));
    }
    assert_eq!(left.law.turns_to(nm(5_000_000)), 4 << 32);
}

#[test]
fn the_last_leg_is_the_extraction() {
    let course = Course::new(nm(5), &TapForm::Standard, 1);
    let infeed = course.first();
    let dwell = course.after(&infeed).unwrap();
    let extract = course.after(&dwell).unwrap();
    assert_eq!(
        [infeed.leg, dwell.leg, extract.leg],
        [Leg::Infeed, Leg::Dwell, Leg::Extract]
    );
    assert_eq!(course.after(&extract), None);
}

fn turner(rpm: i32) -> Turner {
    let lead = Lead::new(1_250_000, 1).unwrap();
    let speed = CentiRpm::of_rpm(Rpm::new(rpm));
    Turner::new(speed, lead, 375_000_000, &Params::sheets())
}

#[test]
fn a_spindle_that_follows_stops_at_its_turning_point() {
    for rpm in [1, 30, 500, 3000] {
        let turner = turner(rpm);
        for way in [1_i64 << 20, 1 << 30, 1 << 33, 20 << 32] {
            let (mut at, mut speed, mut before) = (0_i64, 0_i64, 0_i64);
            let mut ticks = 0_u64;
            while ticks < 4_000_000 {
                speed = turner.towards(speed, turner.stopping(way - at).min(turner.top()));
                assert!((speed - before).abs() <= turner.gentle() * 8 / 7 + 1);
                assert!((0..=turner.top()).contains(&speed));
                if speed == 0 {
                    break;
                }
                at += speed;
                before = speed;
                ticks += 1;
            }
            // Within the speed that the last tick's ramp adds.
            assert!((way - at).abs() <= turner.gentle(), "{rpm} {way}: {at}");
            let planned = turner.ticks(way, true, true);
            assert!(
                planned.abs_diff(ticks) <= ticks / 10 + 30,
                "{rpm} {way}: {planned} {ticks}"
            );
        }
    }
}

#[test]
fn commands_are_s_itself_or_what_was_asked() {
    let turner = turner(500);
    assert_eq!(turner.rate(turner.top()).rpm(), Rpm::new(500));
    assert_eq!(turner.rate(-turner.top()).rpm(), Rpm::new(-500));
    assert_eq!(turner.centi_rpm(turner.top()), CentiRpm::new(50_000));
    assert_eq!(turner.rate(turner.top() / 2).rpm(), Rpm::new(250));
    assert_eq!(turner.stopping(-5), 0);
    assert_eq!(turner.towards(0, 1), 1);
}

#[test]
fn what_cannot_be_planned_is_an_alarm() {
    let code = |call: &TapCall| {
        FloatPlan::new(
            call,
            Signals::default().hand(call.hand),
            Span::default(),
            &Params::sheets(),
        )
        .unwrap_err()
        .code
    };
    let standing = TapCall {
        speed: CentiRpm::default(),
        ..m8()
    };
    assert_eq!(code(&standing), Code::TapSpindleStands);
    let shallow = TapCall {
        bottom: At::new(m8().level.value - nm(5_000), Span::default()),
        ..m8()
    };
    assert_eq!(code(&shallow), Code::StrokeTooShortForSpeed);
}

/// A spindle at 3000 rpm cannot stop within the first 2 mm, so it goes in slower.
#[test]
fn the_spindle_goes_in_as_fast_as_it_can_be_stopped() {
    let fast = fast_peck();
    let plan = plan(&fast);
    let entry = plan.entry_speed().get();
    assert!((40_000..120_000).contains(&entry), "{entry}");
    assert_eq!(
        super::super::FloatPlan::new(&m8(), Hand::Right, Span::default(), &Params::sheets())
            .map(|plan| plan.entry_speed()),
        Ok(CentiRpm::new(50_000))
    );
    // A standing spindle gives no time estimate.
    let stroke = TapMove {
        mode: TapMode::Floating,
        axis: TapAxis::Z,
        spindle: TapSpindle::First,
        lead: m8().lead.value,
        hand: Hand::Right,
        level: m8().level.value,
        bottom: m8().bottom.value,
        turns: TurnRatio::of_travel(nm(15_000_000), m8().lead.value),
        speed: m8().speed,
        outward: false,
        opens: true,
        closes: false,
    };
    let params = Params::sheets();
    let ticks = float_ticks(&stroke, nm(-15_000_000), &params);
    // 12 turns at 500 rpm, and half of the stop.
    assert!((1_440..1_600).contains(&ticks), "{ticks}");
}

/// The speed at which the hole begins. The spindle comes up on its ramp to `peak` and then goes down again to 1, the
/// speed of the hole.
fn begins_at(plan: &FloatPlan, peak: f64) -> f64 {
    let params = Params::sheets();
    assert_eq!(params.tick_us(), 1_000);
    let rpm = f64::from(plan.entry_speed().get()) / 100.0;
    let ramp = 1_000.0 / f64::from(params.spindle_ramp_ms()) / rpm;
    let mut observer = Observer::new(4096, 50, 1_000);
    let mut run = FloatRun::new(plan, Position::ZERO);
    let arrival = Arrival {
        tolerance_percent: 5,
        speed_ticks: 10_000,
        ticks_per_minute: 60_000,
    };
    let (mut angle, mut speed, mut wanted) = (0.0_f64, 0.5_f64, peak);
    for tick in 0..5_000 {
        let before = angle;
        angle += speed * plan.entry as f64 / 4_294_967_296.0;
        let index = (angle.floor() > before.floor()).then_some(angle.floor() as i32 * 4096);
        let _ = observer.tick(EncoderSample {
            count: (angle * 4096.0) as i32,
            edge_age_ns: None,
            index,
        });
        let now = FloatTick {
            observer: &observer,
            ahead: Ticks::ONE,
            hold: false,
            inside: false,
            arrival: &arrival,
        };
        assert_eq!(run.tick(plan, &now).alarm, None);
        if run.line(plan).is_some() {
            return speed;
        }
        // The observer knows the angle before the spindle comes up to speed.
        if tick >= 400 {
            speed += (wanted - speed).clamp(-ramp, ramp);
        }
        if speed == peak {
            wanted = 1.0;
        }
    }
    panic!("the hole does not begin");
}

#[test]
fn what_a_spindle_collects_on_its_way_up_does_not_count_on_its_way_down() {
    let plan = plan(&fast_peck());
    assert!(plan.settling > 0);
    for percent in [108, 110, 115, 120, 140] {
        let at = begins_at(&plan, f64::from(percent) / 100.0);
        assert!(at < 1.01, "{percent}: {at}");
    }
}
