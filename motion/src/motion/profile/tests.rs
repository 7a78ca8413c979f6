//! The profile, compared with hand-worked motions and with random operators.

extern crate std;
use super::*;
use leadscrew_seed::Random;
use std::vec::Vec;

fn ramp(cap: u32, n1: u16, n2: u16) -> Ramp {
    Ramp::new(PathRate::from_raw(cap), n1, n2).unwrap()
}

/// Checks A, K and V of every tick and the end.
struct Watch {
    profile: Profile,
    accel: i64,
}

impl Watch {
    fn tick(&mut self, rate: Rate) -> Progress {
        let progress = self.profile.tick(rate);
        let Ramp { cap, n1, n2, .. } = self.profile.ramp;
        let (v, n1, n2) = (i64::from(cap.raw()), i64::from(n1), i64::from(n2));
        let jerk = self.profile.accel - self.accel;
        assert!(jerk.abs() <= v, "jerk {jerk}");
        assert!(
            self.profile.accel.abs() <= n2 * v,
            "{:?}",
            self.profile.accel
        );
        assert!((0..=n1 * n2 * v).contains(&self.profile.speed));
        self.accel = self.profile.accel;
        progress
    }
}

/// Input in 1/256 nm. `Profile::begin` takes whole nm, so this function sets finer lengths directly.
fn begin(watch: &mut Watch, units: u64, nominal: u32, ramp: Ramp) {
    assert!(
        watch
            .profile
            .begin(Length::ZERO, PathRate::from_raw(nominal), ramp)
    );
    watch.profile.left = units;
}

#[test]
fn constant_pulse_is_the_time_optimal_ramp() {
    let mut profile = <Profile>::new();
    assert!(profile.begin(
        Length::from_nm(10),
        PathRate::from_raw(256),
        ramp(256, 3, 2)
    ));
    let mut travel = Vec::new();
    loop {
        let progress = profile.tick(Rate::FULL);
        travel.push(progress.travel.raw());
        if progress.done {
            break;
        }
    }
    // Ten ticks of input, 3 + 2 of the means: speed in sixths 1 3 5 6 6 6 6 6 6 6 5 3 1, and two ticks of rest.
    assert_eq!(travel.len(), 15);
    assert_eq!(travel[12..], [655_360; 3]);
    let sixths = [1, 4, 9, 15, 21, 27, 33, 39, 45, 51, 56, 59, 60_u64];
    for (travel, sixths) in travel.iter().zip(sixths) {
        assert_eq!(*travel, sixths * 65_536 / 6);
    }
}

/// A random operator with small ramps and short lengths, so that every case of the governor occurs.
#[test]
fn no_operator_breaks_a_limit_or_the_end() {
    leadscrew_seed::volume(11, |seed| {
        let rounds = leadscrew_seed::amount(60_000, 3_000_000);
        let mut random = Random(seed);
        let mut watch = Watch {
            profile: Profile::new(),
            accel: 0,
        };
        for round in 0..rounds {
            let (n1, n2) = (1 + random.below(7) as u16, 1 + random.below(7) as u16);
            let cap = 2 + random.below(40) as u32;
            let area = u64::from(n1) * u64::from(n2);
            let mut units = random.below(u64::from(cap) * 40);
            begin(&mut watch, units, cap, ramp(cap, n1, n2));
            // Behaviour of this operator: how often the rate changes, and to which values.
            let (change, kind) = (1 + random.below(8), random.below(4));
            let mut rate = Rate::FULL;
            let (mut ticks, mut limit) = (0_u64, 4_000);
            loop {
                if ticks < 300 && random.below(change) == 0 {
                    rate = match kind {
                        0 => Rate::from_raw(random.below(70_000) as u32),
                        1 => [Rate::HOLD, Rate::FULL][random.below(2) as usize],
                        2 => Rate::percent((95 + random.below(10)) as u8),
                        _ => [Rate::HOLD, Rate::percent(3), Rate::percent(50), Rate::FULL]
                            [random.below(4) as usize],
                    };
                } else if ticks == 300 {
                    rate = Rate::FULL;
                }
                if random.below(400) == 0 {
                    let more = random.below(200);
                    watch.profile.left += more;
                    units += more;
                    limit += 4_000;
                }
                let progress = watch.tick(rate);
                ticks += 1;
                if progress.done {
                    break;
                }
                assert!(ticks < limit, "round {round} never ends");
            }
            assert_eq!(watch.profile.travel, units << 8, "round {round}");
            assert_eq!((watch.profile.remainder, area > 0), (0, true));
        }
    });
}

