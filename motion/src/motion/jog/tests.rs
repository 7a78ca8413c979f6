use super::*;
use crate::motion::Limits;
use crate::params::Params;
use crate::units::{Feed, Rpm};

const MM: i64 = 1_000_000;

fn mm(mm: i64) -> Length {
    Length::from_nm(mm * MM)
}

fn speed(mm_per_min: i64) -> PathRate {
    PathRate::of_feed(Feed::from_nm_per_min(mm_per_min * MM), 1000)
}

/// The built-in machine: X 2 m/s², 60 m/s³.
struct Bench {
    jog: Jog,
    limits: Limits,
    x: AxisTravel,
    z: AxisTravel,
    position: Position,
    feed: Rate,
    rapid: Rate,
    now: u32,
    /// The last three positions of X and Z, the newest first.
    past: [[i64; 2]; 3],
}

impl Bench {
    fn new() -> Self {
        Self {
            jog: Jog::new(),
            limits: Limits::from_params(&Params::default()),
            x: AxisTravel {
                low: mm(-200),
                high: mm(100),
            },
            z: AxisTravel {
                low: mm(-500),
                high: mm(0),
            },
            position: Position::ZERO,
            feed: Rate::FULL,
            rapid: Rate::FULL,
            now: 0,
            past: [[0; 2]; 3],
        }
    }

    fn ask(&self, axis: Axis, towards: Towards, mm_per_min: i64) -> AxisPress {
        let fast = (speed(mm_per_min), speed(5_000));
        AxisPress::new((axis, towards), fast, false, &self.limits).unwrap()
    }

    fn press(&mut self, number: u8, x: Option<AxisPress>, z: Option<AxisPress>, until: u32) {
        let press = Press {
            number,
            x,
            z,
            spindle: Rpm::STOPPED,
            at_rapid: false,
            slow: false,
            tip: None,
            way: None,
            wheel: None,
            until: Some(until),
            returns: false,
        };
        self.jog.press(&press, &self.x, &self.z);
    }

    fn step(&mut self, number: u8, z: AxisPress, way: Length) {
        let press = Press {
            number,
            x: None,
            z: Some(z),
            spindle: Rpm::STOPPED,
            at_rapid: false,
            slow: false,
            tip: None,
            way: Some(way),
            wheel: None,
            until: None,
            returns: false,
        };
        self.jog.press(&press, &self.x, &self.z);
    }

    /// A claim of the handwheel on Z, or its next frame: turned so far since its beginning.
    fn turn(&mut self, number: u8, way: Length, wheel: Wheel, until: u32) {
        let z = AxisPress::led(Axis::Z, speed(3_000), &self.limits);
        let press = Press {
            number,
            x: None,
            z,
            spindle: Rpm::STOPPED,
            at_rapid: false,
            slow: false,
            tip: None,
            way: Some(way),
            wheel: Some(wheel),
            until: Some(until),
            returns: false,
        };
        self.jog.press(&press, &self.x, &self.z);
    }

    /// One tick, within every limit of the axes. True where counts of a wheel are told to be too many.
    fn tick(&mut self) -> bool {
        self.now = self.now.wrapping_add(1);
        let conditions = JogConditions {
            now: self.now,
            feed: self.feed,
            rapid: self.rapid,
        };
        let drops = self
            .jog
            .tick(&conditions, &self.x, &self.z, &mut self.position);
        let new = [self.position.x.nm(), self.position.z.nm()];
        for (place, axis) in [Axis::X, Axis::Z].into_iter().enumerate() {
            let [a, b, c] = self.past.map(|past| past[place]);
            let limits = self.limits.of_axis(axis, Pace::Rapid);
            let (v, acc, jerk) = (new[place] - a, new[place] - 2 * a + b, {
                new[place] - 3 * a + 3 * b - c
            });
            // Half a nanometre a position: 1, 2 and 4 nm in the differences.
            assert!(v.unsigned_abs() <= u64::from(limits.speed.raw() >> 8) + 1);
            assert!(
                acc.unsigned_abs() <= (limits.acceleration >> 32) + 2,
                "{acc}"
            );
            assert!(jerk.unsigned_abs() <= (limits.jerk >> 32) + 4, "{jerk}");
        }
        self.past = [new, self.past[0], self.past[1]];
        assert!(self.position.x >= self.x.low && self.position.x <= self.x.high);
        assert!(self.position.z >= self.z.low && self.position.z <= self.z.high);
        drops
    }

