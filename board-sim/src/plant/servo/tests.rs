//! The servo against theory, its limits, and anything at random.

extern crate std;

use super::*;
use crate::plant::tests::drives::Random;
use leadscrew_core::units::{Acceleration, Feed, Length};
use std::vec::Vec;

/// A tick of 1 ms.
const T: f64 = 1e-3;
const H: f64 = T / STEPS as f64;
const NO_WINDOW: Following = Following {
    window: Following::OFF,
    timeout_ms: 0,
};

/// A speed loop without integral, a current without delay, no friction, no play: what the formulas are about.
fn plain(kv: u32, ff_percent: u16, buffer: u8) -> ServoOptions {
    ServoOptions {
        buffer,
        kv_milli: kv * 1000,
        feed_forward_milli: ff_percent * 10,
        ..ServoOptions::LOOPS_ALONE
    }
}

/// One increment is one nanometre.
fn servo(options: &ServoOptions) -> Servo {
    Servo::new(options, (1, 1), 1000, Increments::new(0)).unwrap()
}

/// A period with this target; gives the position at its end in nanometres.
fn period(servo: &mut Servo, target: i64) -> f64 {
    assert_eq!(servo.latch(Increments::new(target as i32), true), None);
    assert_eq!(servo.period(NO_WINDOW), None);
    servo.z as f64 / 65_536.0
}

#[test]
fn at_constant_speed_it_is_late_by_buffer_and_loop() {
    for buffer in [0, 5, 10] {
        for kv in [15, 30, 100] {
            for ff in [0, 50, 100] {
                let mut servo = servo(&plain(kv, ff, buffer));
                // 60 mm/s for two seconds.
                let (mut z, mut target) = (0.0, 0);
                for _ in 0..2000 {
                    target += 60_000;
                    z = period(&mut servo, target);
                }
                let lag = (target as f64 - z) / 60e6;
                let theory =
                    f64::from(buffer) * T + (1.0 - f64::from(ff) / 100.0) / f64::from(kv) - H;
                let off = (lag - theory).abs();
                assert!(off < 0.1e-6, "n {buffer}, Kv {kv}, ff {ff}: {lag} {theory}");
            }
        }
    }
}

#[test]
fn a_cubic_is_late_by_a_period_more() {
    let lag = |interpolation| {
        let mut servo = servo(&ServoOptions {
            interpolation,
            ..plain(30, 0, 2)
        });
        (1..1000).fold(0.0, |_, k| {
            k as f64 * 60_000.0 - period(&mut servo, k * 60_000)
        }) / 60e6
    };
    let more = lag(Interpolation::Cubic) - lag(Interpolation::Linear);
    assert!((more - T).abs() < 0.01e-6, "{more}");
}

#[test]
fn a_cubic_goes_through_its_targets_without_a_corner() {
    let mut path = Path::new(0, 0, Interpolation::Cubic);
    let square = |k: i64| k * k * 1_000_000;
    for k in 0..6 {
        path.push(square(k));
    }
    // A parabola is a cubic: place and speed are exact between the third and fourth target.
    for part in 0..=8 {
        let u = 3.0 + part as f64 / 8.0;
        let (place, speed) = path.at(part);
        assert!((place as f64 - u * u * 1e6).abs() <= 0.5, "{part}: {place}");
        let expected = 2.0 * u * 1e6 / 8.0 * 65_536.0;
        assert!((speed as f64 - expected).abs() <= 1.0, "{part}: {speed}");
    }
}

#[test]
fn at_constant_acceleration_the_error_is_that_of_the_formula() {
    for (kv, ff) in [(15, 0), (30, 0), (30, 50), (100, 0), (30, 100)] {
        let mut servo = servo(&plain(kv, ff, 0));
        let a = 2.0;
        let at = |k: i64| k * k * 1000;
        let ticks = 600;
        let z = (1..=ticks).fold(0.0, |_, k| period(&mut servo, at(k)));
        let v = a * ticks as f64 * T;
        let (kv, rest) = (f64::from(kv), 1.0 - f64::from(ff) / 100.0);
        let error = (at(ticks) as f64 - z) * 1e-9;
        let by_speed = rest / kv * v;
        let by_acceleration = a * (1.0 / (kv * 400.0) - rest / (kv * kv));
        // The order of the steps takes off h of the speed, and half a step of each loop's time from the rest; the
        // straight lines between targets cut a·T²/12 off the parabola at most.
        let theory = by_speed + by_acceleration - v * H;
        let step = a * H * (2.0 * rest / kv + 1.0 / 400.0 + T);
        assert!(
            (error - theory).abs() < step,
            "{kv} {rest}: {error} {theory}"
        );
    }
}