#[test]
fn hold_then_resume_ends_where_it_should() {
    let mut profile = <Profile>::new();
    assert!(profile.begin(
        Length::from_nm(1_000),
        PathRate::from_raw(2_560),
        ramp(2_560, 5, 4)
    ));
    for _ in 0..20 {
        assert!(!profile.tick(Rate::FULL).done);
    }
    for _ in 0..9 {
        assert!(!profile.tick(Rate::HOLD).done);
    }
    assert!(profile.at_rest());
    let standing = profile.tick(Rate::HOLD);
    assert_eq!(standing.travel, Travel::from_raw((20 * 2_560) << 8));
    assert_eq!(profile.remaining(), Length::from_nm(800));
    let mut ticks = 0;
    loop {
        let progress = profile.tick(Rate::FULL);
        ticks += 1;
        if progress.done {
            assert_eq!(progress.travel, Travel::of(Length::from_nm(1_000)));
            break;
        }
    }
    assert_eq!(ticks, 80 + 9);
}

#[test]
fn abandoned_while_moving_stops_and_leaves_nothing() {
    let mut profile = <Profile>::new();
    let ramp = ramp(2_560, 5, 4);
    assert!(profile.begin(Length::from_nm(1_000), PathRate::from_raw(2_560), ramp));
    for _ in 0..20 {
        profile.tick(Rate::FULL);
    }
    assert!(!profile.begin(Length::from_nm(1), PathRate::from_raw(256), ramp));
    profile.abandon();
    for _ in 0..8 {
        assert!(!profile.tick(Rate::FULL).done);
    }
    let last = profile.tick(Rate::FULL);
    assert!(last.done);
    assert_eq!(last.travel, Travel::of(Length::from_nm(200)));
    assert_eq!(profile.remaining(), Length::ZERO);
    // The next motion starts from an empty profile.
    assert!(profile.begin(Length::from_nm(3), PathRate::from_raw(256), ramp));
    let first = profile.tick(Rate::FULL);
    assert_eq!(
        (first.travel, first.done),
        (Travel::from_raw(85 * 256 * 256 / 256 / 20), false)
    );
}

#[test]
fn abandoned_at_rest_is_done_at_once() {
    let mut profile = <Profile>::new();
    assert!(profile.begin(Length::from_nm(3), PathRate::from_raw(256), ramp(256, 1, 1)));
    profile.abandon();
    assert_eq!(
        profile.tick(Rate::FULL),
        Progress {
            travel: Travel::ZERO,
            done: true
        }
    );
}

#[test]
fn a_longer_ramp_does_not_see_the_motion_before() {
    let mut profile = <Profile>::new();
    let run = |profile: &mut Profile, ramp| {
        assert!(profile.begin(Length::from_nm(50), PathRate::from_raw(256), ramp));
        let mut travels = Vec::new();
        while {
            let progress = profile.tick(Rate::FULL);
            travels.push(progress.travel);
            !progress.done
        } {}
        travels
    };
    run(&mut profile, ramp(256, 2, 2));
    let used = run(&mut profile, ramp(256, 20, 11));
    assert_eq!(used, run(&mut Profile::new(), ramp(256, 20, 11)));
}

#[test]
fn the_longest_ramp_uses_the_whole_ring() {
    let mut watch = Watch {
        profile: Profile::new(),
        accel: 0,
    };
    begin(&mut watch, 3_000 * 7, 7, ramp(7, 1_024, 1_024));
    let mut ticks = 0;
    while !watch.tick(Rate::FULL).done {
        ticks += 1;
    }
    assert_eq!(ticks + 1, 3_000 + 2_048);
}

#[test]
fn ramps_that_cannot_be_are_refused() {
    let cap = PathRate::from_raw(256);
    assert_eq!(Ramp::new(cap, 0, 4), None);
    assert_eq!(Ramp::new(cap, 4, 0), None);
    assert_eq!(Ramp::new(cap, 2_000, 49), None);
    assert_eq!(Ramp::new(PathRate::from_raw(1), 4, 4), None);
}