    fn rest(&mut self) {
        for _ in 0..100_000 {
            self.tick();
            if !self.jog.is_busy() {
                return;
            }
        }
        panic!("still busy");
    }
}

#[test]
fn a_press_ends_exactly_at_the_limit_and_another_moves_no_farther() {
    let mut bench = Bench::new();
    let x = bench.ask(Axis::X, Towards::Minus, 5_000);
    bench.press(1, Some(x), None, u32::MAX / 4);
    bench.rest();
    assert_eq!(bench.position.x, mm(-200));
    assert_eq!(bench.jog.last(), (1, PressState::Limit));
    bench.press(2, Some(x), None, u32::MAX / 4);
    bench.rest();
    assert_eq!(bench.position.x, mm(-200));
    assert_eq!(bench.jog.last(), (2, PressState::Limit));
}

#[test]
fn without_a_renewal_the_axis_brakes_after_its_tick_and_no_renewal_moves_it_again() {
    let mut bench = Bench::new();
    let z = bench.ask(Axis::Z, Towards::Minus, 3_000);
    bench.press(7, None, Some(z), 500);
    while bench.now < 500 {
        bench.tick();
        assert_eq!(bench.jog.last(), (7, PressState::Runs));
    }
    let at = bench.position.z;
    bench.tick();
    assert_eq!(bench.jog.last(), (7, PressState::Ended));
    bench.rest();
    // v/2 · (cap/a + a/j), with cap = 1.5 v: 50 mm/s, 75 mm/s, and the limits of Z.
    let limits = bench.limits.of_axis(Axis::Z, Pace::Rapid);
    let per_tick = |raw: u64| (raw >> 32) as i64;
    let (a, j) = (per_tick(limits.acceleration), per_tick(limits.jerk));
    let v = 50_000;
    let way = v * (75_000 / a + a / j + 3) / 2;
    let gone = (at - bench.position.z).nm();
    assert!(gone <= way, "{gone} of {way}");
    let rest = bench.position;
    bench.press(7, None, Some(z), 100_000);
    bench.rest();
    assert_eq!(bench.position, rest);
}

#[test]
fn a_renewal_puts_the_end_off_and_an_older_one_does_not_bring_it_back() {
    let mut bench = Bench::new();
    let z = bench.ask(Axis::Z, Towards::Minus, 1_000);
    bench.press(1, None, Some(z), 100);
    bench.press(1, None, Some(z), 300);
    bench.press(1, None, Some(z), 50);
    while bench.now < 300 {
        bench.tick();
        assert_eq!(bench.jog.last().1, PressState::Runs);
    }
    bench.tick();
    assert_eq!(bench.jog.last().1, PressState::Ended);
}

#[test]
fn one_axis_brakes_while_the_other_goes_on_and_an_axis_turns_round_from_rest() {
    let mut bench = Bench::new();
    let x = bench.ask(Axis::X, Towards::Minus, 1_000);
    let back = bench.ask(Axis::X, Towards::Plus, 1_000);
    let z = bench.ask(Axis::Z, Towards::Minus, 1_000);
    bench.press(1, Some(x), Some(z), 100_000);
    for _ in 0..500 {
        bench.tick();
    }
    bench.press(1, Some(back), Some(z), 100_000);
    let turned = bench.position.x;
    for _ in 0..500 {
        bench.tick();
    }
    assert!(bench.position.x > turned);
    let [[_, last], [_, before], _] = bench.past;
    // At speed all the time: 1 m/min is 16 667 nm in a tick, and positions are whole nanometres.
    assert!([16_666, 16_667].contains(&(before - last)));
}

#[test]
fn steps_add_up_and_end_where_they_are_to() {
    let mut bench = Bench::new();
    let z = bench.ask(Axis::Z, Towards::Minus, 2_000);
    bench.step(1, z, mm(1));
    for number in 2..=4 {
        for _ in 0..20 {
            bench.tick();
        }
        bench.step(number, z, mm(1));
    }
    bench.rest();
    assert_eq!(bench.position.z, mm(-4));
    assert_eq!(bench.jog.last(), (4, PressState::Ended));
    // The renewal of a step that is done.
    bench.step(4, z, mm(1));
    bench.rest();
    assert_eq!(bench.position.z, mm(-4));
}

