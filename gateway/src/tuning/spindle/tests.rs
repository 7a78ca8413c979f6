//! Against spindles whose ramps and ripples are known.

use super::*;

/// Time between two looks, and between two steps of the model.
const EVERY: f64 = 0.01;
const STEP: f64 = 0.000_5;
const SECONDS: f64 = 10.0;

/// What swings: cycles in a turn or a second, and the amplitude as a share of the speed.
#[derive(Clone, Copy, Debug)]
enum Swing {
    Order(f64, f64),
    Hertz(f64, f64),
}

#[derive(Clone, Debug)]
struct Model {
    /// Seconds for each 1000 turns a minute.
    up: f64,
    down: f64,
    /// It turns at so much of what it is told.
    slip: f64,
    swings: Vec<Swing>,
}

impl Model {
    fn looks(&self, asked: &[f64]) -> Vec<Look> {
        let mut looks = Vec::new();
        let (mut angle, mut base, mut time) = (0.3, 0.0_f64, 0.0);
        let begun = |time: f64, looks: &mut Vec<Look>, angle: f64, speed: f64| {
            // A look falls on every twentieth step.
            if looks.len() as f64 * EVERY <= time + STEP / 2.0 {
                looks.push(Look {
                    time,
                    angle: (angle.rem_euclid(1.0) * 65_536.0).floor() / 65_536.0,
                    speed: (speed * 1000.0).round() / 1000.0,
                });
            }
        };
        for &speed in asked {
            for (to, lasts) in [
                (
                    speed * self.slip,
                    2.0 * MARGIN + SECONDS + 1.0 + self.up * speed / 1000.0,
                ),
                (0.0, 1.0 + self.down * speed / 1000.0),
            ] {
                let ramp = if to > 0.0 { self.up } else { self.down };
                for _ in 0..(lasts / STEP) as usize {
                    let by = 1000.0 / ramp * STEP;
                    base += (to - base).clamp(-by, by);
                    let swing: f64 = self.swings.iter().map(|swing| swing.at(time, angle)).sum();
                    let now = base * (1.0 + swing);
                    begun(time, &mut looks, angle, now);
                    angle += now / 60.0 * STEP;
                    time += STEP;
                }
            }
        }
        looks
    }

    fn found(&self, asked: &[f64]) -> Result<Found, Refusal> {
        look(&self.looks(asked), asked, &KNOWN)
    }
}

impl Swing {
    fn at(self, time: f64, angle: f64) -> f64 {
        match self {
            Self::Order(order, share) => share * (TAU * order * angle).sin(),
            Self::Hertz(hertz, share) => share * (TAU * hertz * time).sin(),
        }
    }
}

const KNOWN: Known = Known {
    seconds: SECONDS,
    band: 35.0,
};
const ASKED: [f64; 3] = [211.0, 503.0, 887.0];

#[test]
fn ramps_slip_and_swings_are_found() {
    let model = Model {
        up: 0.8,
        down: 0.5,
        slip: 0.97,
        swings: vec![Swing::Hertz(5.3, 0.04), Swing::Order(2.0, 0.01)],
    };
    let found = model.found(&ASKED).unwrap();
    for (run_up, asked) in found.run_ups.iter().zip(ASKED) {
        assert!(
            (run_up.mean / (asked * 0.97) - 1.0).abs() < 0.001,
            "{run_up:?}"
        );
        // The swing goes on in the ramp.
        assert!((run_up.up / 0.8 - 1.0).abs() < 0.12, "{run_up:?}");
        assert!((run_up.down / 0.5 - 1.0).abs() < 0.12, "{run_up:?}");
        assert!((run_up.variation - 0.05).abs() < 0.004, "{run_up:?}");
    }
    let [free, turning] = [found.sources[0], found.sources[1]];
    // Two swings have mixtures.
    let mixture = |source: &Source| source.share < 0.002;
    assert!(
        found.sources[2..].iter().all(mixture),
        "{:?}",
        found.sources
    );
    assert!(
        matches!(free.kind, Kind::Hertz(hertz) if (hertz - 5.3).abs() < 0.01),
        "{free:?}"
    );
    assert_eq!((turning.kind, turning.seen), (Kind::Order(2), 3));
    assert!((free.share - 0.04).abs() < 0.002, "{free:?}");
    assert!((turning.share - 0.01).abs() < 0.001, "{turning:?}");
}

#[test]
fn a_spindle_that_turns_evenly_has_no_lines() {
    let model = Model {
        up: 0.5,
        down: 0.5,
        slip: 1.0,
        swings: Vec::new(),
    };
    let found = model.found(&ASKED).unwrap();
    assert_eq!(found.sources, []);
    assert!((found.ramp - 0.5).abs() < 0.002, "{}", found.ramp);
    assert!(found.variation < 1e-4, "{}", found.variation);
}

