//! What leaves the window, for contours of a few cuts on the built-in machine.

extern crate std;
use std::vec::Vec;

use super::*;
use crate::alarm::Span;
use crate::call::{FeedRate, Position};
use crate::motion::plan;
use crate::motion::{Cut, Epoch, Stops};
use crate::moves::{Move, MoveKind};
use crate::params::Params;
use crate::units::{Feed, Length};

const UM: i64 = 1_000;

fn at(x_um: i64, z_um: i64) -> Position {
    Position {
        x: Length::from_nm(x_um * UM),
        z: Length::from_nm(z_um * UM),
        ..Position::ZERO
    }
}

struct Window {
    limits: Limits,
    lookahead: Lookahead,
    at: Position,
    number: u32,
}

impl Window {
    fn new() -> Self {
        Self {
            limits: Limits::from_params(&Params::default()),
            lookahead: Lookahead::new(),
            at: Position::ZERO,
            number: 0,
        }
    }

    /// A line from the last place, at a feed in mm/min.
    fn line(&mut self, x_um: i64, z_um: i64, feed: i64) -> &mut Self {
        let feed = Feed::from_nm_per_min(feed * 1_000_000);
        let wanted = Move {
            span: Span::default(),
            to: at(x_um, z_um),
            kind: MoveKind::Feed(FeedRate::PerMinute(feed)),
            tag: None,
        };
        let timed = plan::timed(self.at, &wanted, &self.limits)
            .unwrap()
            .unwrap();
        assert!(Lookahead::joins(&timed, &self.limits));
        self.at = wanted.to;
        self.number += 1;
        let segment = Segment {
            number: self.number,
            span: Span::default(),
            epoch: Epoch::default(),
            cut: Cut::NONE,
            stops: Stops::NONE,
            action: Action::Timed(timed),
        };
        assert!(self.lookahead.push(&segment, &self.limits));
        self
    }

    /// The next cut that leaves.
    fn leaves(&mut self, closed: bool) -> Due {
        let mut due = Due::NONE;
        assert!(self.lookahead.pop(&self.limits, closed, &mut due));
        due
    }

    fn corner(&self) -> Corner {
        *self.limits.corner().unwrap()
    }
}

/// Rate of a feed in mm/min.
fn rate(feed: f64) -> f64 {
    // 1/256 nm per millisecond.
    feed * 1e6 / 60_000.0 * 256.0
}

/// Lengths in micrometres, and rates as feeds in mm/min.
fn ways(due: &Due) -> Vec<(f64, f64)> {
    due.stretches
        .iter()
        .map(|stretch| {
            (
                stretch.length as f64 / 256.0 / 1e3,
                (f64::from(stretch.top.raw()) / rate(1.0) * 1e3).round() / 1e3,
            )
        })
        .collect()
}

fn rounds(due: &Due) -> bool {
    let Some(Segment {
        action: Action::Timed(timed),
        ..
    }) = &due.segment
    else {
        return false;
    };
    timed.rounding.is_some()
}

#[test]
fn straight_on_there_is_no_slow_place_and_room_for_an_override_of_150_percent() {
    let mut window = Window::new();
    window.line(0, -4_000, 300).line(0, -9_000, 300);
    let first = window.leaves(true);
    assert_eq!(ways(&first), [(4_000.0, 450.0)]);
    assert!(first.stretches[0].anew && first.stretches[0].ends_block && rounds(&first));
    let second = window.leaves(true);
    assert_eq!(ways(&second), [(5_000.0, 450.0)]);
    assert!(!second.stretches[0].anew && rounds(&second));
    // After the stop, a cut without another one is an exact stop by itself.
    let alone = window.line(0, -10_000, 300).leaves(true);
    assert!(alone.stretches.is_empty() && !rounds(&alone));
}

#[test]
fn a_corner_is_passed_at_the_rate_that_its_turn_allows_and_held_on_both_sides() {
    let mut window = Window::new();
    window.line(0, -40_000, 300).line(40_000, -40_000, 300);
    let corner = window.corner();
    // A quarter of a turn: Δu is √2.
    let passes = corner.turning as f64 / 2_f64.sqrt();
    let zone = |due: &Due| {
        let Action::Timed(timed) = &due.segment.unwrap().action else {
            panic!("a cut")
        };
        f64::from(timed.ramp.ticks()) + 2.0 * window_of(&corner)
    };
    let near =
        |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
    let first = window.leaves(true);
    let zone = zone(&first);
    let [(fast, full), (slow, top)] = ways(&first)[..] else {
        panic!("{:?}", ways(&first))
    };
    assert_eq!((fast + slow, full), (40_000.0, 450.0));
    near(top, passes / rate(1.0));
    near(slow, passes * zone / 256e3);
    let [(slow, again), (_, full)] = ways(&window.leaves(true))[..] else {
        panic!("two stretches")
    };
    // The corner itself takes another mean.
    near(slow, passes * (zone + window_of(&corner)) / 256e3);
    assert_eq!((again, full), (top, 450.0));
}

fn window_of(corner: &Corner) -> f64 {
    f64::from(corner.mean.ticks())
}