#[test]
fn feed_hold_by_the_override_stands_and_goes_on() {
    let mut bench = Bench::new();
    let z = bench.ask(Axis::Z, Towards::Minus, 2_000);
    bench.step(1, z, mm(10));
    for _ in 0..100 {
        bench.tick();
    }
    bench.feed = Rate::HOLD;
    for _ in 0..1_000 {
        bench.tick();
    }
    let at = bench.position.z;
    bench.tick();
    assert_eq!(bench.position.z, at);
    assert!(bench.jog.is_busy());
    bench.feed = Rate::percent(150);
    bench.rest();
    assert_eq!(bench.position.z, mm(-10));
}

/// Any presses, releases, renewals and overrides: never beyond a limit of position, speed, acceleration or jerk, which
/// [`Bench::tick`] asserts; and at rest in time after the last press.
#[test]
fn whatever_is_pressed_the_axes_keep_their_limits() {
    leadscrew_seed::volume(11, |seed| {
        let mut random = leadscrew_seed::Random(seed | 1);
        let mut random = |below| random.below(below);
        let mut bench = Bench::new();
        let (mut number, mut pressed, mut limits) = (0_u8, None, 0_u32);
        for _ in 0..leadscrew_seed::amount(600, 100_000) {
            number = number.wrapping_add(u8::from(random(3) > 0));
            let mut ask = |axis| {
                let towards =
                    [None, Some(Towards::Plus), Some(Towards::Minus)][random(3) as usize]?;
                Some(bench.ask(axis, towards, random(5_000) as i64 + 1))
            };
            let (x, z) = (ask(Axis::X), ask(Axis::Z));
            match random(6) {
                0 => bench.jog.release(),
                1 => {
                    let way = Length::from_nm(random(3_000_000) as i64 + 1);
                    if let Some(z) = z {
                        // A step is no renewal of a press.
                        number = number.wrapping_add(1);
                        pressed = None;
                        bench.step(number, z, way);
                        number = number.wrapping_add(1);
                    }
                }
                2 => bench.feed = Rate::percent(random(151) as u8),
                _ => {
                    let until = bench.now + random(400) as u32;
                    bench.press(number, x, z, until);
                    pressed = (bench.jog.last().1 == PressState::Runs).then_some((x, z));
                }
            }
            for _ in 0..random(300) {
                bench.tick();
            }
            // A press that has come to its limit stands there, to the nanometre.
            let stands = |asked: Option<AxisPress>, at: Length, travel: &AxisTravel| {
                asked.is_none_or(|asked| travel.left(at, asked.towards) == Length::ZERO)
            };
            if bench.jog.last() == (number, PressState::Limit)
                && let Some((x, z)) = pressed
            {
                limits += 1;
                let at = bench.position;
                assert!(
                    stands(x, at.x, &bench.x) && stands(z, at.z, &bench.z),
                    "{seed}"
                );
            }
        }
        assert!(limits > 0, "seed {seed}");
        bench.feed = Rate::FULL;
        bench.jog.release();
        for _ in 0..400 {
            bench.tick();
        }
        assert!(!bench.jog.is_busy(), "seed {seed}");
    });
}

/// 50 ms of 3 m/min.
const DROPS: Wheel = Wheel {
    lag: mm_tenths(25),
    warns: false,
};
const FOLLOWS: Wheel = Wheel {
    lag: mm_tenths(35),
    warns: true,
};
const ALIVE: u32 = u32::MAX / 4;
/// No axis of the bench needs longer to come to rest behind a wheel, in ticks.
const RUN_OUT: u32 = 300;

const fn mm_tenths(tenths: i64) -> Length {
    Length::from_nm(tenths * MM / 10)
}

impl Bench {
    fn ticks(&mut self, ticks: u32) -> u32 {
        (0..ticks).map(|_| u32::from(self.tick())).sum()
    }

    /// From `-250 mm` on.
    fn in_the_middle() -> Self {
        let mut bench = Self::new();
        bench.position.z = mm(-250);
        bench.past = [[0, -250 * MM]; 3];
        bench
    }
}