/// 2 % of the second order; 0.1 % of a mixture has the frequency of the first speed by chance, at two others.
#[test]
fn a_much_smaller_line_of_another_speed_is_another_one() {
    let run_up = |mean: f64, lines: &[(f64, f64)]| RunUp {
        asked: mean,
        mean,
        up: 0.5,
        down: 0.5,
        variation: 0.05,
        lines: lines
            .iter()
            .map(|&(hertz, share)| Line { hertz, share })
            .collect(),
    };
    let run_ups = [
        run_up(600.0, &[(20.0, 0.02)]),
        run_up(780.0, &[(26.0, 0.02), (20.0, 0.001)]),
        run_up(1080.0, &[(20.0, 0.001)]),
    ];
    let sources = sources(&run_ups, &KNOWN);
    assert_eq!(sources[0].kind, Kind::Order(2));
    assert_eq!((sources[0].share, sources[0].seen), (0.02, 2));
}

/// At the second speed the mixture 2 × 14.74 − 5.73 Hz lies beside the second order of the first speed, 2 × 11.78 Hz; the
/// third speed has its second order above the band.
#[test]
fn a_mixture_beside_an_order_of_another_speed_does_not_hide_the_order() {
    let model = Model {
        up: 0.926,
        down: 1.055,
        slip: 1.0085,
        swings: vec![Swing::Hertz(5.732, 0.05), Swing::Order(2.0, 0.0372)],
    };
    let found = model.found(&[701.0, 877.0, 1103.0]).unwrap();
    assert_eq!(found.sources[1].kind, Kind::Order(2), "{:?}", found.sources);
    assert_eq!(found.sources[1].seen, 2);
}

/// At half the speed the second order has the frequency of the first one: nobody can tell which of both it is.
#[test]
fn speeds_that_are_multiples_do_not_tell_lines_apart() {
    let model = Model {
        up: 0.5,
        down: 0.5,
        slip: 1.0,
        swings: vec![Swing::Hertz(10.0, 0.02)],
    };
    let found = model.found(&[300.0, 600.0]).unwrap();
    let kinds: Vec<Kind> = found.sources.iter().map(|source| source.kind).collect();
    assert!(matches!(kinds[..], [Kind::Hertz(_)]), "{kinds:?}");
    let order = Model {
        swings: vec![Swing::Order(1.0, 0.02)],
        ..model
    };
    let found = order.found(&[300.0, 600.0]).unwrap();
    assert_eq!(found.sources[0].kind, Kind::Order(1));
}

#[test]
fn what_does_not_carry_a_result_is_refused() {
    let model = Model {
        up: 0.5,
        down: 0.5,
        slip: 1.0,
        swings: Vec::new(),
    };
    let looks = model.looks(&[300.0]);
    let asked = 300.0;
    let of = |looks: &[Look]| look(looks, &[asked], &KNOWN).unwrap_err();
    assert_eq!(of(&looks[50..]), Refusal::Turning { asked });
    assert_eq!(of(&looks[..1]), Refusal::NotReached { asked });
    assert_eq!(of(&looks[..400]), Refusal::NotAtRest { asked });
    assert_eq!(of(&[]), Refusal::Turning { asked });
    // The time at speed is cut out.
    let mut short = looks[..200].to_vec();
    short.extend_from_slice(&looks[looks.len() - 100..]);
    assert_eq!(of(&short), Refusal::NotReached { asked });
    // It grows slower all the time.
    let mut falling = looks.clone();
    for look in &mut falling {
        look.speed *= 1.0 - 0.01 * look.time;
    }
    assert!(matches!(of(&falling), Refusal::NotSettled { .. }));
}

/// Any ramp, slip and two swings that are far enough apart.
#[test]
fn random_spindles() {
    leadscrew_seed::volume(0x5B1D_1E00, |seed| {
        let mut state = seed;
        let mut within = |low: f64, high: f64| {
            // A step of SplitMix64.
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut of = state;
            of = (of ^ (of >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            of = (of ^ (of >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            low + (high - low) * ((of ^ (of >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        for round in 0..leadscrew_seed::amount(3, 40) {
            let (hertz, free) = (within(3.0, 9.0), within(0.005, 0.05));
            let (order, turning) = (within(1.0, 3.0).floor(), within(0.005, 0.05));
            let model = Model {
                up: within(0.2, 2.0),
                down: within(0.2, 2.0),
                slip: within(0.95, 1.02),
                swings: vec![Swing::Hertz(hertz, free), Swing::Order(order, turning)],
            };
            let what = format!("{round}: {model:?}");
            let found = model.found(&[701.0, 877.0, 1103.0]).expect(&what);
            let ramp = model.up.max(model.down);
            assert!(
                (found.ramp / ramp - 1.0).abs() < 0.2,
                "{what} {}",
                found.ramp
            );
            let share = |is: &dyn Fn(Kind) -> bool| {
                let of = found.sources.iter().find(|source| is(source.kind));
                of.unwrap_or_else(|| panic!("{what} {:?}", found.sources))
                    .share
            };
            let near = |of: f64| (of - hertz).abs() < 0.05;
            let of_free = share(&|kind| matches!(kind, Kind::Hertz(of) if near(of)));
            assert!((of_free / free - 1.0).abs() < 0.15, "{what} {of_free}");
            let of_order = share(&|kind| kind == Kind::Order(order as u32));
            assert!((of_order / turning - 1.0).abs() < 0.15, "{what} {of_order}");
        }
    });
}
