//! Every method of 6098h, from every side: the mark is where the method puts it, and the board stands at its distance from
//! it.

use leadscrew_board_sim::plant::HomingOptions;

use crate::bench::{Bench, MARK, SWITCHES, params_and};

/// The next index above a place.
fn above(place: i64) -> i64 {
    (place - 12_500).div_euclid(50_000) * 50_000 + 62_500
}

/// The next index below a place.
fn below(place: i64) -> i64 {
    (place - 12_501).div_euclid(50_000) * 50_000 + 12_500
}

/// The marks of the methods by hand: the switch goes off 20 µm (200 increments) farther than where it goes on.
fn mark(method: u8, start: i64) -> i64 {
    match method {
        1 => above(-999_800),
        2 => below(999_800),
        7 | 14 => below(299_800),
        8 | 13 => above(300_000),
        9 | 12 => below(400_000),
        10 | 11 => above(400_200),
        17 => -999_800,
        18 => 999_800,
        19 | 23 | 30 => 299_800,
        20 | 22 | 24 | 29 => 300_000,
        21 => 300_200,
        25 | 28 => 400_000,
        26 | 27 => 400_200,
        33 => below(start),
        34 => above(start),
        _ => start,
    }
}

/// The switches for a method: 19 and 20 have one to the positive end, 21 and 22 one to the negative end.
fn switches(method: u8) -> HomingOptions {
    let home = match method {
        19 | 20 => (300_000, 3_000_000),
        21 | 22 => (-3_000_000, 300_000),
        _ => SWITCHES.home,
    };
    HomingOptions { home, ..SWITCHES }
}

const METHODS: [u8; 28] = [
    1, 2, 7, 8, 9, 10, 11, 12, 13, 14, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 33,
    34, 35, 37,
];

#[test]
fn every_method_from_every_side() {
    for method in METHODS {
        for start in [-955_000, 0, 299_900, 350_001, 400_100, 700_000, 955_000] {
            for ends_past in [false, true] {
                let what = format!("method {method} from {start}, past {ends_past}");
                let options = HomingOptions {
                    ends_past,
                    ..switches(method)
                };
                // With the one way to end, the drive gets its setpoints in mode 7.
                let streamed = if ends_past { 7 } else { 8 };
                let params = params_and(&[("9076.X", streamed.into())]);
                let mut bench = Bench::with(&params, start, options, method);
                let at = bench.home_x(&what);
                let place = bench.drive().place();
                let mark = mark(method, start);
                assert_eq!(at, MARK + (place - mark) * 100, "{what}: {place}");
                assert_eq!(
                    i64::from(bench.drive().actual().get()),
                    place - mark,
                    "{what}"
                );
                let rests_past = ends_past && !matches!(method, 35 | 37);
                assert_eq!(place != mark, rests_past, "{what}: {place}");
                bench.judge(&what, 4);
                assert_eq!(bench.modes, [6, streamed], "{what}");
            }
        }
    }
}
