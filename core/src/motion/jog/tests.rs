use super::*;
use crate::motion::Limits;
use crate::params::Params;
use crate::units::Feed;

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
            at_rapid: false,
            slow: false,
            way: None,
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
            at_rapid: false,
            slow: false,
            way: Some(way),
            until: None,
            returns: false,
        };
        self.jog.press(&press, &self.x, &self.z);
    }

    /// One tick, within every limit of the axes.
    fn tick(&mut self) {
        self.now = self.now.wrapping_add(1);
        let conditions = JogConditions {
            now: self.now,
            feed: self.feed,
            rapid: self.rapid,
        };
        self.jog
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
        let mut state = seed | 1;
        let mut random = |below: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let mut bench = Bench::new();
        let mut number = 0_u8;
        for _ in 0..leadscrew_seed::amount(60, 600) {
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
                        bench.step(number, z, way);
                    }
                }
                2 => bench.feed = Rate::percent(random(151) as u8),
                _ => {
                    let until = bench.now + random(400) as u32;
                    bench.press(number, x, z, until);
                }
            }
            for _ in 0..random(300) {
                bench.tick();
            }
        }
        bench.feed = Rate::FULL;
        bench.jog.release();
        for _ in 0..400 {
            bench.tick();
        }
        assert!(!bench.jog.is_busy(), "seed {seed}");
    });
}
