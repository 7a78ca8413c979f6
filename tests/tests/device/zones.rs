//! Zones on a board: what is moved by hand never enters one, and a program is refused before it moves.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::Event;
use leadscrew_core::bus::{BoardState, JogRequest};
use leadscrew_core::operating::{Led, OperatingMode, PressState, Towards, WheelFactor, Zone};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Diameter, Length};
use leadscrew_tests::gateway::NODE;
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::by_hand::{BRAKING, Hand, RENEWAL, WINDOW};

/// Nanometres in a millimetre.
const MM: i64 = 1_000_000;
/// Radius, and Z from, to, of what is set below.
const ZONES: [(i64, i64, i64); 3] = [
    (28 * MM, -75 * MM, -25 * MM),
    (20 * MM, -25 * MM, -5 * MM),
    (10 * MM, 40 * MM, i64::MAX),
];
/// The tip begins here, since the axes begin at 0.
const AT: (i64, i64) = (30 * MM, 10 * MM);
/// No axis takes longer to any end of these tests, in ticks.
const LONG: u64 = 1_500;

fn params() -> Params {
    with(&[
        ("9091", -25 * MM),
        ("9092", 50 * MM),
        ("9093", 56 * MM),
        ("9094", 20 * MM),
        ("9095", 40 * MM),
        ("9096", 40 * MM),
        ("9097", 20 * MM),
        ("9101.X", -AT.0),
        ("9101.Z", -AT.1),
        // Nothing but zones ends a motion of these tests.
        ("1320.X", 300 * MM),
        ("1321.X", -300 * MM),
        ("1320.Z", 300 * MM),
        ("1321.Z", -300 * MM),
    ])
}

struct Bench {
    hand: Hand,
    alarms: Vec<Alarm>,
}

impl Bench {
    /// With tool 1 in place.
    fn new(mode: OperatingMode) -> Self {
        let mut bench = Self {
            hand: Hand::on(&params(), mode),
            alarms: Vec::new(),
        };
        bench.program("T0101\nM30\n");
        bench
    }

    fn tip(&self) -> (i64, i64) {
        let at = self.hand.at();
        (at.x.nm() + AT.0, at.z.nm() + AT.1)
    }