#[test]
fn an_axis_comes_to_rest_where_the_wheel_has_led_it_and_a_claim_alone_moves_nothing() {
    let mut bench = Bench::in_the_middle();
    bench.turn(1, Length::ZERO, DROPS, ALIVE);
    bench.ticks(100);
    assert!(bench.jog.is_busy() && !bench.jog.moves());
    for way in [1_000, 101_000, 1_101_000, 1_100_000, -1_000_000] {
        bench.turn(1, Length::from_nm(way), DROPS, ALIVE);
        bench.ticks(RUN_OUT);
        assert_eq!(bench.position.z, mm(-250) + Length::from_nm(way));
        assert!(!bench.jog.moves());
    }
    assert_eq!(bench.jog.last(), (1, PressState::Runs));
    // The next claim counts from there, and the feed override does not act.
    bench.feed = Rate::HOLD;
    bench.turn(2, mm(2), DROPS, ALIVE);
    bench.ticks(RUN_OUT);
    assert_eq!(bench.position.z, mm(-249));
}

#[test]
fn turned_against_the_end_of_its_travel_an_axis_stands_there_exactly_and_turns_back_at_once() {
    let mut bench = Bench::new();
    bench.position.z = mm(-3);
    bench.past = [[0, -3 * MM]; 3];
    for step in 1..=200 {
        bench.turn(1, mm_tenths(step), DROPS, ALIVE);
        bench.ticks(5);
    }
    bench.ticks(RUN_OUT);
    assert_eq!(bench.position.z, mm(0));
    bench.turn(1, mm_tenths(199), DROPS, ALIVE);
    bench.ticks(RUN_OUT);
    assert_eq!(bench.position.z, mm_tenths(-1));
}

#[test]
fn beyond_its_travel_an_axis_is_led_back_only() {
    let mut bench = Bench::in_the_middle();
    bench.z.high = mm(-251);
    // Within the travel again from the fourth on. In tenths of a millimetre: turned so far, at so much.
    for (way, at) in [
        (10, -2_500),
        (5, -2_505),
        (10, -2_505),
        (-10, -2_525),
        (10, -2_510),
    ] {
        bench.turn(1, mm_tenths(way), DROPS, ALIVE);
        // Without what `Bench::tick` asserts of the travel.
        let conditions = JogConditions {
            now: 0,
            feed: Rate::FULL,
            rapid: Rate::FULL,
        };
        for _ in 0..RUN_OUT {
            bench
                .jog
                .tick(&conditions, &bench.x, &bench.z, &mut bench.position);
        }
        assert_eq!(bench.position.z, mm_tenths(at));
    }
}

#[test]
fn without_frames_the_target_freezes_and_a_dead_claim_leads_nothing() {
    let mut bench = Bench::in_the_middle();
    bench.turn(1, mm(2), DROPS, 20);
    bench.ticks(20);
    assert_eq!(bench.jog.last(), (1, PressState::Runs));
    bench.tick();
    assert_eq!(bench.jog.last(), (1, PressState::Ended));
    bench.rest();
    // 20 ticks of 50 µm.
    assert_eq!(bench.position.z, mm(-249));
    bench.turn(1, mm(4), DROPS, ALIVE);
    bench.ticks(RUN_OUT);
    assert_eq!(bench.position.z, mm(-249));
    // A new claim while the axis comes to rest from the one before.
    bench.turn(2, mm(1), DROPS, ALIVE);
    bench.ticks(10);
    bench.turn(3, mm(1), DROPS, ALIVE);
    bench.ticks(RUN_OUT);
    assert_eq!(bench.position.z, mm(-249) + mm_tenths(15));
}

#[test]
fn what_a_wheel_is_turned_too_fast_is_dropped_or_told_once_in_a_claim() {
    for (wheel, told) in [(DROPS, 0), (FOLLOWS, 1)] {
        let mut bench = Bench::in_the_middle();
        for claim in 1..=2 {
            let at = bench.position.z;
            bench.turn(claim, mm(20), wheel, ALIVE);
            let mut warned = bench.ticks(RUN_OUT);
            assert_eq!(bench.position.z - at, wheel.lag);
            bench.turn(claim, mm(40), wheel, ALIVE);
            warned += bench.ticks(RUN_OUT);
            assert_eq!(bench.position.z - at, wheel.lag + wheel.lag);
            assert_eq!(warned, told);
        }
    }
}