/// The second-order response of G to a unit step, ff = 0.
fn response(kv: f64, wv: f64, t: f64) -> f64 {
    if t <= 0.0 {
        return 0.0;
    }
    let (w, zeta) = ((kv * wv).sqrt(), 0.5 * (wv / kv).sqrt());
    if zeta < 1.0 {
        let wd = w * (1.0 - zeta * zeta).sqrt();
        let decay = (-zeta * w * t).exp();
        1.0 - decay * ((wd * t).cos() + zeta * w / wd * (wd * t).sin())
    } else {
        let root = (zeta * zeta - 1.0).sqrt();
        let (fast, slow) = (w * (zeta + root), w * (zeta - root));
        1.0 - (fast * (-slow * t).exp() - slow * (-fast * t).exp()) / (fast - slow)
    }
}

#[test]
fn a_step_is_answered_as_by_a_second_order_system() {
    for kv in [15.0, 30.0, 90.0, 200.0] {
        let mut servo = servo(&plain(kv as u32, 0, 0));
        for k in 1..=300 {
            let z = period(&mut servo, 1_000_000) / 1e6;
            // The interpolation makes a ramp of one period of the step, and the order of the inner steps is h early.
            let parts = 64;
            let theory = (0..parts)
                .map(|part| {
                    let ago = (f64::from(part) + 0.5) / f64::from(parts) * T;
                    response(kv, 400.0, k as f64 * T - ago + H)
                })
                .sum::<f64>()
                / f64::from(parts);
            assert!((z - theory).abs() < 0.01, "Kv {kv}, {k} ms: {z} {theory}");
        }
    }
}

#[test]
fn at_a_reversal_the_load_stands_for_the_play() {
    let mut servo = servo(&ServoOptions {
        play: Length::from_nm(20_000),
        ..plain(30, 0, 0)
    });
    let mut target = 0;
    for _ in 0..500 {
        target += 1000;
        period(&mut servo, target);
    }
    const HALF: i64 = 10_000 << 16;
    // Without feed-forward it comes to its target without overshoot.
    for _ in 0..1000 {
        period(&mut servo, target);
    }
    assert_eq!(servo.z - servo.load, HALF);
    while servo.v >= 0 {
        target -= 100;
        period(&mut servo, target);
    }
    let stood = servo.load;
    let (mut standing, mut led) = (0, 0);
    while led < 20 {
        target -= 100;
        period(&mut servo, target);
        if servo.z >= stood - HALF {
            assert_eq!(servo.load, stood);
            standing += 1;
        } else {
            assert_eq!(servo.load, servo.z + HALF);
            led += 1;
        }
    }
    // 20 µm at 0.1 µm a period, behind a lag of 1/Kv.
    assert!((228..=236).contains(&standing), "{standing}");
}

#[test]
fn friction_holds_a_small_error_and_stops_a_motion() {
    let friction = Acceleration::from_nm_per_s2(400_000_000);
    let mut servo = servo(&ServoOptions {
        sticking: friction,
        sliding: Acceleration::from_nm_per_s2(250_000_000),
        ..plain(30, 0, 0)
    });
    // ωv · Kv · e = 0.36 m/s² is below the friction at rest of 0.4 m/s².
    for _ in 0..1000 {
        assert_eq!(period(&mut servo, 30_000), 0.0);
    }
    // 0.48 m/s² is above it; it comes to rest before its target and stays there.
    let z = (0..2000).fold(0.0, |_, _| period(&mut servo, 40_000));
    assert!(z > 10_000.0 && z < 40_000.0, "{z}");
    assert_eq!((period(&mut servo, 40_000), servo.v), (z, 0));
}