    fn tick(&mut self) {
        self.hand.tick();
        let (x, z) = self.tip();
        for (radius, from, to) in ZONES {
            let inside = x.abs() <= radius && from <= z && z <= to;
            assert!(!inside, "the tip is at X {x} Z {z}");
        }
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Runs a program to its end, in whatever mode.
    fn program(&mut self, text: &str) {
        let params = params();
        for call in calls(text, &params) {
            assert!(self.hand.sim.offer(&call));
        }
        for _ in 0..5_000 {
            self.hand.sim.step();
            while let Some(event) = self.hand.sim.event() {
                if let Event::Alarm(alarm) = event {
                    self.alarms.push(alarm);
                }
            }
            self.hand.gateway.listen(&mut self.hand.sim);
        }
    }

    fn jog(&mut self, x: Option<Towards>, z: Option<Towards>, rapid: bool, ticks: u64) {
        for tick in 0..ticks {
            if tick % RENEWAL == 0 {
                let frame = JogRequest {
                    session: 1,
                    press: self.hand.press,
                    x,
                    z,
                    spindle: None,
                    rapid,
                    speed: 3_000,
                    echo: self.hand.gateway.beat.beat,
                };
                self.hand.sim.receive(&frame.frame(NODE));
            }
            self.tick();
        }
    }
}

const MINUS: Option<Towards> = Some(Towards::Minus);

#[test]
fn a_press_ends_a_micrometre_before_a_zone_from_any_speed() {
    for rapid in [false, true] {
        // In front of the jaws.
        let mut bench = Bench::new(OperatingMode::Manual);
        bench.hand.press = 1;
        bench.jog(MINUS, None, false, 400);
        bench.run(WINDOW + BRAKING);
        bench.hand.press = 2;
        bench.jog(None, MINUS, rapid, LONG);
        assert_eq!(bench.tip().1, -5 * MM + 1_000);
        assert_eq!(bench.hand.gateway.beat.state, PressState::Limit);
        bench.hand.press = 3;
        bench.jog(None, Some(Towards::Plus), rapid, LONG);
        assert_eq!(bench.tip().1, 40 * MM - 1_000);
    }
}

/// Presses that change in their middle, of both axes, at both speeds, with pauses or without.
#[test]
fn no_jog_and_no_wheel_leads_into_a_zone() {
    leadscrew_seed::volume(61, |seed| {
        let mut random = Random(seed);
        let mut ends = 0;
        for _ in 0..leadscrew_seed::amount(4, 30) {
            let mut bench = Bench::new(OperatingMode::Manual);
            for _ in 0..leadscrew_seed::amount(40, 200) {
                bench.hand.press = bench.hand.press.wrapping_add(1);
                let rapid = random.chance(60);
                for _ in 0..random.within(1, 3) {
                    let mut side = || random.of(&[None, MINUS, MINUS, Some(Towards::Plus)]);
                    let (x, z) = (side(), side());
                    bench.jog(x, z, rapid, random.within(1, 500) as u64);
                }
                let (x, z) = bench.tip();
                ends += u64::from(ZONES.iter().any(|(radius, from, to)| {
                    x == radius + 1_000 || z == from - 1_000 || z == to.saturating_add(1_000)
                }));
                if random.chance(30) {
                    bench.run(WINDOW + BRAKING);
                }
            }
            bench.run(WINDOW + BRAKING);
            bench.hand.mode(OperatingMode::Wheel);
            let mut count = 0_u16;
            for _ in 0..leadscrew_seed::amount(20, 100) {
                bench.hand.press = bench.hand.press.wrapping_add(1);
                let leads = random.of(&[Led::X, Led::Z]);
                for _ in 0..random.within(2, 40) {
                    count = count.wrapping_add_signed(random.within(-60, 40) as i16);
                    let frame = bench.hand.wheel(leads, WheelFactor::Hundred, count);
                    bench.hand.sim.receive(&frame);
                    bench.run(RENEWAL);
                }
                let (x, z) = bench.tip();
                ends += u64::from(ZONES.iter().any(|(radius, from, to)| {
                    x == radius + 1_000 || z == from - 1_000 || z == to.saturating_add(1_000)
                }));
            }
        }
        assert!(
            ends > leadscrew_seed::amount(1, 5),
            "zones were met {ends} times"
        );
    });
}

#[test]
fn a_step_into_a_zone_is_refused_whole_and_one_up_to_it_is_made() {
    let mut bench = Bench::new(OperatingMode::Manual);
    bench.hand.press = 1;
    bench.jog(MINUS, None, false, 400);
    bench.run(WINDOW + BRAKING);
    bench.hand.mode(OperatingMode::Step);
    let (_, z) = bench.tip();
    let free = z - (-5 * MM + 1_000);
    for (way, refused) in [(free / 100 + 1, 4541), (free / 100, 0)] {
        bench.hand.press += 1;
        let frame = bench.hand.step(true, -i32::try_from(way).expect("short"));
        for _ in 0..LONG / RENEWAL {
            let renewal = bench.hand.step(true, -i32::try_from(way).expect("short"));
            bench
                .hand
                .sim
                .receive(if way == 0 { &frame } else { &renewal });
            bench.run(RENEWAL);
        }
        assert_eq!(bench.hand.refused(), refused);
    }
    assert!(bench.tip().1 - (-5 * MM + 1_000) < 100);
}

#[test]
fn a_program_is_refused_before_its_block_moves() {
    let mut bench = Bench::new(OperatingMode::Automatic);
    // Both ends are outside: X 60 Z-80 is behind the chuck.
    bench.program("T0101\nG98 G1 X60 Z5 F2000\nG0 X30 Z-90\nM30\n");
    let [alarm] = bench.alarms[..] else {
        panic!("{:?}", bench.alarms);
    };
    assert_eq!((alarm.code, alarm.span.line), (Code::ZoneEntered, 3));
    assert_eq!(alarm.args[0], Arg::Zone(Zone::Chuck));
    assert_eq!(bench.tip(), (30 * MM, 5 * MM));
    assert_eq!(alarm.args[1], Arg::Letter(b'X'));
    // From the edge of the chuck to X 30.
    let by = Diameter::of_radius(Length::from_nm(13 * MM));
    assert_eq!(alarm.args[2], Arg::Diameter(by));
}

#[test]
fn a_tool_that_was_not_measured_is_moved_slowly_by_hand_and_not_by_a_program() {
    let mut bench = Bench::new(OperatingMode::Manual);
    bench.program("T0202\nM30\n");
    let x = bench.hand.at().x.nm();
    bench.hand.press = 1;
    bench.jog(Some(Towards::Plus), None, true, 600);
    // 1 m/min, 16.7 µm in a tick.
    let gone = bench.hand.at().x.nm() - x;
    assert!((5 * MM..10 * MM).contains(&gone), "{gone}");
    bench.run(WINDOW + BRAKING);
    let at = bench.hand.at();
    bench.program("G0 X100\nM30\n");
    assert_eq!(bench.alarms.len(), 1);
    assert_eq!(bench.alarms[0].code, Code::TipUnknown);
    assert_eq!(bench.alarms[0].args[0], Arg::Int(2));
    assert_eq!(bench.hand.at(), at);
    assert_eq!(bench.hand.gateway.status.state, BoardState::Alarm);
}