/// A press follows a wheel, and a wheel a press, before the axis stands.
#[test]
fn a_press_and_a_wheel_take_turns_from_rest_only() {
    let mut bench = Bench::in_the_middle();
    let z = bench.ask(Axis::Z, Towards::Minus, 2_000);
    bench.press(1, None, Some(z), 50);
    bench.ticks(50);
    bench.turn(2, mm(1), DROPS, ALIVE);
    bench.ticks(2 * RUN_OUT);
    let at = bench.position.z;
    bench.turn(2, mm(3), DROPS, ALIVE);
    bench.ticks(20);
    bench.step(3, z, mm(1));
    bench.ticks(2 * RUN_OUT);
    assert_eq!(bench.position.z, at + mm(1) - mm(1));
    assert_eq!(bench.jog.last(), (3, PressState::Ended));
}

/// However a wheel is turned: never beyond a limit of position, speed, acceleration or jerk, which [`Bench::tick`] asserts;
/// always the two means of a target that never leaves the travel; and at rest the axis stands on it.
#[test]
fn however_a_wheel_is_turned_its_axis_keeps_its_limits() {
    leadscrew_seed::volume(13, |seed| {
        let mut random = leadscrew_seed::Random(seed | 1);
        let mut random = |below| random.below(below);
        let mut bench = Bench::in_the_middle();
        let most = speed(3_000).raw() as i64;
        let (mut way, mut taken) = (0_i64, 0_i64);
        let mut target = -250 * MM * 256;
        let (low, high) = (-500 * MM * 256, 0);
        bench.turn(1, Length::ZERO, DROPS, ALIVE);
        for _ in 0..leadscrew_seed::amount(600, 100_000) {
            let step = [1_000, 10_000, 100_000][random(3) as usize];
            let counts = random(61) as i64 - 30;
            for _ in 0..random(20) {
                way += step * counts;
                bench.turn(1, Length::from_nm(way), DROPS, ALIVE);
                for _ in 0..random(30) {
                    bench.tick();
                    // The same again, from its definition.
                    let lag = DROPS.lag.nm() * 256;
                    let left = (way * 256 - taken).clamp(-lag, lag);
                    let left = left.max(low - target).min(high - target);
                    let step = left.clamp(-most, most);
                    taken = way * 256 - left + step;
                    target += step;
                }
            }
            if random(4) == 0 {
                bench.ticks(RUN_OUT);
                let lag = DROPS.lag.nm() * 256;
                let left = (way * 256 - taken).clamp(-lag, lag);
                target = (target + left).clamp(low, high);
                taken = way * 256;
                assert_eq!(bench.position.z.nm() * 256, target, "seed {seed}");
            }
        }
    });
}

/// A wheel that is turned no faster than its axis may go loses no count, however often and wherever it turns round.
#[test]
fn a_wheel_within_its_speed_loses_no_count() {
    leadscrew_seed::volume(12_345, |seed| {
        let mut random = leadscrew_seed::Random(seed | 1);
        let mut random = |below| random.below(below);
        let mut bench = Bench::in_the_middle();
        let (mut counted, mut count) = (0_u64, 0_i64);
        let all = leadscrew_seed::amount(100_000, 10_000_000) as u64;
        while counted < all {
            // 50 µm in a tick are 50 counts of a micrometre.
            let rate = random(50) as i64 + 1;
            let towards = match count {
                ..-200_000 => 1,
                200_000.. => -1,
                _ => random(2) as i64 * 2 - 1,
            };
            for _ in 0..random(400) {
                count += towards * rate;
                counted += rate as u64;
                bench.turn(1, Length::from_nm(count * 1_000), DROPS, ALIVE);
                bench.tick();
            }
            if random(20) == 0 {
                bench.ticks(RUN_OUT);
                assert_eq!(bench.position.z.nm(), -250 * MM + count * 1_000);
            }
        }
        bench.ticks(RUN_OUT);
        assert_eq!(bench.position.z.nm(), -250 * MM + count * 1_000);
    });
}