#[test]
fn an_integral_overcomes_friction_and_takes_a_constant_load_off() {
    let mut servo = servo(&ServoOptions {
        integral_us: 10_000,
        sticking: Acceleration::from_nm_per_s2(250_000_000),
        sliding: Acceleration::from_nm_per_s2(250_000_000),
        ..plain(30, 0, 0)
    });
    let (mut target, mut z) = (0, 0.0);
    for _ in 0..3000 {
        target += 10_000;
        z = period(&mut servo, target);
    }
    let lag = (target as f64 - z) / 10e6;
    assert!((lag - (1.0 / 30.0 - H)).abs() < 0.5e-6, "{lag}");
}

#[test]
fn the_current_follows_with_its_own_time() {
    let mut servo = servo(&ServoOptions {
        current_loop_milli: 1_000_000,
        ..plain(30, 0, 0)
    });
    servo.v = 0;
    let asked = product(servo.constants.speed_gain, 1000 << 32, 24) as f64;
    servo.ask(1000 << 32);
    let part = servo.a as f64 / asked;
    assert!((part - (1.0 - (-1000.0 * H).exp())).abs() < 1e-9, "{part}");
}

#[test]
fn speed_and_acceleration_stay_within_the_limits_of_the_drive() {
    let options = ServoOptions {
        speed_limit: Feed::from_nm_per_min(6_000_000_000),
        acceleration_limit: Acceleration::from_nm_per_s2(2_000_000_000),
        ..plain(30, 0, 0)
    };
    let mut servo = servo(&options);
    let (mut before, mut speed, mut fastest, mut hardest) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for _ in 0..2000 {
        let z = period(&mut servo, 100_000_000);
        fastest = fastest.max((z - before) / 1e6);
        hardest = hardest.max(((z - before) / 1e6 - speed).abs() / 1e-3);
        (before, speed) = (z, (z - before) / 1e6);
    }
    // 100 mm/s and 2 m/s².
    assert!(fastest > 0.0999 && fastest < 0.1001, "{fastest}");
    assert!(hardest > 1.99 && hardest < 2.001, "{hardest}");
    assert!((before - 1e8).abs() < 2.0, "{before}");
}

#[test]
fn the_encoder_counts_in_whole_quanta() {
    let mut servo = Servo::new(
        &ServoOptions {
            count: Length::from_nm(1000),
            ..plain(30, 0, 0)
        },
        (1, 100),
        1000,
        Increments::new(7),
    )
    .unwrap();
    // 700 nm are no whole count of 1 µm.
    assert_eq!(servo.actual(), Increments::new(0));
    servo.rest_at(1999 << 16);
    assert_eq!(servo.actual(), Increments::new(10));
    servo.rest_at(-1 << 16);
    assert_eq!(servo.actual(), Increments::new(-10));
}

#[test]
fn at_rest_it_reads_back_where_it_was_put() {
    for (increments, nm) in [(1, 1), (1, 1000), (3, 1000), (7, 22_000), (8192, 5_000_000)] {
        let mut servo =
            Servo::new(&plain(30, 0, 0), (increments, nm), 1000, Increments::new(0)).unwrap();
        for count in [
            0,
            1,
            -1,
            12_345,
            -54_321,
            1_000_003,
            100_000_007,
            -99_999_989,
        ] {
            servo.stand_at(count);
            assert_eq!(servo.actual().get(), count as i32, "{increments}/{nm}");
            servo.count_from(count + 5);
            assert_eq!(servo.actual().get(), count as i32 + 5, "{increments}/{nm}");
        }
    }
}

#[test]
fn a_following_error_is_borne_for_its_time() {
    let following = Following {
        window: 1000,
        timeout_ms: 5,
    };
    let mut servo = servo(&plain(30, 0, 0));
    let mut codes = Vec::new();
    for k in 1..100 {
        assert_eq!(servo.latch(Increments::new(k * 60_000), true), None);
        codes.push(servo.period(following));
    }
    // 60 mm/s: beyond 1 µm in the first period; the sixth is longer than 5 ms.
    assert_eq!(codes.iter().position(Option::is_some), Some(5));
    assert_eq!(codes[5], Some(0x8611));
    // Slow enough it never is: 30 µm/s · 1/30 s.
    servo.stop();
    let at = servo.actual().get();
    for k in 0..1000 {
        let target = Increments::new(at + k * 29);
        assert_eq!(servo.latch(target, true), None);
        assert_eq!(servo.period(following), None);
    }
}