#[test]
fn a_corner_below_half_the_feed_is_a_stop() {
    let mut window = Window::new();
    window.line(0, -10_000, 1_000).line(10_000, -10_000, 1_000);
    window
        .line(10_000, -20_000, 1_000)
        .line(10_000, -30_000, 1_000);
    // Two cuts with exact stops, then two that are joined.
    for _ in 0..2 {
        let due = window.leaves(true);
        assert!(due.stretches.is_empty() && !rounds(&due));
    }
    let third = window.leaves(true);
    assert!(third.stretches[0].anew && rounds(&third));
    assert!(!window.leaves(true).stretches[0].anew);
}

#[test]
fn what_is_not_known_is_approached_no_faster_than_it_could_turn_round() {
    let mut window = Window::new();
    window.line(0, -100, 600).line(0, -200, 600);
    let (first, second) = (window.leaves(false), window.leaves(false));
    let turn_round = window.corner().turning as f64 / 2.0 / rate(1.0);
    let last = |due: &Due| ways(due).last().copied().unwrap().1;
    assert!(
        (last(&second) / turn_round - 1.0).abs() < 1e-3,
        "{}",
        last(&second)
    );
    assert!(last(&first) >= last(&second) && last(&first) < 600.0);
    // What comes then goes on without a stop.
    let third = window.line(0, -300, 600).leaves(true);
    assert!(!third.stretches[0].anew && rounds(&third));
    assert!(last(&third) > last(&second));
}

/// Cuts of `um` micrometres straight on until the window is full; the last place on Z.
fn full_of(um: i64, feed: i64) -> (Window, i64) {
    let mut window = Window::new();
    for number in 1..=WINDOW as i64 {
        window.line(0, -um * number, feed);
    }
    assert!(window.lookahead.is_full());
    (window, -um * WINDOW as i64)
}

/// Takes out what waits. Cuts that begin after a stop, or end in one by themselves.
fn stops(window: &mut Window) -> usize {
    let mut stops = 0;
    while !window.lookahead.is_empty() {
        let due = window.leaves(true);
        stops += usize::from(due.stretches.first().is_none_or(|stretch| stretch.anew));
    }
    stops
}

#[test]
fn with_the_window_full_the_way_is_expected_to_go_on_as_it_was() {
    // Two millimetres are known, a tenth of a second, and the feed and half of it again may be put in.
    let (mut window, z) = full_of(80, 1_200);
    let first = window.leaves(false);
    let fastest = |due: &Due| ways(due).iter().map(|(_, top)| *top).fold(0.0, f64::max);
    assert!(fastest(&first) > 1_200.0, "{:?}", ways(&first));
    // A cut of 5 µm can be passed at 5 µm in a tick, 300 mm/min. It is known in time for a rate that takes less time than a
    // stop.
    window.line(0, z - 5, 1_200);
    let mut slowest = f64::MAX;
    while window.lookahead.window.len() > 1 {
        let due = window.leaves(true);
        assert!(!due.stretches.is_empty() && !due.stretches[0].anew);
        slowest = ways(&due)
            .iter()
            .map(|(_, top)| *top)
            .fold(slowest, f64::min);
    }
    assert!(slowest <= 300.0, "{slowest}");
    assert_eq!(stops(&mut window), 0);
}

#[test]
fn a_slow_place_that_is_known_too_late_is_a_stop() {
    // All but two of the cuts that are known have left when it comes.
    let (mut window, z) = full_of(6, 300);
    while window.lookahead.window.len() > 2 {
        let due = window.leaves(false);
        assert!(!due.stretches.is_empty());
    }
    window.line(0, z - 1, 300).line(0, z - 1_000, 300);
    assert_eq!(stops(&mut window), 1);
}

#[test]
fn chords_of_a_curve_are_passed_without_a_stop_whatever_the_feed() {
    // Radius 5 mm, chords of 0.1 mm: each corner is 20 mrad.
    let rate_at = |feed: i64| {
        let mut window = Window::new();
        let mut chords = 0..;
        let mut chord = |window: &mut Window| {
            let angle = f64::from(chords.next().unwrap() + 1) * 0.02;
            let (x, z) = (5e3 * (1.0 - angle.cos()), -5e3 * angle.sin());
            window.line(x.round() as i64, z.round() as i64, feed);
        };
        for _ in 0..WINDOW {
            chord(&mut window);
        }
        let mut slowest = f64::MAX;
        for number in 0..250 {
            let due = window.leaves(false);
            assert!(!due.stretches.is_empty(), "{feed} {number}");
            assert!(number == 0 || !due.stretches[0].anew, "{feed} {number}");
            if number >= 50 {
                slowest = ways(&due)
                    .iter()
                    .map(|(_, top)| *top)
                    .fold(slowest, f64::min);
            }
            chord(&mut window);
        }
        slowest
    };
    let rates = [2_000, 4_000, 7_900].map(rate_at);
    assert!(rates.iter().all(|rate| *rate > 1_500.0), "{rates:?}");
}

#[test]
fn a_tolerance_of_zero_joins_nothing() {
    let mut params = Params::default();
    let entry = crate::params::Entry::find_text("9033").unwrap();
    params.set(entry, 0).unwrap();
    let limits = Limits::from_params(&params);
    assert!(limits.corner().is_none());
}