#[test]
fn options_out_of_their_range_make_no_drive() {
    let made = |options: ServoOptions| Servo::new(&options, (1, 1), 1000, Increments::new(0));
    let good = plain(30, 0, 16);
    assert!(made(good).is_some());
    let wrong = [
        ServoOptions { buffer: 17, ..good },
        ServoOptions {
            feed_forward_milli: 1501,
            ..good
        },
        ServoOptions {
            kv_milli: 8_000_000,
            ..good
        },
        ServoOptions {
            speed_loop_milli: 8_000_000,
            ..good
        },
        ServoOptions {
            play: Length::from_nm(-1),
            ..good
        },
        ServoOptions {
            count: Length::from_nm(-1),
            ..good
        },
        ServoOptions {
            sliding: Acceleration::from_nm_per_s2(-1),
            ..good
        },
        ServoOptions {
            late: Some(Late {
                extrapolate: 2,
                fault: 2,
            }),
            ..good
        },
    ];
    for options in wrong {
        assert!(made(options).is_none(), "{options:?}");
    }
    for (increments, tick) in [
        ((0, 1), 1000),
        ((1, 0), 1000),
        ((1, 1), 0),
        ((1, 1), 20_001),
    ] {
        assert!(Servo::new(&good, increments, tick, Increments::new(0)).is_none());
    }
}

#[test]
fn nothing_overflows_whatever_comes() {
    leadscrew_seed::volume(7, |seed| {
        let mut random = Random::new(seed);
        let mut draw = |limit| random.below(limit);
        let mut made = 0;
        for _ in 0..leadscrew_seed::amount(400, 10_000) {
            let options = ServoOptions {
                buffer: draw(17) as u8,
                interpolation: if draw(2) == 0 {
                    Interpolation::Linear
                } else {
                    Interpolation::Cubic
                },
                kv_milli: draw(500_000) as u32,
                feed_forward_milli: draw(1501) as u16,
                speed_loop_milli: draw(3_000_000) as u32,
                integral_us: draw(100_000) as u32,
                current_loop_milli: draw(20_000_000) as u32,
                speed_limit: Feed::from_nm_per_min(draw(120_000_000_000) as i64),
                acceleration_limit: Acceleration::from_nm_per_s2(draw(50_000_000_000) as i64),
                sticking: Acceleration::from_nm_per_s2(draw(1_000_000_000) as i64),
                sliding: Acceleration::from_nm_per_s2(draw(1_000_000_000) as i64),
                viscous_milli: draw(10_000) as u32,
                play: Length::from_nm(draw(100_000) as i64),
                count: Length::from_nm(draw(5_000) as i64),
                following: None,
                undelayed: false,
                age_us: 0,
                screw: ScrewErrors::default(),
                late: None,
            };
            let increments = (1 + draw(1000) as u32, 1 + draw(1_000_000) as u32);
            let tick = [250, 500, 1000, 2000, 4000][draw(5) as usize];
            let Some(mut servo) = Servo::new(&options, increments, tick, Increments::new(0)) else {
                continue;
            };
            made += 1;
            let limit = servo.constants.acceleration_limit;
            for _ in 0..300 {
                let target = match draw(4) {
                    0 => (draw(1 << 31) as i32).wrapping_mul(2),
                    1 => i32::MIN,
                    2 => i32::MAX,
                    _ => draw(20_000) as i32,
                };
                servo.latch(Increments::new(target), true);
                servo.period(NO_WINDOW);
                assert!(servo.a.abs() <= limit, "{options:?}");
                assert!(servo.integral.abs() <= limit, "{options:?}");
                // Far from the end of its 63 bits, so nothing was cut off.
                assert!(servo.v.abs() < 1 << 60, "{options:?}");
                assert!(servo.z.abs() <= FARTHEST, "{options:?}");
                let play = (servo.z - servo.load).abs();
                assert!(play <= servo.constants.half_play, "{options:?}");
            }
        }
        assert!(made > 200, "{made}");
    });
}
